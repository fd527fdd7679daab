//! Tests of the World as a whole, on small made-up systems: coasting, warp, air, holds, hover, landing.

mod coast;

use super::readout::Situation;
use super::ship::spec::ShipSpec;
use super::ship::spec::tests::torch;
use super::ship::{Motion, Rigid, attitude};
use super::system::{Body, System};
use super::*;
use crate::command::Spot;
use engine::air::density::{Column, ColumnSpec};
use engine::orbit::ephemeris::{Ephemeris, Orbit, Path as EphemerisPath};
use engine::orbit::rotation::Spin;
use engine::terrain::Relief;
use engine::units::DEG;
use glam::Vec3;

const START: SimTime = SimTime::from_ticks(1_000_000);

/// A lone smooth body that turns once in `day_s`.
fn lone_body(gm: f64, radius_m: f64, day_s: f64, air: Option<Column>) -> Arc<System> {
    let spin = Spin { pole_dec_rad: [90.0 * DEG, 0.0], meridian_rad: [0.3, core::f64::consts::TAU * 86_400.0 / day_s], ..Spin::default() };
    let body = rock(gm, radius_m, spin, air);
    Arc::new(System::new("test".into(), "Test".into(), vec![body], Ephemeris::default(), String::new()))
}

fn rock(gm: f64, radius_m: f64, spin: Spin, air: Option<Column>) -> Body {
    Body {
        key: "rock".into(),
        name: "Rock".into(),
        parent: None,
        gm_m3_s2: gm,
        radius_m,
        soi_radius_m: f64::INFINITY,
        spin,
        shape: engine::orbit::eclipse::Shape::sphere(radius_m),
        figure: None,
        albedo: Vec3::splat(0.1),
        intensity_cd: Vec3::ZERO,
        air,
        look: None,
        fog: Vec::new(),
        relief: Some(Arc::new(Relief::smooth(radius_m, false))),
        relief_max: 1.0,
    }
}

/// A planet with one moon on a circle, both smooth and airless.
fn planet_and_moon() -> Arc<System> {
    let (planet, moon, distance) = (3.986_004_4e14, 4.902_800e12, 3.844e8);
    let mut bodies = vec![rock(planet, 6.371e6, Spin::default(), None), rock(moon, 1.737_4e6, Spin::default(), None)];
    bodies[1].key = "moon".into();
    bodies[1].parent = Some(BodyId(0));
    // A save tells bodies apart by their keys.
    bodies[1].key = "moon".into();
    bodies[1].soi_radius_m = 6.6e7;
    let speed = ((planet + moon) / distance).sqrt();
    let state = State { position: Position::xyz(distance, 0.0, 0.0), velocity: Velocity::xyz(0.0, speed, 0.0) };
    let at_rest = EphemerisPath::Barycentric { epoch: START, state: State::default(), of_system: false };
    let orbit = |parent, gm_m3_s2, path| Orbit { parent, gm_m3_s2, path };
    let orbits = vec![orbit(None, planet, at_rest), orbit(Some(BodyId(0)), moon, EphemerisPath::FromParent { epoch: START, state })];
    let ephemeris = Ephemeris::new(orbits).unwrap();
    Arc::new(System::new("two".into(), "Two".into(), bodies, ephemeris, String::new()))
}

fn moon() -> Arc<System> {
    lone_body(4.902_800e12, 1.737_4e6, 27.321_661 * 86_400.0, None)
}

fn earth() -> Arc<System> {
    let spec = ColumnSpec::Us76 { drag_top_m: 200_000.0 };
    lone_body(3.986_004_4e14, 6.371e6, 86_164.1, Some(Column::new(&spec).unwrap()))
}

