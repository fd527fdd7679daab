//! Eclipses of the star on a body larger than the caster: the penumbra and the spot in it run over an ellipsoid that turns.
//!
//! Not here: what one place sees ([`super::local`]).

use super::local::Observer;
use super::search::{crossing_m_s, span};
use super::{Cast, Eclipse, Kind, Paths, Place, Shadow};
use crate::time::Moment;
use glam::DVec3;

/// The shadow against the receiver's own axes, at a moment.
struct Footprint {
    shadow: Shadow,
    axis: DVec3,
    offset: DVec3,
    /// Signed distance of the axis from the outline, m, and the nearest point of the outline.
    gap_m: f64,
    limb: DVec3,
}

impl Footprint {
    fn at(cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> Self {
        let shadow = Shadow::at(cast, paths, t);
        let fixed_from_icrf = cast.receiver.spin.icrf_from_fixed_at(t).inverse();
        let (axis, offset) = (fixed_from_icrf.raw(shadow.axis), fixed_from_icrf.raw(shadow.offset));
        let (gap_m, limb) = cast.receiver.shape.outline(offset, axis);
        Self { shadow, axis, offset, gap_m, limb }
    }

    /// The point that is darkest: where the axis meets the surface, else the outline's nearest.
    fn darkest(&self, cast: &Cast<'_>) -> (DVec3, bool) {
        cast.receiver.shape.first_hit(self.offset, self.axis).map_or((self.limb, false), |hit| (hit, true))
    }

    /// Distance of a surface point from the axis, and how far upstream it lies, m.
    fn aside(&self, p: DVec3) -> (f64, f64) {
        let to_axis = self.offset - p;
        ((to_axis - self.axis * to_axis.dot(self.axis)).length(), -p.dot(self.axis))
    }
}

/// Where the axis meets the receiver at `t`; `None` where it passes by.
pub fn centre(cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> Option<Place> {
    let foot = Footprint::at(cast, paths, t);
    let (p, hit) = foot.darkest(cast);
    (hit && foot.shadow.behind_m > 0.0).then(|| cast.receiver.shape.place(p))
}

/// The central line: `count` places at equal steps of time from where the axis comes on to where it leaves.
pub fn central_line(cast: &Cast<'_>, paths: &Paths<'_>, eclipse: &Eclipse, count: usize) -> Vec<(Moment, Place)> {
    let Some([from, to]) = eclipse.core.filter(|_| cast.is_solar()) else { return Vec::new() };
    let length = to.since(from);
    // The ends touch the outline, where rounding decides: a hair inside.
    let at = |k: usize| from.plus_s(length * (k as f64 / (count.max(2) - 1) as f64).clamp(1e-7, 1.0 - 1e-7));
    (0..count).filter_map(|k| centre(cast, paths, at(k)).map(|place| (at(k), place))).collect()
}

/// The eclipse whose axis passes closest at `greatest`; `None` where even the penumbra passes by.
pub fn describe(cast: &Cast<'_>, paths: &Paths<'_>, greatest: Moment) -> Option<Eclipse> {
    let foot = Footprint::at(cast, paths, greatest);
    let shadow = &foot.shadow;
    let (penumbra, umbra) = (shadow.penumbra(cast), shadow.umbra(cast));
    if shadow.behind_m <= 0.0 || foot.gap_m >= penumbra.radius_m {
        return None;
    }
    let (point, central) = foot.darkest(cast);
    let (from_axis, upstream) = foot.aside(point);
    let (outer, inner) = (penumbra.at(upstream), umbra.at(upstream));
    let covered = from_axis < inner.abs();
    // [ESAE 1992, §8.3622]: the ratio of the discs under the axis, else the covered part of the diameter.
    let magnitude = if central { (outer - inner) / (outer + inner) } else { (outer - from_axis) / (outer + inner) };

    let radius_m = cast.receiver.shape.equatorial_m;
    let step_s = (radius_m + penumbra.radius_m) / crossing_m_s(cast, paths, greatest) / 12.0;
    let gap = |t: Moment, reach: &dyn Fn(&Shadow) -> f64| {
        let foot = Footprint::at(cast, paths, t);
        foot.gap_m - reach(&foot.shadow)
    };
    let during = |reach: &dyn Fn(&Shadow) -> f64| span(&|t| gap(t, reach), greatest, step_s);
    let core = if central { during(&|_| 0.0) } else { None };
    // At its ends the path is farther from the caster by the receiver's radius: what was total may be annular there.
    let end = |t: Moment| {
        let foot = Footprint::at(cast, paths, t);
        foot.shadow.umbra(cast).at(-foot.limb.dot(foot.axis))
    };
    let kind = match core {
        _ if !covered => Kind::Partial,
        Some([a, b]) if (end(a) < 0.0) != (inner < 0.0) || (end(b) < 0.0) != (inner < 0.0) => Kind::Hybrid,
        _ if inner < 0.0 => Kind::Total,
        _ => Kind::Annular,
    };
    let shape = &cast.receiver.shape;
    let north = cast.receiver.spin.icrf_from_fixed_at(greatest).raw(DVec3::Z);
    // Beside the axis the canon gives the direction of its nearest point as if on a sphere; so do we (the outline's own point lies
    // within 0.2° of it, on the line where the star sets).
    let place = if central {
        shape.place(point)
    } else {
        let (lat_rad, lon_rad) = crate::space::sphere::lat_lon_of(foot.offset);
        Place { lat_rad, lon_rad }
    };
    let observer = Observer { place, height_m: 0.0 };
    Some(Eclipse {
        kind,
        greatest,
        light_s: shadow.light_s,
        gamma: shadow.miss_m().copysign(shadow.offset.dot(north)) / radius_m,
        magnitude,
        penumbral_magnitude: magnitude,
        central,
        place,
        star_altitude_rad: libm::asin((-shape.normal(point).dot(foot.axis)).clamp(-1.0, 1.0)),
        penumbra: during(&|s| s.penumbra(cast).radius_m)?,
        umbra: if covered { during(&|s| s.umbra(cast).radius_m.abs()) } else { None },
        core,
        duration_s: if central { observer.inner_phase(cast, paths, greatest).map_or(0.0, |[a, b]| b.since(a)) } else { 0.0 },
    })
}
