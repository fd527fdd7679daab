//! Time: integer ticks of TDB; seconds and dates are derived, never summed.
//!
//! One tick is 1/60 s. [`SimTime`] counts ticks from J2000.0 TDB (JD 2451545.0). Wall-clock time never enters here.
//! TT is taken equal to TDB (they differ by less than 2 ms). UTC is TT − 32.184 s − leap seconds (IERS Bulletin C).

use crate::units::{DAY, HOUR, MINUTE};
use core::fmt;
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

    /// The UTC calendar date and time of day.
    pub fn utc(self) -> CivilTime {
        CivilTime::from_utc_seconds(self.seconds() - tdb_minus_utc(self))
    }

    /// The instant of a UTC calendar date.
    #[allow(clippy::cast_possible_truncation)]
    pub fn from_utc(civil: CivilTime) -> Self {
        let utc_s = civil.utc_seconds();
        let tai_minus_utc = LEAP.iter().rev().find(|(date, _)| midnight(*date) <= utc_s).map_or(LEAP[0].1, |(_, offset)| *offset);
        Self { ticks: ((utc_s + tai_minus_utc + TT_MINUS_TAI) * TICKS_PER_SECOND as f64).round() as i64 }
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

/// Leap seconds: `(UTC seconds since J2000.0 12:00 UTC, TAI − UTC)`. Source: IERS Bulletin C (last entry 2017-01-01).
const LEAP: [((i32, u32, u32), f64); 28] = [
    ((1972, 1, 1), 10.0),
    ((1972, 7, 1), 11.0),
    ((1973, 1, 1), 12.0),
    ((1974, 1, 1), 13.0),
    ((1975, 1, 1), 14.0),
    ((1976, 1, 1), 15.0),
    ((1977, 1, 1), 16.0),
    ((1978, 1, 1), 17.0),
    ((1979, 1, 1), 18.0),
    ((1980, 1, 1), 19.0),
    ((1981, 7, 1), 20.0),
    ((1982, 7, 1), 21.0),
    ((1983, 7, 1), 22.0),
    ((1985, 7, 1), 23.0),
    ((1988, 1, 1), 24.0),
    ((1990, 1, 1), 25.0),
    ((1991, 1, 1), 26.0),
    ((1992, 7, 1), 27.0),
    ((1993, 7, 1), 28.0),
    ((1994, 7, 1), 29.0),
    ((1996, 1, 1), 30.0),
    ((1997, 7, 1), 31.0),
    ((1999, 1, 1), 32.0),
    ((2006, 1, 1), 33.0),
    ((2009, 1, 1), 34.0),
    ((2012, 7, 1), 35.0),
    ((2015, 7, 1), 36.0),
    ((2017, 1, 1), 37.0),
];

/// TT − TAI, s (exact).
const TT_MINUS_TAI: f64 = 32.184;

/// Seconds from 2000-01-01 12:00:00 UTC to the midnight that begins a date, leap seconds not counted.
fn midnight((year, month, day): (i32, u32, u32)) -> f64 {
    CivilTime { year, month, day, hour: 0, minute: 0, second: 0.0 }.utc_seconds()
}

/// TDB − UTC, in seconds. Before 1972 the first entry is held (UTC as it is defined now did not exist).
pub fn tdb_minus_utc(t: SimTime) -> f64 {
    let s = t.seconds();
    let begun = |(date, offset): &&((i32, u32, u32), f64)| midnight(*date) + offset + TT_MINUS_TAI <= s;
    LEAP.iter().rev().find(begun).map_or(LEAP[0].1, |(_, offset)| *offset) + TT_MINUS_TAI
}

/// A proleptic Gregorian calendar date with time of day.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CivilTime {
    /// Astronomical year (0 is 1 BC).
    pub year: i32,
    /// 1 … 12.
    pub month: u32,
    /// 1 … 31.
    pub day: u32,
    /// 0 … 23.
    pub hour: u32,
    /// 0 … 59.
    pub minute: u32,
    /// 0 ≤ second < 60.
    pub second: f64,
}

impl CivilTime {
    /// Seconds from 2000-01-01 12:00:00 on the same scale, leap seconds not counted.
    pub fn utc_seconds(self) -> f64 {
        let days = days_from_civil(self.year, self.month, self.day) - days_from_civil(2000, 1, 1);
        days as f64 * DAY - 0.5 * DAY + f64::from(self.hour) * HOUR + f64::from(self.minute) * MINUTE + self.second
    }

    /// The inverse of [`CivilTime::utc_seconds`].
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn from_utc_seconds(s: f64) -> Self {
        // Rounded to the millisecond first, so that no field shows 60.
        let s = (s * 1000.0).round() / 1000.0 + 0.5 * DAY;
        let days = (s / DAY).floor();
        let rest = s - days * DAY;
        let (year, month, day) = civil_from_days(days as i64 + days_from_civil(2000, 1, 1));
        let hour = (rest / HOUR).floor();
        let minute = ((rest - hour * HOUR) / MINUTE).floor();
        Self { year, month, day, hour: hour as u32, minute: minute as u32, second: rest - hour * HOUR - minute * MINUTE }
    }