/// A ship at `altitude_m` with a velocity (up, east, north) m/s in inertial axes; the nose along the horizontal part.
fn moving(system: &Arc<System>, spec: ShipSpec, altitude_m: f64, velocity: DVec3) -> World {
    let r = system.bodies[0].radius_m + altitude_m;
    let rigid = Rigid {
        body: BodyId(0),
        state: State { position: Position::new(DVec3::X * r), velocity: Velocity::new(velocity) },
        icrf_from_hull: Rotation::new(attitude::look(velocity.with_x(0.0), DVec3::X)),
        rate: Vector::ZERO,
    };
    World::flying(system.clone(), START, Arc::new(spec), rigid)
}

/// On a circular orbit, inclined to the equator; `slower` scales the speed.
fn orbiting(system: &Arc<System>, altitude_m: f64, inclination: f64, slower: f64) -> World {
    let body = &system.bodies[0];
    let v = slower * (body.gm_m3_s2 / (body.radius_m + altitude_m)).sqrt();
    let (s, c) = libm::sincos(inclination);
    moving(system, torch(), altitude_m, DVec3::new(0.0, v * c, v * s))
}

#[test]
fn sunlight_pushes_a_sail_as_its_closed_form_says() {
    use engine::orbit::gravity::radiation::{SUN_AT_1_AU_W_M2, cannonball};
    use engine::units::AU;
    let gm = 1.327_124_4e20;
    let mut bodies = vec![rock(gm, 6.957e8, Spin::default(), None)];
    bodies[0].soi_radius_m = f64::INFINITY;
    bodies[0].intensity_cd = Vec3::splat(engine::space::relative::narrow(1.28e5 * AU * AU));
    let orbit =
        Orbit { parent: None, gm_m3_s2: gm, path: EphemerisPath::Barycentric { epoch: START, state: State::default(), of_system: false } };
    let system = Arc::new(System::new("one".into(), "One".into(), bodies, Ephemeris::new(vec![orbit]).unwrap(), String::new()));
    let spec = ShipSpec { sunlight: Some(super::ship::spec::Sunlight { area_m2: 2.0e5, reflectivity: 1.8 }), ..torch() };
    let mut world = moving(&system, spec, AU, DVec3::new(0.0, 29.8e3, 0.0));
    let (from, began, mass_kg) = (world.rigid().state, world.time, world.ship.mass_kg());
    world.enter_path();
    world.warp_asked = 8;
    idle(&mut world, 4_000);
    // Light goes with the inverse square as gravity does: a conic about less mass.
    let push = cannonball(DVec3::X * AU, 2.0e5 / mass_kg, 1.8, SUN_AT_1_AU_W_M2, 1.0).x * AU * AU;
    let on = |gm: f64| engine::orbit::kepler::propagate(gm, &from, world.time.since(began)).position;
    let moved = (world.rigid().state.position - on(gm)).length();
    let missed = (world.rigid().state.position - on(gm - push)).length();
    assert!(moved > 1.0e7 && missed < 2e-4 * moved, "moved {moved} m, {missed} m from the conic");
}

fn act(world: &mut World, action: Action) {
    world.tick(&Commands { actions: vec![action], ..Commands::default() });
}

fn idle(world: &mut World, ticks: usize) {
    for _ in 0..ticks {
        world.tick(&Commands::default());
    }
}

fn energy(world: &World) -> f64 {
    let rigid = world.rigid();
    0.5 * rigid.state.velocity.0.length_squared() - world.system.bodies[0].gm_m3_s2 / rigid.state.position.length()
}

fn bits(world: &World) -> Vec<u64> {
    let state = world.rigid().state;
    let path = state.position.0.to_array().into_iter().chain(state.velocity.0.to_array()).map(f64::to_bits);
    world.fields().into_iter().filter(|f| !f.1.starts_with("warp") && f.1 != "quarters").map(|f| f.2).chain(path).collect()
}

