//! Local circumstances: what one place on the receiver sees of an eclipse.
//!
//! Not here: air and relief; the star counts as up where its centre is above the plane horizon.

use super::search::{root, span};
use super::{Cast, Eclipse, Kind, Paths, Place, Shadow, Span};
use crate::time::Moment;
use glam::DVec3;

/// Samples between first and last touch of the penumbra, among which the deepest is looked for.
const SAMPLES: u32 = 72;

/// Someone who stands on the receiver, or floats above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    /// Where.
    pub place: Place,
    /// Above the ellipsoid, m.
    pub height_m: f64,
}

/// What is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Partial, annular or total.
    pub kind: Kind,
    /// When most is covered.
    pub greatest: Moment,
    /// Fraction of the star's diameter that is covered then; ratio of the diameters where one disc is within the other.
    pub magnitude: f64,
    /// The star's altitude then, rad.
    pub star_altitude_rad: f64,
    /// Angular radii of star and caster then, and the angle between their centres, rad.
    pub discs_rad: [f64; 3],
    /// First and last contact.
    pub partial: Span,
    /// The total or annular phase.
    pub inner: Option<Span>,
}

/// The shadow about an observer, at a moment.
struct Here {
    /// Distance from the axis, m, and radii of penumbra and umbra at that height.
    from_axis_m: f64,
    outer_m: f64,
    inner_m: f64,
    star_altitude_rad: f64,
    discs_rad: [f64; 3],
}

impl Observer {
    fn at(&self, cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> Here {
        let shape = &cast.receiver.shape;
        let shadow = Shadow::at(cast, paths, t);
        let icrf_from_fixed = cast.receiver.spin.icrf_from_fixed_at(t);
        let ground = shape.point(self.place);
        let up = shape.normal(ground);
        let p = icrf_from_fixed.raw(ground + up * self.height_m);
        let to_axis = shadow.offset - p;
        let upstream = -p.dot(shadow.axis);
        let caster = shadow.offset - shadow.axis * shadow.behind_m - p;
        let star = caster - shadow.axis * shadow.star_m;
        let radius = |limb_m: f64, at: DVec3| libm::asin((limb_m / at.length().max(1.0)).min(1.0));
        Here {
            from_axis_m: (to_axis - shadow.axis * to_axis.dot(shadow.axis)).length(),
            outer_m: shadow.penumbra(cast).at(upstream),
            inner_m: shadow.umbra(cast).at(upstream),
            star_altitude_rad: libm::asin(icrf_from_fixed.raw(up).dot(star.normalize_or(-shadow.axis)).clamp(-1.0, 1.0)),
            discs_rad: [
                radius(cast.star.shape.limb_m[0], star),
                radius(cast.caster.shape.limb_m[1], caster),
                libm::atan2(caster.cross(star).length(), caster.dot(star)),
            ],
        }
    }

    /// The total or annular phase about `t`, if it is on then.
    pub fn inner_phase(&self, cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> Option<Span> {
        let gap = |t: Moment| {
            let here = self.at(cast, paths, t);
            here.from_axis_m - here.inner_m.abs()
        };
        // How fast the axis goes over this place, from one second.
        let rate = (self.at(cast, paths, t.plus_s(1.0)).from_axis_m - self.at(cast, paths, t.plus_s(-1.0)).from_axis_m).abs();
        let speed = (0.5 * rate).max(super::search::crossing_m_s(cast, paths, t) * 0.1);
        span(&gap, t, (self.at(cast, paths, t).inner_m.abs() / speed / 8.0).max(1.0))
    }

    /// What is seen of `eclipse` from here, whether the star is up or not; `None` where nothing of the star is covered.
    pub fn seen(&self, cast: &Cast<'_>, paths: &Paths<'_>, eclipse: &Eclipse) -> Option<Local> {
        let [from, to] = eclipse.penumbra;
        let length = to.since(from);
        let gap = |s: f64| {
            let here = self.at(cast, paths, from.plus_s(s));
            here.from_axis_m - here.outer_m
        };
        let step = length / f64::from(SAMPLES);
        let deepest = (0..=SAMPLES).map(|k| f64::from(k) * step).min_by(|a, b| gap(*a).total_cmp(&gap(*b)))?;
        let rate = |s: f64| gap(s + 0.5) - gap(s - 0.5);
        let at = root(&rate, deepest - step, deepest + step);
        let greatest = from.plus_s(at);
        let here = self.at(cast, paths, greatest);
        if here.from_axis_m >= here.outer_m {
            return None;
        }
        let covered = here.from_axis_m < here.inner_m.abs();
        let sum = here.outer_m + here.inner_m;
        let outside = |t: Moment| {
            let here = self.at(cast, paths, t);
            here.from_axis_m - here.outer_m
        };
        Some(Local {
            kind: match (covered, here.inner_m < 0.0) {
                (false, _) => Kind::Partial,
                (true, true) => Kind::Total,
                (true, false) => Kind::Annular,
            },
            greatest,
            magnitude: if covered { (here.outer_m - here.inner_m) / sum } else { (here.outer_m - here.from_axis_m) / sum },
            star_altitude_rad: here.star_altitude_rad,
            discs_rad: here.discs_rad,
            partial: span(&outside, greatest, step)?,
            inner: if covered { self.inner_phase(cast, paths, greatest) } else { None },
        })
    }

    /// The star's altitude at `t`, rad.
    pub fn star_altitude_rad(&self, cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> f64 {
        self.at(cast, paths, t).star_altitude_rad
    }
}
