//! Time scales: TDB (what [`SimTime`] counts), TT, UT1 and UTC, each way.
//!
//! ```text
//! TDB ── tdb_minus_tt_s (≤ 1.7 ms) ── TT ── ΔT (delta_t) ── UT1: how far the Earth has turned
//!                                     └──── 32.184 s + leap seconds ── UTC: what clocks show
//! ```
//! UTC holds from 1972 on; before, civil time is UT1, as it was then. After the last leap second announced none is added: |UT1 − UTC|
//! stays below 0.9 s to the end of the observed table and then grows with the long-term model.
//! - [Fairhead & Bretagnon 1990] "An analytical formula for the time transformation TB−TT", A&A 229, 240: its seven largest terms.
//! - IERS Bulletin C (leap seconds).

use super::calendar::CivilTime;
use super::delta_t::delta_t_s;
use super::{J2000_JD, Moment, SimTime, TICKS_PER_SECOND};
use crate::units::{DAY, JULIAN_CENTURY};

/// TT − TAI, s (exact).
const TT_MINUS_TAI: f64 = 32.184;

/// Leap seconds: `(from 0 h UTC of, TAI − UTC)`. Source: IERS Bulletin C (last entry 2017-01-01).
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

/// `(amplitude s, rate rad per century, phase rad)` of TDB − TT; the last is multiplied by T.
const TDB_TERMS: [(f64, f64, f64); 6] = [
    (0.001_657, 628.3076, 6.2401),
    (0.000_022, 575.3385, 4.2970),
    (0.000_014, 1256.6152, 6.1969),
    (0.000_005, 606.9777, 4.0212),
    (0.000_005, 52.9691, 0.4444),
    (0.000_002, 21.3299, 5.5431),
];
const TDB_SECULAR: (f64, f64, f64) = (0.000_010, 628.3076, 4.2490);

/// TDB − TT at `s` seconds (of either) since J2000.0, in seconds; good to 10 µs over 1600–2200 [Fairhead & Bretagnon 1990].
pub fn tdb_minus_tt_s(s: f64) -> f64 {
    let t = s / JULIAN_CENTURY;
    let wave = |(amplitude, rate, phase): (f64, f64, f64)| amplitude * libm::sin(rate * t + phase);
    // The secular term was fitted over centuries, not ages.
    TDB_TERMS.iter().map(|term| wave(*term)).sum::<f64>() + t.clamp(-20.0, 20.0) * wave(TDB_SECULAR)
}

/// Seconds from 2000-01-01 12:00:00 to the midnight that begins a date, leap seconds not counted.
fn midnight((year, month, day): (i32, u32, u32)) -> f64 {
    CivilTime { year, month, day, hour: 0, minute: 0, second: 0.0 }.utc_seconds()
}

/// TT − UTC at `tt_s` seconds of TT since J2000.0; before 1972, ΔT (civil time was UT1).
fn tt_minus_utc(tt_s: f64) -> f64 {
    let begun = |(date, offset): &&((i32, u32, u32), f64)| midnight(*date) + offset + TT_MINUS_TAI <= tt_s;
    LEAP.iter().rev().find(begun).map_or_else(|| delta_t_s(tt_s), |(_, offset)| *offset + TT_MINUS_TAI)
}

/// TDB − UTC, in seconds; before 1972, TDB − UT1.
pub fn tdb_minus_utc(t: SimTime) -> f64 {
    let s = t.seconds();
    let lead = tdb_minus_tt_s(s);
    lead + tt_minus_utc(s - lead)
}

impl SimTime {
    /// The UTC calendar date and time of day (before 1972: UT1).
    pub fn utc(self) -> CivilTime {
        CivilTime::from_utc_seconds(self.seconds() - tdb_minus_utc(self))
    }

    /// The tick nearest to a UTC calendar date (before 1972: UT1).
    #[allow(clippy::cast_possible_truncation)]
    pub fn from_utc(civil: CivilTime) -> Self {
        let utc_s = civil.utc_seconds();
        let leap = LEAP.iter().rev().find(|(date, _)| midnight(*date) <= utc_s);
        let tt_s = match leap {
            Some((_, offset)) => utc_s + offset + TT_MINUS_TAI,
            // ΔT turns by 1e-7 at most while time passes: one correction leaves under a microsecond.
            None => utc_s + delta_t_s(utc_s + delta_t_s(utc_s)),
        };
        Self { ticks: ((tt_s + tdb_minus_tt_s(tt_s)) * TICKS_PER_SECOND as f64).round() as i64 }
    }
}

impl Moment {
    /// Seconds of TDB since J2000.0, as one number (0.1 µs of rounding in 2026).
    pub fn seconds(self) -> f64 {
        self.tick.seconds() + self.beyond_s
    }

