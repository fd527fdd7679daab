//! Time: integer ticks of TDB; seconds and dates are derived, never summed.
//!
//! One tick is 1/60 s. [`SimTime`] counts ticks from J2000.0 TDB (JD 2451545.0); a [`Moment`] lies between ticks. Wall-clock time
//! never enters here. [`calendar`] has dates, [`scales`] takes TDB to TT, UTC and UT1, [`delta_t`] knows how late the Earth turns.

pub mod calendar;
pub mod delta_t;
pub mod scales;

pub use calendar::CivilTime;
pub use scales::tdb_minus_utc;

use serde::{Deserialize, Serialize};

/// Ticks in a second.
pub const TICKS_PER_SECOND: i64 = 60;
/// Length of a tick, in seconds.
pub const TICK_S: f64 = 1.0 / 60.0;
/// Julian date (TDB) of the origin of [`SimTime`].
pub const J2000_JD: f64 = 2_451_545.0;

/// An instant of TDB, in ticks since J2000.0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SimTime {
    /// Ticks since J2000.0 TDB.
    pub ticks: i64,
}

impl SimTime {
    /// From a count of ticks since J2000.0 TDB.
    pub const fn from_ticks(ticks: i64) -> Self {
        Self { ticks }
    }

    /// The tick nearest to a TDB Julian date. Saturates beyond ±4.8 Gyr.
    #[allow(clippy::cast_possible_truncation)]
    pub fn from_jd_tdb(jd: f64) -> Self {
        // Split so that the fraction of the day keeps its digits.
        let whole = (jd - J2000_JD).floor();
        let fraction = (jd - J2000_JD) - whole;
        let per_day = 86_400 * TICKS_PER_SECOND;
        Self { ticks: (whole as i64).saturating_mul(per_day).saturating_add((fraction * per_day as f64).round() as i64) }
    }

    /// TDB Julian date (f64: good to 40 µs near the present).
    pub fn jd_tdb(self) -> f64 {
        let per_day = 86_400 * TICKS_PER_SECOND;
        J2000_JD + self.ticks.div_euclid(per_day) as f64 + self.ticks.rem_euclid(per_day) as f64 / per_day as f64
    }

    /// Seconds of TDB since J2000.0.
    pub fn seconds(self) -> f64 {
        self.ticks as f64 / TICKS_PER_SECOND as f64
    }

    /// Exact difference in seconds, `self − earlier`.
    pub fn since(self, earlier: Self) -> f64 {
        (self.ticks - earlier.ticks) as f64 / TICKS_PER_SECOND as f64
    }

    /// This instant moved by whole ticks.
    pub const fn plus(self, ticks: i64) -> Self {
        Self { ticks: self.ticks.saturating_add(ticks) }
    }
}

/// An instant that need not be a tick: seconds beyond one. The pair keeps every digit far from J2000 (at 26 years one ulp of
/// seconds is 0.1 µs: millimetres of the Earth's path).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// The tick at or before it.
    pub tick: SimTime,
    /// Seconds after the tick, 0 … [`TICK_S`].
    pub beyond_s: f64,
}

impl Moment {
    /// `s` seconds after a tick; any finite `s` within ±1e13.
    #[allow(clippy::cast_possible_truncation)]
    pub fn after(tick: SimTime, s: f64) -> Self {
        let whole = (s * TICKS_PER_SECOND as f64).floor();
        Self { tick: tick.plus(whole as i64), beyond_s: (s - whole / TICKS_PER_SECOND as f64).max(0.0) }
    }

    /// This moment moved by `s` seconds.
    pub fn plus_s(self, s: f64) -> Self {
        Self::after(self.tick, self.beyond_s + s)
    }

    /// `self − earlier`, s.
    pub fn since(self, earlier: Self) -> f64 {
        self.tick.since(earlier.tick) + (self.beyond_s - earlier.beyond_s)
    }

    /// The first tick that is not before this moment.
    pub fn next_tick(self) -> SimTime {
        if self.beyond_s > 0.0 { self.tick.plus(1) } else { self.tick }
    }
}

impl From<SimTime> for Moment {
    fn from(tick: SimTime) -> Self {
        Self { tick, beyond_s: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DAY;

    #[test]
    fn julian_dates_round_trip() {
        for jd in [J2000_JD, 2_461_265.241_041_667, 2_415_020.0, 2_488_069.5] {
            assert!((SimTime::from_jd_tdb(jd).jd_tdb() - jd).abs() < 0.6 * TICK_S / DAY + 5e-10);
        }
        assert_eq!(SimTime::from_jd_tdb(J2000_JD).ticks, 0);
    }

    #[test]
    fn a_moment_keeps_its_digits_decades_from_the_origin() {
        let start = Moment::from(SimTime::from_jd_tdb(2_461_265.25));
        let later = start.plus_s(1234.567_890_123);
        assert!((later.since(start) - 1234.567_890_123).abs() < 1e-12);
        assert!((0.0..TICK_S).contains(&later.beyond_s) && later.next_tick() > later.tick);
        assert!(later.plus_s(-1234.567_890_123).since(start).abs() < 1e-12);
        assert_eq!(start.plus_s(0.5), Moment::from(start.tick.plus(30)));
    }
}
