//! A level of light moons: forces about the centre of their planet.
//!
//! Relative to the planet's centre a moon feels the planet (with its figure), its siblings, and the tides of the Sun and of whatever
//! else is strong enough; the planet is pulled by its moons and yields. Others come from the levels above.
//! - [Murray & Dermott 1999] "Solar System Dynamics", eq. 6.6 (motion about a body that yields).

use super::planets::instant;
use crate::orbit::gravity::figure::Figure;
use crate::orbit::gravity::tide;
use crate::orbit::integrate::Force;
use crate::space::{Icrf, Position};
use crate::time::SimTime;
use core::cell::RefCell;
use glam::DVec3;

/// Where others are: `places(t, out)` gives them from the centre of mass of the planet and its light moons.
pub trait Others {
    /// Fills `out` for `t` seconds after the epoch.
    fn places(&self, t: f64, out: &mut [DVec3]);
}

/// The forces on the light moons of one body.
#[derive(Debug)]
pub struct Moons<'a, O> {
    /// When t is 0.
    pub epoch: SimTime,
    /// GM of the planet alone.
    pub planet_gm: f64,
    /// GM of each moon with its own moons.
    pub gm: &'a [f64],
    /// The planet's figure.
    pub figure: Option<&'a Figure>,
    /// GM of the others whose tides count.
    pub others_gm: &'a [f64],
    /// Where they are.
    pub others: O,
    /// Buffer.
    pub places: RefCell<Vec<DVec3>>,
}

impl<O: Others> Force for Moons<'_, O> {
    const USES_VELOCITY: bool = false;

    fn accelerations(&self, t: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        let mut places = self.places.borrow_mut();
        places.resize(self.others_gm.len(), DVec3::ZERO);
        self.others.places(t, &mut places);
        let axes = self.figure.map(|f| f.axes(instant(self.epoch, t)));
        let planet = self.planet_gm;
        // What the moons do to the planet, and where its centre is from that of them all.
        let (mut yields, mut aside, mut total) = (DVec3::ZERO, DVec3::ZERO, planet);
        for ((r, a), gm) in q.iter().zip(&mut *a).zip(self.gm) {
            let r2 = r.length_squared();
            let cube = if r2 > 0.0 { 1.0 / (r2 * r2.sqrt()) } else { 0.0 };
            let mut field = *r * -cube;
            if let (Some(figure), Some(axes)) = (self.figure, &axes) {
                field += figure.acceleration(1.0, axes, *r);
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
        for (r, a) in q.iter().zip(a) {
            *a -= yields;
            for (place, gm) in places.iter().zip(self.others_gm) {
                *a += tide(*gm, Position::<Icrf>::new(*place - centre), Position::new(*r)).0;
            }
        }
    }
}
