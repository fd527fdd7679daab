//! The ephemeris on small systems whose motion is known; Sol itself is tested with its assets (`game::assets`).

use super::*;
use crate::orbit::gravity::figure::Figure;
use crate::orbit::integrate::gauss_radau::GaussRadau;
use crate::orbit::integrate::{Force, Points};
use crate::orbit::kepler::propagate;
use crate::orbit::{BodyId, State};
use crate::space::{Icrf, Position, Velocity};
use crate::time::{Moment, SimTime};
use crate::units::DAY;
use glam::DVec3;

fn state(r: [f64; 3], v: [f64; 3]) -> State<Icrf> {
    State { position: Position::new(r.into()), velocity: Velocity::new(v.into()) }
}

const EPOCH: SimTime = SimTime::from_ticks(50_000_000_000);
const DAY_TICKS: i64 = 60 * 86_400;

fn about(p: u16) -> Option<BodyId> {
    Some(BodyId(p))
}

fn id(i: usize) -> BodyId {
    BodyId(u16::try_from(i).unwrap())
}

/// A star, a planet given by itself, its heavy moon, an outer planet given with its light moon (of mean elements).
fn system() -> Vec<Orbit> {
    let given = |r, v, of_system| Path::Barycentric { epoch: EPOCH, state: state(r, v), of_system };
    vec![
        Orbit { parent: None, gm_m3_s2: 1.3e20, path: given([-7.0e8, 3.0e8, 1.0e8], [10.0, -12.0, -5.0], false) },
        Orbit { parent: about(0), gm_m3_s2: 4.0e14, path: given([1.15e11, -9.0e10, -3.9e10], [1.88e4, 2.07e4, 8.99e3], false) },
        Orbit { parent: about(1), gm_m3_s2: 4.9e12, path: given([1.147e11, -8.98e10, -3.89e10], [1.81e4, 2.0e4, 8.6e3], false) },
        Orbit { parent: about(0), gm_m3_s2: 1.26e17, path: given([-4.8e11, 5.7e11, 2.6e11], [-1.05e4, -6.8e3, -2.6e3], true) },
        Orbit {
            parent: about(3),
            gm_m3_s2: 9.9e12,
            path: Path::Mean(MeanOrbit {
                epoch: SimTime::from_ticks(0),
                semi_major_m: 1.07e9,
                eccentricity: 0.01,
                inclination_rad: 0.003,
                node_rad: [1.0, -1e-9],
                argument_rad: [2.0, 3e-9],
                mean_anomaly_rad: 0.5,
                mean_longitude_rate_rad_s: 1.016e-5,
                pole_ra_dec_rad: [4.68, 1.126],
            }),
        },
    ]
}

#[test]
fn at_the_epoch_every_state_is_the_given_one() {
    let orbits = system();
    let e = Ephemeris::new(orbits.clone()).unwrap();
    for (i, orbit) in orbits.iter().enumerate() {
        let Path::Barycentric { state: given, of_system, .. } = &orbit.path else { continue };
        let mut s = e.state(id(i), EPOCH);
        if *of_system {
            let moon = e.relative(BodyId(4), BodyId(3), EPOCH);
            let share = 9.9e12 / (9.9e12 + 1.26e17);
            s.position += moon.position.from_origin() * share;
            s.velocity += moon.velocity * share;
        }
        assert!((s.position - given.position).length() < 0.05, "body {i}: {} m", (s.position - given.position).length());
        assert!((s.velocity - given.velocity).length() < 1e-6, "body {i}: {}", (s.velocity - given.velocity).length());
    }
}

#[test]
fn the_centre_of_mass_moves_uniformly() {
    let orbits = system();
    let e = Ephemeris::new(orbits.clone()).unwrap();
    let total: f64 = orbits.iter().map(|o| o.gm_m3_s2).sum();
    let centre = |t: SimTime| {
        let mut all = Vec::new();
        e.states_into(t, &mut all);
        orbits.iter().zip(all).fold(DVec3::ZERO, |sum, (o, s)| sum + s.position.0 * (o.gm_m3_s2 / total))
    };
    let [a, b, c] = [-200, 0, 200].map(|d| centre(EPOCH.plus(d * DAY_TICKS)));
    // Newton's centre; that of relativity differs by 1e-8 of the size of the orbits times the share of the planets' mass.
    assert!((c - b - (b - a)).length() < 10.0, "{} m", (c - b - (b - a)).length());
}

