//! The bubble measured: creep, re-anchoring, fall, impacts, and exactness of a restart.

use super::*;
use crate::rigid::gear::Leg;
use crate::rigid::sweep::tests::Hills;
use crate::space::sphere;
use crate::terrain::Relief;
use crate::terrain::relief::Maps;
use crate::terrain::spec::{CraterSpec, NoiseSpec, ReliefSpec};
use crate::time::TICK_S;
use glam::{DMat3, DQuat};

const GM: f64 = 3.986_004_418e14;
const SPIN: RotatingFrame = RotatingFrame { omega_rad_s: DVec3::new(0.0, 0.0, 7.292_115e-5) };

fn pull(p: Position<Fixed>) -> DVec3 {
    let r = p.0.length();
    p.0 * (-GM / (r * r * r))
}

fn lander() -> Chassis {
    let leg = |x: f64, z: f64| Leg {
        hip_m: DVec3::new(0.7 * x, -1.0, 0.7 * z),
        foot_m: DVec3::new(x, -4.0, z),
        stroke_m: 0.8,
        stiffness_n_m: 4.0e5,
        damping_n_s_m: 8.0e4,
        friction: 0.8,
    };
    Chassis {
        half_size_m: DVec3::new(2.0, 2.0, 5.0),
        middle_m: DVec3::ZERO,
        friction: 0.6,
        legs: vec![leg(3.5, 4.0), leg(-3.5, 4.0), leg(3.5, -4.0), leg(-3.5, -4.0)],
        gear_limit_m_s: 6.0,
        slide_limit_m_s: 20.0,
        hull_limit_m_s: 2.0,
    }
}

const MASS: MassProps = MassProps { mass_kg: 30_000.0, inertia_kg_m2: DVec3::new(3.0e5, 3.2e5, 1.2e5) };

struct Rig {
    ground: Hills,
    chassis: Chassis,
    loads: Loads,
    gear_down: bool,
    bubble: Bubble,
    contact: Contact,
    state: BodyState,
}

impl Rig {
    /// A ship upright (as the slope stands where `tilted`), its centre of mass `height_m` above the ground.
    fn new(ground: Hills, height_m: f64) -> Self {
        let up = ground.about;
        let (e, u, n) = sphere::east_up_north(up);
        let at = up * (ground.radius_m + ground.surface_m(up) + height_m);
        Self {
            ground,
            chassis: lander(),
            loads: Loads::default(),
            gear_down: true,
            bubble: Bubble::default(),
            contact: Contact::default(),
            state: BodyState {
                position: Position::new(at),
                fixed_from_hull: Rotation::new(DQuat::from_mat3(&DMat3::from_cols(e, u, -n))),
                velocity: Velocity::ZERO,
                angular: Vector::ZERO,
            },
        }
    }
    fn tick(&mut self) -> Report {
        let ship = Ship {
            chassis: &self.chassis,
            mass: MASS,
            loads: self.loads,
            gear_down: self.gear_down,
            flown: self.loads != Loads::default(),
        };
        let place = Place { surface: &self.ground, frame: SPIN, gravity: &pull };
        self.bubble.tick(&mut self.contact, &mut self.state, &ship, &place, TICK_S).unwrap()
    }
    fn bits(&self) -> Vec<u64> {
        let s = &self.state;
        let q = s.fixed_from_hull.0;
        let mut v: Vec<u64> = [s.position.0, s.velocity.0, s.angular.0].iter().flat_map(|a| a.to_array()).map(f64::to_bits).collect();
        v.extend(q.to_array().map(f64::to_bits));
        v
    }
}

