//! Tests of paths as a whole: against the two-body truth, across spheres of influence, at every way of asking, at the extremes.

use super::*;
use crate::orbit::ephemeris::{Ephemeris, Orbit, Path as Given};
use crate::orbit::field::{Bound, Reach, Source};
use crate::orbit::kepler;
use crate::space::{Position, Velocity};
use crate::units::{AU, DAY, KM};
use glam::DVec3;

const GM: f64 = 3.986_004_355_07e14;
const START: SimTime = SimTime::from_ticks(50_000_000_000);

fn state(r: [f64; 3], v: [f64; 3]) -> State<Centred> {
    State { position: Position::new(r.into()), velocity: Velocity::new(v.into()) }
}

/// One point mass: nothing but Kepler's motion.
fn lone(gm: f64, low_m: f64) -> (Model, Ephemeris) {
    let source = Source { gm_m3_s2: gm, ..Source::default() };
    let body = Body { source, soi_m: f64::INFINITY, low_m, ..Body::default() };
    // A bound so wide that 1PN does not count.
    (Model::new(vec![body], Bound { position_m: 1e30, over_s: 1.0 }), Ephemeris::default())
}

/// A planet with a moon on an ellipse, and the model of both.
fn planet_and_moon() -> (Model, Ephemeris) {
    let (planet, moon) = (GM, 4.902_800_118e12);
    let at = State { position: Position::xyz(3.6e8, 0.5e8, -0.2e8), velocity: Velocity::xyz(-120.0, 1_030.0, 60.0) };
    let rest = Given::Barycentric { epoch: START, state: State::default(), of_system: false };
    let orbit = |parent, gm_m3_s2, path| Orbit { parent, gm_m3_s2, path };
    let ephemeris =
        Ephemeris::new(vec![orbit(None, planet, rest), orbit(Some(BodyId(0)), moon, Given::FromParent { epoch: START, state: at })])
            .unwrap();
    let source = |i: u16, parent, gm_m3_s2| Source { parent, reach: ephemeris.reach(BodyId(i)), gm_m3_s2, ..Source::default() };
    let earth = Body { source: source(0, None, planet), soi_m: f64::INFINITY, low_m: 6.4e6, radius_m: 6.371e6, ..Body::default() };
    let luna = Body { source: source(1, Some(BodyId(0)), moon), soi_m: 6.6e7, low_m: 1.75e6, radius_m: 1.737e6, ..Body::default() };
    (Model::new(vec![earth, luna], Bound::COAST), ephemeris)
}

/// A ship that is thrown by the moon some three days later.
fn transfer() -> State<Centred> {
    let (r, top) = (6.771e6, 4.2e8);
    let speed = (2.0 * GM * (1.0 / r - 1.0 / (r + top)) - 0.0).sqrt();
    let (s, c) = libm::sincos(-2.03);
    state([c * r, s * r, 1.0e5], [-s * speed, c * speed, 10.0])
}

fn follow(model: &Model, places: &dyn Places, from: Knot, until: Moment) -> Path {
    let mut path = Path::new(model, places, from);
    while until.since(path.step().until) >= 0.0 && path.step().end != End::Low {
        path.next(model, places);
    }
    path
}

#[test]
fn a_thousand_revolutions_keep_a_fraction_of_a_millimetre() {
    // LEO_1000orb of `orbit_cases.json`; the reference is that file's, from 31-digit arithmetic.
    let (model, places) = lone(GM, 0.0);
    let start = state([6_771_358.863, 0.0, 0.0], [0.0, 4_768.073_542_876_604, 6_015.811_628_476_833]);
    let until = Moment::after(START, 5_555_290.402_386_342);
    let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), until);
    let truth = DVec3::new(-2_107_465.698_380_959, 4_002_920.903_169_394, 5_050_429.256_305_334);
    let error = (path.step().sample(until).position.0 - truth).length();
    assert!(error < 4e-4, "{error} m");
}

#[test]
#[ignore = "ten seconds: cargo test --release -p engine path -- --ignored"]
fn a_million_revolutions_keep_their_place_as_rounding_lets_them() {
    let (model, places) = lone(GM, 0.0);
    let start = state([6_771_358.863, 0.0, 0.0], [0.0, 4_768.073_542_876_604, 6_015.811_628_476_833]);
    let span_s = 5_553_628_000.0;
    let until = Moment::after(START, span_s);
    let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), until);
    let error = (path.step().sample(until).position - kepler::propagate(GM, &start, span_s).position).length();
    // 0.14 mm × 1000^{3/2} is 4.4 m; a bias would grow as the square, to 140 m.
    assert!(error < 40.0, "{error} m");
}

