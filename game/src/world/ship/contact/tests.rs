//! A whole World at the ground: falling, landing, resting, waking, breaking, and starting again from what a save holds.

use super::*;
use crate::command::{Action, Commands};
use crate::world::World;
use crate::world::ship::spec::tests::torch;
use crate::world::start::standing;
use crate::world::system::{Body, System};
use engine::orbit::BodyId;
use engine::orbit::ephemeris::Ephemeris;
use engine::orbit::rotation::Spin;
use engine::space::{Velocity, sphere};
use glam::{DMat3, DQuat, Vec3};
use std::sync::Arc;

fn rock(ground: bool) -> Arc<System> {
    let radius_m = 6.371e6;
    let relief = Relief::smooth(radius_m, false);
    let body = Body {
        key: "rock".into(),
        name: "Rock".into(),
        parent: None,
        gm_m3_s2: 3.986_004_4e14,
        radius_m,
        soi_radius_m: f64::INFINITY,
        spin: Spin { pole_dec_rad: [1.2, 0.0], meridian_rad: [0.3, core::f64::consts::TAU * 86_400.0 / 86_164.1], ..Spin::default() },
        shape: engine::orbit::eclipse::Shape::sphere(radius_m),
        figure: None,
        albedo: Vec3::splat(0.1),
        intensity_cd: Vec3::ZERO,
        air: None,
        look: None,
        fog: Vec::new(),
        relief: ground.then(|| Arc::new(relief)),
        relief_max: 1.0,
    };
    Arc::new(System::new("t".into(), "T".into(), vec![body], Ephemeris::default(), String::new()))
}

/// Upright over the ground, moving at `velocity` (east, up, north) over it.
fn over(system: &Arc<System>, height_m: f64, velocity: DVec3) -> World {
    let time = SimTime::from_ticks(50_000_000_000);
    let body = &system.bodies[0];
    let up = sphere::direction_of_lat_lon(0.4, 1.3);
    let (e, u, n) = sphere::east_up_north(up);
    let axes = body.spin.icrf_from_fixed(time);
    let r = axes.raw(up * (body.radius_m + height_m));
    let over = axes.raw(e * velocity.x + u * velocity.y + n * velocity.z);
    let rigid = Rigid {
        body: BodyId(0),
        state: State { position: Position::new(r), velocity: Velocity::new(body.spin.angular_velocity(time).0.cross(r) + over) },
        icrf_from_hull: Rotation::new((axes.0 * DQuat::from_mat3(&DMat3::from_cols(e, u, -n))).normalize()),
        rate: Vector::ZERO,
    };
    let mut world = World::flying(system.clone(), time, Arc::new(torch()), rigid);
    world.ship.motion = Motion::Fly(rigid);
    world.ship.gear_down = true;
    world
}

fn idle(world: &mut World, ticks: usize) {
    for _ in 0..ticks {
        world.tick(&Commands::default());
    }
}

fn act(world: &mut World, action: Action) {
    world.tick(&Commands { actions: vec![action], ..Commands::default() });
}

#[test]
fn falls_lands_rests_and_takes_off_again() {
    let mut world = over(&rock(true), 6.0, DVec3::ZERO);
    let t = (0..600).find(|_| {
        idle(&mut world, 1);
        matches!(world.ship.motion, Motion::Landed(_))
    });
    assert!(t.is_some(), "{:?}", world.ship.motion);
    let (speed, _) = world.ship.last_contact.unwrap();
    assert!((0.05..8.0).contains(&speed), "{speed}");
    let Motion::Landed(rest) = world.ship.motion else { unreachable!() };
    idle(&mut world, 600);
    assert_eq!(world.ship.motion, Motion::Landed(rest), "frozen");

    act(&mut world, Action::Hold(crate::command::Hold::SurfaceVertical));
    act(&mut world, Action::Throttle(u16::MAX / 2));
    idle(&mut world, 300);
    let height = world.readout().altitude_m;
    assert!(matches!(world.ship.motion, Motion::Fly(_)) && height > 50.0, "{height} m, {:?}", world.ship.motion);
    assert!(subsystem(&world.ship).1.contains("flying"));
}

#[test]
fn weight_locks_the_gear() {
    let system = rock(true);
    let mut world = over(&system, 5.0, DVec3::ZERO);
    let up = sphere::direction_of_lat_lon(0.4, 1.3);
    let (east, ..) = sphere::east_up_north(up);
    world.ship.motion = Motion::Landed(standing(&system, BodyId(0), &world.ship.spec, up, east));
    act(&mut world, Action::Gear(false));
    assert!(world.ship.gear_down && matches!(world.ship.motion, Motion::Landed(_)));
    let mut flying = over(&system, 500.0, DVec3::ZERO);
    act(&mut flying, Action::Gear(false));
    assert!(!flying.ship.gear_down);
}

#[test]
fn breaks_at_the_surface_at_any_speed() {
    for (speed, down) in [(12.0, 1.0), (100.0, 1.0), (3_000.0, 0.3), (3_000.0, 1.0), (12_000.0, 0.05), (12_000.0, 1.0)] {
        let east = libm::sqrt(1.0 - down * down);
        let mut world = over(&rock(true), 4_000.0_f64.min(speed * 2.0), DVec3::new(east, -down, 0.0) * speed);
        for _ in 0..2_000 {
            idle(&mut world, 1);
            if !matches!(world.ship.motion, Motion::Fly(_) | Motion::Contact(_)) {
                break;
            }
        }
        let Motion::Crashed(rest) = world.ship.motion else { panic!("{speed} m/s: {:?}", world.ship.motion) };
        let height = rest.position.length() - 6.371e6;
        assert!((1.5..6.0).contains(&height), "{speed} m/s, {down}: stopped at {height} m");
        let (hit, _) = world.ship.last_contact.unwrap();
        assert!(hit > 0.9 * speed * down, "{speed}: {hit}");
        let newest = world.ship.ground.recorder.at(0.0).unwrap();
        assert_eq!(newest.position, rest.position);
        assert!(world.ship.ground.recorder.poses().len() > 3);
    }
}

