//! Light's walk traced backwards: from a point in the air through scatterings and bounces, asking at each for direct sunlight.
//!
//! One walk serves three channels. It is steered by one of them (its hero), drawn evenly; what it brings is divided by the mean of the
//! densities with which each of the three would have drawn the same walk, so that no weight exceeds three times an analog one
//! [Wilkie et al. 2014, "Hero Wavelength Spectral Sampling", eq. 5]. Nothing is cut off: weak walks end by Russian roulette, without bias.

use super::random::Draw;
use super::scatter::{Scatter, turn};
use super::space::{Light, Space, exp3};
use crate::air::medium::Phase;
use core::f64::consts::PI;
use glam::DVec3;

/// How a walk is steered. None of it changes what is found on average, only how evenly.
struct Steering {
    /// Flights that are not allowed to leave the air: they are drawn within it and weighed for that.
    forced: usize,
    /// Part of those flights that are drawn evenly in distance, to where the air is too thin to stop many.
    spread: f64,
    /// Scatterings of which a part [`GUIDED`] goes towards the glow.
    guided: usize,
    /// Weight relative to its start below which roulette may end a walk.
    weak: f64,
}

/// Under a high sun light is much the same everywhere.
const DAY: Steering = Steering { forced: 2, spread: 0.0, guided: 0, weak: 0.25 };
/// Under a low or sunken one most of it comes a long way from where the air is still lit.
const DUSK: Steering = Steering { forced: 8, spread: 0.25, guided: 16, weak: 0.03 };
/// Part of the guided scatterings that follow the glow and not the phase function.
const GUIDED: f64 = 0.4;
/// Bounces before roulette may end a walk.
const FREE: usize = 4;
/// Bounces after which every walk is in the hands of roulette, so that none goes on for ever between white walls.
const LONG: usize = 2000;
/// Cosine of the sun's zenith angle under which there is a glow.
const LOW_SUN: f64 = 0.1;

/// The glow of a low or sunken sun: most light comes from near the horizon below which it is, and phase functions do not know.
pub struct Glow {
    sun: DVec3,
    lobes: [Scatter; 2],
}

/// The glow over one place.
pub struct Lobes<'a> {
    axis: DVec3,
    lobes: &'a [Scatter; 2],
}

impl Glow {
    /// Of the sun over a place; `None` where it stands high.
    pub fn of(light: &Light<'_>, at: DVec3) -> Option<Self> {
        let lobes = [0.5, 0.9].map(|g| Scatter::new(&Phase::HenyeyGreenstein { g }));
        (at.normalize_or(DVec3::Z).dot(light.sun) < LOW_SUN).then_some(Self { sun: light.sun, lobes })
    }

    fn over(&self, at: DVec3) -> Lobes<'_> {
        let up = at.normalize_or(DVec3::Z);
        let axis = (self.sun - up * up.dot(self.sun).min(0.0)).normalize_or(up);
        Lobes { axis, lobes: &self.lobes }
    }
}

impl Lobes<'_> {
    fn draw(&self, which: f64, u: f64, fraction: f64) -> DVec3 {
        let [wide, narrow] = self.lobes;
        turn(self.axis, if which < 0.5 { wide } else { narrow }.draw(u), fraction)
    }

    fn density(&self, direction: DVec3) -> f64 {
        let [wide, narrow] = self.lobes;
        let mu = self.axis.dot(direction).clamp(-1.0, 1.0);
        0.5 * (wide.density(mu) + narrow.density(mu))
    }
}

/// A walk under way.
pub struct Walk {
    /// Where it is, m from the centre.
    pub at: DVec3,
    /// Where it goes next.
    pub direction: DVec3,
    /// What one unit of radiance found along `direction` is worth.
    pub weight: DVec3,
    /// Densities of the walk if each channel had steered, over their mean.
    pub density: DVec3,
    /// The channel that steers.
    pub hero: usize,
}

impl Walk {
    /// Makes the mean density 1.
    fn balance(&mut self) {
        let mean = self.density.element_sum() / 3.0;
        if mean > 0.0 {
            self.weight /= mean;
            self.density /= mean;
        } else {
            self.weight = DVec3::ZERO;
        }
    }

