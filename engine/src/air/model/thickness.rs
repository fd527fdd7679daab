//! The model `thickness`: air is as bright as it is thick, shadowed air a fifth of that.
//!
//! After R. Josth, "Real Time Atmosphere Rendering for the Space Simulators", CESCG. Along the ray lies the air between the front and
//! the back of its shell, cut by the ground; part of it lies in the shadow, a cone as wide as the planet. From the two widths
//! `colour = brightness · (lit + k · shadowed)`, widths in units of a scale. He finds them by four depth textures and loses what their
//! 24 bits cannot hold and what the near plane cuts off; here every pixel intersects shell and cones in closed form. His widths
//! count along the view's axis and are divided by the span of his depth buffer; ours count along the ray and are divided by [`Thickness::unit_m`].
//!
//! Several bodies may throw a shadow: air is shadowed where any of the cones holds it. A shell without a planet
//! is a bank of fog, or a nebula: [`Thickness::ball`]. One that lies in another's air is lit by the sun and the sky of that air where it lies
//! (`light_in_air` of `shaders/pass/sky_thickness.wgsl`), which know of shadows: `shadow_share` then says nothing.
//!
//! GPU twin: `shaders/lib/thickness.wgsl`. Not here: reddening, penumbrae, light scattered twice: the model has none.

use super::super::{Air, Medium, Model, RangeError};
use core::f64::consts::PI;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Radius of the core of a ball of air, m: altitudes are counted from it.
const CORE_M: f64 = 1e-3;

/// Settings of the model `thickness`: the table `[thickness]` of an `atmosphere.toml`. Every key may be left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Thickness {
    /// `colour`: of the air, linear sRGB, 0 … 1 per channel.
    pub colour: Vec3,
    /// `brightness`, 0 … 1000, 3 by default: how bright a lit way of one scale is; 1 is a white Lambert surface that faces the sun.
    pub brightness: f32,
    /// `shadow_share`, 0 … 1, 0.2 by default: how bright shadowed air is beside lit air (k). Of a bank of fog in a planet's air that air's own light counts.
    pub shadow_share: f32,
    /// `scale_m`, 1 … 1e15 m: the width of air that counts as one. Left out: the longest way that a ray can have in the shell, past the ground.
    pub scale_m: Option<f64>,
    /// `shadow`: `"cone"` (default) or `"cylinder"`.
    pub shadow: ShadowShape,
    /// `opacity`, 0 … 1000, 0 by default: optical depth of a way of one scale for what lies behind. 0 only adds light, as in the
    /// paper; fog hides.
    pub opacity: f32,
}

/// The volume in which air counts as shadowed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShadowShape {
    /// The umbra: the cone that narrows away from the sun's disc.
    #[default]
    Cone,
    /// As wide as the body all along: there the sun's centre is hidden.
    Cylinder,
}

impl Default for Thickness {
    fn default() -> Self {
        Self {
            colour: Vec3::new(0.30, 0.52, 1.0),
            brightness: 3.0,
            shadow_share: 0.2,
            scale_m: None,
            shadow: ShadowShape::Cone,
            opacity: 0.0,
        }
    }
}

impl Thickness {
    /// Everything that is out of range; fields are named as keys of the table.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        for (i, x) in self.colour.to_array().into_iter().enumerate() {
            RangeError::check(&mut e, &format!("colour[{i}]"), f64::from(x), 0.0, 1.0);
        }
        RangeError::check(&mut e, "brightness", f64::from(self.brightness), 0.0, 1000.0);
        RangeError::check(&mut e, "shadow_share", f64::from(self.shadow_share), 0.0, 1.0);
        RangeError::check(&mut e, "scale_m", self.scale_m.unwrap_or(1.0), 1.0, 1.0e15);
        RangeError::check(&mut e, "opacity", f64::from(self.opacity), 0.0, 1000.0);
        e
    }

    /// The width of air that counts as one, m.
    pub fn unit_m(&self, medium: &Medium) -> f64 {
        let (bottom, top) = (medium.bottom_radius_m, medium.top_altitude_m);
        self.scale_m.unwrap_or_else(|| 2.0 * (top * (2.0 * bottom + top)).max(0.0).sqrt()).max(1.0)
    }

    /// A ball of such air without a planet: a bank of fog, or a nebula.
    pub fn ball(self, radius_m: f64) -> Air {
        let medium = Medium { bottom_radius_m: CORE_M, top_altitude_m: radius_m, ground_albedo: Vec3::ZERO, layers: Vec::new() };
        Air { model: Model::Thickness(self), ..Air::from(medium) }
    }

    /// Radiance per unit of illuminance above the air (sr⁻¹, per channel), and how much of the light from behind comes through.
    /// The colour 1 is the radiance of a white Lambert surface that faces the sun, 1/π.
    pub fn light(&self, widths: Widths, unit_m: f64) -> (DVec3, f64) {
        let lit = (widths.lit_m + f64::from(self.shadow_share) * widths.shadowed_m) / unit_m;
        let all = (widths.lit_m + widths.shadowed_m) / unit_m;
        (f64::from(self.brightness) * lit / PI * self.colour.as_dvec3(), libm::exp(-f64::from(self.opacity) * all))
    }
}