#[test]
fn velocity_is_the_rate_of_position_and_all_ways_agree() {
    let e = Ephemeris::new(system()).unwrap();
    let t = EPOCH.plus(123_456_789);
    let mut all = Vec::new();
    e.states_into(t, &mut all);
    assert_eq!(all.len(), e.len());
    for (i, one) in all.iter().enumerate() {
        assert!((one.position - e.state(id(i), t).position).length() < 1e-3);
        let (before, after) = (e.state(id(i), t.plus(-600)), e.state(id(i), t.plus(600)));
        let rate = (after.position - before.position).0 / 20.0;
        assert!((rate - one.velocity.0).length() < 1e-3, "body {i}: {}", (rate - one.velocity.0).length());
        for j in 0..e.len() {
            let relative = e.relative(id(i), id(j), t);
            let difference = e.state(id(i), t).position - e.state(id(j), t).position;
            assert!((relative.position.from_origin() + difference * -1.0).length() < 1e-3, "{i} from {j}");
        }
    }
}

#[test]
fn bodies_stay_within_their_reach() {
    let e = Ephemeris::new(system()).unwrap();
    for (moon, planet) in [(2, 1), (4, 3), (1, 0), (3, 0)] {
        let reach = e.reach(BodyId(moon));
        for k in -200..200 {
            let s = e.relative(BodyId(moon), BodyId(planet), EPOCH.plus(k * 60 * 50_000));
            let r = s.position.length();
            assert!(r > reach.nearest_m && r < reach.farthest_m && s.velocity.length() < reach.fastest_m_s, "{moon}: {reach:?} {s:?}");
        }
    }
}

#[test]
fn bits_do_not_depend_on_who_asks_first_or_in_what_order() {
    let days = [0, 40, -3, 300, -250, 41, 7];
    let ask = |e: &Ephemeris, order: &[i64]| -> Vec<[u64; 3]> {
        let mut list: Vec<(i64, [u64; 3])> = order
            .iter()
            .flat_map(|d| {
                (0..e.len())
                    .map(|i| (*d * 10 + i as i64, e.state(id(i), EPOCH.plus(*d * DAY_TICKS)).position.0.to_array().map(f64::to_bits)))
            })
            .collect();
        list.sort_unstable();
        list.into_iter().map(|x| x.1).collect()
    };
    let (a, b) = (Ephemeris::new(system()).unwrap(), Ephemeris::new(system()).unwrap());
    let mut reversed = days;
    reversed.reverse();
    assert_eq!(ask(&a, &days), ask(&b, &reversed));
    assert_eq!(ask(&a, &days), ask(&a, &reversed), "nor on what was made again");
}

#[test]
fn two_bodies_run_on_their_conic() {
    // So slow that relativity is nothing: a light moon's level is Kepler's problem.
    let start = state([3.0e7, 1.0e7, 0.0], [-300.0, 1.1e3, 400.0]);
    let orbits = vec![
        Orbit { parent: None, gm_m3_s2: 4.0e13, path: Path::FromParent { epoch: EPOCH, state: State::default() } },
        Orbit { parent: about(0), gm_m3_s2: 1.0e3, path: Path::FromParent { epoch: EPOCH, state: start } },
    ];
    let e = Ephemeris::new(orbits).unwrap();
    for days in [-60.0, -0.3, 0.0, 0.7, 33.3, 120.0] {
        let t = Moment::after(EPOCH, days * DAY);
        let exact = propagate(4.0e13 + 1.0e3, &start, t.since(EPOCH.into()));
        let ours = e.relative_at(BodyId(1), BodyId(0), t);
        // Relativity: 14 (GM)²/(c²r³) over the time, and its square's growth along the track.
        let bound = 1e-3 + 1.5 * 14.0 * 1.6e27 / (9e16 * 2.7e22) * days * days * DAY * DAY;
        assert!((ours.position - exact.position).length() < bound, "{days}: {} of {bound}", (ours.position - exact.position).length());
    }
}

#[test]
fn the_series_is_the_ephemeris_until_its_piece_ends() {
    let e = Ephemeris::new(system()).unwrap();
    for days in [0.0, 12.3, -77.7, 26.0] {
        let t = Moment::after(EPOCH, days * DAY);
        for (body, center) in [(2, 1), (0, 1), (4, 3), (2, 4)] {
            let mut series = [DVec3::ZERO; 16];
            let ahead = e.series(BodyId(body), BodyId(center), t, &mut series);
            assert!(ahead > 0.0);
            for part in [0.0, 0.3, 0.999_999] {
                let h = ahead.min(1e7) * part;
                let sum = series.iter().rev().fold(DVec3::ZERO, |sum, c| sum * h + *c);
                let exact = e.relative_at(BodyId(body), BodyId(center), t.plus_s(h)).position.0;
                assert!(
                    (sum - exact).length() < 2e-15 * 1e12 + 1e-13 * exact.length(),
                    "{body} {center} {days} {part}: {}",
                    (sum - exact).length()
                );
            }
        }
    }
}

