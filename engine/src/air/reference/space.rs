//! What the integrator walks through: the medium in f64, its shells, and the light that falls into it.

use super::chords::Chords;
use super::scatter::Scatter;
use crate::air::medium::{Medium, Profile};
use crate::light::occlusion::{Disc, separation_rad, visible, visible_above_limb};
use glam::DVec3;

/// Distances along a ray: where the air begins and ends, and whether the ground ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Metres to where the ray enters the air (0 inside).
    pub near_m: f64,
    /// Metres to where it leaves the air or meets the ground.
    pub far_m: f64,
    /// True when it ends on the ground.
    pub hits_ground: bool,
}

/// The stretch of a ray inside the air; `None` when it misses. `from_m` is relative to the body's centre, `direction` a unit vector.
///
/// The ground is the datum sphere; for an eye at or below the datum it is the sphere on which the eye stands, down to
/// [`Medium::FLOOR_M`].
pub fn span(medium: &Medium, from_m: DVec3, direction: DVec3) -> Option<Span> {
    let (r2, b) = (from_m.length_squared(), from_m.dot(direction));
    let sphere = |radius: f64| {
        let d = b * b - (r2 - radius * radius);
        (d > 0.0).then(|| (-b - d.sqrt(), -b + d.sqrt()))
    };
    let (near, far) = sphere(medium.bottom_radius_m + medium.top_altitude_m)?;
    if far <= 0.0 {
        return None;
    }
    let near_m = near.max(0.0);
    let ground_m = ground_under(medium, from_m);
    if r2.sqrt() <= ground_m {
        // On the ground or in it.
        let hits_ground = b < 0.0 || r2.sqrt() < ground_m;
        return Some(Span { near_m, far_m: if hits_ground { near_m } else { far }, hits_ground });
    }
    match sphere(ground_m) {
        Some((ground, _)) if ground > near_m => Some(Span { near_m, far_m: ground, hits_ground: true }),
        _ => Some(Span { near_m, far_m: far, hits_ground: false }),
    }
}

/// Radius of the ground sphere as an eye at this place sees it, m.
pub fn ground_under(medium: &Medium, from_m: DVec3) -> f64 {
    let datum = medium.bottom_radius_m;
    from_m.length().min(datum).max((datum - Medium::FLOOR_M).max(0.5 * datum))
}

/// A sphere that may stand before the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre relative to the body's, m.
    pub centre_m: DVec3,
    /// Radius, m.
    pub radius_m: f64,
}

/// Where light comes from: a uniform disc at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    /// Unit vector to its centre.
    pub sun: DVec3,
    /// Angular radius, rad.
    pub sun_rad: f64,
    /// What may hide it.
    pub occluders: &'a [Sphere],
}

impl Light<'_> {
    /// Angle between the sun's centre and the limb of one occluder as a point sees it, rad: covered below `−sun_rad`, free above `sun_rad`.
    pub fn gap_rad(&self, occluder: &Sphere, at_m: DVec3) -> f64 {
        let disc = Disc::of_sphere(occluder.centre_m - at_m, occluder.radius_m);
        separation_rad(self.sun, disc.direction) - disc.radius_rad
    }
}

/// One layer.
pub struct Optic {
    /// Scattering coefficient at density 1, m⁻¹.
    pub scattering: DVec3,
    /// Extinction coefficient at density 1, m⁻¹.
    pub extinction: DVec3,
    /// Density against altitude.
    pub profile: Profile,
    /// Where scattered light goes.
    pub scatter: Scatter,
}

/// An atmosphere made ready for one family of rays: those with the same ground under the eye.
pub struct Space {
    /// The layers that do anything.
    pub optics: Vec<Optic>,
    /// Lambert albedo of the ground.
    pub albedo: DVec3,
    /// Radius of the datum, m: altitudes and horizons count from it.
    pub datum_m: f64,
    /// Radius of the ground that rays meet, m.
    pub ground_m: f64,
    /// Radius of the top, m.
    pub top_m: f64,
    /// Altitudes where some layer bends or jumps, m, rising, within the air.
    pub breaks_m: Vec<f64>,
    /// Optical depths along all chords.
    pub chords: Chords,
}