#[test]
fn rests_on_slopes_without_creep() {
    for degrees in [0.0, 5.0, 10.0, 15.0, 20.0] {
        let about = sphere::direction_of_lat_lon(0.6, 0.5 + degrees);
        let mut rig = Rig::new(Hills::slope(degrees, about), 4.2 + 3.6 * libm::tan(degrees.to_radians()));
        if degrees > 15.0 {
            // Let down along the slope: level, the downhill feet would slap down harder than the gear bears.
            let tilt = DQuat::from_axis_angle(sphere::east_up_north(about).0, degrees.to_radians());
            rig.state.fixed_from_hull = Rotation::new(tilt * rig.state.fixed_from_hull.0);
        }
        let mut slept = None;
        for t in 0..1200 {
            let r = rig.tick();
            assert!(r.crash_m_s.is_none(), "{degrees}°: crash at {:?}", r.crash_m_s);
            if r.at_rest && slept.is_none() {
                slept = Some(t);
            }
        }
        let slept = slept.unwrap_or_else(|| panic!("{degrees}°: not at rest after 20 s, v = {:?}", rig.state.velocity));
        // Kept awake on purpose: a sleeping ship cannot creep at all.
        let from = rig.state.position;
        for _ in 0..3600 {
            rig.tick();
        }
        let creep_mm = (rig.state.position - from).length() * 1e3;
        println!("slope {degrees}°: quiet after {:.1} s, creep {creep_mm:.6} mm/min", slept as f64 / 60.0);
        assert!(creep_mm < 0.1, "{degrees}°: creeps {creep_mm} mm in a minute");
    }
}

#[test]
fn slides_down_what_friction_cannot_hold() {
    let mut rig = Rig::new(Hills::slope(45.0, DVec3::X), 6.0);
    rig.chassis.slide_limit_m_s = 1e3;
    rig.chassis.hull_limit_m_s = 1e3;
    rig.chassis.gear_limit_m_s = 1e3;
    let from = rig.state.position;
    for _ in 0..300 {
        rig.tick();
    }
    assert!((rig.state.position - from).length() > 5.0);
}

#[test]
fn a_fall_agrees_with_kepler() {
    // Radial and oblique falls over 10 s in the turning frame against the universal solution in inertial axes.
    for v0 in [DVec3::ZERO, DVec3::new(-20.0, 40.0, 30.0), DVec3::new(-300.0, 2_900.0, 100.0)] {
        let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 4_000.0);
        rig.state.velocity = Velocity::new(v0);
        let (p, v, ..) = SPIN.to_centred(DQuat::IDENTITY, &rig.state);
        for _ in 0..600 {
            assert!(!rig.tick().touching);
        }
        let turned = DQuat::from_rotation_z(SPIN.omega_rad_s.z * 10.0);
        let (p1, v1, ..) = SPIN.to_centred(turned, &rig.state);
        let (pk, vk) = series(p.0, v.0, 10.0);
        let (dp, dv) = ((p1.0 - pk).length(), (v1.0 - vk).length());
        println!("fall from {v0}: {dp:.3e} m, {dv:.3e} m/s after 10 s");
        assert!(dp < 2e-5 && dv < 5e-6, "{v0}: {dp} m, {dv} m/s");
    }
}

/// Two-body motion by the classical fourth-order Runge–Kutta method at 1 ms, good to nanometres over 10 s.
fn series(mut p: DVec3, mut v: DVec3, t: f64) -> (DVec3, DVec3) {
    let a = |p: DVec3| p * (-GM / (p.length_squared() * p.length()));
    let h = 1e-3;
    let n = (t / h).round();
    let mut k = 0.0;
    while k < n {
        let (k1p, k1v) = (v, a(p));
        let (k2p, k2v) = (v + k1v * (h / 2.0), a(p + k1p * (h / 2.0)));
        let (k3p, k3v) = (v + k2v * (h / 2.0), a(p + k2p * (h / 2.0)));
        let (k4p, k4v) = (v + k3v * h, a(p + k3p * h));
        p += (k1p + 2.0 * (k2p + k3p) + k4p) * (h / 6.0);
        v += (k1v + 2.0 * (k2v + k3v) + k4v) * (h / 6.0);
        k += 1.0;
    }
    (p, v)
}

