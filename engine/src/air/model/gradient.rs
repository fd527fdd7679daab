//! The model `gradient`: a stylised air whose colours are looked up in two small painted maps.
//!
//! After the blog post "Simple Flexibile Atmosphere Shaders" (Ogre planet plug-in, NVidia FX Composer 2.5). The shell's map is read by where a ray enters and leaves
//! the shell (`u`, from the sun's cosines there and at the camera) and by how low it passes (bottom row: along the surface, top row: at
//! the edge of the air). The ground's map holds two rows, the colour of the air above (top) and what becomes of the sun's (bottom), by
//! the sun's cosine. There is no physics in it: a modder paints both.
//!
//! What the article leaves open is fixed here: all points are unit vectors from the centre; within the air the ray enters at
//! the camera; `height` falls from 1 at the surface to 0 at the edge; something drawn within the air but above the datum takes the
//! ground's formula by its `height`, and the shell by the rest and by how much of the way lies before it.
//!
//! Of eclipses the article knows nothing: here the air's own light is multiplied by the free fraction of the sun's disc, averaged along the ray,
//! on the GPU as for all models that keep light in tables (`shaders/lib/eclipse_along.wgsl`).
//!
//! GPU twin: `shaders/lib/gradient.wgsl`.

use super::super::RangeError;
use super::maps::ColourMap;
use super::shell::Chord;
use core::f64::consts::PI;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Settings of the model `gradient`: the table `[gradient]` of an `atmosphere.toml`. Every key may be left out. The shell's height is
/// `top_altitude_m` of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gradient {
    /// `stretch`, 0 … 2, 0.5 by default: by how much of the sun's cosine day reaches beyond the terminator: where sunset begins.
    pub stretch: f32,
    /// `fade_stretch`, 0 … 2, 0.5 by default: by how much more the air is seen at all. 0: it has faded out at the end of sunset.
    pub fade_stretch: f32,
    /// `visibility_m`, 1 … 1e9 m, 30 km by default: ground nearer than this is clear. A short one makes a dense air.
    pub visibility_m: f64,
    /// `transparency`, 0 … 1, 0.4 by default: how strong the air's colour can become over the ground.
    pub transparency: f32,
    /// `brightness`, 0 … 100, 1 by default: the radiance of the map's white, in that of a white Lambert surface that faces the sun.
    pub brightness: f32,
    /// `opacity`, 0 … 1, 0 by default: how much of the sky behind the shell it hides where it is strongest. 0 only adds light.
    pub opacity: f32,
    /// `shell_map = "FILE.png"`: 32 × 16 texels as the article's, 2 … 256 each way allowed. Left: away from the sun, right: toward it. Bottom: at the
    /// surface, top: at the edge. Its alpha weighs the shell's.
    pub shell_map: ColourMap,
    /// `ground_map = "FILE.png"`: 32 × 2 texels, 2 … 256 wide, 2 high. Top row: colour of the air; bottom row: what the sun's is multiplied
    /// by. Left: midnight, middle: the sun on the horizon, right: overhead.
    pub ground_map: ColourMap,
}

impl Default for Gradient {
    fn default() -> Self {
        Self {
            stretch: 0.5,
            fade_stretch: 0.5,
            visibility_m: 30_000.0,
            transparency: 0.4,
            brightness: 1.0,
            opacity: 0.0,
            shell_map: ColourMap::earthly_shell(),
            ground_map: ColourMap::earthly_ground(),
        }
    }
}

/// Light of an air along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Per unit of illuminance above the air, sr⁻¹ per channel.
    pub radiance: DVec3,
    /// By what the light from behind is multiplied.
    pub transmittance: DVec3,
}

/// What [`Gradient::light`] is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// The camera from the planet's centre, m.
    pub eye: DVec3,
    /// Unit vector of sight.
    pub ray: DVec3,
    /// Unit vector to the sun.
    pub sun: DVec3,
    /// Radius of the datum, m.
    pub bottom_m: f64,
    /// Height of the shell above it, m.
    pub top_m: f64,
    /// Distance to what is drawn, m; none where nothing is: the datum then stands for the ground.
    pub surface_m: Option<f64>,
}

