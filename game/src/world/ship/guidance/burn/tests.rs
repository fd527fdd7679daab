//! Burns flown on a bare round world: by the autopilot at several warps, by hand, across a save.

use super::*;
use crate::command::{Action, Axes, Commands, WARP_ONE};
use crate::save::{self, fixture};
use crate::world::World;
use crate::world::ship::{Motion, Rigid};
use engine::orbit::{BodyId, kepler};
use engine::space::{Rotation, Vector};

/// A ship on a circle 400 km up, and a node so many seconds ahead.
fn planned(after_s: f64, dv_m_s: DVec3) -> World {
    let speed = (3.986e14_f64 / 6.771e6).sqrt();
    let state = State { position: Position::xyz(6.771e6, 0.0, 0.0), velocity: Velocity::xyz(0.0, speed, 0.0) };
    let rigid = Rigid { body: BodyId(1), state, icrf_from_hull: Rotation::IDENTITY, rate: Vector::ZERO };
    let mut world = fixture::world(Motion::Fly(rigid));
    let node = Node::new(world.time.plus(ticks(after_s)), dv_m_s);
    act(&mut world, &[Action::AddNode(node)]);
    assert_eq!(world.ship.nodes, [node]);
    world
}

fn act(world: &mut World, actions: &[Action]) {
    world.tick(&Commands { actions: actions.to_vec(), ..Commands::default() });
}

fn fly(world: &mut World) {
    for _ in 0..200_000 {
        world.tick(&Commands::default());
        if world.ship.nodes.is_empty() && matches!(world.ship.motion, Motion::Coast(_)) {
            return;
        }
    }
    panic!("the burn was not flown: {:?} {:?}", world.ship.burn, world.ship.nodes);
}

/// The state at a moment, on the path that the ship is on now.
fn at(world: &World, t: SimTime) -> State<Centred> {
    let rigid = world.rigid();
    kepler::propagate(3.986e14, &rigid.state, t.since(world.time))
}

#[test]
fn the_autopilot_flies_a_burn_to_a_millimetre_a_second_at_every_warp() {
    for dv in [DVec3::new(80.0, 0.0, 0.0), DVec3::new(-3.0, 250.0, -60.0), DVec3::new(0.0, 0.0, 0.4)] {
        let mut bits = Vec::new();
        for level in [WARP_ONE, 6, 8, 10] {
            let mut world = planned(1_500.0, dv);
            let node = world.ship.nodes[0];
            let before = at(&world, node.at);
            act(&mut world, &[Action::Guidance(Guidance::Node), Action::Warp(level)]);
            if level != WARP_ONE || dv.x > 0.0 {
                fly(&mut world);
                let after = at(&world, node.at);
                // An impulse at the node gives this; a burn of seconds about it moves the place by half its length squared.
                let gained = after.velocity.0 - before.velocity.0;
                let length_s = world.ship.burn_s(dv.length());
                let slack = 2e-3 + 0.5 * 1.3e-6 * dv.length() * length_s * length_s;
                assert!((gained - node.dv(&before)).length() < slack, "{dv}: {gained} for {}", node.dv(&before));
                assert_eq!((world.ship.guidance, world.ship.throttle, world.ship.burn), (Guidance::Manual, 0, None));
                while world.time < node.at.plus(20_000) {
                    world.warp_asked = WARP_ONE;
                    world.tick(&Commands::default());
                }
                assert_eq!(world.time, node.at.plus(20_000));
                bits.push(world.rigid().state.position.0.to_array().map(f64::to_bits));
            }
        }
        assert!(bits.windows(2).all(|w| w[0] == w[1]), "same bits at every warp");
    }
}

