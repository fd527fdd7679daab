//! From mean elements to a state that gravity can go on from.
//!
//! A state taken as if the ellipse were Kepler's would start with the wrong mean motion: its osculating size differs from the mean one
//! by what the parent's flattening adds, and published sizes have few digits, while rates are known to ten. So the size is taken from
//! the rate: on a near-circular path in the equator, λ̇² = (GM/a³)(1 + (3/2) J₂ (R/a)² − (15/8) J₄ (R/a)⁴) [Greenberg 1981].
//! What siblings and inclination add to the rate is not known here: expect 1e-4 of the mean motion for moons in company.
//! - [Greenberg 1981] "Apsidal precession of orbits about an oblate planet", AJ 86, 912, eq. 4 (to J₄).

use super::orbit::MeanOrbit;
use super::tree::Pair;
use crate::orbit::elements::Elements;
use crate::orbit::gravity::figure::Figure;
use crate::orbit::kepler::Conic;
use crate::space::Centred;
use crate::time::SimTime;
use core::f64::consts::FRAC_PI_2;
use glam::{DQuat, DVec3};

/// Size from the mean motion about `gm` (parent and moon together) with the parent's figure, m.
pub fn semi_major_m(orbit: &MeanOrbit, gm: f64, figure: Option<&Figure>) -> f64 {
    let rate2 = orbit.mean_longitude_rate_rad_s * orbit.mean_longitude_rate_rad_s;
    let mut a = libm::cbrt(gm / rate2);
    if let Some(f) = figure {
        for _ in 0..6 {
            let ratio2 = f.radius_m * f.radius_m / (a * a);
            a = libm::cbrt(gm * (1.0 + 1.5 * f.zonal[0] * ratio2 - 1.875 * f.zonal[2] * ratio2 * ratio2) / rate2);
        }
    }
    a
}

fn about(axis: DVec3, angle: f64) -> DQuat {
    let (s, c) = libm::sincos(0.5 * angle);
    DQuat::from_xyzw(axis.x * s, axis.y * s, axis.z * s, c)
}

/// The state on the precessing ellipse at `t`, from the parent's centre, ICRF axes.
pub fn state(orbit: &MeanOrbit, gm: f64, figure: Option<&Figure>, t: SimTime) -> Pair {
    let dt_s = t.since(orbit.epoch);
    let a = semi_major_m(orbit, gm, figure);
    let anomalistic = orbit.mean_longitude_rate_rad_s - orbit.node_rad[1] - orbit.argument_rad[1];
    let mean = orbit.mean_anomaly_rad + anomalistic * dt_s;
    // The GM that gives this anomalistic motion at this size.
    let ellipse = Elements::from_mean(anomalistic * anomalistic * a * a * a, a, orbit.eccentricity, [0.0, 0.0, 0.0, mean]);
    let s = ellipse.to_state::<Centred>();
    let direction = anomalistic.signum();
    let (r, v) = (s.position.0, s.velocity.0 * direction);
    let node = about(DVec3::Z, orbit.node_rad[0] + orbit.node_rad[1] * dt_s);
    let tilt = about(DVec3::X, orbit.inclination_rad);
    let turn = about(DVec3::Z, orbit.argument_rad[0] + orbit.argument_rad[1] * dt_s);
    let plane_from_perifocal = node * tilt * turn;
    let r = plane_from_perifocal * r;
    // The ellipse turns while the body runs on it.
    let drift = DVec3::Z * orbit.node_rad[1] + node * (tilt * DVec3::Z) * orbit.argument_rad[1];
    let v = plane_from_perifocal * v + drift.cross(r);
    let [ra, dec] = orbit.pole_ra_dec_rad;
    let icrf_from_plane = about(DVec3::Z, ra + FRAC_PI_2) * about(DVec3::X, FRAC_PI_2 - dec);
    (icrf_from_plane * r, icrf_from_plane * v)
}

/// The conic that a start makes about what it orbits.
pub fn conic(gm: f64, start: Pair) -> Conic {
    Conic::new(gm, start.0, start.1)
}
