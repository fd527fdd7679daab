//! The path ahead of the ship as it is now, with planned burns: what a map draws and a pilot plans with.

use super::World;
use super::ship::Motion;
use engine::orbit::path::Knot;
use engine::orbit::predict::{Burn, Engine, Limits, Prediction, predict};

impl World {
    /// Where the ship goes, coasting, and what it meets; see [`predict`] for the burns. A coasting ship's own steps, bit for bit:
    /// the first may have begun before now. A ship that flies is taken as if its engine stopped now; one that rests has no path.
    pub fn predict(&self, burns: &[Burn], limits: &Limits) -> Option<Prediction> {
        let knot = match &self.ship.motion {
            Motion::Coast(coast) => *coast.path.knot(),
            Motion::Fly(rigid) | Motion::Contact(rigid) => Knot::new(rigid.body, self.time, &rigid.state),
            Motion::Landed(_) | Motion::Crashed(_) => return None,
        };
        // The step may have begun before a burn whose moment has passed: nothing is burnt for that any more.
        let ahead_of_now = |b: &Burn| if b.at.since(self.time.into()) < 0.0 { Burn { at: b.at, ..Burn::default() } } else { *b };
        let burns: Vec<Burn> = burns.iter().map(ahead_of_now).collect();
        let mut ahead = predict(&self.system.gravity, &self.system.ephemeris, knot, &burns, limits);
        ahead.marks.retain(|m| m.at.since(self.time.into()) >= 0.0);
        Some(ahead)
    }

    /// The main engine at full thrust with the mass of now, for planned burns.
    pub fn engine(&self) -> Engine {
        let spec = &self.ship.spec.main_engine;
        Engine { acceleration_m_s2: spec.thrust_n / self.ship.mass_kg(), exhaust_m_s: spec.exhaust_velocity_m_s }
    }
}