/// How much air lies along a ray, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Widths {
    /// Outside all shadows.
    pub lit_m: f64,
    /// Within one or several.
    pub shadowed_m: f64,
}

impl Widths {
    /// Of the air from `start_m` to `end_m` along a ray, given each shadow.
    pub fn between(eye: DVec3, ray: DVec3, start_m: f64, end_m: f64, shadows: &[ShadowCone]) -> Self {
        let mut spans: Vec<(f64, f64)> =
            shadows.iter().filter_map(|c| c.along(eye, ray)).map(|(a, b)| (a.max(start_m), b.min(end_m))).filter(|(a, b)| a < b).collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut shadowed_m, mut reached) = (0.0, start_m);
        for (from, to) in spans {
            shadowed_m += (to - from.max(reached)).max(0.0);
            reached = reached.max(to);
        }
        Self { lit_m: (end_m - start_m).max(0.0) - shadowed_m, shadowed_m }
    }
}

/// The shadow of a sphere: the cone that touches it and the sun, from the circle where it touches it to its apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowCone {
    /// Centre of the sphere, m, in the frame of the eye.
    pub centre: DVec3,
    /// Unit vector away from the sun.
    pub axis: DVec3,
    /// Radius of the sphere, m: the mean one of a flattened planet.
    pub radius_m: f64,
    /// Sine of the half angle: 0 is a cylinder; negative where the sphere is larger than its sun, and the cone widens.
    pub sine: f64,
}

impl ShadowCone {
    /// Of a sphere lit by a sun of radius `sun_radius_m` at `sun` (same frame as `centre`).
    pub fn new(centre: DVec3, radius_m: f64, sun: DVec3, sun_radius_m: f64, shape: ShadowShape) -> Self {
        let away = centre - sun;
        let distance = away.length().max(radius_m + sun_radius_m).max(1.0);
        let sine = if shape == ShadowShape::Cone { (sun_radius_m - radius_m) / distance } else { 0.0 };
        Self { centre, axis: away.normalize_or(DVec3::X), radius_m, sine }
    }

    /// From where to where a ray (unit vector) lies in the shadow, distances from `eye`, m; either may be infinite.
    ///
    /// With z along the axis and x across it, both from the centre, a point is in shadow where `cos·|x| + sin·z ≤ R`, z lies behind the
    /// circle of contact (`z ≥ R sin`) and before the apex (`z sin ≤ R`). The first, squared, is `A s² + 2B s + C ≤ 0`; the volume is convex, so one span is all.
    pub fn along(&self, eye: DVec3, ray: DVec3) -> Option<(f64, f64)> {
        let from = eye - self.centre;
        let cos2 = 1.0 - self.sine * self.sine;
        let (z0, m) = (from.dot(self.axis), ray.dot(self.axis));
        let (x0, x) = (from - z0 * self.axis, ray - m * self.axis);
        let l0 = self.radius_m - z0 * self.sine;
        let a = x.length_squared() - self.sine * self.sine;
        let b = cos2 * x0.dot(x) + l0 * m * self.sine;
        let c = cos2 * x0.length_squared() - l0 * l0;
        let behind = half_line(z0 - self.radius_m * self.sine, m);
        let before = half_line(l0, -m * self.sine);
        let inside = cone_span(a, b, c, m * self.sine)?;
        let span = (behind.0.max(before.0).max(inside.0), behind.1.min(before.1).min(inside.1));
        (span.0 < span.1).then_some(span)
    }
}

