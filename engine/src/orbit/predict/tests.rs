//! Tests of predictions: apsides and nodes against Kepler's closed forms, burns against Tsiolkovsky's and vis-viva, closest
//! approaches against a scan, frames against places that are known.

use super::*;
use crate::orbit::elements::Elements;
use crate::orbit::ephemeris::{Ephemeris, Orbit, Path as Given};
use crate::orbit::field::{Bound, Source};
use crate::orbit::path::{Body, Path};
use crate::orbit::rotation::Spin;
use crate::space::{Position, Velocity};
use crate::units::DEG;
use core::f64::consts::TAU;

const GM: f64 = 3.986_004_355_07e14;
const START: SimTime = SimTime::from_ticks(50_000_000_000);
const DAY_S: f64 = 86_164.1;

fn state(r: [f64; 3], v: [f64; 3]) -> State<Centred> {
    State { position: Position::new(r.into()), velocity: Velocity::new(v.into()) }
}

/// A planet with air and a moon on a circle; `light` takes the moon's mass away.
fn system(light: bool) -> (Model, Ephemeris) {
    let moon = if light { 1.0 } else { 4.902_800_118e12 };
    let at = State { position: Position::xyz(3.844e8, 0.0, 0.0), velocity: Velocity::xyz(0.0, (GM / 3.844e8).sqrt(), 0.0) };
    let rest = Given::Barycentric { epoch: START, state: State::default(), of_system: false };
    let orbit = |parent, gm_m3_s2, path| Orbit { parent, gm_m3_s2, path };
    let given = Given::FromParent { epoch: START, state: at };
    let ephemeris = Ephemeris::new(vec![orbit(None, GM, rest), orbit(Some(BodyId(0)), moon, given)]).unwrap();
    let source = |i: u16, parent, gm_m3_s2| Source { parent, reach: ephemeris.reach(BodyId(i)), gm_m3_s2, ..Source::default() };
    let spin = Spin { pole_dec_rad: [90.0 * DEG, 0.0], meridian_rad: [0.0, TAU * 86_400.0 / DAY_S], ..Spin::default() };
    let earth = Body { source: source(0, None, GM), spin, soi_m: f64::INFINITY, low_m: 6.571e6, radius_m: 6.371e6, air_top_m: 6.571e6 };
    let soi_m = if light { 0.0 } else { 6.6e7 };
    let luna = Body { source: source(1, Some(BodyId(0)), moon), soi_m, low_m: 1.75e6, radius_m: 1.737e6, ..Body::default() };
    let bound = if light { Bound { position_m: 1e6, over_s: 1.0 } } else { Bound::COAST };
    (Model::new(vec![earth, luna], bound), ephemeris)
}

fn low() -> State<Centred> {
    state([6.9e6, 0.0, 0.0], [200.0, 4.4e3, 6.3e3])
}

#[test]
fn apsides_and_nodes_are_keplers() {
    let (model, places) = system(true);
    let orbit = Elements::from_state(GM, &low());
    let limits = Limits { periapses: 10, ..Limits::until(START.plus(60 * 86_400)) };
    let p = predict(&model, &places, Knot::new(BodyId(0), START, &low()), &[], &limits);
    assert_eq!(p.ending, Ending::Periapses);
    let of = |kind: Kind| p.marks.iter().filter(move |m| m.kind == kind).collect::<Vec<_>>();
    let (peri, apo, up, down) = (of(Kind::Periapsis), of(Kind::Apoapsis), of(Kind::AscendingNode), of(Kind::DescendingNode));
    assert_eq!((peri.len(), apo.len(), down.len()), (10, 10, 10));
    // It starts on the node itself: that one may be told or not.
    assert!((9..=11).contains(&up.len()), "{}", up.len());
    for (n, m) in peri.iter().enumerate() {
        let expected = orbit.to_periapsis_s() + n as f64 * orbit.period_s();
        assert!((m.at.since(START.into()) - expected).abs() < 1e-4, "{n}");
        assert!((m.state.position.length() - orbit.periapsis_m).abs() < 1e-5);
    }
    assert!(apo.iter().all(|m| (m.state.position.length() - orbit.apoapsis_m()).abs() < 1e-5));
    assert!(up.iter().chain(&down).all(|m| m.state.position.0.z.abs() < 1e-6));
    assert!(p.marks.windows(2).all(|w| w[1].at.since(w[0].at) >= 0.0), "in order");
}

