//! Numbers for people: fixed widths, SI prefixes, "—" for what is not a number or has no end.

use engine::units::{DAY, HOUR, MINUTE};

/// What stands where there is no number.
pub const NONE: &str = "—";

/// A length: `12.3 m`, `4 211 m`, `420.1 km`, `384.40 Mm`, `1.0000 AU`.
pub fn length(m: f64) -> String {
    let a = m.abs();
    match a {
        _ if !m.is_finite() => NONE.to_owned(),
        _ if a < 99.95 => format!("{m:.1} m"),
        _ if a < 9_999.5 => format!("{m:.0} m"),
        _ if a < 9_999.5e3 => format!("{:.1} km", m / 1e3),
        _ if a < 9_999.5e6 => format!("{:.2} Mm", m / 1e6),
        _ => format!("{:.4} AU", m / engine::units::AU),
    }
}

/// A speed: `12.3 m/s`, `7 660 m/s`, `29.78 km/s`.
pub fn speed(m_s: f64) -> String {
    let a = m_s.abs();
    match a {
        _ if !m_s.is_finite() => NONE.to_owned(),
        _ if a < 0.05 => "0.0 m/s".to_owned(),
        _ if a < 999.95 => format!("{m_s:.1} m/s"),
        _ if a < 99_999.5 => format!("{m_s:.0} m/s"),
        _ => format!("{:.2} km/s", m_s / 1e3),
    }
}

/// A duration: `12 s`, `3:07`, `1:32:50`, `27 d 7 h`.
pub fn duration(s: f64) -> String {
    let a = s.abs();
    if !s.is_finite() || a > 1e13 {
        return NONE.to_owned();
    }
    let sign = if s < 0.0 { "−" } else { "" };
    match a {
        _ if a < MINUTE => format!("{sign}{a:.0} s"),
        _ if a < HOUR => format!("{sign}{:.0}:{:02.0}", (a / MINUTE).floor(), (a % MINUTE).floor()),
        _ if a < 3.0 * DAY => {
            format!("{sign}{:.0}:{:02.0}:{:02.0}", (a / HOUR).floor(), (a % HOUR / MINUTE).floor(), (a % MINUTE).floor())
        }
        _ if a < 1_000.0 * DAY => format!("{sign}{:.0} d {:.0} h", (a / DAY).floor(), (a % DAY / HOUR).floor()),
        _ => format!("{sign}{:.1} a", a / (365.25 * DAY)),
    }
}

/// A pressure: `12 Pa`, `4.2 kPa`, `1.01 MPa`.
pub fn pressure(pa: f64) -> String {
    match pa.abs() {
        _ if !pa.is_finite() => NONE.to_owned(),
        a if a < 999.5 => format!("{pa:.0} Pa"),
        a if a < 999.5e3 => format!("{:.1} kPa", pa / 1e3),
        _ => format!("{:.2} MPa", pa / 1e6),
    }
}

/// A heat flux: `3 kW/m²`, `1.20 MW/m²`.
pub fn flux(w_m2: f64) -> String {
    match w_m2.abs() {
        _ if !w_m2.is_finite() => NONE.to_owned(),
        a if a < 999.5e3 => format!("{:.0} kW/m²", w_m2 / 1e3),
        _ => format!("{:.2} MW/m²", w_m2 / 1e6),
    }
}

/// Any number with some decimals.
pub fn number(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return NONE.to_owned();
    }
    let text = format!("{x:.decimals$}");
    // What rounds to nought has no sign.
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}

/// An angle in whole degrees, 000 … 359.
pub fn heading(rad: f64) -> String {
    if !rad.is_finite() {
        return NONE.to_owned();
    }
    let degrees = libm::fmod(rad.to_degrees().round(), 360.0);
    format!("{:03.0}°", if degrees < 0.0 { degrees + 360.0 } else { degrees.abs() })
}

/// Latitude and longitude: `37.123° N  25.004° W`.
pub fn place(lat_rad: f64, lon_rad: f64) -> String {
    if !lat_rad.is_finite() || !lon_rad.is_finite() {
        return NONE.to_owned();
    }
    let (lat, lon) = (lat_rad.to_degrees(), lon_rad.to_degrees());
    let (ns, ew) = (if lat < 0.0 { 'S' } else { 'N' }, if lon < 0.0 { 'W' } else { 'E' });
    format!("{:.3}° {ns}  {:.3}° {ew}", lat.abs(), lon.abs())
}

/// A warp level: `¼×`, `1×`, `1,000×`.
pub fn warp(level: u8) -> String {
    match crate::command::WARP_QUARTERS.get(usize::from(level)) {
        Some(1) => "¼×".to_owned(),
        Some(2) => "½×".to_owned(),
        Some(q) if *q >= 4_000_000 => format!("{},000,000×", q / 4_000_000),
        Some(q) if *q >= 4_000 => format!("{},000×", q / 4_000),
        Some(q) => format!("{}×", q / 4),
        None => NONE.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_people_write_them() {
        assert_eq!(length(420_123.0), "420.1 km");
        assert_eq!(length(-3.04), "-3.0 m");
        assert_eq!(length(384.4e6), "384.40 Mm");
        assert_eq!(length(f64::INFINITY), NONE);
        assert_eq!(speed(f64::NAN), NONE);
        assert_eq!(speed(7_660.4), "7660 m/s");
        assert_eq!(duration(5_570.0), "1:32:50");
        assert_eq!(duration(187.9), "3:07");
        assert_eq!(duration(-12.0), "−12 s");
        assert_eq!(duration(27.3 * DAY), "27 d 7 h");
        assert_eq!(duration(f64::INFINITY), NONE);
        assert_eq!(heading(-0.1), "354°");
        assert_eq!(heading(core::f64::consts::TAU - 1e-9), "000°");
        assert_eq!(place(-0.5, 1.0), "28.648° S  57.296° E");
        assert_eq!(
            (0..11).map(warp).collect::<Vec<_>>(),
            ["¼×", "½×", "1×", "2×", "4×", "10×", "100×", "1,000×", "10,000×", "50,000×", "100,000×"]
        );
        assert_eq!(warp(99), NONE);
        assert_eq!((number(-0.2, 0), number(-0.004, 2), number(-0.006, 2)), ("0".into(), "0.00".into(), "-0.01".into()));
    }
}
