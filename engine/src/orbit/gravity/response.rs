//! The tidal response of a body: the bulge that another raises on it, carried ahead by its rotation, pulls back.
//!
//! A bulge raised by a mass at r* lies along r* and makes the potential `k₂ μ R⁵/(r³ r*³) P₂(cos ψ)` [Kaula 1964]. With a constant lag τ
//! the body has turned ahead by ωτ meanwhile: r* = r − τ(v − ω × r). For the Moon this is its secular acceleration.
//! - [Mignard 1979] "The evolution of the lunar orbit revisited I", Moon and Planets 20, 301.
//! - [Kaula 1964] "Tidal dissipation by solid friction", Rev. Geophys. 2, 661.

use glam::DVec3;

/// Acceleration, m/s², that a raising mass of parameter `gm_raiser` at `at`, moving with `velocity` (both from the body's centre, axes at
/// rest), feels by the bulge that it raised itself `lag_s` ago on a body of Love number `k2` and radius `radius_m` that turns with
/// `spin_rad_s` [Mignard 1979, eq. 4].
pub fn own_bulge(gm_raiser: f64, k2: f64, lag_s: f64, radius_m: f64, spin_rad_s: DVec3, at: DVec3, velocity: DVec3) -> DVec3 {
    let r2 = at.length_squared();
    if r2 <= 0.0 {
        return DVec3::ZERO;
    }
    let raised = at - (velocity - spin_rad_s.cross(at)) * lag_s;
    let s2 = raised.length_squared();
    let dot = at.dot(raised);
    let r5 = r2 * r2 * r2.sqrt();
    let s5 = s2 * s2 * s2.sqrt();
    let radius2 = radius_m * radius_m;
    let scale = gm_raiser * k2 * radius2 * radius2 * radius_m / (r5 * s5);
    // The gradient of (3(r·r*)² − r²r*²)/(2r⁵) at fixed r*.
    (raised * (3.0 * dot) - at * s2 - at * (2.5 * (3.0 * dot * dot - r2 * s2) / r2)) * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_lag_the_bulge_pulls_inwards_as_r_to_the_minus_seven() {
        let at = DVec3::new(3.0e8, -2.0e8, 1.0e8);
        let a = own_bulge(4.9e12, 0.3, 0.0, 6.378e6, DVec3::Z * 7.29e-5, at, DVec3::X * 1e3);
        let r = at.length();
        let expected = -3.0 * 4.9e12 * 0.3 * libm::pow(6.378e6, 5.0) / libm::pow(r, 7.0);
        assert!((a.dot(at / r) / expected - 1.0).abs() < 1e-12 && a.cross(at).length() < 1e-12 * a.length() * r);
    }

    #[test]
    fn a_lag_pushes_the_moon_on_by_its_secular_acceleration() {
        // Circular, in the equator: the transverse part is 3 μ k₂ R⁵ (ω − n) τ / r⁷ per mass (its torque 3/2 sin 2ε of the bulge).
        let (gm, k2, lag, radius, spin, n, r) = (4.9028e12, 0.3, 600.0, 6.378e6, 7.292e-5, 2.6617e-6, 3.844e8);
        let a = own_bulge(gm, k2, lag, radius, DVec3::Z * spin, DVec3::X * r, DVec3::Y * (n * r));
        let expected = 3.0 * gm * k2 * libm::pow(radius, 5.0) * (spin - n) * lag / libm::pow(r, 7.0);
        // The lag turns the bulge by 2.4°: the linear form is good to its square.
        assert!((a.y / expected - 1.0).abs() < 0.01, "{} {expected}", a.y);
    }
}