#[test]
fn a_hundred_revolutions_keep_their_energy_and_their_bits_at_every_warp() {
    let end = START.ticks + 60 * 5545 * 100;
    let mut finals = Vec::new();
    for level in [6, 7, 8, 9, 10] {
        let mut world = orbiting(&earth(), 400e3, 0.9, 1.0);
        let before = energy(&world);
        world.warp_asked = level;
        while world.time.ticks < end {
            // As fast as the level allows without running past the end.
            while i64::from(WARP_QUARTERS[usize::from(world.warp_asked)] / 4) > end - world.time.ticks {
                world.warp_asked -= 1;
            }
            idle(&mut world, 1);
        }
        assert_eq!(world.time.ticks, end);
        assert!(matches!(world.ship.motion, Motion::Coast(_)));
        assert!((energy(&world) / before - 1.0).abs() < 1e-12, "{}", energy(&world) / before - 1.0);
        finals.push(bits(&world));
    }
    assert!(finals.windows(2).all(|w| w[0] == w[1]));
}

#[test]
fn twenty_minutes_of_coasting_end_in_the_same_bits_at_each_of_the_warp_levels() {
    let end = START.ticks + 20 * 60 * 60;
    let finals = (0..WARP_QUARTERS.len()).map(|level| {
        let mut world = orbiting(&earth(), 400e3, 0.9, 1.0);
        world.warp_asked = u8::try_from(level).unwrap();
        while world.time.ticks < end {
            while i64::from(WARP_QUARTERS[usize::from(world.warp_asked)] / 4) > end - world.time.ticks {
                world.warp_asked -= 1;
            }
            idle(&mut world, 1);
        }
        (world.time.ticks, bits(&world))
    });
    let finals: Vec<_> = finals.collect();
    assert!(finals.iter().all(|f| *f == finals[0] && f.0 == end), "same bits from ¼× to 100,000×");
}

#[test]
fn warp_falls_before_the_air_is_reached() {
    let mut entries = Vec::new();
    for level in [4, 6, 8, 10] {
        let mut world = orbiting(&earth(), 400e3, 0.3, 0.97);
        world.warp_asked = level;
        let mut last = 0;
        while matches!(world.ship.motion, Motion::Coast(_)) {
            let before = world.time.ticks;
            idle(&mut world, 1);
            last = world.time.ticks - before;
        }
        assert!(last <= 4, "the clock still ran at {last} ticks a tick");
        assert_eq!(world.warp_asked, WARP_ONE);
        while world.time.ticks % 64 != 0 {
            idle(&mut world, 1);
        }
        let altitude = world.readout().altitude_m;
        assert!((198e3..200e3).contains(&altitude), "entered at {altitude}");
        entries.push(bits(&world));
    }
    assert!(entries.windows(2).all(|w| w[0] == w[1]), "same bits at every warp");
}

#[test]
fn a_flyby_changes_spheres_at_the_same_ticks_at_every_warp() {
    let system = planet_and_moon();
    let end = START.ticks + 60 * 86_400 * 8;
    let mut finals = Vec::new();
    for level in [7, 8, 9, 10] {
        // A transfer that meets the moon after some three days and is thrown by it.
        let mut world = moving(&system, torch(), 400e3, DVec3::new(0.0, 0.0, 0.0));
        let r = 6.771e6_f64;
        let aim = 2.289;
        let (s, c) = libm::sincos(-aim);
        let velocity = DVec3::new(-s, c, 0.0) * (2.0 * 3.986_004_4e14 * (1.0 / r - 1.0 / 4.1e8)).sqrt();
        let state = State { position: Position::new(DVec3::new(c, s, 0.0) * r), velocity: Velocity::new(velocity) };
        world.ship.motion = Motion::Fly(Rigid { state, ..world.rigid() });
        world.enter_path();
        world.warp_asked = level;
        let mut spheres = vec![world.ship.body()];
        while world.time.ticks < end {
            while i64::from(WARP_QUARTERS[usize::from(world.warp_asked)] / 4) > end - world.time.ticks {
                world.warp_asked -= 1;
            }
            idle(&mut world, 1);
            if spheres.last() != Some(&world.ship.body()) {
                spheres.push(world.ship.body());
                world.warp_asked = level;
            }
        }
        assert_eq!(spheres, [BodyId(0), BodyId(1), BodyId(0)], "level {level}");
        finals.push(bits(&world));
    }
    assert!(finals.windows(2).all(|w| w[0] == w[1]), "same bits at every warp");
}

