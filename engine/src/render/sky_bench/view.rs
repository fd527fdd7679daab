//! Views that a bench draws, and the rays of their pixels: one eye over a bare planet under one sun, for models and for the reference alike.

use crate::air::reference::{Ray, optical_depth, span};
use crate::air::{Air, Medium};
use crate::scene::{AutoOr, Body, Camera, Force, Snapshot, Star, Surface};
use crate::space::relative::{narrow, narrow3};
use crate::units::{AU, DEG, KM};
use glam::{DVec3, Mat3, Quat, Vec3};

/// Pictures are this many times an odd number wide and high, so that the middles of the pixels of [`GRID`] are middles of pixels in all.
pub const GRID: [u32; 2] = [160, 90];
/// The smallest picture whose errors are asked for, in pixels of the grid.
const COARSEST: f64 = 3.0;

/// Optical depth, in every channel, of a ray that judges: over less, the ground is seen and not the air, and its little light is nobody's aim.
const SEEN: f64 = 0.01;

/// The light of a view, by which errors are grouped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Light {
    /// From within the air, sun well above the horizon.
    Day,
    /// From within the air, sun on the horizon.
    Sunset,
    /// From within the air, sun below the horizon.
    Twilight,
    /// From above the air.
    Space,
}

impl Light {
    /// All, in order.
    pub const ALL: [Self; 4] = [Self::Day, Self::Sunset, Self::Twilight, Self::Space];

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Day => "day",
            Self::Sunset => "sunset",
            Self::Twilight => "twilight",
            Self::Space => "space",
        }
    }
}

/// An eye, where it looks, and the sun. Up is +Z, forward along +X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Its name in tables and files.
    pub name: &'static str,
    /// The group it counts for.
    pub light: Light,
    /// Of the eye over the datum, m.
    pub altitude_m: f64,
    /// Of the sun at the eye, degrees.
    pub sun_zenith_deg: f64,
    /// Of the sun to the left of the view, degrees.
    pub sun_azimuth_deg: f64,
    /// Of the view above the level, degrees.
    pub pitch_deg: f64,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
}

/// The views: half of each from the ground is sky, or more; the limb fills one, half a world another.
pub const VIEWS: [View; 8] = [
    View::of("day", Light::Day, 2.0, [45.0, 60.0, 15.0, 60.0]),
    View::of("low_sun", Light::Day, 2.0, [85.0, 30.0, 12.0, 60.0]),
    View::of("high", Light::Day, 10.0 * KM, [60.0, 50.0, -3.0, 60.0]),
    View::of("sunset", Light::Sunset, 2.0, [90.0, 20.0, 12.0, 60.0]),
    View::of("twilight", Light::Twilight, 2.0, [94.0, 10.0, 16.0, 60.0]),
    View::of("limb", Light::Space, 400.0 * KM, [65.0, 50.0, -19.7, 12.0]),
    View::of("sunset_limb", Light::Space, 400.0 * KM, [108.0, 10.0, -19.7, 12.0]),
    View::of("world", Light::Space, 6000.0 * KM, [60.0, 70.0, -70.0, 60.0]),
];

impl View {
    const fn of(name: &'static str, light: Light, altitude_m: f64, degrees: [f64; 4]) -> Self {
        let [sun_zenith_deg, sun_azimuth_deg, pitch_deg, fov_deg] = degrees;
        Self { name, light, altitude_m, sun_zenith_deg, sun_azimuth_deg, pitch_deg, fov_deg }
    }

    fn aim(elevation_deg: f64, azimuth_deg: f64) -> DVec3 {
        let ((se, ce), (sa, ca)) = (libm::sincos(elevation_deg * DEG), libm::sincos(azimuth_deg * DEG));
        DVec3::new(ce * ca, ce * sa, se)
    }

    /// Unit vector to the sun, which is so far that all of the planet has it there.
    fn sun(&self) -> DVec3 {
        Self::aim(90.0 - self.sun_zenith_deg, self.sun_azimuth_deg)
    }

    /// Right, up and forward, unit.
    fn axes(&self) -> [DVec3; 3] {
        let forward = Self::aim(self.pitch_deg, 0.0);
        let right = DVec3::NEG_Y;
        [right, right.cross(forward), forward]
    }

    /// What is drawn: a black ball under its air, lit by an illuminance of 1, so that the picture holds radiance per unit of that.
    pub fn scene(&self, air: &Air, sun_rad: f64, size_px: [u32; 2]) -> Snapshot {
        let [right, up, forward] = self.axes().map(narrow3);
        let radius = air.medium.bottom_radius_m;
        Snapshot {
            camera: Camera {
                view_from_icrf: Quat::from_mat3(&Mat3::from_cols(right, up, -forward)).conjugate(),
                fov_y_rad: narrow(self.fov_deg * DEG),
                near_m: 0.2,
                size_px,
            },
            star: Star { id: 0, centre_m: narrow3(self.sun() * AU), radius_m: narrow(AU * libm::sin(sun_rad)), intensity_cd: Vec3::ONE },
            bodies: vec![Body {
                id: 0,
                centre_m: narrow3(DVec3::NEG_Z * (radius + self.altitude_m)),
                radius_m: narrow(radius),
                icrf_from_fixed: Quat::IDENTITY,
                camera_altitude_m: narrow(self.altitude_m),
                camera_up: Vec3::Z,
                sun_direction: narrow3(self.sun()),
                sun_angular_radius_rad: narrow(sun_rad),
                sun_illuminance_lx: Vec3::ONE,
                occluders: Vec::new(),
                albedo: Vec3::ZERO,
                surface: Surface::Smooth,
                air: Some(air.clone()),
            }],
            ships: Vec::new(),
            exposure: AutoOr::Ev100(0.0),
            adapt_s: None,
            force: Force::default(),
        }
    }