/// The Moon-like member of a level of light moons against the same forces written down once more, by differences.
struct Plain {
    gm: [f64; 3],
}
impl Force for Plain {
    const USES_VELOCITY: bool = false;
    fn accelerations(&self, _: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        for i in 0..3 {
            a[i] = DVec3::ZERO;
            for j in (0..3).filter(|j| *j != i) {
                let d = q[j] - q[i];
                a[i] += d * (self.gm[j] / (d.length_squared() * d.length()));
            }
        }
    }
}

#[test]
fn light_moons_move_as_in_the_whole_problem() {
    // A star, a planet and a moon light enough for a level of its own, against plain three bodies about the barycentre. Relativity,
    // which is not in that, is switched off by a star that is far and a slow planet.
    let gm = [1.0e16, 1.0e12, 1.0e6];
    let place = [DVec3::ZERO, DVec3::X * 1.0e10, DVec3::new(1.0e10, 2.0e7, 3.0e6)];
    let speed = (1.0e16_f64 / 1.0e10).sqrt();
    let velocity = [DVec3::ZERO, DVec3::Y * speed, DVec3::new(-190.0, speed, 110.0)];
    let orbit = |i: usize, parent| Orbit {
        parent,
        gm_m3_s2: gm[i],
        path: Path::Barycentric { epoch: EPOCH, state: state(place[i].to_array(), velocity[i].to_array()), of_system: false },
    };
    let e = Ephemeris::new(vec![orbit(0, None), orbit(1, about(0)), orbit(2, about(1))]).unwrap();
    let mut points = Points { t: 0.0, q: place.to_vec(), v: velocity.to_vec() };
    let mut method = GaussRadau::new(3, GaussRadau::TOLERANCE);
    for days in [3.0, 20.0, 50.0] {
        method.run(&Plain { gm }, &mut points, days * DAY);
        let ours = e.relative_at(BodyId(2), BodyId(1), Moment::after(EPOCH, days * DAY)).position.0;
        let exact = points.q[2] - points.q[1];
        assert!((ours - exact).length() < 1e-5 * exact.length(), "{days}: {} m", (ours - exact).length());
    }
}

#[test]
fn a_flattened_planet_turns_the_node_of_its_moon() {
    let start = state([2.0e7, 0.0, 0.0], [0.0, 1.2e3, 6.0e2]);
    let orbits = vec![
        Orbit { parent: None, gm_m3_s2: 1.0e20, path: Path::FromParent { epoch: EPOCH, state: State::default() } },
        Orbit {
            parent: about(0),
            gm_m3_s2: 4.0e13,
            path: Path::FromParent { epoch: EPOCH, state: state([1.0e14, 0.0, 0.0], [0.0, 1.0e3, 0.0]) },
        },
        Orbit { parent: about(1), gm_m3_s2: 1.0, path: Path::FromParent { epoch: EPOCH, state: start } },
    ];
    let spin = crate::orbit::rotation::Spin { pole_dec_rad: [core::f64::consts::FRAC_PI_2, 0.0], ..Default::default() };
    let figure = Figure { radius_m: 3.4e6, zonal: [2e-3, 0.0, 0.0], spin, ..Figure::default() };
    let details = Details { figures: vec![None, Some(figure)], ..Details::default() };
    let e = Ephemeris::detailed(&orbits, &details).unwrap();
    let node = |days: f64| {
        let s = e.relative_at(BodyId(2), BodyId(1), Moment::after(EPOCH, days * DAY));
        let normal = s.position.0.cross(s.velocity.0);
        libm::atan2(normal.x, -normal.y)
    };
    let elements = crate::orbit::elements::Elements::from_state(4.0e13, &start);
    let p = elements.periapsis_m * (1.0 + elements.eccentricity);
    let rate = -1.5 * elements.mean_motion_rad_s() * 2e-3 * (3.4e6 / p) * (3.4e6 / p) * libm::cos(elements.inclination_rad);
    let moved = node(100.0) - node(-100.0);
    assert!((moved / (rate * 200.0 * DAY) - 1.0).abs() < 0.02, "{moved} {}", rate * 200.0 * DAY);
}

