//! Eclipses of a body smaller than the caster: it dips into a penumbra and an umbra wider than itself.
//!
//! Angles are those seen from the caster's centre, as the canon has them [Espenak & Meeus 2009, §1.6]: with the parallaxes of
//! receiver and star and their semi-diameters, the shadow's radii are `q π_r + π_s ± s_s`, q the enlargement of the caster's shadow
//! (Danjon's rule for the Earth: 1.01).

use super::search::{crossing_m_s, span};
use super::{Cast, Eclipse, Kind, Paths, Shadow};
use crate::time::Moment;
use glam::DVec3;

/// `asin` of a ratio of lengths.
fn angle(radius_m: f64, distance_m: f64) -> f64 {
    libm::asin((radius_m / distance_m.max(1.0)).clamp(-1.0, 1.0))
}

/// How wide the caster is towards the receiver, m. Where a rule enlarges its shadow (the Earth's), the rule has its oblateness in it;
/// else it is the outline of its ellipsoid.
fn width_m(cast: &Cast<'_>, shadow: &Shadow, t: Moment) -> f64 {
    let shape = &cast.caster.shape;
    if shape.flattening <= 0.0 || shape.shadow > 1.0 {
        return shape.equatorial_m * shape.shadow;
    }
    let pole = cast.caster.spin.icrf_from_fixed_at(t).raw(DVec3::Z);
    let slant = pole.dot(shadow.offset.normalize_or(pole.any_orthonormal_vector()));
    let across = DVec3::new((1.0 - slant * slant).max(0.0).sqrt(), 0.0, slant);
    shape.touching(across).dot(across)
}

/// Radii of penumbra and umbra, of the receiver, and its distance from the axis: rad, seen from the caster.
fn angles(cast: &Cast<'_>, shadow: &Shadow, t: Moment) -> [f64; 4] {
    let distance_m = libm::hypot(shadow.behind_m, shadow.miss_m());
    let width = angle(width_m(cast, shadow, t), distance_m) + angle(cast.caster.shape.equatorial_m, shadow.star_m);
    let star = angle(cast.star.shape.limb_m[0], shadow.star_m);
    [width + star, width - star, angle(cast.receiver.shape.limb_m[0], distance_m), angle(shadow.miss_m(), distance_m)]
}

/// The eclipse whose axis passes closest at `greatest`; `None` where even the penumbra passes by.
pub fn describe(cast: &Cast<'_>, paths: &Paths<'_>, greatest: Moment) -> Option<Eclipse> {
    let shadow = Shadow::at(cast, paths, greatest);
    let [penumbra, umbra, radius, miss] = angles(cast, &shadow, greatest);
    if shadow.behind_m <= 0.0 || miss >= penumbra + radius {
        return None;
    }
    let distance_m = libm::hypot(shadow.behind_m, shadow.miss_m());
    let step_s = (penumbra + radius) * distance_m / crossing_m_s(cast, paths, greatest) / 12.0;
    let during = |limit: &dyn Fn([f64; 4]) -> f64| {
        span(
            &|t| {
                let all = angles(cast, &Shadow::at(cast, paths, t), t);
                all[3] - limit(all)
            },
            greatest,
            step_s,
        )
    };
    let core = during(&|[_, umbra, radius, _]| umbra - radius);
    let depth = |shadow: f64| (shadow + radius - miss) / (2.0 * radius);
    let icrf_from_caster = cast.caster.spin.icrf_from_fixed_at(greatest.plus_s(-shadow.light_s));
    // Who has the receiver in the zenith: the direction to it in the caster's axes, there and then.
    let towards = icrf_from_caster.inverse().raw(shadow.axis * shadow.behind_m - shadow.offset);
    let (lat, lon) = crate::space::sphere::lat_lon_of(towards);
    Some(Eclipse {
        kind: match depth(umbra) {
            m if m >= 1.0 => Kind::Total,
            m if m > 0.0 => Kind::Partial,
            _ => Kind::Penumbral,
        },
        greatest,
        light_s: shadow.light_s,
        gamma: -shadow.miss_m().copysign(shadow.offset.dot(icrf_from_caster.raw(DVec3::Z))) / cast.caster.shape.equatorial_m,
        magnitude: depth(umbra),
        penumbral_magnitude: depth(penumbra),
        central: miss < radius,
        place: super::Place { lat_rad: lat, lon_rad: lon },
        star_altitude_rad: 0.0,
        penumbra: during(&|[penumbra, _, radius, _]| penumbra + radius)?,
        umbra: during(&|[_, umbra, radius, _]| umbra + radius),
        core,
        duration_s: core.map_or(0.0, |[a, b]| b.since(a)),
    })
}
