//! Eclipses: when a body's shadow falls on another, where, and how deep. Pure geometry with light time; any three bodies.
//!
//! ```text
//!  star ───────────── caster ═══ axis ═══▶ receiver
//!  S(t − τ_s)         C(t − τ_c)           R(t)
//! ```
//! The receiver's clock counts. Light that arrives at `t` left the caster at `t − τ_c` and the star at `t − τ_s`; the axis runs
//! through those two places ([`shadow`]). [`search`] finds the moments at which the axis passes closest to the receiver's centre
//! without missing one. What happens then is told by
//! - [`solar`] where the receiver is the larger: a spot runs over it (the Moon on the Earth, Io on Jupiter);
//! - [`lunar`] where the caster is: the receiver dips into a shadow (the Earth on the Moon, Jupiter on Io).
//!
//! [`local`] says what is seen from one place; [`shape`] is the receiver's ellipsoid.
//!
//! Not here: which bodies to try and what to call it (`game::world::eclipse`), light and discs (`crate::light`).
//! Refraction by air, the lunar limb's mountains and polar motion are left out: seconds at most.
//! - [Espenak & Meeus 2006] "Five Millennium Canon of Solar Eclipses: −1999 to +3000", NASA TP-2006-214141: definitions of kind,
//!   gamma and magnitude, the two radii of the Moon.
//! - [Espenak & Meeus 2009] "Five Millennium Canon of Lunar Eclipses", NASA TP-2009-214172: shadow by Danjon's rule.
//! - [ESAE 1992] "Explanatory Supplement to the Astronomical Almanac", ch. 8: Besselian elements.

pub mod local;
pub mod lunar;
pub mod search;
pub mod shadow;
pub mod shape;
pub mod solar;
#[cfg(test)]
mod tests;

pub use local::Local;
pub use search::Pace;
pub use shadow::Shadow;
pub use shape::Shape;

use super::rotation::Spin;
use super::{BodyId, State};
use crate::space::Icrf;
use crate::time::Moment;

/// Barycentric state of a body at a moment: what stands behind it (an ephemeris, a table) is the caller's.
pub type Paths<'a> = dyn Fn(BodyId, Moment) -> State<Icrf> + 'a;

/// A body that takes part.
#[derive(Clone, Copy, Debug)]
pub struct Role<'a> {
    /// Who.
    pub id: BodyId,
    /// How it turns.
    pub spin: &'a Spin,
    /// How large it is.
    pub shape: Shape,
}

/// Who takes part.
#[derive(Clone, Copy, Debug)]
pub struct Cast<'a> {
    /// Gives the light.
    pub star: Role<'a>,
    /// Throws the shadow.
    pub caster: Role<'a>,
    /// Is hit by it.
    pub receiver: Role<'a>,
}

impl Cast<'_> {
    /// True where the receiver is the larger: a spot runs over it, and eclipses are those of the star.
    pub fn is_solar(&self) -> bool {
        self.receiver.shape.equatorial_m >= self.caster.shape.equatorial_m
    }
}

/// What an eclipse is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Only the penumbra touches a body smaller than the caster.
    Penumbral,
    /// Solar: only the penumbra touches. Lunar: the umbra covers a part.
    Partial,
    /// Solar: the caster stands within the star's disc.
    Annular,
    /// Solar: annular at one end of the path or both, total between.
    Hybrid,
    /// Covered altogether.
    Total,
}

impl Kind {
    /// One lower-case word.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Penumbral => "penumbral",
            Self::Partial => "partial",
            Self::Annular => "annular",
            Self::Hybrid => "hybrid",
            Self::Total => "total",
        }
    }
}

/// Two moments between which something lasts.
pub type Span = [Moment; 2];

/// A place on a body: geodetic latitude and east longitude, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Geodetic: the angle of the plumb line with the equator.
    pub lat_rad: f64,
    /// East positive, (−π, π].
    pub lon_rad: f64,
}

/// One eclipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eclipse {
    /// What it is called.
    pub kind: Kind,
    /// When the axis passes closest to the receiver's centre, by the receiver's clock.
    pub greatest: Moment,
    /// Light time from the caster to the receiver, s. The canon gives lunar eclipses as seen from the Earth: this much later.
    pub light_s: f64,
    /// Distance of the receiver's centre from the axis then, in equatorial radii of the larger body; solar: positive where the axis
    /// passes north of the centre; lunar: where the receiver passes north of the axis.
    pub gamma: f64,
    /// Solar: the fraction of the star's diameter covered at the place of greatest eclipse; of a central one the ratio of the discs'
    /// diameters. Lunar: the fraction of the receiver's diameter within the umbra (negative for penumbral ones).
    pub magnitude: f64,
    /// Lunar: the fraction of the diameter within the penumbra. Solar: as `magnitude`.
    pub penumbral_magnitude: f64,
    /// Solar: the axis meets the receiver. Lunar: the axis passes through it.
    pub central: bool,
    /// Solar: where on the receiver it is greatest. Lunar: the place on the caster that has the receiver in its zenith.
    pub place: Place,
    /// Solar: the star's altitude there, rad.
    pub star_altitude_rad: f64,
    /// While the penumbra touches: P1, P4.
    pub penumbra: Span,
    /// While the umbra (or what lies beyond its apex) touches: U1, U4.
    pub umbra: Option<Span>,
    /// Solar: while the axis meets the receiver. Lunar: while it is covered altogether: U2, U3.
    pub core: Option<Span>,
    /// Seconds of the total or annular phase at `place` (solar), of totality (lunar); 0 where there is none.
    pub duration_s: f64,
}

impl Eclipse {
    /// When it is greatest as a canon gives it: of the receiver's clock for solar eclipses; seen from the caster for lunar ones.
    pub fn canonical(&self, cast: &Cast<'_>) -> Moment {
        if cast.is_solar() { self.greatest } else { self.greatest.plus_s(self.light_s) }
    }
}

/// Every eclipse whose greatest moment lies in `from ..= to`, in order, until `each` answers false.
pub fn find(cast: &Cast<'_>, paths: &Paths<'_>, pace: Pace, from: Moment, to: Moment, each: &mut dyn FnMut(Eclipse) -> bool) {
    let mut t = from;
    while let Some((closest, next)) = search::closest(cast, paths, pace, t, to) {
        let found = if cast.is_solar() { solar::describe(cast, paths, closest) } else { lunar::describe(cast, paths, closest) };
        if found.is_some_and(|eclipse| !each(eclipse)) {
            return;
        }
        t = next;
    }
}