#[test]
fn systems_scaled_by_a_million_either_way_move_alike() {
    // Lengths × s and GM × s³ keep times; relativity does not scale, so the slow system stays below it.
    let at = |s: f64| {
        let scaled = |o: &Orbit| {
            let Path::FromParent { epoch, state: given } = &o.path else { unreachable!() };
            let state = state((given.position.0 * s).to_array(), (given.velocity.0 * s).to_array());
            Orbit { parent: o.parent, gm_m3_s2: o.gm_m3_s2 * s * s * s, path: Path::FromParent { epoch: *epoch, state } }
        };
        let slow = [
            Orbit { parent: None, gm_m3_s2: 1.0e9, path: Path::FromParent { epoch: EPOCH, state: State::default() } },
            Orbit {
                parent: about(0),
                gm_m3_s2: 1.0e5,
                path: Path::FromParent { epoch: EPOCH, state: state([1.0e7, 0.0, 0.0], [0.0, 9.0, 2.0]) },
            },
            Orbit {
                parent: about(1),
                gm_m3_s2: 1.0,
                path: Path::FromParent { epoch: EPOCH, state: state([2.0e4, 0.0, 0.0], [0.0, 2.1, 0.3]) },
            },
        ];
        let e = Ephemeris::new(slow.iter().map(scaled).collect()).unwrap();
        let t = EPOCH.plus(30 * DAY_TICKS);
        [1, 2].map(|i| e.relative(BodyId(i), BodyId(i - 1), t).position.0 / s)
    };
    let [one, small, large] = [1.0, 1e-6, 1e2].map(at);
    for i in 0..2 {
        assert!((small[i] - one[i]).length() < 1e-7 * one[i].length(), "{i}: {} {}", small[i], one[i]);
        assert!((large[i] - one[i]).length() < 1e-5 * one[i].length(), "{i}: {} {}", large[i], one[i]);
    }
}

#[test]
fn what_is_no_system_is_refused() {
    let good = system();
    let with = |i: usize, change: fn(&mut Orbit)| {
        let mut list = good.clone();
        change(&mut list[i]);
        Ephemeris::new(list).unwrap_err()
    };
    assert_eq!(Ephemeris::new(Vec::new()).unwrap_err(), EphemerisError::Count(0));
    assert_eq!(with(0, |o| o.parent = Some(BodyId(1))), EphemerisError::Root(0));
    assert_eq!(with(1, |o| o.parent = None), EphemerisError::Root(1));
    assert_eq!(with(1, |o| o.parent = Some(BodyId(2))), EphemerisError::Order(1));
    assert!(matches!(with(2, |o| o.gm_m3_s2 = f64::NAN), EphemerisError::Value { body: 2, .. }));
    assert!(matches!(with(3, |o| o.gm_m3_s2 = -1.0), EphemerisError::Value { body: 3, .. }));
    let hasty = with(4, |o| {
        let Path::Mean(mean) = &mut o.path else { return };
        mean.mean_longitude_rate_rad_s *= 2.0;
    });
    assert!(matches!(hasty, EphemerisError::Pace { body: 4, kepler_m, .. } if (6.6e8..6.9e8).contains(&kepler_m)), "{hasty:?}");
    let mut twins = good.clone();
    twins[3].path = twins[1].path.clone();
    assert_eq!(Ephemeris::new(twins).unwrap_err(), EphemerisError::Same(1, 3));
    let bare = Ephemeris::default();
    assert_eq!(bare.state(BodyId(7), EPOCH), State::default());
    assert_eq!(bare.relative(BodyId(7), BodyId(1), EPOCH), State::default());
}

#[test]
fn out_of_reach_bodies_are_finite_and_near_their_conics() {
    let e = Ephemeris::new(system()).unwrap();
    let (first, last) = e.limits();
    assert!(first < EPOCH && last > EPOCH.plus(300 * 365 * DAY_TICKS));
    for t in [last.plus(1), first.plus(-1), SimTime::from_ticks(i64::MAX), SimTime::from_ticks(i64::MIN)] {
        let s = e.relative(BodyId(1), BodyId(0), t);
        assert!(s.position.is_finite() && s.position.length() < 3e11 && s.velocity.length() > 1e3, "{s:?}");
        let mut series = [DVec3::ZERO; 8];
        assert!(e.series(BodyId(1), BodyId(0), t.into(), &mut series) > 0.0);
    }
}

