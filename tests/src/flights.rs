//! The reference flights: how each is flown, through Commands alone, so that it can be recorded (`tests/replays/`) and
//! judged. A pilot here looks at the readout twice a second and acts on it, as a person would.

use game::command::{AXIS_MAX, Action, Axes, Commands, Guidance, Hold, Spot, Target};
use game::input::Input;
use game::input::bindings::Bindings;
use game::input::pads::{Hand, PadButton, event};
use game::replay::Log;
use game::session::Session;
use game::world::World;
use game::world::readout::{Readout, Situation};
use game::world::start::{Place, StartSpec};

/// Ticks between two looks at the instruments.
const LOOK_TICKS: u64 = 30;
/// Index into the warp levels: 100×.
const WARP_100: u8 = 6;
/// 1×.
const WARP_1: u8 = game::command::WARP_ONE;

/// A flight to be recorded.
pub struct Reference {
    /// File name in `tests/replays/`, without its ending.
    pub name: &'static str,
    /// Where it starts.
    pub start: fn() -> StartSpec,
    /// How it is flown.
    pub fly: fn(&mut Pilot),
}

/// All of them.
pub const FLIGHTS: [Reference; 5] = [
    Reference { name: "orbit_to_surface", start: over_the_atlantic, fly: orbit_to_surface },
    Reference { name: "takeoff_to_orbit", start: at_the_cape, fly: takeoff_to_orbit },
    Reference { name: "landed_on_moon", start: about_the_moon, fly: landed_on_moon },
    Reference { name: "save_load_midflight", start: over_the_atlantic, fly: save_load_midflight },
    Reference { name: "gamepad_flight", start: in_the_air, fly: gamepad_flight },
];

/// Who flies: a session that is being recorded, and the commands of the next tick.
pub struct Pilot {
    session: Session,
    next: Vec<Action>,
}

impl Pilot {
    /// Takes a World over and records from here.
    pub fn new(world: World) -> Self {
        let mut session = Session::new(world);
        session.record();
        Self { session, next: Vec::new() }
    }
    /// What the instruments say.
    pub fn readout(&self) -> Readout {
        self.session.world.readout()
    }
    /// Ends the flight: its record and its last World.
    ///
    /// # Panics
    /// Never: a pilot records from the beginning.
    pub fn finish(mut self) -> (Log, World) {
        let log = self.session.recorded().expect("recorded from the beginning");
        (log, self.session.world)
    }

    fn act(&mut self, action: Action) {
        self.next.push(action);
    }
    fn tick(&mut self, mut commands: Commands) {
        commands.actions.append(&mut self.next);
        self.session.tick(&commands);
    }
    fn ticks(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick(Commands::default());
        }
    }
    fn stick_down(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick(Commands { axes: Axes { pitch: -AXIS_MAX, ..Axes::default() }, actions: Vec::new() });
        }
    }
    /// Flies on until something holds.
    fn until(&mut self, what: &str, limit_ticks: u64, mut holds: impl FnMut(&Readout) -> bool) {
        let mut flown = 0;
        loop {
            let readout = self.readout();
            if holds(&readout) {
                return;
            }
            assert!(
                flown < limit_ticks && readout.situation != Situation::Crashed,
                "waiting for: {what}; after {flown} ticks {:?} ({}), altitude {:.0} m, ground {:.0} m, {:.1} m/s over ground, {:.1} m/s up",
                readout.situation,
                readout.guidance_phase,
                readout.altitude_m,
                readout.ground_m,
                readout.surface_speed_m_s,
                readout.vertical_speed_m_s,
            );
            self.ticks(LOOK_TICKS);
            flown += LOOK_TICKS;
        }
    }
    fn land(&mut self, body: &str, lat_udeg: i32, lon_udeg: i32) {
        let body = self.session.world.system.find(body).expect("the system has the body");
        self.act(Action::Target(Some(Target { body, spot: Some(Spot { lat_udeg, lon_udeg }) })));
        self.act(Action::Guidance(Guidance::Land));
        self.act(Action::Warp(WARP_100));
        self.until("standing", 60 * 60 * 40, |r| r.situation == Situation::Landed);
        self.act(Action::Guidance(Guidance::Manual));
        self.act(Action::Throttle(0));
        self.act(Action::Warp(WARP_1));
        // Ten seconds at rest, to be seen in the record.
        self.ticks(600);
    }
    fn climb_to_orbit(&mut self, apoapsis_m: f64, periapsis_m: f64) {
        self.act(Action::Guidance(Guidance::VerticalSpeed { cm_s: 15_000 }));
        self.until("3 km above ground", 6_000, |r| r.altitude_m - r.ground_m > 3_000.0);
        self.act(Action::Gear(false));
        self.act(Action::Guidance(Guidance::Manual));
        self.act(Action::Hold(Hold::SurfacePrograde));
        self.until("the nose up", 900, |r| r.markers.surface_prograde.z < -0.98);
        self.act(Action::Throttle(50_000));
        self.until("above thick air", 12_000, |r| r.altitude_m > 30_000.0);
        // Nose down, towards the east, by hand; with the stick let go the attitude stays.
        self.act(Action::Hold(Hold::Rate));
        self.stick_down(80);
        self.act(Action::Throttle(u16::MAX));
        self.until("the apoapsis", 20_000, |r| r.orbit.apoapsis_m > apoapsis_m);
        self.act(Action::Throttle(0));
        // Before the top: while the burn lasts, gravity takes the rest of the climb.
        self.until("the burn's beginning", 60_000, |r| r.vertical_speed_m_s < 250.0);
        self.act(Action::Hold(Hold::Prograde));
        self.act(Action::Throttle(u16::MAX));
        self.until("an orbit", 60_000, |r| r.orbit.periapsis_m > periapsis_m);
        self.act(Action::Throttle(0));
        self.act(Action::Warp(WARP_100));
        self.ticks(1_200);
    }
}