#[test]
fn burning_the_tanks_gives_tsiolkovskys_speed() {
    let far = lone_body(1.0, 1.0, 1e9, None);
    let spec = torch();
    let expected = spec.main_engine.exhaust_velocity_m_s * libm::log(spec.full_mass_kg() / spec.mass.dry_kg);
    let mut world = moving(&far, spec, 1e12, DVec3::Y * 1e-9);
    act(&mut world, Action::Throttle(u16::MAX));
    while world.ship.propellant_kg > 0.0 {
        idle(&mut world, 1);
    }
    let speed = world.rigid().state.velocity.length();
    assert!((speed / expected - 1.0).abs() < 1e-7, "{speed} {expected}");
    idle(&mut world, 1);
    assert!(matches!(world.ship.motion, Motion::Coast(_)), "an empty ship coasts");
}

#[test]
fn every_hold_settles_and_then_coasts() {
    use Hold::{AntiNormal, Normal, Prograde, RadialIn, RadialOut, Retrograde, SurfacePrograde, SurfaceRetrograde, SurfaceVertical};
    for hold in [Prograde, Retrograde, Normal, AntiNormal, RadialOut, RadialIn, SurfacePrograde, SurfaceRetrograde, SurfaceVertical] {
        let mut world = orbiting(&earth(), 400e3, 0.9, 1.0);
        act(&mut world, Action::Hold(hold));
        let mut ticks = 0;
        while !matches!(world.ship.motion, Motion::Coast(_)) {
            idle(&mut world, 1);
            ticks += 1;
            assert!(ticks < 60 * 20, "{hold:?} does not settle");
        }
        // Half a revolution later it still points where it should, without having been stepped.
        world.advance(60 * 2772, Axes::default());
        let rigid = world.rigid();
        let frame = attitude::hold_frame(hold, &world.local(&rigid), None).unwrap();
        let axis = if hold == SurfaceVertical { DVec3::Y } else { DVec3::NEG_Z };
        let off = attitude::rotation_vector(attitude::arc(rigid.icrf_from_hull.0 * axis, frame * axis, DVec3::X)).length();
        assert!(off < 2e-3, "{hold:?} is off by {off}");
    }
}

#[test]
fn the_stick_turns_and_released_it_holds_exactly() {
    let mut world = orbiting(&earth(), 400e3, 0.9, 1.0);
    let turn = Commands { axes: Axes { pitch: 20_000, yaw: -9_000, roll: 30_000, ..Axes::default() }, actions: Vec::new() };
    for _ in 0..120 {
        world.tick(&turn);
    }
    let rate = world.rigid().rate.0;
    let wanted = 20_000.0 / 32_767.0 * world.ship.spec.attitude.max_rate_deg_s.x * DEG;
    assert!((rate.x - wanted).abs() < 1e-9, "stick commands a rate: {rate}");
    idle(&mut world, 180);
    assert_eq!(world.rigid().rate.0, DVec3::ZERO);
    assert!(matches!(world.ship.motion, Motion::Coast(_)));
    let attitude = world.rigid().icrf_from_hull;
    idle(&mut world, 600);
    assert_eq!(attitude, world.rigid().icrf_from_hull, "no drift, no limit cycle");
}