#[test]
fn a_cache_gives_the_same_bits_and_is_never_trusted() {
    use std::sync::atomic::AtomicBool;
    let (made, fresh) = (Ephemeris::new(system()).unwrap(), Ephemeris::new(system()).unwrap());
    let (from, to) = (EPOCH.plus(-200 * DAY_TICKS), EPOCH.plus(500 * DAY_TICKS));
    let heard = std::sync::Mutex::new(Vec::new());
    assert!(made.prepare(from, to, &|x| heard.lock().unwrap().push(x), &AtomicBool::new(false)));
    let heard = heard.into_inner().unwrap();
    assert!(heard.is_sorted() && (heard.last().unwrap() - 1.0).abs() < 1e-9, "{heard:?}");
    let bytes = made.to_bytes();
    assert!(made.is_prepared(from, to) && !fresh.is_prepared(from, to) && !made.is_prepared(from, to.plus(400 * DAY_TICKS)));
    assert_eq!(fresh.from_bytes(&bytes), Ok(()));
    assert_eq!(fresh.to_bytes(), bytes);
    let t = EPOCH.plus(333 * DAY_TICKS);
    for i in 0..5 {
        assert_eq!(fresh.state(id(i), t), Ephemeris::new(system()).unwrap().state(id(i), t), "body {i}");
    }
    assert_eq!(fresh.from_bytes(&bytes), Ok(()), "twice does no harm");
    let mut other = system();
    other[4].gm_m3_s2 *= 1.000_001;
    assert_eq!(Ephemeris::new(other).unwrap().from_bytes(&bytes), Err(CacheError::Foreign));
    let new = || Ephemeris::new(system()).unwrap();
    assert_eq!(new().from_bytes(b"nothing"), Err(CacheError::Layout));
    for at in [60, bytes.len() / 2, bytes.len() - 1] {
        let mut broken = bytes.clone();
        broken[at] ^= 1;
        assert_eq!(new().from_bytes(&broken), Err(CacheError::Damaged), "{at}");
        assert!(new().from_bytes(&bytes[..at]).is_err());
    }
    // Sealed again after a change: only the comparison with this program's own first chunk tells.
    let mut forged = bytes.clone();
    forged[44 + 4 + 2 * 4 * 24 + 1] ^= 1;
    let end = forged.len() - 32;
    let seal = blake3::hash(&forged[..end]);
    forged[end..].copy_from_slice(seal.as_bytes());
    assert_eq!(new().from_bytes(&forged), Err(CacheError::Other));
    // Cancelled before it begins.
    assert!(!new().prepare(from, to, &|_| (), &AtomicBool::new(true)));
}

#[test]
#[ignore = "seconds in a release build, most of a minute in a debug one"]
fn a_thousand_years_of_the_inner_planets_keep_their_energy() {
    // Circular starts at the planets' distances and masses, 40° apart.
    let gm = [1.327e20_f64, 2.203e13, 3.249e14, 4.035e14, 4.283e13];
    let sizes = [0.0, 5.79e10, 1.082e11, 1.496e11, 2.279e11];
    let orbits: Vec<Orbit> = (0..5)
        .map(|i| {
            let (s, c) = libm::sincos(0.7 * i as f64);
            let speed = if i == 0 { 0.0 } else { 1.05 * (gm[0] / sizes[i]).sqrt() };
            let path =
                Path::FromParent { epoch: EPOCH, state: state([sizes[i] * c, sizes[i] * s, 0.0], [-speed * s, speed * c, 0.01 * speed]) };
            Orbit { parent: (i > 0).then_some(BodyId(0)), gm_m3_s2: gm[i], path }
        })
        .collect();
    let e = Ephemeris::new(orbits).unwrap();
    // Newton's energy swings with relativity's part of it (1e-8): a mean over a decade does not.
    let energy = |from_years: i64| {
        let (mut sum, mut all) = (0.0, Vec::new());
        for k in 0..2000 {
            e.states_into(EPOCH.plus((from_years * 365 + 2 * k) * DAY_TICKS - k), &mut all);
            for (i, a) in all.iter().enumerate() {
                sum += 0.5 * gm[i] * a.velocity.0.length_squared();
                for (j, b) in all.iter().enumerate().take(i) {
                    sum -= gm[i] * gm[j] / (a.position - b.position).length();
                }
            }
        }
        sum / 2000.0
    };
    let (first, last) = (energy(0), energy(985));
    assert!((last / first - 1.0).abs() < 1e-9, "{}", last / first - 1.0);
}
