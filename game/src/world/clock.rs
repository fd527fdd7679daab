//! Moving the clock: the sky goes to another moment while the ship stays where it is about its body. For pictures and photo
//! mode only; a flight's own time passes in ticks.

use super::World;
use super::ship::{Coast, Motion};
use engine::orbit::arc::Arc as OrbitArc;
use engine::time::SimTime;

impl World {
    /// Sets the time. A coasting ship keeps its place on its path, a resting one its place on the ground.
    pub fn move_clock(&mut self, to: SimTime) {
        let moved = to.ticks - self.time.ticks;
        self.time = to;
        self.quarters = 0;
        if let Motion::Coast(Coast { arc, attitude, .. }) = self.ship.motion {
            self.start_arc(OrbitArc { epoch: arc.epoch.plus(moved), ..arc }, attitude);
        }
    }
}
