//! Pops looked for: a model's sky along fixed directions while the eye climbs or a moon crosses the sun, shot by shot.
//!
//! A pop is a change that is not the sky's own. Two measures, each a share of the radiance of all orders (or of a thousandth of the brightest
//! direction of the same shot, where that is more):
//! - of single scattering, by how much the model's error against the f64 reference changes from one shot to the next;
//! - of all orders, by how much its error against the same model at [`FINE`] steps does.
//!
//! Left out are pairs of shots between which a ray changes what it meets (ground, sky, no air at all): there the truth itself jumps.

use engine::air::Medium;
use engine::air::reference::{Options, Ray, Sphere, radiance, span};
use engine::gpu::Gpu;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, Prober};
use engine::scene::Occluder;
use engine::space::relative::{narrow, narrow3};
use engine::units::{DEG, KM};
use glam::DVec3;

/// Steps of a march that is next to exact.
pub const FINE: u32 = 128;

/// A unit vector by zenith angle and azimuth, degrees.
pub fn polar(zenith_deg: f64, azimuth_deg: f64) -> DVec3 {
    let ((s, c), (sa, ca)) = ((zenith_deg * DEG).sin_cos(), (azimuth_deg * DEG).sin_cos());
    DVec3::new(s * ca, s * sa, c)
}

/// Altitudes of a climb from the datum to 1,000 km, m, rising, as f32 holds them: by the logarithm from 1 cm, evenly through
/// the air, by the logarithm again; and dense about the top of the air, which is one of them to the bit.
pub fn climb(shots: u32, top_m: f64) -> Vec<f64> {
    let part = |n: u32| (0..n).map(move |i| f64::from(i) / f64::from(n));
    let mut all = vec![0.0, top_m - 1.0, top_m - 0.01, top_m, top_m + 0.01, top_m + 1.0];
    all.extend(part(shots / 5).map(|x| 0.01 * 1e5_f64.powf(x)));
    all.extend(part(shots / 2).map(|x| KM + (top_m + 4.0 * KM) * x));
    all.extend(part(shots / 20).map(|x| top_m + KM * (2.0 * x - 1.0).powi(3)));
    let rest = shots.saturating_sub(u32::try_from(all.len()).unwrap_or(0));
    all.extend(part(rest).map(|x| (top_m + 5.0 * KM) * (1000.0 * KM / (top_m + 5.0 * KM)).powf(x)));
    all.iter_mut().for_each(|h| *h = f64::from(narrow(*h)));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// One shot: where the eye is, straight up from the centre, and what hides the sun.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Altitude of the eye, m.
    pub altitude_m: f64,
    /// Where the model is told that it is: the same, but to see that a pop would be found.
    pub told_m: f64,
    /// Occluders, from the centre.
    pub occluders: Vec<Sphere>,
}

impl Shot {
    /// From an altitude.
    pub fn at(altitude_m: f64, occluders: Vec<Sphere>) -> Self {
        Self { altitude_m, told_m: altitude_m, occluders }
    }
}

/// A course of shots.
pub struct Course<'a> {
    /// The air.
    pub medium: &'a Medium,
    /// The sun, and its angular radius, rad.
    pub sun: (DVec3, f64),
    /// Directions of sight.
    pub views: &'a [DVec3],
}

/// The greatest changes found, as shares, each with its place.
#[derive(Clone, Debug, Default)]
pub struct Pops {
    /// Of single scattering.
    pub single: (f64, String),
    /// Of all orders.
    pub all: (f64, String),
    /// The greatest error of single scattering itself.
    pub error: (f64, String),
    /// Pairs of shots that were compared.
    pub pairs: usize,
}

impl Pops {
    /// With those of another course.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let more = |a: (f64, String), b: (f64, String)| if b.0 > a.0 { b } else { a };
        Self {
            single: more(self.single, other.single),
            all: more(self.all, other.all),
            error: more(self.error, other.error),
            pairs: self.pairs + other.pairs,
        }
    }
}

/// Red, green and blue of every view.
type Lights = Vec<[f64; 3]>;