impl Gradient {
    /// Everything that is out of range; fields are named as keys of the table.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        RangeError::check(&mut e, "stretch", f64::from(self.stretch), 0.0, 2.0);
        RangeError::check(&mut e, "fade_stretch", f64::from(self.fade_stretch), 0.0, 2.0);
        RangeError::check(&mut e, "visibility_m", self.visibility_m, 1.0, 1.0e9);
        RangeError::check(&mut e, "transparency", f64::from(self.transparency), 0.0, 1.0);
        RangeError::check(&mut e, "brightness", f64::from(self.brightness), 0.0, 100.0);
        RangeError::check(&mut e, "opacity", f64::from(self.opacity), 0.0, 1.0);
        self.shell_map.check(&mut e, "shell_map", 2..=256);
        self.ground_map.check(&mut e, "ground_map", 2..=2);
        e
    }

    /// `uv.x` and alpha of the shell, from the sun's cosine at the far and the near end of the ray's way through it and at the camera.
    ///
    /// The article's code, with its offsets taken from the bare cosines both times: `ln` and `lnn` are those of far and near end.
    pub fn across(&self, far: f64, near: f64, camera: f64) -> (f64, f64) {
        let stretch = f64::from(self.stretch);
        let both = stretch + f64::from(self.fade_stretch);
        let reached = |by: f64| ((far + by).max(0.0) + (near + by).max(0.0) * camera).clamp(0.0, 1.0);
        (reached(stretch) * (camera + 1.0 + stretch).clamp(0.0, 1.0), reached(both))
    }

    /// How far the air's colour has come over ground that is seen from `distance_m`, 0 … 1.
    pub fn attenuation(&self, distance_m: f64, top_m: f64) -> f64 {
        let vd = top_m.min(self.visibility_m);
        ((distance_m - self.visibility_m) / (top_m + vd)).clamp(0.0, 1.0)
    }

    /// The ground's formula where the sun's cosine is `mu_s`: radiance added, and the factor on what is drawn there:
    /// `diffuse · sunColor + atmosphereColor · min(transparency, attenuation) · sunColor`.
    pub fn ground(&self, mu_s: f64, attenuation: f64) -> Light {
        let u = 0.5 + 0.5 * mu_s;
        let air = self.ground_map.at(u, 0.25).truncate();
        let sun = self.ground_map.at(u, 0.75).truncate();
        let strength = f64::from(self.transparency).min(attenuation) * f64::from(self.brightness) / PI;
        Light { radiance: air * sun * strength, transmittance: sun }
    }

    /// The light of a ray; none where it misses the shell, or where something is drawn before it.
    pub fn light(&self, sight: &Sight) -> Option<Light> {
        let chord = Chord::new(sight.eye, sight.ray, sight.bottom_m, sight.top_m)?;
        if sight.surface_m.is_some_and(|s| s <= chord.start_m) {
            return None;
        }
        let at = |s: f64| sight.eye + sight.ray * s;
        let cosine = |p: DVec3| p.normalize_or(sight.sun).dot(sight.sun);
        let (near, far, camera) = (cosine(at(chord.start_m)), cosine(at(chord.exit_m)), cosine(sight.eye));
        let height = (1.0 - chord.lowest_m / sight.top_m).clamp(0.0, 1.0);
        let (u, alpha) = self.across(far, near, camera);
        let texel = self.shell_map.at(u, height);
        let alpha = height * alpha * texel.w;
        let shell = Light {
            radiance: texel.truncate() * (alpha * f64::from(self.brightness) / PI),
            transmittance: DVec3::splat(1.0 - f64::from(self.opacity) * alpha),
        };
        let Some(surface_m) = sight.surface_m.or(chord.ground_m).filter(|s| *s < chord.exit_m) else { return Some(shell) };
        let point = at(surface_m);
        let low = (1.0 - (point.length() - sight.bottom_m) / sight.top_m).clamp(0.0, 1.0);
        let passed = (1.0 - low) * ((surface_m - chord.start_m) / (chord.exit_m - chord.start_m).max(1e-9)).clamp(0.0, 1.0);
        let ground = self.ground(cosine(point), self.attenuation(surface_m, sight.top_m));
        Some(Light {
            radiance: ground.radiance * low + shell.radiance * passed,
            transmittance: DVec3::ONE.lerp(ground.transmittance, low) * DVec3::ONE.lerp(shell.transmittance, passed),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: f64 = 6.371e6;
    const TOP: f64 = 1.0e5;

    fn sight(eye: DVec3, ray: DVec3, surface_m: Option<f64>) -> Sight {
        Sight { eye, ray: ray.normalize(), sun: DVec3::X, bottom_m: R, top_m: TOP, surface_m }
    }

    #[test]
    fn the_horizontal_coordinate_is_the_article_s() {
        let model = Gradient::default();
        // Between the planet and the sun: ln 0, lnn 1, lc 1. Behind: ln 1, lnn 0, lc −1: red, halfway.
        assert_eq!(model.across(0.0, 1.0, 1.0), (1.0, 1.0));
        assert_eq!(model.across(1.0, 0.0, -1.0).0, 0.5);
        assert_eq!(model.across(1.0, -0.5, -1.0), (0.5, 1.0));
        // Sideways: ln alone counts; it has faded out `stretch + fade_stretch` beyond the terminator.
        assert!((model.across(0.1, -0.7, 0.0).0 - 0.6).abs() < 1e-12);
        assert!((model.across(-0.75, 0.0, 0.0).1 - 0.25).abs() < 1e-12);
        assert_eq!(model.across(-1.0, -1.0, 0.0), (0.0, 0.0));
        let sharp = Gradient { stretch: 0.0, fade_stretch: 0.0, ..model };
        assert_eq!(sharp.across(-0.01, 0.5, 0.0), (0.0, 0.0));
    }

    #[test]
    fn attenuation_is_the_article_s() {
        let model = Gradient { visibility_m: 2.0e4, ..Gradient::default() };
        let found = [1.0e4, 2.0e4, 8.0e4, 1.4e5, 1.0e9].map(|d| model.attenuation(d, TOP));
        assert_eq!(found, [0.0, 0.0, 0.5, 1.0, 1.0]);
        // Beyond the height of the air visibility no longer lengthens the rise.
        assert_eq!(Gradient { visibility_m: 5.0e5, ..model }.attenuation(6.0e5, TOP), 0.5);
    }

    #[test]
    fn the_ground_takes_both_rows() {
        let ground_map =
            ColourMap { size: [2, 2], rgba: [[255, 0, 0, 255], [255, 0, 0, 255], [0, 0, 0, 255], [255, 255, 255, 255]].concat() };
        let model = Gradient { ground_map, ..Gradient::default() };
        let noon = model.ground(1.0, 0.9);
        assert_eq!(noon.transmittance, DVec3::ONE);
        assert!((noon.radiance * PI - DVec3::X * 0.4).length() < 1e-7);
        assert!((model.ground(1.0, 0.1).radiance * PI - DVec3::X * 0.1).length() < 1e-9);
        let set = model.ground(0.0, 0.9);
        assert_eq!(set.transmittance, DVec3::splat(0.5));
        assert!((set.radiance * PI - DVec3::X * 0.2).length() < 1e-7);
    }

    #[test]
    fn the_vertical_coordinate_goes_from_the_surface_to_the_edge() {
        // Rows black, grey, white from the edge down: from afar a ray that passes at half the height reads the middle.
        let shell_map = ColourMap { size: [2, 3], rgba: [0_u8, 188, 255].into_iter().flat_map(|g| [g, g, g, 255, g, g, g, 255]).collect() };
        let model = Gradient { shell_map, opacity: 0.5, ..Gradient::default() };
        let afar = |lowest: f64| {
            let eye = DVec3::new(5.0e7, 0.0, 0.0);
            let sine = (R + lowest) / 5.0e7;
            model.light(&sight(eye, DVec3::new(-(1.0 - sine * sine).sqrt(), sine, 0.0), None))
        };
        let half = afar(0.5 * TOP).unwrap();
        assert!((half.radiance.x * PI - 0.5 * 0.502_886).abs() < 1e-6, "{}", half.radiance.x * PI);
        assert!((half.transmittance.x - 0.75).abs() < 1e-9);
        assert!((afar(0.0).unwrap().radiance.x * PI - 1.0).abs() < 1e-6);
        assert!(afar(TOP - 1.0).unwrap().radiance.x < 1e-5 && afar(TOP + 1.0).is_none());
        // On the ground every direction of the sky is the bottom row.
        let above = model.light(&sight(DVec3::X * R, DVec3::new(0.2, 1.0, 0.0), None)).unwrap();
        assert!((above.radiance.x * PI - 1.0).abs() < 1e-6);
    }

    #[test]
    fn nothing_pops_at_the_top_of_the_air_nor_where_things_leave_it() {
        let model = Gradient { opacity: 0.7, ..Gradient::default() };
        for ray in [DVec3::new(-1.0, 2.0, 0.0), DVec3::new(1.0, 3.0, 0.5), DVec3::new(0.01, 1.0, 0.0)] {
            let at = |altitude: f64| model.light(&sight(DVec3::new(0.6, 0.8, 0.0) * (R + altitude), ray, None));
            let (inside, outside) = (at(TOP - 1e-3).unwrap(), at(TOP + 1e-3));
            let outside = outside.unwrap_or(Light { radiance: DVec3::ZERO, transmittance: DVec3::ONE });
            assert!((inside.radiance - outside.radiance).length() < 1e-4, "{ray}: {inside:?} {outside:?}");
            assert!((inside.transmittance - outside.transmittance).length() < 1e-4);
        }
        // A thing that moves along a ray through the shell: in at the front without a trace, out at the back as the shell itself.
        let (eye, ray) = (DVec3::X * (R + 1.0e6), DVec3::new(-0.49, 0.872, 0.0));
        let chord = Chord::new(eye, ray.normalize(), R, TOP).unwrap();
        let at = |s| model.light(&sight(eye, ray, Some(s))).unwrap();
        assert!(at(chord.start_m + 1e-3).radiance.length() < 1e-6);
        let (last, beyond) = (at(chord.exit_m - 1e-3), at(chord.exit_m + 1e-3));
        assert!((last.radiance - beyond.radiance).length() < 1e-6 && (last.transmittance - beyond.transmittance).length() < 1e-6);
        assert_eq!(model.light(&sight(eye, ray, Some(chord.start_m - 1.0))), None);
    }

    #[test]
    fn bad_settings_are_told_all_at_once() {
        let bad = Gradient { stretch: -1.0, visibility_m: f64::NAN, shell_map: ColourMap::default(), ..Gradient::default() };
        let fields: Vec<_> = bad.validate().into_iter().map(|e| e.field).collect();
        assert_eq!(fields, ["stretch", "visibility_m", "shell_map: width in texels", "shell_map: height in texels"]);
        assert!(Gradient::default().validate().is_empty());
    }
}
