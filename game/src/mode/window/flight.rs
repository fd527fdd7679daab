//! The flight in the window: session, camera, saves. What menus ask for ends here; what is drawn begins here.

use crate::assets::Assets;
use crate::command::{Action, Commands};
use crate::hud::{Lists, SaveEntry, StartEntry, format};
use crate::input::Input;
use crate::save::slots::{Kind, Loaded};
use crate::save::{self, SaveV1, Slots};
use crate::session::{Event, Session};
use crate::view::rig::Mount;
use crate::view::{CameraMode, Rig};
use crate::world::World;
use crate::world::eclipse::Sky;
use crate::world::readout::Readout;
use engine::space::{Vector, sphere};
use engine::time::TICK_S;
use glam::DVec3;
use std::path::Path;

/// Seconds of flight between two automatic saves.
const AUTO_SAVE_S: f64 = 300.0;
/// The free camera is never slower than at this height, m.
const LOWEST_M: f64 = 4.0;

/// A flight.
pub struct Flight {
    /// The session.
    pub session: Session,
    /// What the World told last.
    pub readout: Readout,
    /// The camera.
    pub rig: Rig,
    /// Speed of the free camera, heights above the ground a second.
    pace: f64,
    unsaved_s: f64,
}

/// What a run of ticks brought that the player should be told.
#[derive(Debug, Default)]
pub struct Told {
    /// Small notices.
    pub notices: Vec<String>,
    /// There was nothing in the session to quick-load: look on disk.
    pub look_on_disk: bool,
}

impl Flight {
    /// A flight that begins with this World.
    pub fn new(world: World) -> Self {
        let readout = world.readout();
        Self { session: Session::new(world), readout, rig: Rig::default(), pace: 1.0, unsaved_s: 0.0 }
    }

    /// Runs ticks. What was clicked goes into the first of them.
    pub fn run(&mut self, ticks: u32, input: &mut Input, clicked: &mut Vec<Action>, slots: &Slots) -> Told {
        let mut told = Told::default();
        for _ in 0..ticks {
            let mut commands: Commands = input.sample(TICK_S, &self.readout);
            commands.actions.append(clicked);
            let events = self.session.tick(&commands);
            self.readout = self.session.world.readout();
            for event in events {
                match event {
                    Event::QuickSaved => told.notices.push(self.save(slots, &Kind::Quick)),
                    Event::QuickLoaded => {
                        input.adopt(&self.readout);
                        told.notices.push("Quick save loaded".to_owned());
                    }
                    Event::NothingToLoad => told.look_on_disk = true,
                }
            }
        }
        self.unsaved_s += f64::from(ticks) * TICK_S;
        if self.unsaved_s > AUTO_SAVE_S {
            self.unsaved_s = 0.0;
            let text = self.save(slots, &Kind::Auto);
            told.notices.push(text);
        }
        told
    }

    /// Writes a save and says how it went.
    pub fn save(&self, slots: &Slots, kind: &Kind) -> String {
        let world = &self.session.world;
        match slots.write(kind, &save::label(world), &save::encode(world)) {
            Ok(_) => match kind {
                Kind::Quick => "Quick save written".to_owned(),
                Kind::Auto => "Automatic save written".to_owned(),
                Kind::Named(name) => format!("Saved as {name}"),
            },
            Err(e) => format!("Not saved: {e}"),
        }
    }

    /// The next camera.
    pub fn next_camera(&mut self) -> &'static str {
        let (mode, name) = match self.rig.mode {
            CameraMode::Chase => (CameraMode::Cockpit, "Cockpit"),
            CameraMode::Cockpit => {
                self.leave_ship();
                return "Free camera: W S A D R F move it, the wheel sets its speed";
            }
            CameraMode::Free => (CameraMode::Map, "Far camera"),
            _ => (CameraMode::Chase, "Chase camera"),
        };
        self.rig.free = None;
        self.rig.mode = mode;
        (self.rig.yaw_rad, self.rig.pitch_rad) = match mode {
            CameraMode::Cockpit => (0.0, 0.0),
            _ => (0.0, -0.2),
        };
        name
    }

    /// What the rig is mounted on, now.
    fn mounted<T>(&mut self, with: impl FnOnce(&mut Rig, &Mount<'_>) -> T) -> T {
        let world = &self.session.world;
        let (rigid, sky) = (world.rigid(), Sky::at(&world.system, world.time));
        let mount =
            Mount { system: &world.system, sky: &sky, host: rigid.body, ship: rigid.state.position, icrf_from_hull: rigid.icrf_from_hull };
        with(&mut self.rig, &mount)
    }

    /// The free camera begins where the chase camera would hang, looking the same way.
    fn leave_ship(&mut self) {
        self.mounted(|rig, mount| {
            (rig.mode, rig.yaw_rad, rig.pitch_rad) = (CameraMode::Chase, 0.0, -0.2);
            let eye = rig.eye(mount);
            rig.fly(mount, &eye, Vector::new(DVec3::ZERO));
            let fixed = |v: DVec3| mount.axes(mount.host).inverse().raw(v);
            let ahead = fixed(eye.view_from_icrf.inverse().raw(DVec3::NEG_Z));
            let (east, up, north) = sphere::east_up_north(fixed(eye.position.0).normalize_or(DVec3::Z));
            rig.mode = CameraMode::Free;
            rig.yaw_rad = libm::atan2(-ahead.dot(east), ahead.dot(north));
            rig.pitch_rad = libm::asin(ahead.dot(up).clamp(-1.0, 1.0));
        });
        self.pace = 1.0;
    }

    /// Moves the free camera for `dt_s` seconds along `push` (right, up, back): the height above the ground each second at a pace
    /// of 1, so that one key is enough from the gear to the orbit.
    pub fn fly(&mut self, push: DVec3, dt_s: f64) {
        let pace = self.pace;
        if self.rig.mode != CameraMode::Free || push == DVec3::ZERO {
            return;
        }
        self.mounted(|rig, mount| {
            let eye = rig.eye(mount);
            let body = mount.system.body(eye.host);
            let up = mount.axes(eye.host).inverse().raw(eye.position.0.normalize_or(DVec3::Z));
            let ground = body.radius_m + body.relief.as_ref().map_or(0.0, |r| r.surface_m(up));
            let speed = (eye.position.length() - ground).max(LOWEST_M) * pace;
            rig.fly(mount, &eye, Vector::new(push * (speed * dt_s)));
        });
    }

    /// Faster or slower by the wheel.
    pub fn change_pace(&mut self, factor: f64) {
        self.pace = (self.pace * factor).clamp(0.01, 20.0);
    }
}

