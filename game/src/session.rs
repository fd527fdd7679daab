//! The session: the loop body that every mode calls. Live play, a headless run, a replay and a picture differ only in who
//! makes the commands and where the picture goes.
//!
//! It holds what outlives a World: the quick slots, the record of the flight, and the count of ticks. Not here: the clock on the wall (the window
//! counts ticks owed), files ([`crate::save`]), drawing ([`crate::view`]).

use crate::command::{Action, Commands};
use crate::replay::{Log, Recorder};
use crate::world::World;
use std::collections::VecDeque;

/// Quick slots that a session keeps.
pub const QUICK_SLOTS: usize = 3;

/// A flight in progress.
#[derive(Clone)]
pub struct Session {
    /// The simulated truth.
    pub world: World,
    /// Ticks of the session so far.
    pub ticks: u64,
    quick: VecDeque<World>,
    recorder: Option<Recorder>,
}

/// What a tick did beyond advancing the World, for those who write files or show messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The state was put into a quick slot.
    QuickSaved,
    /// The newest quick slot was taken back.
    QuickLoaded,
    /// There was no quick slot to go back to.
    NothingToLoad,
}

impl Session {
    /// A session that begins with this World.
    pub fn new(world: World) -> Self {
        Self { world, ticks: 0, quick: VecDeque::new(), recorder: None }
    }

    /// Goes on in a system whose files were changed ([`World::adopt`]); quick slots follow, so that none brings the old one back.
    pub fn adopt(&mut self, system: &std::sync::Arc<crate::world::system::System>) -> bool {
        let same = self.world.adopt(system);
        if same {
            self.quick.retain_mut(|kept| kept.adopt(system));
        }
        same
    }

    /// Records the flight from now on.
    pub fn record(&mut self) {
        self.recorder = Some(Recorder::new(&self.world));
    }

    /// Ends the record and gives it back; `None` when nothing was recorded.
    pub fn recorded(&mut self) -> Option<Log> {
        self.recorder.take().map(|r| r.finish(&self.world))
    }

    /// One tick: quick slots first, then the World.
    pub fn tick(&mut self, commands: &Commands) -> Vec<Event> {
        let mut events = Vec::new();
        for action in &commands.actions {
            match action {
                Action::Quicksave => {
                    self.quick.push_back(self.world.clone());
                    if self.quick.len() > QUICK_SLOTS {
                        self.quick.pop_front();
                    }
                    events.push(Event::QuickSaved);
                }
                Action::Quickload => match self.quick.back() {
                    Some(kept) => {
                        self.world = kept.clone();
                        events.push(Event::QuickLoaded);
                    }
                    None => events.push(Event::NothingToLoad),
                },
                _ => {}
            }
        }
        self.world.tick(commands);
        self.ticks += 1;
        if let Some(recorder) = &mut self.recorder {
            recorder.tick(commands, &self.world);
        }
        events
    }
}