    /// Whole days and the fraction of a day (0 … 1) since J2000.0 of the scale that runs `behind_s` seconds behind TDB now.
    pub fn days_behind(self, behind_s: f64) -> (f64, f64) {
        let per_day = 86_400 * TICKS_PER_SECOND;
        let days = self.tick.ticks.div_euclid(per_day) as f64;
        let rest = (self.tick.ticks.rem_euclid(per_day) as f64 / TICKS_PER_SECOND as f64 + (self.beyond_s - behind_s)) / DAY;
        let whole = rest.floor();
        (days + whole, rest - whole)
    }

    /// TDB − TT now, s.
    pub fn tdb_minus_tt_s(self) -> f64 {
        tdb_minus_tt_s(self.seconds())
    }

    /// ΔT = TT − UT1 now, s.
    pub fn delta_t_s(self) -> f64 {
        delta_t_s(self.seconds())
    }

    /// Julian date of TT (one f64: good to 40 µs).
    pub fn jd_tt(self) -> f64 {
        let (days, fraction) = self.days_behind(self.tdb_minus_tt_s());
        J2000_JD + days + fraction
    }

    /// Julian date of UT1, from J2000.0: whole days, and the fraction of a day (0 … 1).
    pub fn ut1_days(self) -> (f64, f64) {
        self.days_behind(self.tdb_minus_tt_s() + self.delta_t_s())
    }

    /// The moment of a Julian date of TDB.
    #[allow(clippy::cast_possible_truncation)]
    pub fn from_jd_tdb(jd: f64) -> Self {
        let days = (jd - J2000_JD).floor();
        let midday = SimTime { ticks: (days as i64).saturating_mul(86_400 * TICKS_PER_SECOND) };
        Self::after(midday, ((jd - J2000_JD) - days) * DAY)
    }

    /// The moment of a Julian date of TT.
    pub fn from_jd_tt(jd: f64) -> Self {
        Self::from_jd_tdb(jd).plus_s(tdb_minus_tt_s((jd - J2000_JD) * DAY))
    }

    /// The moment of a Julian date of UT1.
    pub fn from_jd_ut1(jd: f64) -> Self {
        let ut1_s = (jd - J2000_JD) * DAY;
        let delta = delta_t_s(ut1_s + delta_t_s(ut1_s));
        Self::from_jd_tt(jd).plus_s(delta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::TICK_S;

    #[test]
    fn tdb_swings_about_tt_as_the_full_series_has_it() {
        // The 787-term series of Fairhead & Bretagnon at the geocentre (SOFA's `iauDtdb`), µs.
        let table = [
            (2_415_020.5, -18.5),
            (2_440_000.5, 1048.5),
            (2_451_545.0, -99.3),
            (2_457_987.27, -1223.4),
            (2_461_265.241, -989.9),
            (2_469_807.5, -80.2),
            (2_488_069.5, -89.9),
        ];
        for (jd, micro) in table {
            let ours = tdb_minus_tt_s((jd - J2000_JD) * DAY) * 1e6;
            assert!((ours - micro).abs() < 10.0, "{jd}: {ours} for {micro}");
        }
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
    fn leap_second_of_2017() {
        let before = SimTime::from_utc(CivilTime::parse("2016-12-31T23:59:59").unwrap());
        let after = SimTime::from_utc(CivilTime::parse("2017-01-01T00:00:00").unwrap());
        assert_eq!(after.ticks - before.ticks, 2 * TICKS_PER_SECOND);
    }

    #[test]
    fn ut1_and_utc_keep_together_while_leap_seconds_are_made() {
        let mut worst = 0.0_f64;
        for half_month in 0..(55 * 24) {
            let m = Moment::from_jd_tdb(2_441_318.5 + 15.2 * f64::from(half_month));
            worst = worst.max((tdb_minus_utc(m.tick) - m.tdb_minus_tt_s() - m.delta_t_s()).abs());
        }
        assert!((0.5..0.9).contains(&worst), "{worst}");
    }

    #[test]
    fn dates_come_back_before_and_after_utc_began() {
        for text in ["1066-10-14T09:00", "1919-05-29T13:08:34", "1971-12-31T12:00:00", "1980-02-29T23:59:59.5", "2150-01-01"] {
            let civil = CivilTime::parse(text).unwrap();
            let back = SimTime::from_utc(civil).utc();
            assert!((back.utc_seconds() - civil.utc_seconds()).abs() < TICK_S, "{text}: {back}");
        }
    }

    #[test]
    fn julian_dates_of_every_scale_come_back() {
        for jd in [1_356_174.0, 2_415_020.25, 2_451_545.0, 2_461_265.241_041_667, 2_488_069.5] {
            assert!((Moment::from_jd_tt(jd).jd_tt() - jd).abs() < 1e-9);
            let (days, fraction) = Moment::from_jd_ut1(jd).ut1_days();
            assert!((J2000_JD + days + fraction - jd).abs() < 1e-9, "{jd}");
        }
        // One TT day of 2026: a fraction keeps its nanoseconds.
        let (_, fraction) = Moment::after(SimTime::from_jd_tdb(2_461_265.0), 1e-9).days_behind(0.0);
        assert!((fraction * DAY - 1e-9).abs() < 1e-11, "{fraction}");
    }
}