#[test]
fn giants_crush_what_sinks() {
    let mut world = over(&rock(false), 300.0, DVec3::new(0.0, -200.0, 0.0));
    idle(&mut world, 120);
    assert!(matches!(world.ship.motion, Motion::Crashed(_)));
}

#[test]
fn nothing_of_it_exists_high_up() {
    let mut world = over(&rock(true), 200_000.0, DVec3::ZERO);
    act(&mut world, Action::Throttle(9_000));
    idle(&mut world, 5);
    let ground = &world.ship.ground;
    assert!(!ground.bubble.has_ground() && ground.contact == Contact::default() && ground.fields().len() == 2);
    assert!(!subsystem(&world.ship).0);
}

#[test]
fn what_a_save_holds_is_enough() {
    let mut world = over(&rock(true), 4.6, DVec3::new(2.0, -1.5, 1.0));
    idle(&mut world, 25);
    assert!(matches!(world.ship.motion, Motion::Contact(_)) && world.ship.ground.contact.touching);
    let mut other = world.clone();
    other.ship.ground = Ground { contact: world.ship.ground.contact.clone(), ..Ground::default() };
    for tick in 0..600 {
        idle(&mut world, 1);
        idle(&mut other, 1);
        assert_eq!(world.fields(), other.fields(), "tick {tick}");
    }
    assert!(matches!(world.ship.motion, Motion::Landed(_)));
}

#[test]
fn a_guided_descent_ends_on_its_feet() {
    let mut world = over(&rock(true), 60.0, DVec3::new(6.0, 0.0, -4.0));
    act(&mut world, Action::Guidance(Guidance::VerticalSpeed { cm_s: -200 }));
    let landed = (0..6_000).any(|_| {
        idle(&mut world, 1);
        matches!(world.ship.motion, Motion::Landed(_))
    });
    let (speed, _) = world.ship.last_contact.unwrap_or_default();
    assert!(landed && speed < 3.0, "{speed} m/s, {:?}, {:?}", world.ship.motion, world.ship.guidance);
    let r = world.readout();
    assert!(r.heading_pitch_roll_rad[1].abs() < 0.05 && r.heading_pitch_roll_rad[2].abs() < 0.05);
}

#[test]
fn the_automatic_landing_stands_at_its_spot() {
    use crate::command::{Spot, Target};
    let mut world = over(&rock(true), 3_000.0, DVec3::new(40.0, 0.0, 0.0));
    let spot = Spot { lat_udeg: 22_920_000, lon_udeg: 74_490_000 };
    act(&mut world, Action::Target(Some(Target { body: BodyId(0), spot: Some(spot) })));
    act(&mut world, Action::Guidance(Guidance::Land));
    let landed = (0..60_000).any(|_| {
        idle(&mut world, 1);
        matches!(world.ship.motion, Motion::Landed(_) | Motion::Crashed(_))
    });
    let (speed, _) = world.ship.last_contact.unwrap_or_default();
    let r = world.readout();
    let away = r.target.and_then(|t| t.ground_distance_m).unwrap_or(f64::NAN);
    println!("touchdown {speed:.2} m/s, {away:.1} m from the spot, {:?}", world.ship.motion);
    assert!(landed && matches!(world.ship.motion, Motion::Landed(_)), "{:?} {:?}", world.ship.motion, world.ship.landing);
    assert!(speed < 3.0 && away < 500.0, "{speed} m/s, {away} m away");
}

#[test]
fn hops_on_the_shipped_moon_and_stands_again() {
    let dir = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    let assets = crate::assets::Assets::new(dir, Vec::new());
    let Ok(mut world) = assets.begin("moon_surface", &|_, _| {}) else { panic!("assets/starts/moon_surface.toml does not load") };
    assert!(matches!(world.ship.motion, Motion::Landed(_)));
    act(&mut world, Action::Guidance(Guidance::VerticalSpeed { cm_s: 400 }));
    idle(&mut world, 300);
    let height = world.readout().altitude_m - world.readout().ground_m;
    assert!(height > 8.0, "{height} m");
    act(&mut world, Action::Guidance(Guidance::VerticalSpeed { cm_s: -150 }));
    let clock = std::time::Instant::now();
    let ticks = (0..3_000).find(|_| {
        idle(&mut world, 1);
        matches!(world.ship.motion, Motion::Landed(_) | Motion::Crashed(_))
    });
    let (speed, _) = world.ship.last_contact.unwrap();
    let rate = ticks.unwrap_or(3_000) as f64 / 60.0 / clock.elapsed().as_secs_f64();
    println!("touchdown {speed:.2} m/s after {ticks:?} ticks, {rate:.0} x real time");
    assert!(matches!(world.ship.motion, Motion::Landed(_)) && speed < 3.0, "{speed} m/s, {:?}", world.ship.motion);
    let r = world.readout();
    let [_, pitch, roll] = r.heading_pitch_roll_rad;
    assert!(pitch.abs() < 0.5 && roll.abs() < 0.5, "upright: {pitch} {roll}");
}
