//! The tree of orbits on a small system whose motion is known; Sol itself is tested with its assets (`game::assets`).

use super::*;

fn state(r: [f64; 3], v: [f64; 3]) -> State<Icrf> {
    State { position: Position::new(r.into()), velocity: Velocity::new(v.into()) }
}

const EPOCH: SimTime = SimTime::from_ticks(50_000_000_000);

/// A star, a planet given by itself, its moon, and an outer planet given with its (mean-element) moon.
fn system() -> Vec<Orbit> {
    let given = |r, v, of_system| Path::Barycentric { epoch: EPOCH, state: state(r, v), of_system };
    let about = |p: u16| Some(BodyId(p));
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
        let mut s = e.state(BodyId(u16::try_from(i).unwrap()), EPOCH);
        if *of_system {
            let moon = e.relative(BodyId(4), BodyId(3), EPOCH);
            let share = 9.9e12 / (9.9e12 + 1.26e17);
            s.position += moon.position.from_origin() * share;
            s.velocity += moon.velocity * share;
        }
        assert!((s.position - given.position).length() < 2e-3, "body {i}: {} m", (s.position - given.position).length());
        assert!((s.velocity - given.velocity).length() < 1e-8, "body {i}");
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
    let day = 60 * 86_400;
    let [a, b, c] = [0, 400, 800].map(|d| centre(EPOCH.plus(d * day)));
    assert!((c - b - (b - a)).length() < 0.05, "{} m", (c - b - (b - a)).length());
}

#[test]
fn velocity_is_the_rate_of_position_and_all_three_ways_agree() {
    let e = Ephemeris::new(system()).unwrap();
    let t = EPOCH.plus(123_456_789);
    let mut all = Vec::new();
    e.states_into(t, &mut all);
    assert_eq!(all.len(), e.len());
    for (i, one) in all.iter().enumerate() {
        let id = BodyId(u16::try_from(i).unwrap());
        assert!((one.position - e.state(id, t).position).length() < 1e-3);
        let (before, after) = (e.state(id, t.plus(-600)), e.state(id, t.plus(600)));
        let rate = (after.position - before.position).0 / 20.0;
        assert!((rate - one.velocity.0).length() < 3e-4, "body {i}: {}", (rate - one.velocity.0).length());
        for j in 0..e.len() {
            let other = BodyId(u16::try_from(j).unwrap());
            let relative = e.relative(id, other, t);
            let difference = e.state(id, t).position - e.state(other, t).position;
            assert!((relative.position.from_origin() + difference * -1.0).length() < 1e-3, "{i} from {j}");
        }
    }
}

#[test]
fn bodies_stay_within_their_reach() {
    let e = Ephemeris::new(system()).unwrap();
    for (moon, planet) in [(2, 1), (4, 3), (1, 0), (3, 0)] {
        let reach = e.reach(BodyId(moon));
        for k in 0..500 {
            let s = e.relative(BodyId(moon), BodyId(planet), EPOCH.plus(k * 60 * 20_000));
            let r = s.position.length();
            assert!(r > reach.nearest_m && r < reach.farthest_m && s.velocity.length() < reach.fastest_m_s, "{moon}: {reach:?} {s:?}");
        }
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
    let bare = Ephemeris::default();
    assert_eq!(bare.state(BodyId(7), EPOCH), State::default());
    assert_eq!(bare.relative(BodyId(7), BodyId(1), EPOCH), State::default());
}
