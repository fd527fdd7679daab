//! A small World for the tests of saves and replays: a star and one bare body, a ship in each kind of motion.

use crate::command::{Guidance, Hold, Node, Spot, Target};
use crate::world::World;
use crate::world::ship::guidance::burn::Stage;
use crate::world::ship::guidance::{Burn, Landing, Phase};
use crate::world::ship::spec::tests::torch;
use crate::world::ship::{Effort, Motion, Resting, Rigid, Ship};
use crate::world::system::{Body, System};
use engine::orbit::{BodyId, State};
use engine::rigid::{Contact, LegState, PatchKey};
use engine::space::{Position, Rotation, Vector, Velocity};
use engine::terrain::Relief;
use engine::time::SimTime;
use engine::units::KM;
use glam::{DQuat, DVec3, Vec3};
use std::sync::Arc;

fn body(key: &str, parent: Option<BodyId>, gm_m3_s2: f64, radius_m: f64) -> Body {
    Body {
        key: key.into(),
        name: key.into(),
        parent,
        gm_m3_s2,
        radius_m,
        soi_radius_m: if parent.is_some() { 9.0e8 } else { f64::INFINITY },
        spin: engine::orbit::rotation::Spin { pole_dec_rad: [1.4, 0.0], meridian_rad: [0.3, 6.3], ..Default::default() },
        shape: engine::orbit::eclipse::Shape::sphere(radius_m),
        figure: None,
        albedo: Vec3::splat(0.3),
        intensity_cd: Vec3::ZERO,
        air: None,
        look: None,
        fog: Vec::new(),
        relief: parent.map(|_| Arc::new(Relief::smooth(radius_m, false))),
        relief_max: 1.0,
    }
}

/// A star and `rock`, of the Earth's mass and size but bare.
pub(crate) fn system() -> Arc<System> {
    let bodies = vec![body("star", None, 1.327e20, 7.0e8), body("rock", Some(BodyId(0)), 3.986e14, 6371.0 * KM)];
    Arc::new(System::new("two".into(), "Two".into(), bodies, Default::default(), "ab".repeat(32)))
}

/// About the rock, 400 km up, turning a little.
pub(crate) fn rigid() -> Rigid {
    Rigid {
        body: BodyId(1),
        state: State { position: Position::xyz(6771.0 * KM, 1.0 / 3.0, -7.0), velocity: Velocity::xyz(0.1, 7672.6, 3.0) },
        icrf_from_hull: Rotation::new(DQuat::from_xyzw(0.1, -0.7, 0.2, 0.6).normalize()),
        rate: Vector::xyz(1e-3, 2e-3, -0.5e-3),
    }
}

/// On the rock.
pub(crate) fn resting() -> Resting {
    let position = Position::xyz(0.0, 6371.0 * KM + 3.0, 1.0 / 7.0);
    Resting { body: BodyId(1), position, fixed_from_hull: Rotation::new(DQuat::from_xyzw(0.3, 0.1, -0.5, 0.8).normalize()) }
}

/// A World with a ship that moves so.
pub(crate) fn world(motion: Motion) -> World {
    World::new(system(), SimTime::from_ticks(50_399_999_999), Ship::new(Arc::new(torch()), motion))
}

/// One World for each kind of motion, with every optional part of the state filled in one or the other.
pub(crate) fn worlds() -> Vec<World> {
    let mut flying = world(Motion::Fly(rigid()));
    flying.ship.motion = Motion::Fly(rigid());
    flying.ship.throttle = 40_000;
    flying.ship.nozzle = 1.0 / 3.0;
    flying.ship.propellant_kg *= 0.1 + 0.2;
    flying.ship.held = Some(DQuat::from_xyzw(0.5, 0.5, -0.5, 0.5));
    flying.ship.effort = Effort { throttle: 0.61, rcs: 0.1, felt_m_s2: 9.1 };
    flying.ship.last_contact = Some((0.7, SimTime::from_ticks(50_000_000_000)));
    flying.target = Some(Target { body: BodyId(1), spot: Some(Spot { lat_udeg: -33_000_000, lon_udeg: 151_200_000 }) });
    let mut landing = flying.clone();
    landing.ship.guidance = Guidance::Land;
    landing.ship.landing = Some(Landing {
        body: BodyId(1),
        spot: DVec3::new(0.6, 0.0, 0.8),
        ground_m: 12.5,
        gate_m: 8_000.0,
        arrival_rad: 0.017,
        phase: Phase::Approach { brake: SimTime::from_ticks(50_400_100_000) },
    });
    let mut coasting = world(Motion::Fly(Rigid { rate: Vector::ZERO, ..rigid() }));
    coasting.ship.hold = Hold::Free;
    coasting.warp_asked = 5;
    let mut touching = world(Motion::Contact(rigid()));
    touching.ship.ground.contact = Contact {
        key: Some(PatchKey { face: 4, middle: [-812, 2_000_000] }),
        legs: vec![LegState { hold_m: Some(DVec3::new(6371.0 * KM, 1.0 / 3.0, -2.0)), compression_m: 0.1 + 0.2 }, LegState::default()],
        quiet_ticks: 17,
        touching: true,
    };
    let mut burning = flying.clone();
    burning.ship.guidance = Guidance::Node;
    burning.ship.hold = Hold::Node;
    burning.warp_to = Some(SimTime::from_ticks(50_400_050_000));
    burning.ship.nodes = vec![
        Node { at: SimTime::from_ticks(50_400_100_000), dv_mm_s: [120_000, -7, 3_000] },
        Node { at: SimTime::from_ticks(50_500_000_000), dv_mm_s: [0, i32::MIN, i32::MAX] },
    ];
    burning.ship.burn = Some(Burn {
        to_gain: DVec3::new(0.1, -120.0, 1.0 / 3.0),
        aim: DVec3::NEG_Y,
        spent: true,
        phase: Stage::Wait { turn: SimTime::from_ticks(50_400_090_000) },
    });
    vec![coasting, flying, landing, touching, burning, world(Motion::Landed(resting())), world(Motion::Crashed(resting()))]
}