/// Where `w + m s ≥ 0`.
fn half_line(w: f64, m: f64) -> (f64, f64) {
    let s = if m == 0.0 { f64::INFINITY.copysign(w) } else { -w / m };
    if m > 0.0 {
        (s, f64::INFINITY)
    } else if m < 0.0 || w >= 0.0 {
        (f64::NEG_INFINITY, if m < 0.0 { s } else { f64::INFINITY })
    } else {
        (f64::INFINITY, f64::NEG_INFINITY)
    }
}

/// Where `A s² + 2B s + C ≤ 0`, of the two parts that it has for A < 0 the one behind the narrowing side: `toward` is positive for a
/// ray that goes toward the apex. Roots without cancellation [Press et al. 2007, "Numerical Recipes", §5.6].
fn cone_span(a: f64, b: f64, c: f64, toward: f64) -> Option<(f64, f64)> {
    let d = b * b - a * c;
    if d < 0.0 && a > 0.0 {
        return None;
    }
    let t = -(b + d.max(0.0).sqrt().copysign(b));
    if t == 0.0 {
        // The left side is C all along: a ray along the axis of a cylinder.
        return (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (r1, r2) = (if a == 0.0 { f64::INFINITY.copysign(t) } else { t / a }, c / t);
    let (low, high) = (r1.min(r2), r1.max(r2));
    if a >= 0.0 {
        Some((low, high))
    } else if toward > 0.0 {
        Some((f64::NEG_INFINITY, low))
    } else {
        Some((high, f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::model::shell::Chord;
    use crate::light::occlusion::{Disc, visible};
    use crate::units::AU;

    const R: f64 = 6.371e6;
    const TOP: f64 = 1.0e5;
    const SUN: f64 = 6.957e8;

    fn medium() -> Medium {
        Medium { bottom_radius_m: R, top_altitude_m: TOP, ground_albedo: Vec3::ZERO, layers: Vec::new() }
    }

    /// Numbers from 0 to 1 without pattern [Knuth 1997, TAOCP 2, table 3.3.4-1, line 26].
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 53) as f64
    }
    fn direction(state: &mut u64) -> DVec3 {
        let z = 2.0 * random(state) - 1.0;
        let angle = 2.0 * PI * random(state);
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * libm::cos(angle), across * libm::sin(angle), z)
    }

    #[test]
    fn the_shadow_is_where_the_sun_is_wholly_hidden() {
        // Judged by the free fraction of the sun's disc, which knows no cone. A near, large sun makes a short one: all its sides are tried.
        let mut state = 1;
        let (mut inside, mut total) = (0, 0);
        for sun_distance in [AU, 4.0e9, 2.0e9] {
            let sun = DVec3::new(0.6, -0.48, 0.64) * sun_distance;
            let cone = ShadowCone::new(DVec3::ZERO, R, sun, SUN, ShadowShape::Cone);
            let apex = (R / cone.sine).min(50.0 * R);
            for _ in 0..400 {
                // Rays that go by the shadow's axis.
                let near_axis = cone.axis * (apex * random(&mut state)) + direction(&mut state) * (R * 1.2 * random(&mut state));
                let ray =
                    if random(&mut state) < 0.2 { (cone.axis + 0.01 * direction(&mut state)).normalize() } else { direction(&mut state) };
                let eye = near_axis - ray * (3.0 * R * random(&mut state));
                let span = cone.along(eye, ray);
                for k in 0..60 {
                    let s = (f64::from(k) / 30.0 - 1.0) * 4.0 * R;
                    let point = eye + ray * s;
                    if point.length() < 1.001 * R {
                        continue;
                    }
                    let disc = Disc::of_sphere(sun - point, SUN);
                    let hidden = visible(disc, &[Disc::of_sphere(-point, R)]) == 0.0;
                    let found = span.is_some_and(|(a, b)| a < s && s < b);
                    // At the edge itself the two may differ by rounding of angles.
                    let edge = span.is_some_and(|(a, b)| (s - a).abs().min((s - b).abs()) < 1e-4 * R);
                    let nearly = visible(disc, &[Disc::of_sphere(-point, R)]) < 1e-5;
                    assert!(hidden == found || edge || nearly, "{point}: hidden {hidden}, in the cone {found} {span:?}");
                    inside += i32::from(found);
                    total += 1;
                }
            }
        }
        assert!(inside > total / 20 && inside < total / 2, "{inside} of {total} points lie in shadow: the trial is lopsided");
    }

    #[test]
    fn spans_have_their_closed_forms() {
        let cylinder = ShadowCone { centre: DVec3::ZERO, axis: DVec3::X, radius_m: 2.0, sine: 0.0 };
        let close = |found: Option<(f64, f64)>, a: f64, b: f64| {
            let (x, y) = found.expect("it meets the shadow");
            assert!((x == a || (x - a).abs() < 1e-12) && (y == b || (y - b).abs() < 1e-12), "{x} {y}, not {a} {b}");
        };
        close(cylinder.along(DVec3::new(5.0, -10.0, 0.0), DVec3::Y), 8.0, 12.0);
        close(cylinder.along(DVec3::new(5.0, -10.0, 1.2), DVec3::Y), 8.4, 11.6);
        close(cylinder.along(DVec3::new(-3.0, 1.0, 0.0), DVec3::X), 3.0, f64::INFINITY);
        assert_eq!(cylinder.along(DVec3::new(-3.0, 2.5, 0.0), DVec3::X), None);
        assert_eq!(cylinder.along(DVec3::new(-3.0, -10.0, 0.0), DVec3::Y), None, "before the body there is light");
        // Half angle 30°: apex at R / sin = 4, contact at R sin = 1, and at z the half width is (R − z sin) / cos.
        let cone = ShadowCone { sine: 0.5, ..cylinder };
        close(cone.along(DVec3::new(-3.0, 0.0, 0.0), DVec3::X), 4.0, 7.0);
        close(cone.along(DVec3::new(9.0, 0.0, 0.0), DVec3::NEG_X), 5.0, 8.0);
        let half = (2.0 - 2.0 * 0.5) / 0.75_f64.sqrt();
        close(cone.along(DVec3::new(2.0, -10.0, 0.0), DVec3::Y), 10.0 - half, 10.0 + half);
        assert_eq!(cone.along(DVec3::new(5.0, -10.0, 0.0), DVec3::Y), None, "beyond the apex there is light");
    }

    #[test]
    fn overlapping_shadows_count_once() {
        // Two equal cylinders whose axes lie 3 apart: across both, the shadow is 7 wide and not 8.
        let at = |y: f64| ShadowCone { centre: DVec3::new(0.0, y, 0.0), axis: DVec3::X, radius_m: 2.0, sine: 0.0 };
        let (eye, ray) = (DVec3::new(1.0, -10.0, 0.0), DVec3::Y);
        let widths = |shadows: &[ShadowCone], to| Widths::between(eye, ray, 0.0, to, shadows);
        assert_eq!(widths(&[at(0.0), at(3.0)], 30.0), Widths { lit_m: 23.0, shadowed_m: 7.0 });
        assert_eq!(widths(&[at(3.0), at(0.0), at(0.0)], 30.0), Widths { lit_m: 23.0, shadowed_m: 7.0 });
        assert_eq!(widths(&[at(0.0), at(10.0)], 30.0), Widths { lit_m: 22.0, shadowed_m: 8.0 });
        assert_eq!(widths(&[at(0.0), at(10.0)], 19.0), Widths { lit_m: 14.0, shadowed_m: 5.0 }, "a surface cuts air and shadow");
        assert_eq!(widths(&[], 30.0), Widths { lit_m: 30.0, shadowed_m: 0.0 });
    }

    #[test]
    fn colours_are_the_paper_s() {
        let model = Thickness::default();
        assert!(model.validate().is_empty());
        let unit = model.unit_m(&medium());
        assert!((unit - 2.0 * ((R + TOP) * (R + TOP) - R * R).sqrt()).abs() < 1e-3);
        // 3 · (lit + 0.2 · shadowed), a white Lambert surface being 1.
        let (radiance, kept) = model.light(Widths { lit_m: 0.5 * unit, shadowed_m: 0.25 * unit }, unit);
        assert!((radiance / model.colour.as_dvec3() * PI - DVec3::splat(3.0 * (0.5 + 0.2 * 0.25))).length() < 1e-7);
        assert_eq!(kept, 1.0);
        let fog = Thickness { opacity: 2.0, ..model };
        assert!((fog.light(Widths { lit_m: 0.5 * unit, shadowed_m: 0.5 * unit }, unit).1 - libm::exp(-2.0)).abs() < 1e-12);
        // By noon the shadow is on the other side; at midnight it holds all the air of the zenith.
        let sun = DVec3::X * AU;
        let cone = ShadowCone::new(DVec3::ZERO, R, sun, SUN, ShadowShape::Cone);
        for (eye, lit_m) in [(DVec3::X * R, TOP), (DVec3::NEG_X * R, 0.0)] {
            let ray = eye / R;
            let chord = Chord::new(eye, ray, R, TOP).unwrap();
            let widths = Widths::between(eye, ray, chord.start_m, chord.end_m(None), &[cone]);
            assert!((widths.lit_m - lit_m).abs() < 1e-3 && (widths.shadowed_m - (TOP - lit_m)).abs() < 1e-3, "{widths:?}");
        }
    }

    #[test]
    fn an_eclipse_shades_the_air_between_two_shadows() {
        // The Moon's umbra, some 130 km wide here, stands in the air of a noon: a horizontal way across its axis loses just that.
        let sun = DVec3::X * AU;
        let planet = ShadowCone::new(DVec3::ZERO, R, sun, SUN, ShadowShape::Cone);
        let moon = ShadowCone::new(DVec3::X * 3.63e8, 1.7374e6, sun, SUN, ShadowShape::Cone);
        let (eye, ray) = (DVec3::X * (R + 1e4), DVec3::Y);
        let half = (moon.radius_m - (3.63e8 - eye.x) * moon.sine) / (1.0 - moon.sine * moon.sine).sqrt();
        assert!((5.0e4..9.0e4).contains(&half), "{half}");
        let exit = Chord::new(eye, ray, R, TOP).unwrap().exit_m;
        let widths = Widths::between(eye, ray, 0.0, exit, &[planet, moon]);
        assert!((widths.shadowed_m - half).abs() < 1e-3 && (widths.lit_m - (exit - half)).abs() < 1e-3, "{widths:?}");
        let cylinder = ShadowCone::new(DVec3::X * 3.63e8, 1.7374e6, sun, SUN, ShadowShape::Cylinder);
        assert_eq!(Widths::between(eye, ray, 0.0, exit, &[planet, cylinder]).lit_m, 0.0);
    }

    #[test]
    fn a_ball_of_fog_is_as_thick_as_its_chord() {
        let air = Thickness { brightness: 1.0, ..Thickness::default() }.ball(500.0);
        let Model::Thickness(model) = &air.model else { panic!("{:?}", air.model) };
        let (bottom, top) = (air.medium.bottom_radius_m, air.medium.top_altitude_m);
        let chord = Chord::new(DVec3::new(-2000.0, 300.0, 0.0), DVec3::X, bottom, top).unwrap();
        assert!((chord.exit_m - chord.start_m - 800.0).abs() < 0.01);
        // Its diameter counts as one, and a planet's shadow that holds half of it leaves the rest lit.
        let planet = ShadowCone { centre: DVec3::new(0.0, 0.0, 6.0e6), axis: DVec3::NEG_Z, radius_m: 6.0e6, sine: 0.0 };
        let aside = ShadowCone { centre: DVec3::new(6.0e6, 0.0, 0.0), axis: DVec3::NEG_Z, ..planet };
        let widths = |cone| Widths::between(DVec3::new(-2000.0, 300.0, 0.0), DVec3::X, chord.start_m, chord.exit_m, &[cone]);
        assert!((widths(planet).shadowed_m - 800.0).abs() < 0.01 && (widths(aside).shadowed_m - 400.0).abs() < 0.01);
        let (radiance, _) = model.light(widths(aside), model.unit_m(&air.medium));
        assert!((radiance.z * PI - (0.4 + 0.2 * 0.4)).abs() < 1e-5);
    }

    #[test]
    fn bad_settings_are_told_all_at_once() {
        let bad = Thickness { colour: Vec3::new(0.1, 2.0, f32::NAN), shadow_share: -0.1, scale_m: Some(0.0), ..Thickness::default() };
        let fields: Vec<_> = bad.validate().into_iter().map(|e| e.field).collect();
        assert_eq!(fields, ["colour[1]", "colour[2]", "shadow_share", "scale_m"]);
    }
}