#[test]
fn a_thousand_anchors_move_nothing() {
    // A hover at 9 m/s over flat ground, low enough that the mesh is held: each 8 cells the anchor moves.
    let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 8.0);
    let hold = |rig: &mut Rig| {
        let up = rig.state.position.0.normalize();
        let g = pull(rig.state.position) + SPIN.fictitious(rig.state.position.0, rig.state.velocity.0);
        let climb = rig.state.velocity.0.dot(up);
        let force = (up * (-g.dot(up) - climb) - (g - up * g.dot(up))) * MASS.mass_kg;
        rig.loads.force_n = rig.state.fixed_from_hull.inverse().vector(Vector::new(force));
    };
    rig.state.velocity = Velocity::xyz(0.0, 58.0, 3.0);
    let (mut anchors, mut worst_p, mut worst_v): (u32, f64, f64) = (0, 0.0, 0.0);
    let mut key = None;
    for _ in 0..1_000_000 {
        hold(&mut rig);
        // The same tick with the old anchor kept from moving, in exact free motion: the reference without any mesh.
        let mut reference = rig.state;
        let ship = Ship { chassis: &rig.chassis, mass: MASS, loads: rig.loads, gear_down: true, flown: true };
        let place = Place { surface: &rig.ground, frame: SPIN, gravity: &pull };
        for _ in 0..SUBSTEPS {
            drift(&mut reference, &ship, &place, DVec3::ZERO, DVec3::ZERO, false, TICK_S / f64::from(SUBSTEPS));
        }
        assert!(!rig.tick().touching);
        if rig.contact.key != key {
            key = rig.contact.key;
            anchors += 1;
            worst_p = worst_p.max((rig.state.position - reference.position).length());
            worst_v = worst_v.max((rig.state.velocity.0 - reference.velocity.0).length());
        }
        if anchors > 1000 {
            break;
        }
    }
    println!("{anchors} anchors: worst jump {worst_p:.3e} m, {worst_v:.3e} m/s");
    assert!(anchors > 1000 && worst_p < 1e-6 && worst_v < 1e-6);
}

#[test]
fn a_foot_feels_no_seam() {
    // The same ship on the same spot, on two patches that share the ground: the legs' accelerations differ by rounding only.
    let run = |shift: i32| {
        let ground = Hills { amplitude_m: 2.0, wave_rad: 1e-6, ..Hills::earth() };
        let mut rig = Rig::new(ground, 3.6);
        let key = PatchKey::for_ship(None, rig.ground.radius_m, rig.ground.about);
        rig.contact.key = Some(PatchKey { face: key.face, middle: [key.middle[0] + shift, key.middle[1] - shift] });
        rig.tick();
        assert_eq!(rig.contact.key.map(|k| k.middle[0] - key.middle[0]), Some(shift));
        rig.state
    };
    let (a, b) = (run(0), run(6));
    let (dp, dv) = ((a.position - b.position).length(), (a.velocity.0 - b.velocity.0).length());
    println!("seam: {dp:.3e} m, {dv:.3e} m/s");
    assert!(a.velocity.length() > 1e-3 && dp < 1e-6 && dv < 1e-5);
}

#[test]
fn a_restart_in_mid_bounce_gives_the_same_bits() {
    let mut rig = Rig::new(Hills { amplitude_m: 2.0, wave_rad: 2e-6, ..Hills::earth() }, 5.5);
    rig.state.velocity = Velocity::xyz(-3.0, 1.0, 0.5);
    rig.state.angular = Vector::xyz(0.02, -0.1, 0.05);
    rig.chassis.hull_limit_m_s = 1e3;
    let mut touched = false;
    for _ in 0..40 {
        touched |= rig.tick().touching;
    }
    assert!(touched);
    let mut other = Rig::new(Hills { amplitude_m: 2.0, wave_rad: 2e-6, ..Hills::earth() }, 5.5);
    other.chassis.hull_limit_m_s = 1e3;
    other.state = rig.state;
    other.contact = rig.contact.clone();
    for t in 0..600 {
        rig.tick();
        other.tick();
        assert_eq!(rig.bits(), other.bits(), "tick {t}");
    }
    assert_eq!(rig.contact, other.contact);
    // The same in every build profile: compare by eye, or by a replay.
    let digest = rig.bits().iter().fold(0_u64, |h, b| h.rotate_left(7) ^ b);
    println!("state after the bounce: {digest:016x}");
}

