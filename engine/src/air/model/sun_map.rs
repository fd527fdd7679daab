//! How the suns of the table of further orders ([`super::orders`]) stand.

use super::orders::SUNS;
use crate::air::Medium;
use core::f64::consts::PI;

/// How the table's coordinate for the sun runs: `x = (asinh(t · scale) + low) · inverse`, `t = 2 sin(e/2)`, e the sun's angle above the
/// horizon of the altitude; from the knee upwards evenly in t, one unit of asinh by each knee. Dense at the terminator, within an angle in
/// which the air's own curvature lets day and night mix; it ends where no air in sight is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunMap {
    /// 1 / that angle, rad⁻¹.
    pub scale: f64,
    /// asinh at the deepest night, negated.
    pub low: f64,
    /// 1 / the range.
    pub inverse: f64,
    /// t of the knee.
    pub knee: f64,
}

impl SunMap {
    /// For the air of a medium.
    pub fn new(medium: &Medium) -> Self {
        let (sine, cosine) = dip(medium.bottom_radius_m, medium.top_altitude_m);
        let dip = libm::atan2(sine, cosine);
        let scale = 1.0 / (0.35 * dip).max(0.01);
        let knee = 0.35;
        // Twice the dip: where the farthest air in sight of the ground sees the sun on its horizon.
        let night = (2.5 * dip + 0.05).min(0.5 * PI);
        let low = libm::asinh(2.0 * libm::sin(0.5 * night) * scale);
        let high = libm::asinh(knee * scale) + (2.0 * (1.0 + sine)).sqrt() / knee - 1.0;
        Self { scale, low, inverse: 1.0 / (low + high), knee }
    }

    /// Zenith cosine of the `k`-th sun of a table, where the horizon dips by so much (sine, cosine); the inverse of the above.
    pub fn mu(&self, (sine, cosine): (f64, f64), k: usize) -> f64 {
        let y = k as f64 / (SUNS - 1) as f64 / self.inverse - self.low;
        let above = y - libm::asinh(self.knee * self.scale);
        let t = if above > 0.0 { self.knee * (1.0 + above) } else { libm::sinh(y) / self.scale };
        let e = 2.0 * libm::asin((0.5 * t).clamp(-0.5 * 2.0_f64.sqrt(), (0.5 * (1.0 + sine)).sqrt()));
        libm::sin(e) * cosine - libm::cos(e) * sine
    }
}

/// Sine and cosine of the angle by which the horizon lies below the level at an altitude.
pub(super) fn dip(radius_m: f64, altitude_m: f64) -> (f64, f64) {
    let r = radius_m + altitude_m;
    ((altitude_m * (2.0 * radius_m + altitude_m)).max(0.0).sqrt() / r, radius_m / r)
}
