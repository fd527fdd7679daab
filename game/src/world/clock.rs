//! Moving the clock: the sky goes to another moment while the ship stays where it is about its body. For pictures and photo
//! mode only; a flight's own time passes in ticks.

use super::World;
use super::ship::Motion;
use engine::orbit::path::Knot;
use engine::time::SimTime;

impl World {
    /// Sets the time. A coasting ship keeps its state about its body and goes on from it, a resting one keeps its place on the ground.
    pub fn move_clock(&mut self, to: SimTime) {
        let moved = to.ticks - self.time.ticks;
        let from = self.time;
        self.time = to;
        self.quarters = 0;
        if let Motion::Coast(coast) = &self.ship.motion {
            let knot = Knot::new(coast.path.host(), to, &coast.path.sample(from));
            self.start_path(knot, coast.attitude, coast.since.plus(moved));
        }
    }
}