#[test]
fn breaks_above_tolerance_and_not_below() {
    for (speed, breaks) in [(2.5, false), (5.5, false), (6.5, true), (30.0, true)] {
        let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 4.02);
        rig.state.velocity = Velocity::xyz(-speed, 0.0, 0.0);
        let crash = (0..300).find_map(|_| rig.tick().crash_m_s);
        assert_eq!(crash.is_some(), breaks, "{speed} m/s: {crash:?}");
        assert!(crash.is_none_or(|c| (c - speed).abs() < 0.3), "{speed} m/s: {crash:?}");
    }
    // Gear up: the belly bears 2 m/s, not 4.
    for (speed, breaks) in [(1.0, false), (4.0, true)] {
        let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 2.05);
        rig.gear_down = false;
        rig.state.velocity = Velocity::xyz(-speed, 0.0, 0.0);
        let crash = (0..120).find_map(|_| rig.tick().crash_m_s);
        assert_eq!(crash.is_some(), breaks, "belly at {speed} m/s: {crash:?}");
        assert!(crash.is_none_or(|c| (c - speed).abs() < 0.3), "belly at {speed} m/s: {crash:?}");
    }
}

#[test]
fn rests_on_its_belly() {
    let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 2.05);
    rig.gear_down = false;
    let rest = (0..600).any(|_| rig.tick().at_rest);
    let height = rig.state.position.length() - rig.ground.radius_m;
    assert!(rest && (height - 2.0).abs() < 0.03, "at rest: {rest}, {height} m, v = {:?}", rig.state.velocity);
}

#[test]
fn a_fast_ship_stops_at_the_surface() {
    for speed in [61.0, 800.0, 3_000.0, 12_000.0] {
        for below in [1.0_f64, 15.0, 60.0, 90.0] {
            let mut rig = Rig::new(Hills::earth(), 150.0);
            let (e, u, _) = sphere::east_up_north(rig.ground.about);
            let a = below.to_radians();
            rig.state.velocity = Velocity::new((e * libm::cos(a) - u * libm::sin(a)) * speed);
            let crash = (0..40_000).find_map(|_| rig.tick().crash_m_s);
            assert!(crash.is_some(), "{speed} m/s at {below}°");
            let deepest = rig
                .chassis
                .extremes(true)
                .iter()
                .fold(f64::INFINITY, |d, m| d.min(rig.ground.clearance_m(rig.state.position.0 + rig.state.fixed_from_hull.raw(*m))));
            assert!(deepest.abs() < 0.02, "{speed} m/s at {below}°: {deepest} m from the surface");
        }
    }
}

#[test]
fn wakes_and_leaves_by_thrust() {
    let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 4.0);
    assert!((0..600).any(|_| rig.tick().at_rest));
    rig.loads.force_n = Vector::xyz(0.0, 1.5 * 9.8 * MASS.mass_kg, 0.0);
    for _ in 0..600 {
        assert!(!rig.tick().at_rest);
    }
    assert!(rig.state.position.length() - rig.ground.radius_m > 200.0 && !rig.bubble.has_ground());
}

/// A cratered moon, as rough as they come.
fn moon() -> Relief {
    let spec = ReliefSpec {
        noise: Some(NoiseSpec { wavelength_m: 2e5, amplitude_m: 900.0, plain_amplitude_m: 90.0, gain: 0.48, ridged: 0.2, seed: 5 }),
        craters: Some(CraterSpec {
            largest_radius_m: 1e5,
            smallest_radius_m: 2.0,
            density: 0.8,
            depth_ratio: 0.2,
            complex_radius_m: 7500.0,
            seed: 9,
        }),
        ..ReliefSpec::default()
    };
    Relief::new(1.7374e6, spec, Maps::default()).unwrap()
}