    /// Parses `2026-08-12`, `2026-08-12T17:30` or `2026-08-12T17:30:00[.5][Z]`. The error says what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let bad = || format!("`{text}` is not a UTC date: expected YYYY-MM-DD, YYYY-MM-DDThh:mm or YYYY-MM-DDThh:mm:ss");
        let trimmed = text.trim().trim_end_matches('Z');
        let (date, clock) = trimmed.split_once(['T', ' ']).unwrap_or((trimmed, "0:0:0"));
        let (negative, digits) = date.strip_prefix('-').map_or((false, date), |d| (true, d));
        let d: Vec<&str> = digits.split('-').collect();
        let c: Vec<&str> = clock.split(':').collect();
        if d.len() != 3 || !(2..=3).contains(&c.len()) {
            return Err(bad());
        }
        let year: i32 = d[0].parse().map_err(|_| bad())?;
        let civil = Self {
            year: if negative { -year } else { year },
            month: d[1].parse().map_err(|_| bad())?,
            day: d[2].parse().map_err(|_| bad())?,
            hour: c[0].parse().map_err(|_| bad())?,
            minute: c[1].parse().map_err(|_| bad())?,
            second: c.get(2).map_or(Ok(0.0), |s| s.parse::<f64>()).map_err(|_| bad())?,
        };
        let in_range = (1..=12).contains(&civil.month)
            && (1..=31).contains(&civil.day)
            && civil.hour < 24
            && civil.minute < 60
            && (0.0..60.0).contains(&civil.second)
            && civil.year.abs() < 1_000_000;
        let back = civil_from_days(days_from_civil(civil.year, civil.month.clamp(1, 12), civil.day));
        if !in_range || back != (civil.year, civil.month, civil.day) {
            return Err(format!("`{text}` is not a date of the calendar: expected month 1–12, day within the month, time below 24:00:00"));
        }
        Ok(civil)
    }
}

impl fmt::Display for CivilTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = self.second.floor();
        write!(f, "{:04}-{:02}-{:02} {:02}:{:02}:{:02} UTC", self.year, self.month, self.day, self.hour, self.minute, s)
    }
}

/// Days from 1970-01-01 of a proleptic Gregorian date (the era algorithm: 400-year cycles of 146,097 days).
fn days_from_civil(year: i32, month: u32, day: u32) -> i64 {
    let y = i64::from(year) - i64::from(month <= 2);
    let era = y.div_euclid(400);
    let yoe = y.rem_euclid(400);
    let mp = (i64::from(month) + 9) % 12;
    let doy = (153 * mp + 2) / 5 + i64::from(day) - 1;
    let doe = yoe * 365 + yoe / 4 - yoe / 100 + doy;
    era * 146_097 + doe - 719_468
}

/// The inverse of [`days_from_civil`].
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn civil_from_days(days: i64) -> (i32, u32, u32) {
    let z = days + 719_468;
    let era = z.div_euclid(146_097);
    let doe = z.rem_euclid(146_097);
    let yoe = (doe - doe / 1460 + doe / 36_524 - doe / 146_096) / 365;
    let doy = doe - (365 * yoe + yoe / 4 - yoe / 100);
    let mp = (5 * doy + 2) / 153;
    let day = (doy - (153 * mp + 2) / 5 + 1) as u32;
    let month = if mp < 10 { mp + 3 } else { mp - 9 } as u32;
    ((yoe + era * 400 + i64::from(month <= 2)) as i32, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn julian_dates_round_trip() {
        for jd in [J2000_JD, 2_461_265.241_041_667, 2_415_020.0, 2_488_069.5] {
            assert!((SimTime::from_jd_tdb(jd).jd_tdb() - jd).abs() < 0.6 * TICK_S / DAY + 5e-10);
        }
        assert_eq!(SimTime::from_jd_tdb(J2000_JD).ticks, 0);
    }

    #[test]
    fn greatest_eclipse_of_2026_in_utc() {
        // NASA canon: 2026-08-12 greatest eclipse 17:47:06 TT = 17:45:57 UTC with 37 leap seconds.
        let utc = SimTime::from_jd_tdb(2_461_265.241_041_667).utc();
        assert_eq!((utc.year, utc.month, utc.day, utc.hour, utc.minute), (2026, 8, 12, 17, 45));
        assert!((utc.second - 56.8).abs() < 0.2, "{}", utc.second);
        assert!((SimTime::from_utc(utc).since(SimTime::from_jd_tdb(2_461_265.241_041_667))).abs() <= TICK_S);
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

    #[test]
    fn leap_second_of_2017() {
        let before = SimTime::from_utc(CivilTime::parse("2016-12-31T23:59:59").unwrap());
        let after = SimTime::from_utc(CivilTime::parse("2017-01-01T00:00:00").unwrap());
        assert_eq!(after.ticks - before.ticks, 2 * TICKS_PER_SECOND);
    }

    #[test]
    fn refuses_what_is_no_date() {
        for bad in ["", "yesterday", "2026-13-01", "2026-02-30", "2026-08-12T25:00", "2026-08-12T10:00:99", "2026-08"] {
            assert!(CivilTime::parse(bad).is_err(), "{bad}");
        }
        assert!(CivilTime::parse("2028-02-29T12:00:00Z").is_ok());
    }
}