#[test]
fn every_conic_is_keplers() {
    let (model, places) = lone(GM, 0.0);
    for e in [0.0, 0.5, 0.9, 0.999, 0.999_999_999_999, 1.0, 1.5, 20.0] {
        let q = 7.0e6;
        let v = (GM / q * (1.0 + e)).sqrt();
        let start = state([0.6 * q, 0.0, 0.8 * q], [0.0, v, 0.0]);
        let until = Moment::after(START, 2.0 * DAY);
        let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), until);
        let found = path.step().sample(until);
        let truth = kepler::propagate(GM, &start, 2.0 * DAY);
        let miss = (found.position - truth.position).length() / truth.position.length();
        assert!(miss < 3e-13, "e = {e}: {miss}");
    }
}

#[test]
fn a_fall_along_the_radius_ends_at_the_ground_at_the_right_moment() {
    let (model, places) = lone(GM, 6.371e6);
    for speed in [0.0, 1e-3, 50.0] {
        let start = state([4.0e8, 0.0, 0.0], [0.0, speed, 0.0]);
        let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), Moment::after(START, 30.0 * DAY));
        assert_eq!(path.step().end, End::Low);
        let there = path.step().sample(path.step().until).position.length();
        assert!((there - 6.371e6).abs() < 1e-5, "{there}");
        let fall_s = path.step().until.since(START.into());
        let truth = kepler::propagate(GM, &start, fall_s).position.length();
        assert!((truth - 6.371e6).abs() < 1e-3, "{speed}: {truth}");
    }
}

#[test]
fn a_graze_of_a_millimetre_is_met_and_a_miss_of_a_millimetre_is_none() {
    // From a quarter of a revolution before periapsis, once on an ellipse, once at 1 km above the ground on a hyperbola.
    for (q, e) in [(6.471e6, 0.02), (6.372e6, 1.4), (1.738e6, 0.7)] {
        let p = q * (1.0 + e);
        let start = state([0.0, -p, 0.0], [(GM / p).sqrt(), (GM / p).sqrt() * e, 0.0]);
        let period = kepler::Conic::new(GM, start.position.0, start.velocity.0).period_s().min(20_000.0);
        let until = Moment::after(START, 0.9 * period);
        for (low_m, end) in [(q + 1e-3, End::Low), (q - 1e-3, End::Natural)] {
            let (model, places) = lone(GM, low_m);
            let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), until);
            assert_eq!(path.step().end, end, "periapsis {q}, floor {low_m}");
            if end == End::Low {
                let r = path.step().sample(path.step().until).position.length();
                assert!((r - low_m).abs() < 1e-8 * 5.0, "{}", r - low_m);
            }
        }
    }
}

#[test]
fn a_dip_that_begins_and_ends_within_one_step_is_met() {
    let (model, places) = lone(GM, 0.0);
    let start = state([0.0, -6.6e6, 0.0], [7.80e3, 20.0, 0.0]);
    let step = *Path::new(&model, &places, Knot::new(BodyId(0), START, &start)).step;
    let lowest = (0..=1000).map(|i| step.sample(step.moment(f64::from(i) / 1000.0)).position.length()).fold(f64::INFINITY, f64::min);
    let end = step.sample(step.until).position.length();
    assert!(lowest + 10.0 < end.min(6.6e6), "the step holds a periapsis: {lowest} {end}");
    let (model, places) = lone(GM, lowest + 5.0);
    assert_eq!(Path::new(&model, &places, Knot::new(BodyId(0), START, &start)).step.end, End::Low);
}

#[test]
fn a_path_is_the_same_bits_however_it_is_asked() {
    let (model, places) = planet_and_moon();
    let begin = Knot::new(BodyId(0), START, &transfer());
    let end = START.plus(60 * 86_400 * 8);
    let mut finals = Vec::new();
    for stride in [7_i64, 977, 60_000, 1_000_000_000] {
        let mut path = Path::new(&model, &places, begin);
        let mut hosts = vec![path.host()];
        let mut now = START;
        while now < end {
            // From knots alone, as after a save, now and then.
            if now.ticks % 5 == 0 {
                path = Path::new(&model, &places, *path.knot());
            }
            let to = now.plus(stride.max((end.ticks - START.ticks) / 3_000)).min(end);
            match path.advance(&model, &places, to) {
                Some(event) => {
                    now = event.at.next_tick().max(now);
                    hosts.push(path.host());
                }
                None => now = to,
            }
        }
        assert_eq!(hosts, [BodyId(0), BodyId(1), BodyId(0)], "thrown by the moon");
        finals.push((*path.knot(), path.sample(end)));
    }
    assert!(finals.windows(2).all(|w| w[0] == w[1]));
}

