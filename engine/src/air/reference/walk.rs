//! Light's walk traced backwards: from a point in the air through scatterings and bounces, asking at each for direct sunlight.
//!
//! One walk serves three channels. It is steered by one of them (its hero), drawn evenly; what it brings is divided by the mean of the
//! densities with which each of the three would have drawn the same walk, so that no weight exceeds three times an analog one
//! [Wilkie et al. 2014, "Hero Wavelength Spectral Sampling", eq. 5]. Nothing is cut off: weak walks end by Russian roulette, without bias.

use super::random::Draw;
use super::scatter::turn;
use super::space::{Light, Space, exp3};
use core::f64::consts::PI;
use glam::DVec3;

/// Flights that are not allowed to leave the air: they are drawn within it and weighed for that.
const FORCED: usize = 2;
/// Bounces before roulette may end a walk, and the weight relative to its start below which it does.
const FREE: usize = 4;
const WEAK: f64 = 0.25;
/// Bounces after which every walk is in the hands of roulette, so that none goes on for ever between white walls.
const LONG: usize = 2000;

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

    /// Scatters: light sent on into `direction`, drawn by the hero's mixture of layers.
    pub fn scatter(&mut self, space: &Space, draw: &mut Draw) {
        let h = self.at.length() - space.datum_m;
        let share = |o: &super::space::Optic| o.scattering * o.profile.density(h);
        let all: DVec3 = space.optics.iter().map(share).sum();
        let mut left = draw.next() * all[self.hero];
        let chosen = space.optics.iter().find(|o| {
            left -= share(o)[self.hero];
            left < 0.0
        });
        let (u, fraction) = (draw.next(), draw.next());
        let Some(chosen) = chosen.or_else(|| space.optics.iter().rfind(|o| share(o)[self.hero] > 0.0)) else {
            self.weight = DVec3::ZERO;
            return;
        };
        let mu = chosen.scatter.draw(u);
        self.direction = turn(self.direction, mu, fraction);
        let (mut sent, mut density) = (DVec3::ZERO, DVec3::ZERO);
        for o in &space.optics {
            let part = share(o);
            let p = o.scatter.phase.value(mu);
            sent += part * p;
            density += part * o.scatter.density(mu);
        }
        self.weight *= sent;
        self.density *= density / all.max(DVec3::splat(f64::MIN_POSITIVE));
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
    pub fn run(mut self, space: &Space, light: &Light<'_>, draw: &mut Draw, found: &mut impl FnMut(usize, DVec3)) {
        let start = self.weight.max_element();
        for order in 1.. {
            if !(self.weight.max_element() > 0.0) {
                return;
            }
            let way = space.chords.way(self.at, self.direction);
            let whole = exp3(-way.depth);
            let u = draw.next();
            let forced = !way.hits_ground && order <= FORCED;
            let reach = if forced { -libm::expm1(-way.depth[self.hero]) } else { 1.0 };
            let depth = -libm::log1p(-u * reach);
            if depth >= way.depth[self.hero] && !forced {
                if !way.hits_ground {
                    return;
                }
                self.ground(space, &way, whole, light, draw, order, found);
            } else {
                if reach <= 0.0 {
                    return;
                }
                let stop = space.chords.stop(&way, self.hero, depth);
                self.at += self.direction * stop.distance_m;
                let seen = exp3(-stop.depth);
                let norm = if forced { DVec3::ONE - whole } else { DVec3::ONE };
                self.weight *= seen;
                self.density *= stop.slope * seen / norm.max(DVec3::splat(f64::MIN_POSITIVE));
                self.balance();
                found(order, self.weight * self.sunlit(space, light));
                self.scatter(space, draw);
            }
            let strength = self.weight.max_element() / start;
            if (order >= FREE && strength < WEAK) || order >= LONG {
                let survive = if order >= LONG { 0.99 } else { strength / WEAK };
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