#[test]
fn warp_falls_before_the_burn_and_a_hurry_ends_before_its_moment() {
    let mut world = planned(40_000.0, DVec3::new(10.0, 0.0, 0.0));
    let start = world.ship.burn_start(&world.ship.nodes[0]);
    act(&mut world, &[Action::WarpTo(Some(start))]);
    let mut most = 0;
    let mut took = 0;
    while world.warp_to.is_some() {
        world.tick(&Commands::default());
        most = most.max(world.warp);
        took += 1;
    }
    let left = start.since(world.time);
    assert!(most >= 7 && took < 60 * 20, "it was quick: {most} {took}");
    assert!((0.1..2.0).contains(&left) && world.warp_asked <= WARP_ONE, "{left} s before");
    // The choice of a level ends a hurry.
    let mut world = planned(40_000.0, DVec3::X);
    act(&mut world, &[Action::WarpTo(Some(start)), Action::Warp(5)]);
    assert_eq!((world.warp_to, world.warp_asked), (None, 5));
}

#[test]
fn by_hand_the_hold_points_along_the_burn_and_what_is_left_shrinks() {
    let mut world = planned(60.0, DVec3::new(0.0, 0.0, -30.0));
    act(&mut world, &[Action::Hold(Hold::Node)]);
    let left = |w: &World| w.readout().node.map(|n| n.left_m_s);
    for _ in 0..60 * 58 {
        world.tick(&Commands::default());
    }
    let nose = world.rigid().icrf_from_hull.0 * DVec3::NEG_Z;
    let aim = world.ship.burn.unwrap().aim;
    assert!(nose.dot(aim) > 0.999_99 && (world.readout().markers.node - DVec3::NEG_Z).length() < 5e-3);
    assert!((left(&world).unwrap() - 30.0).abs() < 1e-9);
    act(&mut world, &[Action::Throttle(20_000)]);
    let mut last = 30.0;
    for _ in 0..600 {
        world.tick(&Commands::default());
        match left(&world) {
            Some(now) => {
                assert!(now < last, "{now} {last}");
                last = now;
            }
            None => break,
        }
    }
    assert!(last < 1.0 && world.ship.nodes.is_empty() && world.ship.hold == Hold::Rate, "{last}");
}

#[test]
fn a_save_in_the_middle_of_a_burn_goes_on_with_the_same_bits() {
    let mut world = planned(100.0, DVec3::new(900.0, 0.0, 0.0));
    act(&mut world, &[Action::Guidance(Guidance::Node)]);
    for _ in 0..60 * 90 {
        world.tick(&Commands::default());
    }
    assert_eq!(world.ship.burn.unwrap().phase, Stage::Burn);
    let mut loaded = save::round_trip(&world).unwrap();
    let stick = Commands { axes: Axes { roll: 9_000, ..Axes::default() }, actions: Vec::new() };
    for _ in 0..60 * 40 {
        world.tick(&stick);
        loaded.tick(&stick);
    }
    assert_eq!(world.fields(), loaded.fields());
    assert!(world.ship.nodes.is_empty());
}

#[test]
fn a_list_of_nodes_is_kept_in_order_and_refuses_what_cannot_be() {
    let mut world = planned(1_000.0, DVec3::X);
    let later = |s: f64, w: &World| Node::new(w.time.plus(ticks(s)), DVec3::Y);
    let (a, b, past) = (later(500.0, &world), later(2_000.0, &world), later(-5.0, &world));
    act(&mut world, &[Action::AddNode(b), Action::AddNode(a), Action::AddNode(past), Action::DeleteNode(9), Action::ChangeNode(9, a)]);
    assert_eq!(world.ship.nodes.len(), 3);
    assert_eq!((world.ship.nodes[0], world.ship.nodes[2]), (a, b));
    act(&mut world, &[Action::ChangeNode(0, Node { at: b.at.plus(5), ..a }), Action::DeleteNode(0)]);
    assert_eq!(world.ship.nodes, [b, Node { at: b.at.plus(5), ..a }]);
    for _ in 0..40 {
        act(&mut world, &[Action::AddNode(b)]);
    }
    assert_eq!(world.ship.nodes.len(), crate::command::MOST_NODES);
    // One whose time has long passed is not flown.
    let mut world = planned(5.0, DVec3::X);
    for _ in 0..60 * 200 {
        world.tick(&Commands::default());
    }
    act(&mut world, &[Action::Guidance(Guidance::Node)]);
    world.tick(&Commands::default());
    assert_eq!((world.ship.guidance, world.ship.nodes.len()), (Guidance::Manual, 1));
}
