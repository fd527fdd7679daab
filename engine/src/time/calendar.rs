//! Calendar dates: proleptic Gregorian years, months, days and a time of day on any uniform scale.
//!
//! Not here: which scale ([`super::scales`]).

use crate::units::{DAY, HOUR, MINUTE};
use core::fmt;
use serde::{Deserialize, Serialize};

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
    fn refuses_what_is_no_date() {
        for bad in ["", "yesterday", "2026-13-01", "2026-02-30", "2026-08-12T25:00", "2026-08-12T10:00:99", "2026-08"] {
            assert!(CivilTime::parse(bad).is_err(), "{bad}");
        }
        assert!(CivilTime::parse("2028-02-29T12:00:00Z").is_ok());
    }
}
