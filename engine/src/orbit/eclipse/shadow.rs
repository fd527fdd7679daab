//! The shadow at one moment: its axis, and the two cones about it.

use super::{Cast, Paths};
use crate::time::Moment;
use crate::units::SPEED_OF_LIGHT;
use glam::DVec3;

/// The axis of a shadow against the receiver's centre, by the light that arrives there at a moment. ICRF axes, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Unit vector along the axis, from the star through the caster.
    pub axis: DVec3,
    /// The point of the axis nearest to the receiver's centre, from that centre.
    pub offset: DVec3,
    /// How far past the caster that point lies, m; negative where the caster is not before the star.
    pub behind_m: f64,
    /// From the star to the caster, m.
    pub star_m: f64,
    /// Light time from the caster, s.
    pub light_s: f64,
}

/// A cone about the axis: signed radius where the axis passes the receiver's centre, and what it grows by each metre downstream.
/// An umbra's radius is negative before its apex [ESAE 1992, §8.323: L₁, L₂].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// m.
    pub radius_m: f64,
    /// tan f.
    pub slope: f64,
}

impl Cone {
    /// Radius at a point that lies `towards_star_m` upstream.
    pub fn at(self, towards_star_m: f64) -> f64 {
        self.radius_m - towards_star_m * self.slope
    }
}

impl Shadow {
    /// The shadow that the receiver is in at `t`.
    pub fn at(cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> Self {
        let here = paths(cast.receiver.id, t).position;
        let seen = |id| {
            // Two rounds: the second changes the light time by (v/c)² of itself.
            let mut light_s = (paths(id, t).position - here).length() / SPEED_OF_LIGHT;
            light_s = (paths(id, t.plus_s(-light_s)).position - here).length() / SPEED_OF_LIGHT;
            ((paths(id, t.plus_s(-light_s)).position - here).0, light_s)
        };
        let (star, _) = seen(cast.star.id);
        let (caster, light_s) = seen(cast.caster.id);
        let from_star = caster - star;
        let star_m = from_star.length();
        let axis = from_star.normalize_or(DVec3::X);
        let behind_m = -caster.dot(axis);
        Self { axis, offset: caster + axis * behind_m, behind_m, star_m, light_s }
    }

    fn cone(&self, sine: f64, limb_m: f64) -> Cone {
        let sine = sine.clamp(-0.999, 0.999);
        let cosine = (1.0 - sine * sine).sqrt();
        Cone { radius_m: self.behind_m * (sine / cosine) + limb_m / cosine, slope: sine / cosine }
    }

    /// The penumbra: tangents that cross between star and caster.
    pub fn penumbra(&self, cast: &Cast<'_>) -> Cone {
        let limb = cast.caster.shape.limb_m[0];
        self.cone((cast.star.shape.limb_m[0] + limb) / self.star_m.max(1.0), limb)
    }

    /// The umbra: the outer tangents.
    pub fn umbra(&self, cast: &Cast<'_>) -> Cone {
        let limb = cast.caster.shape.limb_m[1];
        self.cone((cast.star.shape.limb_m[0] - limb) / self.star_m.max(1.0), -limb)
    }

    /// Distance of the axis from the receiver's centre, m.
    pub fn miss_m(&self) -> f64 {
        self.offset.length()
    }
}
