//! Transmittance and single scattering along a ray, by adaptive quadrature: no table, no sample.
//!
//! `L₁ = ∫ T(s) Σ σ_s p(θ) V(s) T☉(s) ds`, V the visible fraction of the disc. Panels end where the integrand bends: at the edges of
//! layers, at the lowest point, where the disc begins and ends to be hidden by the ground or an occluder, and where the light's way is
//! first held at the horizon.

use super::quadrature::integrate;
use super::space::{Light, Space, Span, exp3};
use crate::air::Medium;
use glam::DVec3;

/// Points of a ray at which edges of shadows are looked for: a shadow of less than a 400th of the ray between two of them is left to
/// the quadrature to find.
const SCAN: u32 = 400;

/// Distances between two along a ray at which a layer bends or the ray is lowest, m, rising, the ends among them.
fn bends(layers_m: &[f64], datum_m: f64, from_m: DVec3, direction: DVec3, stretch_m: (f64, f64)) -> Vec<f64> {
    let lowest = -from_m.dot(direction);
    let b2 = from_m.cross(direction).length_squared();
    let mut all = vec![stretch_m.0, stretch_m.1, lowest];
    for h in layers_m {
        let r = datum_m + h;
        let half2 = r * r - b2;
        if half2 > 0.0 {
            all.extend([lowest - half2.sqrt(), lowest + half2.sqrt()]);
        }
    }
    all.retain(|s| (stretch_m.0..=stretch_m.1).contains(s));
    all.sort_by(f64::total_cmp);
    all
}

fn layer_breaks(medium: &Medium) -> Vec<f64> {
    medium.layers.iter().flat_map(|l| l.profile.breaks_m()).collect()
}

fn extinction(medium: &Medium, altitude_m: f64) -> DVec3 {
    medium.layers.iter().map(|l| (l.scattering_per_m + l.absorption_per_m).as_dvec3() * l.profile.density(altitude_m)).sum()
}

/// Optical depth between two distances along a ray, per channel, to a relative error. No ground stands in the way.
pub fn optical_depth(medium: &Medium, from_m: DVec3, direction: DVec3, stretch_m: (f64, f64), relative: f64) -> DVec3 {
    let breaks = bends(&layer_breaks(medium), medium.bottom_radius_m, from_m, direction, stretch_m);
    integrate(&mut |s| extinction(medium, (from_m + direction * s).length() - medium.bottom_radius_m), &breaks, relative)
}

/// Transmittance from radius `r_m` to the top of the air along a ray at cosine `mu` to the zenith, ground ignored.
pub fn transmittance_to_top(medium: &Medium, r_m: f64, mu: f64) -> DVec3 {
    transmittance(medium, r_m, mu, 1e-8)
}

fn transmittance(medium: &Medium, r_m: f64, mu: f64, relative: f64) -> DVec3 {
    let top = medium.bottom_radius_m + medium.top_altitude_m;
    let (from, direction) = (DVec3::Z * r_m, DVec3::new(((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt(), 0.0, mu));
    let far = -r_m * mu + ((top - r_m) * (top + r_m) + r_m * r_m * mu * mu).max(0.0).sqrt();
    exp3(-optical_depth(medium, from, direction, (0.0, far), relative))
}

/// Where a function changes sign between two distances, by scan and bisection.
fn roots(f: &impl Fn(f64) -> f64, stretch_m: (f64, f64), out: &mut Vec<f64>) {
    let at = |i: u32| stretch_m.0 + (stretch_m.1 - stretch_m.0) * f64::from(i) / f64::from(SCAN);
    let mut last = f(at(0));
    for i in 1..=SCAN {
        let next = f(at(i));
        if (last < 0.0) != (next < 0.0) {
            let (mut low, mut high) = (at(i - 1), at(i));
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (f(middle) < 0.0) == (last < 0.0) { low = middle } else { high = middle }
            }
            out.push(0.5 * (low + high));
        }
        last = next;
    }
}

/// Distances along a ray at which the integrand of single scattering bends, m, rising, the ends among them.
pub fn breaks(space: &Space, light: &Light<'_>, from_m: DVec3, direction: DVec3, span: Span) -> Vec<f64> {
    let stretch = (span.near_m, span.far_m);
    let mut all = bends(&space.breaks_m, space.datum_m, from_m, direction, stretch);
    let elevation = |s: f64| space.elevation_rad(light, from_m + direction * s);
    for edge in [-light.sun_rad, 0.0, light.sun_rad] {
        roots(&|s| elevation(s) - edge, stretch, &mut all);
    }
    for occluder in light.occluders {
        for edge in [-light.sun_rad, light.sun_rad] {
            roots(&|s| light.gap_rad(occluder, from_m + direction * s) - edge, stretch, &mut all);
        }
    }
    all.sort_by(f64::total_cmp);
    all
}

/// Singly scattered radiance along a ray per unit of irradiance above the air, sr⁻¹ per channel, to a relative error.
pub fn single_scattering(
    medium: &Medium,
    space: &Space,
    light: &Light<'_>,
    (from_m, direction): (DVec3, DVec3),
    span: Span,
    relative: f64,
) -> DVec3 {
    let phase: Vec<f64> = space.optics.iter().map(|o| o.scatter.phase.value(direction.dot(light.sun))).collect();
    let inner = 0.03 * relative;
    let mut source = |s: f64| {
        let at = from_m + direction * s;
        let r = at.length();
        let visible = space.visible(light, at);
        if visible <= 0.0 {
            return DVec3::ZERO;
        }
        let towards = transmittance(medium, r, space.sun_cosine(light, at), inner);
        let seen = exp3(-optical_depth(medium, from_m, direction, (span.near_m, s), inner));
        let scattered: DVec3 =
            space.optics.iter().zip(&phase).map(|(o, p)| o.scattering * (o.profile.density(r - space.datum_m) * p)).sum();
        scattered * towards * seen * visible
    };
    integrate(&mut source, &breaks(space, light, from_m, direction, span), relative)
}