impl Space {
    /// The space as an eye at `from_m` has it.
    pub fn new(medium: &Medium, from_m: DVec3) -> Self {
        let optic = |layer: &crate::air::Layer| Optic {
            scattering: layer.scattering_per_m.as_dvec3(),
            extinction: (layer.scattering_per_m + layer.absorption_per_m).as_dvec3(),
            profile: layer.profile.clone(),
            scatter: Scatter::new(&layer.phase),
        };
        let optics: Vec<Optic> = medium.layers.iter().map(optic).filter(|o| o.extinction.max_element() > 0.0).collect();
        let mut breaks_m: Vec<f64> = optics.iter().flat_map(|o| o.profile.breaks_m()).collect();
        breaks_m.retain(|h| (-Medium::FLOOR_M..medium.top_altitude_m).contains(h));
        breaks_m.sort_by(f64::total_cmp);
        breaks_m.dedup();
        let mut space = Self {
            optics,
            albedo: medium.ground_albedo.as_dvec3(),
            datum_m: medium.bottom_radius_m,
            ground_m: ground_under(medium, from_m),
            top_m: medium.bottom_radius_m + medium.top_altitude_m,
            breaks_m,
            chords: Chords::default(),
        };
        space.chords = Chords::new(&space);
        space
    }

    /// Extinction at a radius, m⁻¹.
    pub fn extinction(&self, r_m: f64) -> DVec3 {
        self.optics.iter().map(|o| o.extinction * o.profile.density(r_m - self.datum_m)).sum()
    }

    /// Scattering at a radius, m⁻¹.
    pub fn scattering(&self, r_m: f64) -> DVec3 {
        self.optics.iter().map(|o| o.scattering * o.profile.density(r_m - self.datum_m)).sum()
    }

    /// Sine of the horizon's depression at a radius, as a cosine to the zenith: 0 at the datum and below.
    pub fn horizon(&self, r_m: f64) -> f64 {
        let x = (self.datum_m / r_m).min(1.0);
        -((1.0 - x) * (1.0 + x)).sqrt()
    }

    /// Angle from the straight local horizon up to the sun's centre, rad.
    pub fn elevation_rad(&self, light: &Light<'_>, at_m: DVec3) -> f64 {
        let r = at_m.length();
        libm::asin((at_m.dot(light.sun) / r).clamp(-1.0, 1.0)) - libm::asin(self.horizon(r))
    }

    /// Visible fraction of the sun's disc.
    pub fn visible(&self, light: &Light<'_>, at_m: DVec3) -> f64 {
        let r = at_m.length();
        let (mu, horizon) = (at_m.dot(light.sun) / r, self.horizon(r));
        // The arcs are only needed near the horizon: an angle is never smaller than the difference of sines.
        let above = if mu - horizon >= light.sun_rad { 1.0 } else { visible_above_limb(light.sun_rad, self.elevation_rad(light, at_m)) };
        if above == 0.0 || light.occluders.is_empty() {
            return above;
        }
        let sun = Disc { direction: light.sun, radius_rad: light.sun_rad };
        let discs = light.occluders.iter().map(|o| Disc::of_sphere(o.centre_m - at_m, o.radius_m));
        above * discs.map(|d| visible(sun, &[d])).product::<f64>()
    }

    /// Cosine to the zenith along which the sun's light is taken to come: the disc's centre, held at the horizon.
    pub fn sun_cosine(&self, light: &Light<'_>, at_m: DVec3) -> f64 {
        let r = at_m.length();
        (at_m.dot(light.sun) / r).max(self.horizon(r))
    }

    /// Direct sunlight at a point, per unit of irradiance above the air, by the table of chords.
    pub fn sunlight(&self, light: &Light<'_>, at_m: DVec3) -> DVec3 {
        let visible = self.visible(light, at_m);
        if visible > 0.0 { self.chords.transmittance(at_m.length(), self.sun_cosine(light, at_m)) * visible } else { DVec3::ZERO }
    }
}

/// `exp` of each channel.
pub fn exp3(v: DVec3) -> DVec3 {
    DVec3::new(libm::exp(v.x), libm::exp(v.y), libm::exp(v.z))
}