fn start(key: &str, utc: &str, place: Place) -> StartSpec {
    StartSpec {
        key: key.into(),
        name: key.into(),
        description: String::new(),
        system: "sol".into(),
        ship: "torch".into(),
        utc: utc.into(),
        place,
        target: None,
    }
}

fn over_the_atlantic() -> StartSpec {
    let place = Place::Orbit { body: "earth".into(), altitude_m: 420e3, lat_deg: 25.0, lon_deg: -40.0, heading_deg: 50.0 };
    start("over_the_atlantic", "2026-08-12T15:30:00", place)
}

fn at_the_cape() -> StartSpec {
    let place = Place::Ground { body: "earth".into(), lat_deg: 28.5, lon_deg: -80.7, heading_deg: 90.0 };
    start("at_the_cape", "2026-08-12T15:30:00", place)
}

fn in_the_air() -> StartSpec {
    let (body, altitude_m, speed_m_s) = ("earth".into(), 3_000.0, 220.0);
    let place = Place::Air { body, altitude_m, lat_deg: 28.5, lon_deg: -80.7, heading_deg: 90.0, speed_m_s, climb_m_s: 0.0 };
    start("in_the_air", "2026-08-12T15:30:00", place)
}

fn about_the_moon() -> StartSpec {
    let place = Place::Orbit { body: "moon".into(), altitude_m: 100e3, lat_deg: 0.0, lon_deg: -60.0, heading_deg: 88.0 };
    start("about_the_moon", "2026-08-12T15:30:00", place)
}

/// From a 420 km orbit to a stand on the Meseta near Burgos, under the eclipse's path.
fn orbit_to_surface(pilot: &mut Pilot) {
    pilot.ticks(120);
    pilot.land("earth", 42_357_000, -3_620_000);
}

/// From the ground at Cape Canaveral to an orbit.
fn takeoff_to_orbit(pilot: &mut Pilot) {
    pilot.ticks(60);
    pilot.climb_to_orbit(300e3, 205e3);
}

/// From a 100 km orbit of the Moon to Tranquility Base.
fn landed_on_moon(pilot: &mut Pilot) {
    pilot.ticks(60);
    pilot.land("moon", 674_000, 23_473_000);
}

/// A burn, a quick save in the middle of it, another minute, and back: what follows is flown from the saved tick.
fn save_load_midflight(pilot: &mut Pilot) {
    pilot.act(Action::Hold(Hold::Retrograde));
    pilot.ticks(900);
    pilot.act(Action::Throttle(40_000));
    pilot.ticks(301);
    pilot.act(Action::Quicksave);
    pilot.ticks(437);
    pilot.act(Action::Throttle(0));
    pilot.ticks(600);
    pilot.act(Action::Quickload);
    pilot.ticks(60);
    pilot.act(Action::Throttle(0));
    pilot.act(Action::Hold(Hold::Prograde));
    pilot.ticks(900);
    // And once more in the air, hot.
    pilot.act(Action::Hold(Hold::SurfaceRetrograde));
    pilot.act(Action::Warp(WARP_100));
    pilot.until("air", 60_000, |r| r.density_kg_m3 > 1e-6);
    pilot.act(Action::Warp(WARP_1));
    pilot.act(Action::Quicksave);
    pilot.ticks(600);
    pilot.act(Action::Quickload);
    pilot.ticks(600);
}

/// Up, forward and round on a gamepad: events put into gilrs' queue, through the bindings in force by default.
fn gamepad_flight(pilot: &mut Pilot) {
    let mut input = Input::new(Bindings::default());
    let mut fly = |pilot: &mut Pilot, hands: &[Hand], ticks: u64| {
        for hand in hands {
            let event = event(0, *hand).expect("an event can be made on this platform");
            assert!(input.pads.insert(event), "a gamepad subsystem is there to take events");
        }
        for _ in 0..ticks {
            input.poll_pads();
            let commands = input.sample(engine::time::TICK_S, &pilot.readout());
            pilot.tick(commands);
        }
    };
    use Hand::{Axis as A, Press, Release, Trigger};
    use gilrs::Axis::{LeftStickX as LEFT_X, LeftStickY as LEFT_Y};
    fly(pilot, &[Trigger(PadButton::RightTrigger2, 1.0)], 20);
    fly(pilot, &[Trigger(PadButton::RightTrigger2, 0.0), A(LEFT_Y, -0.4)], 60);
    fly(pilot, &[A(LEFT_Y, 0.0), A(LEFT_X, 0.7)], 90);
    fly(pilot, &[A(LEFT_X, 0.03), Press(PadButton::South)], 30);
    fly(pilot, &[Release(PadButton::South), Press(PadButton::LeftTrigger)], 45);
    fly(pilot, &[Release(PadButton::LeftTrigger), Press(PadButton::RightThumb), Release(PadButton::RightThumb)], 240);
    fly(pilot, &[Press(PadButton::East), Release(PadButton::East)], 60);
}
