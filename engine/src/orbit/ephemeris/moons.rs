//! A level of light moons: forces about the centre of their planet.
//!
//! Relative to the planet's centre a moon feels the planet (with its figure), its siblings, and the tides of the Sun and of whatever
//! else is strong enough; the planet is pulled by its moons and yields. Others come from the levels above.
//! - [Murray & Dermott 1999] "Solar System Dynamics", eq. 6.6 (motion about a body that yields).

use super::chunk::Chunk;
use super::planets::instant;
use crate::orbit::gravity::figure::Figure;
use crate::orbit::gravity::tide;
use crate::orbit::gravity::zonal::zonal;
use crate::orbit::integrate::Force;
use crate::space::{Icrf, Position};
use crate::time::SimTime;
use glam::DVec3;

/// Another body whose tide counts.
#[derive(Clone, Debug)]
pub struct Outside {
    /// Its GM, m³/s².
    pub gm: f64,
    /// The moons for which it does.
    pub felt_by: Vec<usize>,
}

/// The forces on the light moons of one body.
#[derive(Debug)]
pub struct Moons<'a> {
    /// GM of the planet alone.
    pub planet_gm: f64,
    /// Its pole.
    pub pole: Pole,
    /// GM of each moon with its own moons.
    pub gm: &'a [f64],
    /// The planet's figure.
    pub figure: Option<&'a Figure>,
    /// The others whose tides count.
    pub outside: &'a [Outside],
    /// Where they are, from the centre of mass of the planet and its light moons, over the chunk …
    pub others: &'a Chunk,
    /// … which begins here and ends there, s.
    pub span_s: (f64, f64),
}

/// A pole over a chunk of time: it moves slowly and smoothly, so a parabola through three instants has all its digits that matter.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pole {
    middle_s: f64,
    half_s: f64,
    /// At the middle, half the difference of the ends, and their mean's distance from the middle.
    terms: [DVec3; 3],
}

impl Pole {
    /// The pole of a figure between two times (seconds after the epoch).
    pub fn between(figure: Option<&Figure>, epoch: SimTime, early_s: f64, late_s: f64) -> Self {
        let middle_s = 0.5 * (early_s + late_s);
        let at = |t: f64| figure.map_or(DVec3::Z, |f| f.axes(instant(epoch, t)).z);
        let [a, b, c] = [early_s, middle_s, late_s].map(at);
        Self { middle_s, half_s: 0.5 * (late_s - early_s), terms: [b, (c - a) * 0.5, (a + c) * 0.5 - b] }
    }

    fn at(&self, t: f64) -> DVec3 {
        let x = (t - self.middle_s) / self.half_s;
        self.terms[0] + (self.terms[1] + self.terms[2] * x) * x
    }
}

impl Force for Moons<'_> {
    const USES_VELOCITY: bool = false;

    fn accelerations(&self, t: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        let x = (t - self.span_s.0) / (self.span_s.1 - self.span_s.0);
        let pole = self.pole.at(t);
        let planet = self.planet_gm;
        // What the moons do to the planet, and where its centre is from that of them all.
        let (mut yields, mut aside, mut total) = (DVec3::ZERO, DVec3::ZERO, planet);
        for ((r, a), gm) in q.iter().zip(&mut *a).zip(self.gm) {
            let r2 = r.length_squared();
            let cube = if r2 > 0.0 { 1.0 / (r2 * r2.sqrt()) } else { 0.0 };
            let mut field = *r * -cube;
            if let Some(f) = self.figure {
                field += zonal(1.0, f.zonal, f.radius_m, pole, Position::<Icrf>::new(*r)).0;
            }
            *a = field * planet;
            yields -= field * *gm;
            aside += *r * *gm;
            total += gm;
        }
        let centre = aside * (-1.0 / total);
        for i in 0..q.len() {
            for j in 0..i {
                let d = q[j] - q[i];
                let r2 = d.length_squared();
                let cube = if r2 > 0.0 { 1.0 / (r2 * r2.sqrt()) } else { 0.0 };
                a[i] += d * (self.gm[j] * cube);
                a[j] -= d * (self.gm[i] * cube);
            }
        }
        for a in a.iter_mut() {
            *a -= yields;
        }
        for (k, other) in self.outside.iter().enumerate() {
            let place = Position::<Icrf>::new(self.others.position(k, x) - centre);
            for &i in &other.felt_by {
                a[i] += tide(other.gm, place, Position::new(q[i])).0;
            }
        }
    }
}
