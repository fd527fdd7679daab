//! Units: the only place with a conversion factor.
//!
//! Everything inside Syzygy is SI in `f64`. Multiply by a unit at entry (`6371.0 * KM`), divide by it at display
//! (`altitude_m / KM`). This file is not for physical constants of bodies: those live in `assets/`.

/// One kilometre, in metres.
pub const KM: f64 = 1.0e3;
/// One astronomical unit, in metres (IAU 2012 Resolution B2, exact).
pub const AU: f64 = 149_597_870_700.0;
/// One degree, in radians.
pub const DEG: f64 = core::f64::consts::PI / 180.0;
/// One arcsecond, in radians.
pub const ARCSEC: f64 = DEG / 3600.0;
/// One minute, in seconds.
pub const MINUTE: f64 = 60.0;
/// One hour, in seconds.
pub const HOUR: f64 = 3600.0;
/// One day of 86,400 SI seconds, in seconds.
pub const DAY: f64 = 86_400.0;
/// One Julian century of 36,525 days, in seconds.
pub const JULIAN_CENTURY: f64 = 36_525.0 * DAY;
/// One kilometre cubed per second squared, in m³/s².
pub const KM3_S2: f64 = 1.0e9;
/// One tonne, in kilograms.
pub const TONNE: f64 = 1.0e3;
/// One kilonewton, in newtons.
pub const KN: f64 = 1.0e3;
/// One kilopascal, in pascals.
pub const KPA: f64 = 1.0e3;
/// One nanometre, in metres.
pub const NM: f64 = 1.0e-9;
/// Standard gravity, in m/s² (CGPM 1901, exact).
pub const G0: f64 = 9.806_65;
/// Speed of light in vacuum, in m/s (exact).
pub const SPEED_OF_LIGHT: f64 = 299_792_458.0;