#[test]
fn what_is_predicted_is_what_is_flown() {
    let (model, places) = system(false);
    let start = Knot::new(BodyId(0), START, &state([6.771e6, 0.0, 0.0], [0.0, 10.75e3, 300.0]));
    let until = START.plus(60 * 86_400 * 6);
    let p = predict(&model, &places, start, &[], &Limits::until(until));
    let mut path = Path::new(&model, &places, start);
    for k in 1..=50 {
        let t = START.plus((until.ticks - START.ticks) * k / 51);
        while path.advance(&model, &places, t).is_some() {}
        assert_eq!(p.state(t.into()), Some((path.host(), path.sample(t))));
    }
    assert!(p.state(START.plus(-1).into()).is_none() && p.state(until.plus(1).into()).is_none());
    assert_eq!(p.end(), until.into());
}

#[test]
fn an_impulse_raises_the_apoapsis_by_vis_viva() {
    let (model, places) = system(true);
    let r = 7.0e6;
    let v = (GM / r).sqrt();
    let start = Knot::new(BodyId(0), START, &state([r, 0.0, 0.0], [0.0, v, 0.0]));
    let at = Moment::after(START, 1234.567);
    let burn = Burn { at, prograde_m_s: 100.0, ..Burn::default() };
    let p = predict(&model, &places, start, &[burn], &Limits::until(START.plus(60 * 9_000)));
    let a = 1.0 / (2.0 / r - (v + 100.0) * (v + 100.0) / GM);
    let begin = p.first(|k| k == Kind::BurnBegins(0)).unwrap().at;
    assert!(begin.since(at).abs() < 1e-9);
    let apo = p.marks.iter().rfind(|m| m.kind == Kind::Apoapsis).unwrap();
    assert!((apo.state.position.length() - (2.0 * a - r)).abs() < 1e-4, "{}", apo.state.position.length());
    // Normal and radial burns go where they are named.
    let [along, normal, out] = axes(&start.state());
    assert_eq!((along, normal, out), (DVec3::Y, DVec3::Z, DVec3::X));
}

#[test]
fn a_finite_burn_gives_tsiolkovskys_speed_and_tends_to_the_impulse() {
    let (model, places) = system(true);
    let far = Knot::new(BodyId(0), START, &state([4.0e12, 0.0, 0.0], [0.0, 1.0, 0.0]));
    let engine = Engine { acceleration_m_s2: 3.0, exhaust_m_s: 3_000.0 };
    let burn = Burn { at: Moment::after(START, 2_000.0), prograde_m_s: 4_000.0, engine: Some(engine), ..Burn::default() };
    let p = predict(&model, &places, far, &[burn], &Limits::until(START.plus(60 * 4_000)));
    let gained = p.state(p.end()).unwrap().1.velocity.0.y - 1.0;
    assert!((gained - 4_000.0).abs() < 1e-6, "{gained}");
    let ends = p.first(|k| k == Kind::BurnEnds(0)).unwrap().at;
    let lasted = ends.since(p.first(|k| k == Kind::BurnBegins(0)).unwrap().at);
    assert!((lasted - (1.0 - libm::exp(-4.0 / 3.0)) * 1_000.0).abs() < 1e-6, "{lasted}");
    // In a low orbit a burn a hundred times harder comes ten thousand times nearer to the impulse.
    let start = Knot::new(BodyId(0), START, &low());
    let end = START.plus(60 * 3_000);
    let after = |engine| {
        let burn = Burn { at: Moment::after(START, 900.0), prograde_m_s: 30.0, normal_m_s: 10.0, engine, ..Burn::default() };
        predict(&model, &places, start, &[burn], &Limits::until(end)).state(end.into()).unwrap().1.position
    };
    let impulse = after(None);
    let miss = |a| (after(Some(Engine { acceleration_m_s2: a, exhaust_m_s: 1e9 })) - impulse).length();
    let (slow, hard) = (miss(1.0), miss(100.0));
    assert!(slow > 0.1 && hard < slow / 8_000.0, "{slow} {hard}");
}