    /// The ray through the middle of a pixel of the grid.
    pub fn ray(&self, medium: &Medium, sun_rad: f64, pixel: [u32; 2]) -> Ray {
        let [right, up, forward] = self.axes();
        let tan = libm::tan(0.5 * self.fov_deg * DEG);
        let [x, y] = [0, 1].map(|i| (f64::from(pixel[i]) + 0.5) / f64::from(GRID[i]) * 2.0 - 1.0);
        let wide = tan * f64::from(GRID[0]) / f64::from(GRID[1]);
        Ray {
            from_m: DVec3::Z * (medium.bottom_radius_m + self.altitude_m),
            direction: (forward + right * (x * wide) - up * (y * tan)).normalize(),
            sun: self.sun(),
            sun_rad,
            occluders: Vec::new(),
        }
    }

    /// Pixels of the grid whose rays are judged, `count` at most, spread over the picture: those that meet so much air that it is seen
    /// ([`SEEN`]), and for which one ray stands in every picture. Where an edge of the ground or of the air parts a pixel, pictures hold a mean over it.
    pub fn judged(&self, medium: &Medium, count: usize) -> Vec<[u32; 2]> {
        let [w, h] = GRID.map(f64::from);
        // Steps of the plastic number's powers fill a square evenly [Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"].
        let place = |i: u32| [0.754_877_666_246_693, 0.569_840_290_998_053].map(|a: f64| (0.5 + a * f64::from(i + 1)).fract());
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let pixels = (0..1000).map(place).map(|[x, y]| [(x * w) as u32, (y * h) as u32]);
        let mut out: Vec<[u32; 2]> = Vec::new();
        for pixel in pixels {
            if out.len() < count && !out.contains(&pixel) && self.one_ray(medium, pixel) && self.sees_air(medium, pixel) {
                out.push(pixel);
            }
        }
        out
    }

    fn sees_air(&self, medium: &Medium, pixel: [u32; 2]) -> bool {
        let ray = self.ray(medium, 0.0, pixel);
        span(medium, ray.from_m, ray.direction)
            .is_some_and(|s| optical_depth(medium, ray.from_m, ray.direction, (s.near_m, s.far_m), 1e-3).min_element() > SEEN)
    }

    fn one_ray(&self, medium: &Medium, pixel: [u32; 2]) -> bool {
        let ray = self.ray(medium, 0.0, pixel);
        let along = -ray.from_m.dot(ray.direction);
        let low = ray.from_m.cross(ray.direction).length() - medium.bottom_radius_m;
        let (eye, top) = (self.altitude_m, medium.top_altitude_m);
        if along <= 0.0 {
            return eye < top;
        }
        let angle = 2.0 * libm::tan(0.5 * self.fov_deg * DEG) / (f64::from(GRID[1]) * COARSEST);
        // An edge may stand two pixels away.
        let margin = 2.0 * angle * along;
        if low > top - margin && eye > top {
            return false;
        }
        let far = along
            + libm::sqrt(
                ((medium.bottom_radius_m + top) * (medium.bottom_radius_m + top) - ray.from_m.cross(ray.direction).length_squared())
                    .max(0.0),
            );
        let thin = eye > top && angle * far > 0.05 * top;
        low.abs() > margin && !(thin && low > -2.0 * angle * far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::{Layer, Phase, Profile};

    fn medium() -> Medium {
        let layer = Layer {
            scattering_per_m: Vec3::splat(1e-5),
            absorption_per_m: Vec3::ZERO,
            profile: Profile::Exponential { scale_height_m: 8000.0 },
            phase: Phase::Rayleigh,
        };
        Medium { bottom_radius_m: 6.36e6, top_altitude_m: 6e4, ground_albedo: Vec3::ZERO, layers: vec![layer] }
    }

    #[test]
    fn every_view_has_rays_that_meet_air_and_a_picture_of_both_kinds() {
        let medium = medium();
        for view in VIEWS {
            let pixels = view.judged(&medium, 24);
            assert_eq!(pixels.len(), 24, "{}", view.name);
            let spans: Vec<_> = pixels
                .iter()
                .map(|p| {
                    let ray = view.ray(&medium, 0.0047, *p);
                    span(&medium, ray.from_m, ray.direction).expect("it meets air")
                })
                .collect();
            let ground = spans.iter().filter(|s| s.hits_ground).count();
            assert!(view.name == "world" || ground < 20, "{}: {ground} of 24 end on the ground", view.name);
        }
    }
}