/// The World of a start, on the system at hand where it is the one asked for.
///
/// # Errors
/// Everything that is wrong with the files, as text.
pub fn begin(assets: &Assets, key: &str, at_hand: Option<&World>, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<World, String> {
    if let Some(world) = at_hand
        && let Ok(start) = assets.start(key)
        && start.system == world.system.key
    {
        let ship = assets.ship(&start.ship).map_err(|e| e.lines().to_string())?;
        return World::from_start(world.system.clone(), ship, &start).map_err(|e| e.to_string());
    }
    assets.begin(key, progress).map_err(|e| e.lines().to_string())
}

/// The World of a save that was read, and what the player should be told.
///
/// # Errors
/// What is wrong with the save or with the files that it needs, as text.
pub fn restore(
    assets: &Assets,
    loaded: &Loaded<SaveV1>,
    at_hand: Option<&World>,
    progress: &(dyn Fn(f32, &str) + Sync),
) -> Result<(World, Vec<String>), String> {
    let state = &loaded.state;
    let system = match at_hand.filter(|w| w.system.key == state.system) {
        Some(world) => world.system.clone(),
        None => assets.system(&state.system, progress).map_err(|e| e.lines().to_string())?,
    };
    let ship = assets.ship(&state.ship_key).map_err(|e| e.lines().to_string())?;
    let world = state.restore(&system, &ship).map_err(|problems| format!("{}:\n{}", loaded.from.display(), problems.join("\n")))?;
    Ok((world, loaded.notes.clone()))
}

/// Reads a save file.
///
/// # Errors
/// What is wrong with it, as text.
pub fn read(slots: &Slots, path: &Path) -> Result<Loaded<SaveV1>, String> {
    slots.load(path, &save::decode).map_err(|e| e.to_string())
}

/// What the menus list.
pub fn lists(assets: &Assets, slots: &Slots) -> Lists {
    let starts = assets.starts().into_iter().map(|(key, start)| match start {
        Ok(start) => StartEntry { key, name: start.name, description: start.description },
        Err(e) => StartEntry { name: format!("{key} (cannot be read)"), key, description: e.lines().to_string() },
    });
    let saves = slots.list().into_iter().map(|entry| {
        let title = match &entry.kind {
            Kind::Quick => "Quick save".to_owned(),
            Kind::Auto => "Automatic save".to_owned(),
            Kind::Named(name) => name.clone(),
        };
        match entry.header {
            Ok(h) => {
                let detail = format!("{}  ·  {}  ·  {}", h.time.utc(), h.body, format::length(h.altitude_m));
                SaveEntry { path: entry.path, title, detail, damage: None }
            }
            Err(e) => SaveEntry { detail: entry.path.display().to_string(), path: entry.path, title, damage: Some(e.to_string()) },
        }
    });
    Lists { starts: starts.collect(), saves: saves.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_free_camera_starts_with_the_chase_view_and_moves_by_its_height() {
        let mut flight = Flight::new(crate::hud::testing::world());
        flight.rig.pitch_rad = -0.2;
        let (chase, height) = flight.mounted(|rig, mount| {
            let eye = rig.eye(mount);
            (eye, eye.position.length() - mount.system.body(eye.host).radius_m)
        });
        flight.leave_ship();
        let free = flight.mounted(|rig, mount| rig.eye(mount));
        let turn = (free.view_from_icrf.raw(DVec3::X) - chase.view_from_icrf.raw(DVec3::X)).length();
        assert!((free.position - chase.position).length() < 1e-3 && turn < 1e-6, "{turn}");
        flight.fly(DVec3::NEG_Z, 0.01);
        let moved = flight.mounted(|rig, mount| rig.eye(mount)).position - free.position;
        let ahead = free.view_from_icrf.raw(moved.0);
        assert!((ahead.z / (-0.01 * height) - 1.0).abs() < 0.02 && ahead.x.abs() < 1e-3 * height, "{ahead} of {height}");
    }
}