#[test]
fn lands_on_real_relief_and_lies_still() {
    let moon = moon();
    let pull = |p: Position<Fixed>| p.0 * (-4.9028e12 / (p.0.length_squared() * p.0.length()));
    let place = Place { surface: &moon, frame: RotatingFrame { omega_rad_s: DVec3::Z * 2.66e-6 }, gravity: &pull };
    let chassis = lander();
    let ship = Ship { chassis: &chassis, mass: MASS, loads: Loads::default(), gear_down: true, flown: false };
    let mut rested = 0;
    for k in 0..8 {
        let up = sphere::direction_of_lat_lon(0.13 * f64::from(k) - 0.5, 0.7 * f64::from(k));
        let (e, u, n) = sphere::east_up_north(up);
        // As a landing guidance would come down: level, a little fast, clear of the highest ground under its feet.
        let top =
            [e, -e, n, -n].iter().map(|d| moon.surface_m((up + *d * (4.0 / 1.7374e6)).normalize())).fold(moon.surface_m(up), f64::max);
        let mut state = BodyState {
            position: Position::new(up * (1.7374e6 + top + 4.1)),
            fixed_from_hull: Rotation::new(DQuat::from_mat3(&DMat3::from_cols(e, u, -n))),
            velocity: Velocity::new(u * -1.0 + e * 0.3),
            angular: Vector::ZERO,
        };
        let (mut bubble, mut contact) = (Bubble::default(), Contact::default());
        let mut crash = None;
        let still = (0..1800).find(|_| {
            let r = bubble.tick(&mut contact, &mut state, &ship, &place, TICK_S).unwrap();
            crash = crash.or(r.crash_m_s);
            r.at_rest || crash.is_some()
        });
        if still.is_some() && crash.is_none() {
            rested += 1;
            let mut wait = |ticks: usize| {
                for _ in 0..ticks {
                    bubble.tick(&mut contact, &mut state, &ship, &place, TICK_S).unwrap();
                }
                state.position
            };
            // What swings in the springs when the ship would be frozen, dies out first.
            let from = wait(300);
            wait(600);
            let creep_mm = (state.position - from).length() * 1e3;
            println!("spot {k}: at rest after {:?} ticks, {creep_mm:.5} mm in 10 s", still);
            assert!(creep_mm < 0.1);
        } else {
            println!("spot {k}: {still:?}, crash {crash:?}, {:?}", state.velocity);
        }
        assert!(still.is_some(), "spot {k} neither rests nor breaks");
    }
    assert!(rested >= 5, "{rested} of 8");
}

#[test]
#[ignore = "prints run times"]
fn costs() {
    let time = |name: &str, n: u32, f: &mut dyn FnMut()| {
        let start = std::time::Instant::now();
        for _ in 0..n {
            f();
        }
        println!("{name}: {:.1} µs", start.elapsed().as_secs_f64() * 1e6 / f64::from(n));
    };
    let hills = Hills::earth();
    let key = PatchKey::for_ship(None, hills.radius_m, hills.about);
    let patch = Patch::build(&hills, key, 9.5, None).unwrap();
    time("patch", 20, &mut || drop(Patch::build(&hills, key, 9.5, None)));
    time("patch, shifted", 20, &mut || {
        let key = PatchKey { face: key.face, middle: [key.middle[0] + 8, key.middle[1]] };
        drop(Patch::build(&hills, key, 9.5, Some(&patch)));
    });
    let (moon, d) = (moon(), DVec3::new(0.6, 0.0, 0.8));
    let key = PatchKey::for_ship(None, moon.radius_m, d);
    time("patch of the moon", 10, &mut || drop(Patch::build(&moon, key, 9.5, None)));
    time("height of the moon", 1000, &mut || assert!(moon.surface_m(d).is_finite()));
    let mut rig = Rig::new(Hills::slope(10.0, DVec3::X), 5.0);
    for _ in 0..300 {
        rig.tick();
    }
    time("tick on its feet", 600, &mut || {
        rig.tick();
    });
    let mut rig = Rig::new(Hills { amplitude_m: 0.0, ..Hills::earth() }, 2.05);
    rig.gear_down = false;
    time("tick on its belly", 600, &mut || {
        rig.tick();
    });
}