#[test]
fn a_change_of_host_is_continuous() {
    let (model, places) = planet_and_moon();
    let mut path = Path::new(&model, &places, Knot::new(BodyId(0), START, &transfer()));
    let mut changes = 0;
    for _ in 0..2_000 {
        let old = path.step().clone();
        if path.next(&model, &places).is_some() {
            changes += 1;
            let at = old.until;
            let moon = places.relative_at(BodyId(1), BodyId(0), at);
            let seen = |host: BodyId, s: State<Centred>| {
                if host == BodyId(0) {
                    (s.position.0, s.velocity.0)
                } else {
                    (s.position.0 + moon.position.0, s.velocity.0 + moon.velocity.0)
                }
            };
            let before = seen(old.knot.host, old.sample(at));
            let after = seen(path.host(), path.knot().state());
            assert!((before.0 - after.0).length() < 2e-7 && (before.1 - after.1).length() < 1e-12, "{before:?} {after:?}");
            let away = path.knot().state().position.length();
            let edge = if path.host() == BodyId(1) { 6.6e7 } else { 6.6e7 * model::LEAVE };
            let away = if path.host() == BodyId(1) { away } else { (after.0 - moon.position.0).length() };
            assert!((away - edge).abs() < 1e-5, "{away}");
        }
        if changes == 2 {
            return;
        }
    }
    panic!("{changes} changes of host");
}

#[test]
fn far_out_and_close_in_nothing_breaks() {
    let gm = 1.327_124_4e20;
    for (distance, speed) in [(0.1 * AU, 1.2e5), (30.0 * AU, 100.0), (1000.0 * AU, 1.0), (1000.0 * AU, 0.0)] {
        let (model, places) = lone(gm, 0.0);
        let start = state([0.0, distance, 0.0], [speed, 0.0, 0.0]);
        let until = Moment::after(START, 3_650.0 * DAY);
        let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), until);
        let found = path.step().sample(until);
        let truth = kepler::propagate(gm, &start, 3_650.0 * DAY);
        assert!((found.position - truth.position).length() < 1e-11 * distance, "{distance}: {found:?}");
    }
    // Starts that are no orbit: at the centre, at rest with nothing near, about a body that does not exist.
    let (model, places) = lone(gm, 0.0);
    for (host, s) in [(0, state([0.0; 3], [0.0; 3])), (0, state([0.0; 3], [1.0, 0.0, 0.0])), (9, state([1.0, 0.0, 0.0], [0.0; 3]))] {
        let path = Path::new(&model, &places, Knot::new(BodyId(host), START, &s));
        let there = path.step().sample(path.step().until);
        assert!(there.position.is_finite() && there.velocity.is_finite() && path.step().span_s() > 0.0);
    }
}

#[test]
fn scaled_systems_move_alike() {
    // Lengths by λ, GM by λ³: the same motion, at 1e-6 and at 1e6.
    let unscaled = state([7.0e6, 0.0, 0.0], [0.0, 5.0e3, 7.0e3]);
    for scale in [1e-6, 1e6] {
        let (model, places) = lone(GM * scale * scale * scale, 0.0);
        let start = state((unscaled.position.0 * scale).into(), (unscaled.velocity.0 * scale).into());
        let until = Moment::after(START, 1.0 * DAY);
        let path = follow(&model, &places, Knot::new(BodyId(0), START, &start), until);
        let truth = kepler::propagate(GM, &unscaled, 1.0 * DAY).position.0;
        assert!((path.step().sample(until).position.0 / scale - truth).length() < 1e-5, "{scale}");
    }
}

#[test]
fn light_pressure_is_less_pull_of_the_star() {
    let (model, places) = lone(1.327e20, 0.0);
    let start = state([AU, 0.0, 0.0], [0.0, 29.8 * KM, 0.0]);
    let setting = Setting { light_m3_s2: 0.02 * 1.327e20, ..Setting::default() };
    let until = Moment::after(START, 20.0 * DAY);
    let mut path = Path::with(&model, &places, Knot::new(BodyId(0), START, &start), setting);
    while until.since(path.step().until) >= 0.0 {
        path.next(&model, &places);
    }
    let truth = kepler::propagate(0.98 * 1.327e20, &start, 20.0 * DAY).position;
    assert!((path.step().sample(until).position - truth).length() < 1e-3);
}

#[test]
fn only_a_body_in_reach_is_looked_for() {
    let (model, _) = planet_and_moon();
    assert_eq!(model.children(BodyId(0)), [BodyId(1)]);
    assert_eq!(model.field(BodyId(1)).unwrap().perturbers[0].body, BodyId(0), "the planet's tide on a ship about the moon");
    assert_eq!(Reach::default().farthest_m, 0.0);
}