#[test]
fn belly_first_fall_reaches_terminal_velocity() {
    let system = earth();
    let ground = system.bodies[0].spin.angular_velocity(START).0.cross(DVec3::X * 6.374e6);
    let mut world = moving(&system, torch(), 3000.0, ground - DVec3::X * 60.0);
    idle(&mut world, 60 * 20);
    let rigid = world.rigid();
    let local = world.local(&rigid);
    let aero = &world.ship.spec.aero;
    let area = aero.reference_area_m2 * (aero.cd0 + aero.belly_drag);
    let expected = (2.0 * world.ship.mass_kg() * local.gravity().length() / (local.air.density_kg_m3 * area)).sqrt();
    // Sinking into ever denser air it is always a little too fast: by v²/4gH, some 1.5 %.
    let ratio = -local.vertical_m_s() / expected;
    assert!((1.0..1.02).contains(&ratio), "{} {expected}", local.vertical_m_s());
}

#[test]
fn hover_stops_over_the_ground_and_vertical_speed_is_held() {
    let system = earth();
    let ground = system.bodies[0].spin.angular_velocity(START).0.cross(DVec3::X * 6.374e6);
    let mut world = moving(&system, torch(), 3000.0, ground + DVec3::new(-80.0, 40.0, 90.0));
    act(&mut world, Action::Guidance(Guidance::Hover));
    idle(&mut world, 60 * 60);
    assert!(world.readout().surface_speed_m_s < 0.05, "{:?}", world.readout());
    act(&mut world, Action::Guidance(Guidance::VerticalSpeed { cm_s: -750 }));
    idle(&mut world, 60 * 20);
    let r = world.readout();
    assert!((r.vertical_speed_m_s + 7.5).abs() < 0.05 && (r.surface_speed_m_s - 7.5).abs() < 0.05, "{r:?}");
}

/// Flies the automatic landing to rest. The spot is reached within metres on smooth ground; the bars are far wider.
fn land(mut world: World, lat_deg: i32, lon_deg: i32) -> World {
    let spot = Spot { lat_udeg: lat_deg * 1_000_000, lon_udeg: lon_deg * 1_000_000 };
    act(&mut world, Action::Target(Some(Target { body: BodyId(0), spot: Some(spot) })));
    world.warp_asked = 10;
    act(&mut world, Action::Guidance(Guidance::Land));
    for _ in 0..60_000 {
        idle(&mut world, 1);
        if matches!(world.ship.motion, Motion::Landed(_) | Motion::Crashed(_)) {
            break;
        }
    }
    let r = world.readout();
    assert_eq!(r.situation, Situation::Landed, "{r:?}");
    assert!(r.target.unwrap().ground_distance_m.unwrap() < 100.0, "{r:?}");
    assert!(r.last_contact.unwrap().0 < 2.0, "{r:?}");
    let [_, pitch, roll] = r.heading_pitch_roll_rad;
    assert!(pitch.abs() < 1.0 * DEG && roll.abs() < 1.0 * DEG, "upright: {r:?}");
    assert_eq!((r.throttle, r.guidance, r.warp_asked), (0.0, Guidance::Manual, WARP_ONE));
    world
}

#[test]
fn lands_on_an_airless_body_from_orbit() {
    land(orbiting(&moon(), 400e3, 1.1, 1.0), 20, -75);
}

#[test]
fn lands_through_air_from_orbit_and_takes_off_again() {
    let mut world = land(orbiting(&earth(), 400e3, 0.9, 1.0), 37, 140);
    act(&mut world, Action::Throttle(u16::MAX / 2));
    idle(&mut world, 300);
    assert!(world.readout().vertical_speed_m_s > 20.0, "{:?}", world.readout());
}

#[test]
fn a_spot_beyond_the_propellant_is_refused() {
    let capsule = toml::from_str(include_str!("../../../assets/ships/capsule.toml")).unwrap();
    let mut world = moving(&earth(), capsule, 400e3, DVec3::new(0.0, 7668.0, 0.0));
    act(&mut world, Action::Guidance(Guidance::Land));
    idle(&mut world, 600);
    assert!(world.readout().guidance_phase.starts_with("Out of reach"), "{}", world.readout().guidance_phase);
    assert!(matches!(world.ship.motion, Motion::Coast(_)), "nothing is burnt for it");
}
