//! Thirty days of coasting past a moon: the same bits however fast the clock runs, however often somebody looks, saved or not.

use super::*;
use crate::mode::window::clock::Clock;
use crate::save;

const END: i64 = START.ticks + 60 * 86_400 * 30;

/// Perigee 20,000 km, and an apogee past which the moon comes: it changes spheres on the way.
fn past_the_moon() -> World {
    let mut world = moving(&planet_and_moon(), torch(), 400e3, DVec3::ZERO);
    let (s, c) = libm::sincos(-2.05);
    let speed = (2.0_f64 * 3.986_004_4e14 * (1.0 / 2.0e7 - 1.0 / 4.15e8)).sqrt();
    let state = State { position: Position::new(DVec3::new(c, s, 0.02) * 2.0e7), velocity: Velocity::new(DVec3::new(-s, c, 0.01) * speed) };
    world.ship.motion = Motion::Fly(Rigid { state, ..world.rigid() });
    world.enter_path();
    world
}

/// One tick of the session at `level`, or at the level that does not pass `end`.
fn tick_at(world: &mut World, level: u8, end: i64) {
    world.warp_asked = level;
    while i64::from(WARP_QUARTERS[usize::from(world.warp_asked)] / 4) > end - world.time.ticks {
        world.warp_asked -= 1;
    }
    world.tick(&Commands::default());
}

fn at_level(level: u8) -> World {
    let mut world = past_the_moon();
    while world.time.ticks < END {
        tick_at(&mut world, level, END);
    }
    world
}

#[test]
fn the_same_bits_at_every_warp() {
    let million = at_level(11);
    assert!(matches!(million.ship.motion, Motion::Coast(_)));
    assert_eq!(bits(&at_level(8)), bits(&million), "10,000x");
    // Two days of it at 100x, and ten minutes at 1x before and after the moon.
    let mut slow = past_the_moon();
    let mut hosts = vec![slow.ship.body()];
    while slow.time.ticks < END {
        let day = (slow.time.ticks - START.ticks) / (60 * 86_400);
        let second = (slow.time.ticks - START.ticks) / 60 % 86_400;
        let level = match (day, second) {
            (1 | 9, 1_000..1_600) => 2,
            (3 | 4, _) => 6,
            _ => 8,
        };
        tick_at(&mut slow, level, END);
        if hosts.last() != Some(&slow.ship.body()) {
            hosts.push(slow.ship.body());
        }
    }
    assert_eq!(bits(&slow), bits(&million), "1x and 100x");
    assert!(hosts.len() >= 3, "thrown by the moon: {hosts:?}");
}

#[test]
fn the_same_bits_at_every_frame_rate() {
    let expected = bits(&at_level(8));
    for rate in [24.0, 60.0, 144.0] {
        let (mut world, mut clock) = (past_the_moon(), Clock::default());
        let mut farthest: f64 = 0.0;
        while world.time.ticks < END {
            for _ in 0..clock.advance(1.0 / rate) {
                if world.time.ticks < END {
                    tick_at(&mut world, 8, END);
                }
            }
            // Who draws looks at everything, once a frame.
            farthest = farthest.max(world.rigid().state.position.length());
            assert!(world.readout().altitude_m.is_finite());
        }
        assert_eq!(bits(&world), expected, "{rate} frames a second");
        assert!(farthest > 2.0e8);
    }
}

#[test]
fn the_same_bits_across_saves_and_loads() {
    let mut world = past_the_moon();
    let mut ticks = 0;
    while world.time.ticks < END {
        tick_at(&mut world, 8, END);
        ticks += 1;
        if ticks % 97 == 0 {
            let loaded = save::round_trip(&world).unwrap();
            assert_eq!(loaded.fields(), world.fields());
            world = loaded;
        }
    }
    assert_eq!(bits(&world), bits(&at_level(8)));
}

#[test]
fn a_save_from_when_paths_were_conics_goes_on_from_where_the_conic_led() {
    use crate::save::v1::{MotionV1, SaveV1};
    let world = past_the_moon();
    let mut old = SaveV1::from(&world);
    let MotionV1::Coast { knot, epoch_ticks, wake_ticks, .. } = &mut old.ship.motion else { panic!("coasts") };
    (*knot, *epoch_ticks, *wake_ticks) = (None, START.ticks - 60 * 3_600, Some(START.ticks + 1));
    let loaded = old.restore(&world.system, &world.ship.spec).unwrap();
    let before = world.rigid().state;
    let conic = engine::orbit::kepler::propagate(3.986_004_4e14, &before, 3_600.0);
    assert!((loaded.rigid().state.position - conic.position).length() < 1e-6);
    assert!(matches!(loaded.ship.motion, Motion::Coast(_)));
}