#[test]
fn closest_approach_is_where_a_scan_finds_it() {
    let (model, places) = system(false);
    let start = Knot::new(BodyId(0), START, &state([6.771e6, 0.0, 0.0], [-300.0, 10.6e3, 900.0]));
    let until = START.plus(60 * 86_400 * 9);
    let limits = Limits { target: Some(BodyId(1)), ..Limits::until(until) };
    let p = predict(&model, &places, start, &[], &limits);
    let gap = |t: Moment| {
        let (host, s) = p.state(t).unwrap();
        let moon = if host == BodyId(1) { DVec3::ZERO } else { places.relative_at(BodyId(1), host, t).position.0 };
        (s.position.0 - moon).length()
    };
    let closest: Vec<(Moment, f64)> =
        p.marks.iter().filter_map(|m| if let Kind::Closest { distance_m } = m.kind { Some((m.at, distance_m)) } else { None }).collect();
    assert!(!closest.is_empty());
    for (at, distance) in closest {
        assert!((gap(at) - distance).abs() < 1e-3, "{} {distance}", gap(at));
        assert!([-20.0, 20.0].iter().all(|d| gap(at.plus_s(*d)) > distance));
    }
    // Every dip of a scan every ten minutes has its mark.
    let scan: Vec<f64> = (0..1_290).map(|i| gap(Moment::after(START, 600.0 * f64::from(i)))).collect();
    let dips = scan.windows(3).filter(|w| w[1] < w[0] && w[1] < w[2]).count();
    let told = p.marks.iter().filter(|m| matches!(m.kind, Kind::Closest { .. })).count();
    assert_eq!(dips, told);
}

#[test]
fn a_path_into_the_air_enters_and_ends_at_the_ground() {
    let (model, places) = system(true);
    let start = Knot::new(BodyId(0), START, &state([6.871e6, 0.0, 0.0], [0.0, 7.0e3, 0.0]));
    let p = predict(&model, &places, start, &[], &Limits::until(START.plus(60 * 86_400)));
    assert_eq!(p.ending, Ending::Impact);
    let entry = p.first(|k| k == Kind::AirEntry).unwrap();
    let impact = p.marks.last().unwrap();
    assert!((entry.state.position.length() - 6.571e6).abs() < 1e-5 && impact.kind == Kind::Impact);
    assert!((impact.state.position.length() - 6.371e6).abs() < 1e-5 && impact.at.since(entry.at) > 60.0);
}

#[test]
fn a_flyby_is_told_in_order_and_a_burn_that_has_passed_is_left_out() {
    let (model, places) = system(false);
    let (s, c) = libm::sincos(-2.0);
    let r = 6.771e6;
    let v = (2.0 * GM * (1.0 / r - 1.0 / 4.2e8)).sqrt();
    let start = Knot::new(BodyId(0), START, &state([c * r, s * r, 0.0], [-s * v, c * v, 0.0]));
    let old = Burn { at: Moment::after(START, -1.0), prograde_m_s: 1e4, ..Burn::default() };
    let p = predict(&model, &places, start, &[old], &Limits::until(START.plus(60 * 86_400 * 12)));
    let hosts: Vec<Kind> =
        p.marks.iter().map(|m| m.kind).filter(|k| matches!(k, Kind::Enter(_) | Kind::Leave | Kind::BurnBegins(_))).collect();
    assert_eq!(hosts, [Kind::Enter(BodyId(1)), Kind::Leave]);
    let near = p.marks.iter().find(|m| m.kind == Kind::Periapsis && m.host == BodyId(1)).expect("periapsis at the moon");
    assert!(near.state.position.length() < 6.6e7);
    let pieces = p.polylines(&model, &places, View { body: BodyId(1), rotating: false }, 0.1);
    assert_eq!(pieces.iter().map(|p| p.host.0).collect::<Vec<_>>(), [0, 1, 0]);
    // Pieces meet, in whatever frame.
    for w in pieces.windows(2) {
        let (a, b) = (w[0].points.last().unwrap(), w[1].points[0]);
        assert!((a.position - b.position).length() < 1e-6 && a.at == b.at);
    }
}

#[test]
fn over_a_turning_planet_a_synchronous_ship_stands_still() {
    let (model, places) = system(true);
    let r = libm::cbrt(GM * (DAY_S / TAU) * (DAY_S / TAU));
    let start = Knot::new(BodyId(0), START, &state([r, 0.0, 0.0], [0.0, (GM / r).sqrt(), 0.0]));
    let p = predict(&model, &places, start, &[], &Limits::until(START.plus(60 * 86_400)));
    let pieces = p.polylines(&model, &places, View { body: BodyId(0), rotating: true }, 0.1);
    let points = &pieces[0].points;
    assert!(points.len() > 60, "{}", points.len());
    // The axes are those of whole ticks: 3 km/s × 1/60 s.
    assert!(points.iter().all(|q| (q.position - points[0].position).length() < 60.0));
    let still = p.polylines(&model, &places, View { body: BodyId(0), rotating: false }, 0.1);
    assert!(still[0].points.iter().any(|q| (q.position - points[0].position).length() > r));
}