    /// Scatters: light sent on into `direction`, drawn by the hero's mixture of layers, and where the sun is low also by [`Glow`].
    pub fn scatter(&mut self, space: &Space, glow: Option<&Glow>, draw: &mut Draw) {
        let h = self.at.length() - space.datum_m;
        let share = |o: &super::space::Optic| o.scattering * o.profile.density(h);
        let all: DVec3 = space.optics.iter().map(share).sum();
        let mut left = draw.next();
        let (u, fraction) = (draw.next(), draw.next());
        let glow = glow.map(|g| g.over(self.at));
        let before = self.direction;
        match &glow {
            Some(lobes) if left < GUIDED => self.direction = lobes.draw(left / GUIDED, u, fraction),
            _ => {
                if glow.is_some() {
                    left = (left - GUIDED) / (1.0 - GUIDED);
                }
                left *= all[self.hero];
                let chosen = space.optics.iter().find(|o| {
                    left -= share(o)[self.hero];
                    left < 0.0
                });
                let Some(chosen) = chosen.or_else(|| space.optics.iter().rfind(|o| share(o)[self.hero] > 0.0)) else {
                    self.weight = DVec3::ZERO;
                    return;
                };
                self.direction = turn(before, chosen.scatter.draw(u), fraction);
            }
        }
        let mu = before.dot(self.direction).clamp(-1.0, 1.0);
        let (mut sent, mut density) = (DVec3::ZERO, DVec3::ZERO);
        for o in &space.optics {
            let part = share(o);
            sent += part * o.scatter.phase.value(mu);
            density += part * o.scatter.density(mu);
        }
        density /= all.max(DVec3::splat(f64::MIN_POSITIVE));
        if let Some(lobes) = glow {
            density = density * (1.0 - GUIDED) + lobes.density(self.direction) * GUIDED;
        }
        self.weight *= sent;
        self.density *= density;
        self.balance();
    }

    /// Scattered sunlight at the walk's place: `Σ σ_s p(θ) E`.
    fn sunlit(&self, space: &Space, light: &Light<'_>) -> DVec3 {
        let sunlight = space.sunlight(light, self.at);
        if sunlight == DVec3::ZERO {
            return sunlight;
        }
        let (h, mu) = (self.at.length() - space.datum_m, self.direction.dot(light.sun));
        let sent: DVec3 = space.optics.iter().map(|o| o.scattering * (o.profile.density(h) * o.scatter.phase.value(mu))).sum();
        sent * sunlight
    }

    /// Goes on until the light is lost, giving `found(order, radiance)` at each meeting with sunlight. `order` counts from 1 at the first
    /// place reached from here.
    pub fn run(mut self, space: &Space, light: &Light<'_>, glow: Option<&Glow>, draw: &mut Draw, found: &mut impl FnMut(usize, DVec3)) {
        let start = self.weight.max_element();
        let steering = if glow.is_some() { DUSK } else { DAY };
        for order in 1.. {
            if self.weight.max_element() <= 0.0 || self.weight.is_nan() {
                return;
            }
            let way = space.chords.way(self.at, self.direction);
            let whole = exp3(-way.depth);
            let u = draw.next();
            let forced = !way.hits_ground && order <= steering.forced;
            let spread = if forced { steering.spread } else { 0.0 };
            let reach = if forced { -libm::expm1(-way.depth[self.hero]) } else { 1.0 };
            let by_depth = |u: f64| -libm::log1p(-u * reach);
            if !forced && by_depth(u) >= way.depth[self.hero] {
                if !way.hits_ground {
                    return;
                }
                self.ground(space, &way, whole, light, draw, order, found);
            } else {
                if reach <= 0.0 || way.length_m <= 0.0 {
                    return;
                }
                let stop = if u < spread {
                    space.chords.stop_at(&way, u / spread * way.length_m)
                } else {
                    space.chords.stop(&way, self.hero, by_depth((u - spread) / (1.0 - spread)))
                };
                self.at += self.direction * stop.distance_m;
                let seen = exp3(-stop.depth);
                let norm = if forced { DVec3::ONE - whole } else { DVec3::ONE };
                self.weight *= seen;
                let density = stop.slope * seen / norm.max(DVec3::splat(f64::MIN_POSITIVE));
                self.density *= density * (1.0 - spread) + spread / way.length_m;
                self.balance();
                found(order, self.weight * self.sunlit(space, light));
                self.scatter(space, glow.filter(|_| order < steering.guided), draw);
            }
            let strength = self.weight.max_element() / start;
            if (order >= FREE && strength < steering.weak) || order >= LONG {
                let survive = if order >= LONG { 0.99 } else { strength / steering.weak };
                if draw.next() >= survive {
                    return;
                }
                self.weight /= survive;
            }
        }
    }

    /// Meets the ground: Lambert's law, the next direction drawn by its cosine.
    #[allow(clippy::too_many_arguments)]
    fn ground(
        &mut self,
        space: &Space,
        way: &super::chords::Way,
        whole: DVec3,
        light: &Light<'_>,
        draw: &mut Draw,
        order: usize,
        found: &mut impl FnMut(usize, DVec3),
    ) {
        self.at = (self.at + self.direction * way.length_m).normalize_or(DVec3::Z) * space.ground_m;
        self.weight *= whole * space.albedo;
        self.density *= whole;
        self.balance();
        if self.weight == DVec3::ZERO {
            return;
        }
        let up = self.at / space.ground_m;
        let cosine = up.dot(light.sun).max(0.0);
        if cosine > 0.0 {
            found(order, self.weight * space.sunlight(light, self.at) * (cosine / PI));
        }
        self.direction = upward(up, draw);
    }
}

/// A direction above a horizontal plane, drawn by its cosine.
pub fn upward(up: DVec3, draw: &mut Draw) -> DVec3 {
    let u = draw.next();
    turn(up, u.sqrt().max(1e-9), draw.next())
}
