//! The arguments of `probe eclipses`.

use super::{ProbeCommon, julian_date};
use clap::Args;

/// Arguments of `probe eclipses`.
#[derive(Clone, Debug, Args)]
pub struct ProbeEclipsesArgs {
    /// The body that the shadow falls on, by its folder's name
    #[arg(long, value_name = "B")]
    pub on: String,
    /// The body that throws it
    #[arg(long, value_name = "C")]
    pub by: String,
    /// Greatest not before this Julian date of TT
    #[arg(long, value_name = "JD", allow_hyphen_values = true, value_parser = julian_date)]
    pub from: f64,
    /// Greatest not after this Julian date of TT
    #[arg(long, value_name = "JD", allow_hyphen_values = true, value_parser = julian_date)]
    pub to: f64,
    /// Also tell what is seen from a place (geodetic latitude and east longitude, °); may be given several times
    #[arg(long, value_name = "LAT,LON", allow_hyphen_values = true, value_parser = place)]
    pub at: Vec<(f64, f64)>,
    /// Also tell so many points of the central line
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=10_000))]
    pub line: u16,
    #[command(flatten)]
    /// What all probes share.
    pub common: ProbeCommon,
}

/// `43.37,-8.40` → (43.37, −8.40).
fn place(text: &str) -> Result<(f64, f64), String> {
    let expected = || "expected LATITUDE,LONGITUDE in degrees, for example 43.37,-8.40".to_owned();
    let (lat, lon) = text.split_once(',').ok_or_else(expected)?;
    let number = |s: &str, most: f64| s.trim().parse::<f64>().ok().filter(|x| x.abs() <= most).ok_or_else(expected);
    Ok((number(lat, 90.0)?, number(lon, 360.0)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_are_none_are_refused() {
        assert_eq!(place("43.37,-8.40"), Ok((43.37, -8.40)));
        for bad in ["93.37,-8.40", "NaN,0", "43.37", "a,b", "0,361"] {
            assert!(place(bad).is_err(), "{bad}");
        }
    }
}