impl Course<'_> {
    fn probe(&self, gpu: &Gpu, prober: &Prober, shots: &[Shot], multiple: bool, steps: Option<u32>) -> Vec<Lights> {
        let row = |v: DVec3, w: f64| [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)];
        let rays = |shot: &Shot| {
            self.views
                .iter()
                .map(move |v| ProbeRay { up: row(DVec3::Z, shot.told_m), ray: row(*v, 0.0), sun: row(self.sun.0, self.sun.1) })
                .collect::<Vec<_>>()
        };
        let ask = |rays: &[ProbeRay], occluders: &[Sphere]| {
            let occluder = |o: &Sphere| Occluder { id: 1, centre_m: narrow3(o.centre_m), radius_m: narrow(o.radius_m) };
            let given = ProbeOptions::default();
            let options = ProbeOptions {
                multiple,
                steps: steps.unwrap_or(given.steps),
                occluders: occluders.iter().map(occluder).collect(),
                ..given
            };
            let found = prober.ask(gpu, rays, &options).expect("it marches");
            found.iter().map(|l| [0, 1, 2].map(|c| f64::from(l.radiance[c]))).collect::<Lights>()
        };
        if shots.iter().all(|s| s.occluders.is_empty()) {
            let all: Vec<ProbeRay> = shots.iter().flat_map(rays).collect();
            return ask(&all, &[]).chunks(self.views.len()).map(<[_]>::to_vec).collect();
        }
        shots.iter().map(|s| ask(&rays(s), &s.occluders)).collect()
    }

    /// The pops between neighbours.
    pub fn pops(&self, gpu: &Gpu, prober: &Prober, shots: &[Shot]) -> Pops {
        let ray = |shot: &Shot, v: &DVec3| Ray {
            from_m: DVec3::Z * (self.medium.bottom_radius_m + shot.altitude_m),
            direction: *v,
            sun: self.sun.0,
            sun_rad: self.sun.1,
            occluders: shot.occluders.clone(),
        };
        let rays: Vec<Ray> = shots.iter().flat_map(|s| self.views.iter().map(move |v| ray(s, v))).collect();
        let options = Options { max_walks: 0, single_error: 1e-4, ..Options::default() };
        let truth: Vec<Lights> = radiance(self.medium, &rays, &options)
            .chunks(self.views.len())
            .map(|c| c.iter().map(|e| e.single.to_array()).collect())
            .collect();
        let meets: Vec<u8> =
            rays.iter().map(|r| span(self.medium, r.from_m, r.direction).map_or(0, |s| 1 + u8::from(s.hits_ground))).collect();
        let single = self.probe(gpu, prober, shots, false, None);
        let all = self.probe(gpu, prober, shots, true, None);
        let fine = self.probe(gpu, prober, shots, true, Some(FINE));
        let mut pops = Pops::default();
        for (view, direction) in self.views.iter().enumerate() {
            for channel in 0..3 {
                let error = |found: &[Lights], of: &[Lights], i: usize| {
                    let floor = fine[i].iter().map(|l| l[channel]).fold(1e-9, f64::max) * 1e-3;
                    (found[i][view][channel] - of[i][view][channel]) / fine[i][view][channel].max(floor)
                };
                for i in 1..shots.len() {
                    let place = |e: f64, l: f64| {
                        let zenith = direction.z.clamp(-1.0, 1.0).acos() / DEG;
                        let azimuth = direction.y.atan2(direction.x) / DEG;
                        let sun = self.sun.0.z.clamp(-1.0, 1.0).acos() / DEG;
                        let aside = shots[i].occluders.first().map_or(0.0, |o| o.centre_m.y / KM);
                        format!(
                            "{:.3} m, moon {aside:.1} km, sun {sun:.1}°, view {zenith:.1}° {azimuth:.0}°, channel {channel}: error {e:+.4} of {l:.2e}",
                            shots[i].altitude_m
                        )
                    };
                    let count = |worst: &mut (f64, String), x: f64, e: f64, l: f64| {
                        if x > worst.0 || x.is_nan() {
                            *worst = (if x.is_nan() { f64::INFINITY } else { x }, place(e, l));
                        }
                    };
                    let (e1, l1) = (error(&single, &truth, i), truth[i][view][channel]);
                    count(&mut pops.error, e1.abs(), e1, l1);
                    if meets[i * self.views.len() + view] != meets[(i - 1) * self.views.len() + view] {
                        continue;
                    }
                    pops.pairs += 1;
                    count(&mut pops.single, (e1 - error(&single, &truth, i - 1)).abs(), e1, l1);
                    let (ea, la) = (error(&all, &fine, i), fine[i][view][channel]);
                    count(&mut pops.all, (ea - error(&all, &fine, i - 1)).abs(), ea, la);
                }
            }
        }
        pops
    }
}

/// Radius of the moon, m.
pub const MOON_M: f64 = 1.7374e6;

/// A moon that is seen `ratio` times as large as the sun from the point straight up on the datum, its shadow's axis `aside_m` from there.
pub fn moon_at(bottom_radius_m: f64, sun: (DVec3, f64), ratio: f64, aside_m: DVec3) -> Sphere {
    let distance_m = MOON_M / (ratio * sun.1.sin());
    Sphere { centre_m: DVec3::Z * bottom_radius_m + sun.0 * distance_m + aside_m, radius_m: MOON_M }
}

/// A transit of that moon from first to fourth contact along +Y: two thirds of the shots are dense about second and third contact. `miss_m`: by
/// how much its shadow's axis goes by the point. One shot stands in the middle, to the bit.
pub fn transit(medium: &Medium, sun: (DVec3, f64), altitude_m: f64, ratio: f64, miss_m: f64, shots: u32) -> Vec<Shot> {
    let at_sun = MOON_M / ratio;
    let (outer, inner) = (MOON_M + at_sun, (MOON_M - at_sun).abs());
    let third = shots / 3;
    let mut asides = vec![0.0];
    for i in 0..=third {
        let x = 2.0 * f64::from(i) / f64::from(third) - 1.0;
        asides.extend([1.02 * outer * x, 0.3 * inner * x * x * x - inner, 0.3 * inner * x * x * x + inner]);
    }
    asides.sort_by(f64::total_cmp);
    let aside = |y: f64| DVec3::Y * y + sun.0.cross(DVec3::Y) * miss_m;
    let shot = |y| Shot::at(altitude_m, vec![moon_at(medium.bottom_radius_m, sun, ratio, aside(y))]);
    asides.into_iter().map(shot).collect()
}
