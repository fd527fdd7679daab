//! Random shots: planets of every size under airs of every depth, eyes everywhere, suns that other worlds may hide. All from one seed.

use engine::air::{Layer, Medium, Phase, Profile};
use engine::render::pass::sky_probe::{ProbeLight, ProbeOptions, ProbeRay};
use engine::scene::Occluder;
use engine::space::relative::{narrow, narrow3};
use glam::{DVec3, Vec3};

/// Rays that share their occluders.
#[derive(Clone, Debug)]
pub struct Shots {
    /// How to probe them.
    pub options: ProbeOptions,
    /// The rays.
    pub rays: Vec<ProbeRay>,
}

/// A source of numbers.
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// From a seed.
    pub const fn new(seed: u64) -> Self {
        Self(0x9e37_79b9_7f4a_7c15 ^ seed.wrapping_mul(0xd134_2543_de82_ef95))
    }
    /// Even in 0 ≤ x < 1.
    pub fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// Even in the logarithm.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.even())
    }
    /// One of `n`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn pick(&mut self, n: u32) -> u32 {
        (self.even() * f64::from(n)) as u32
    }
    /// A unit vector.
    pub fn direction(&mut self) -> DVec3 {
        let mu = 2.0 * self.even() - 1.0;
        let (s, c) = (2.0 * std::f64::consts::PI * self.even()).sin_cos();
        let sine = (1.0 - mu * mu).max(0.0).sqrt();
        DVec3::new(sine * c, sine * s, mu)
    }
}

/// An air of up to three layers on a planet of this size: optical depth to 50, asymmetry to ±0.99.
pub fn medium(dice: &mut Dice, bottom_radius_m: f64, top_altitude_m: f64) -> Medium {
    let mut layer = || {
        let height = dice.log(0.02, 0.5) * top_altitude_m;
        let (x, albedo) = (dice.even(), narrow(dice.even()));
        let depth = narrow(50.0 * x * x * x);
        let g = dice.even();
        let phase = match dice.pick(4) {
            0 => Phase::Rayleigh,
            1 => Phase::HenyeyGreenstein { g: narrow(1.98 * g - 0.99) },
            2 => Phase::CornetteShanks { g: narrow(1.96 * g - 0.98) },
            _ => Phase::Isotropic,
        };
        let profile = match dice.pick(6) {
            0 => Profile::Constant { bottom_m: 0.0, top_m: narrow(height) },
            1 => Profile::Tent { bottom_m: 0.0, peak_m: narrow(0.4 * height), top_m: narrow(height) },
            _ => Profile::Exponential { scale_height_m: narrow(height.max(10.0)) },
        };
        let all = Vec3::new(0.4, 1.0, 1.6) * (depth / narrow(height));
        Layer { scattering_per_m: all * albedo, absorption_per_m: all * (1.0 - albedo), profile, phase }
    };
    let layers = [(); 3].map(|()| layer());
    let ground = narrow(dice.even());
    let count = dice.pick(4) as usize;
    Medium { bottom_radius_m, top_altitude_m, ground_albedo: Vec3::splat(ground), layers: layers.into_iter().take(count).collect() }
}

/// Rays from where numbers are hardest: the datum, the top to the bit, below sea level, the centre, afar and in between; straight up and
/// down and level; the sun on the horizon or anywhere. Of four sets the first has no occluder, the others one to four, the first of these
/// centred on the sun, to the bit, as one of the eyes sees it.
pub fn shots(dice: &mut Dice, medium: &Medium, rays: u32) -> Vec<Shots> {
    let (bottom, top) = (medium.bottom_radius_m, medium.top_altitude_m);
    let mut sets = Vec::new();
    for set in 0..4 {
        let sun_rad = if set % 2 == 0 { 0.0047 } else { dice.log(1e-6, 0.1) };
        let shared = match dice.pick(3) {
            0 => DVec3::X,
            1 => DVec3::Z,
            _ => dice.direction(),
        };
        let mut list = Vec::new();
        for i in 0..rays / 4 {
            let altitude = match i % 8 {
                0 => 0.0,
                1 => top,
                2 => -dice.even() * top.min(1e4),
                3 => 1e-6 - bottom,
                4 => top * dice.log(1.0, 1e3),
                5 => dice.log(1e-3, 10.0),
                _ => top * dice.even(),
            };
            let view = match i % 5 {
                0 => DVec3::Z,
                1 => DVec3::NEG_Z,
                2 => DVec3::X,
                3 if set > 0 => shared,
                _ => dice.direction(),
            };
            // Where there are occluders all rays share the sun that they hide.
            let sun = if set > 0 { shared } else { [DVec3::X, dice.direction()][usize::from(i % 3 > 0)] };
            let row = |v: DVec3, w: f64| [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)];
            list.push(ProbeRay { up: row(DVec3::Z, altitude), ray: row(view, 0.0), sun: row(sun, sun_rad) });
        }
        let mut options = ProbeOptions::default();
        for k in 0..set.min(1) * (1 + dice.pick(4)) {
            let eye = list[dice.pick(rays / 4) as usize].up[3];
            let from = DVec3::Z * (bottom + f64::from(eye).max(-bottom));
            let distance = dice.log(1.5, 300.0) * (bottom + top);
            let towards = if k == 0 { shared } else { (shared + dice.direction() * dice.log(1e-4, 1.0)).normalize() };
            let radius = match dice.pick(3) {
                0 => distance * sun_rad.sin(),
                1 => distance * sun_rad.sin() * dice.log(0.3, 30.0),
                _ => distance * dice.log(1e-5, 0.5),
            };
            let radius_m = narrow(radius.min(0.9 * (distance - bottom)).max(1.0));
            options.occluders.push(Occluder { id: 1, centre_m: narrow3(from + towards * distance), radius_m });
        }
        if set == 3 {
            let away = dice.log(1e3, 1e5) * (bottom + top);
            options.star = Some((narrow3(shared * away), narrow(away * sun_rad.sin())));
        }
        sets.push(Shots { options, rays: list });
    }
    sets
}

/// Whether it is light: finite, and not less than none.
pub fn is_light(light: &ProbeLight) -> bool {
    light.radiance.iter().all(|x| x.is_finite() && *x >= 0.0) && light.transmittance.iter().all(|x| (0.0..=1.0).contains(x))
}
