//! Against the canons of NASA and published local circumstances, with positions of DE440 about sixteen eclipses: the geometry alone,
//! apart from our own ephemeris. Then what needs no Earth: shadows that a ruler and compass can draw.

use super::*;
use crate::space::{Position, Velocity};
use crate::time::{J2000_JD, SimTime};
use crate::units::{AU, DAY, DEG, KM};
use core::f64::consts::FRAC_PI_2;
use glam::DVec3;

/// Chebyshev coefficients of Sun, Earth and Moon over 0.4 days about each of sixteen dates.
const DE440: &str = include_str!("../../../../tests/reference/de440_eclipses.csv");
const SUN: BodyId = BodyId(0);
const EARTH: BodyId = BodyId(1);
const MOON: BodyId = BodyId(2);
/// Half of a record, days.
const HALF_D: f64 = 0.2;

/// `(centre jd, body, axis, coefficients km)`.
struct Table(Vec<(f64, BodyId, usize, Vec<f64>)>);

impl Table {
    fn load() -> Self {
        let rows = DE440.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
        let row = |line: &str| {
            let f: Vec<&str> = line.split(',').collect();
            let body = match f[1] {
                "sun" => SUN,
                "earth" => EARTH,
                _ => MOON,
            };
            let axis = "xyz".find(f[2]).unwrap();
            (f[0].parse().unwrap(), body, axis, f[3..].iter().map(|c| c.parse().unwrap()).collect())
        };
        Self(rows.map(row).collect())
    }

    fn state(&self, body: BodyId, t: Moment) -> State<Icrf> {
        let (days, fraction) = t.days_behind(0.0);
        let mut r = DVec3::ZERO;
        for (jd, _, axis, c) in self.0.iter().filter(|row| row.1 == body) {
            let x = ((days - (jd - J2000_JD)) + fraction) / HALF_D;
            if x.abs() <= 1.0 {
                let (mut b1, mut b2) = (0.0, 0.0);
                for ck in c.iter().skip(1).rev() {
                    (b1, b2) = (2.0 * x * b1 - b2 + ck, b1);
                }
                r[*axis] = (x * b1 - b2 + c[0]) * KM;
            }
        }
        assert!(r != DVec3::ZERO, "no record of {body:?} at {}", t.jd_tt());
        State { position: Position::new(r), velocity: Velocity::ZERO }
    }
}

/// The canons' shapes: the Moon's two radii are 0.2725076 and 0.272281 of the Earth's, the Sun's is 959.63″ at 1 AU.
fn shapes() -> [Shape; 3] {
    let a = 6_378.137 * KM;
    let earth = Shape { equatorial_m: a, flattening: 1.0 / 298.257_222, limb_m: [a; 2], shadow: 1.01 };
    let moon = Shape { equatorial_m: 1737.4 * KM, flattening: 0.0, limb_m: [0.272_507_6 * a, 0.272_281 * a], shadow: 1.0 };
    [Shape::sphere(695_990.0 * KM), earth, moon]
}

fn spins() -> [Spin; 3] {
    let still = Spin { pole_dec_rad: [FRAC_PI_2, 0.0], ..Spin::default() };
    [still.clone(), Spin::earth(), still]
}

fn cast(spins: &[Spin; 3], solar: bool) -> Cast<'_> {
    let [sun, earth, moon] = shapes();
    let star = Role { id: SUN, spin: &spins[0], shape: sun };
    let earth = Role { id: EARTH, spin: &spins[1], shape: earth };
    let moon = Role { id: MOON, spin: &spins[2], shape: moon };
    if solar { Cast { star, caster: moon, receiver: earth } } else { Cast { star, caster: earth, receiver: moon } }
}

/// Of the Moon about the Earth, and of the Sun.
const PACE: Pace = Pace { closing_rad_s: 3.45e-6, closing_m_s: 3.3e4 };

fn one(table: &Table, cast: &Cast<'_>, jd_tt: f64) -> Eclipse {
    let mut found = Vec::new();
    let around = |s: f64| Moment::from_jd_tt(jd_tt).plus_s(s);
    find(cast, &|b, t| table.state(b, t), PACE, around(-3000.0), around(3000.0), &mut |e| {
        found.push(e);
        true
    });
    assert_eq!(found.len(), 1, "{jd_tt}: {found:?}");
    found[0]
}

fn hms(day: f64, h: f64, m: f64, s: f64) -> f64 {
    day + (h * 3600.0 + m * 60.0 + s) / DAY
}

#[test]
fn solar_eclipses_are_those_of_the_canon() {
    // [Espenak & Meeus 2006]: 0 h TT of the day; greatest eclipse h m s TT; kind, gamma, magnitude, latitude, longitude, duration s.
    type Row = (f64, [f64; 3], Kind, f64, f64, f64, f64, f64);
    let canon: [Row; 9] = [
        (2_451_401.5, [11.0, 4.0, 9.0], Kind::Total, 0.5062, 1.0286, 45.1, 24.3, 143.0),
        (2_455_034.5, [2.0, 36.0, 25.0], Kind::Total, 0.0698, 1.0799, 24.2, 144.1, 399.0),
        (2_456_599.5, [12.0, 47.0, 36.0], Kind::Hybrid, 0.3272, 1.0159, 3.5, -11.7, 100.0),
        (2_456_776.5, [6.0, 4.0, 33.0], Kind::Annular, -1.0, 0.9868, -70.6, 131.3, 0.0),
        (2_457_986.5, [18.0, 26.0, 40.0], Kind::Total, 0.4367, 1.0306, 37.0, -87.7, 160.0),
        (2_458_843.5, [5.0, 18.0, 53.0], Kind::Annular, 0.4135, 0.9701, 1.0, 102.3, 220.0),
        (2_460_054.5, [4.0, 17.0, 56.0], Kind::Hybrid, -0.3952, 1.0132, -9.6, 125.8, 76.0),
        (2_460_763.5, [10.0, 48.0, 36.0], Kind::Partial, 1.0405, 0.9376, 61.1, -77.1, 0.0),
        (2_461_264.5, [17.0, 47.0, 6.0], Kind::Total, 0.8977, 1.0386, 65.2, -25.2, 138.0),
    ];
    let (table, spins) = (Table::load(), spins());
    let cast = cast(&spins, true);
    for (day, [h, m, s], kind, gamma, magnitude, lat, lon, duration) in canon {
        let jd = hms(day, h, m, s);
        let e = one(&table, &cast, jd);
        assert_eq!(e.kind, kind, "{jd}");
        let late = (e.canonical(&cast).jd_tt() - jd) * DAY;
        assert!(late.abs() < 0.7, "{jd}: {late} s");
        assert!((e.gamma - gamma).abs() < 1e-4, "{jd}: {}", e.gamma);
        assert!((e.magnitude - magnitude).abs() < 2e-4, "{jd}: {}", e.magnitude);
        // A tenth of a degree is the canon's last digit; its predicted ΔT was up to 6 s (0.025°) off by now.
        let place = [e.place.lat_rad / DEG - lat, e.place.lon_rad / DEG - lon];
        assert!(place[0].abs() < 0.06 && place[1].abs() < 0.1, "{jd}: {place:?}");
        assert!((e.duration_s - duration).abs() < 1.5, "{jd}: {}", e.duration_s);
        assert_eq!(e.core.is_some(), e.central);
        assert!(e.penumbra[0].since(e.greatest) < 0.0 && e.penumbra[1].since(e.greatest) > 0.0);
    }
}

#[test]
fn lunar_eclipses_are_those_of_the_canon() {
    // [Espenak & Meeus 2009]: gamma, penumbral and umbral magnitude; semi-duration of the partial and total phase in minutes.
    type Row = (f64, [f64; 3], Kind, f64, f64, f64, f64);
    let canon: [Row; 7] = [
        (2_451_564.5, [4.0, 44.0, 34.0], Kind::Total, -0.2957, 1.3246, 101.6, 38.5),
        (2_453_306.5, [3.0, 5.0, 11.0], Kind::Total, 0.2846, 1.3081, 109.6, 40.4),
        (2_458_326.5, [20.0, 22.0, 54.0], Kind::Total, 0.1168, 1.6087, 117.3, 51.5),
        (2_458_858.5, [19.0, 11.0, 11.0], Kind::Penumbral, 1.0727, -0.116, 0.0, 0.0),
        (2_459_537.5, [9.0, 4.0, 6.0], Kind::Partial, -0.4552, 0.9742, 104.2, 0.0),
        (2_460_748.5, [6.0, 59.0, 56.0], Kind::Total, 0.3484, 1.1784, 109.1, 32.7),
        (2_462_313.5, [3.0, 23.0, 22.0], Kind::Total, 0.0124, 1.8436, 109.6, 50.9),
    ];
    let (table, spins) = (Table::load(), spins());
    let cast = cast(&spins, false);
    for (day, [h, m, s], kind, gamma, magnitude, partial, total) in canon {
        let jd = hms(day, h, m, s);
        let e = one(&table, &cast, jd);
        let late = (e.canonical(&cast).jd_tt() - jd) * DAY;
        assert!(e.kind == kind && late.abs() < 0.8, "{jd}: {:?} {late} s", e.kind);
        assert!((e.gamma - gamma).abs() < 1e-4 && (e.magnitude - magnitude).abs() < 2e-4, "{jd}: {} {}", e.gamma, e.magnitude);
        let half = |span: Option<Span>| span.map_or(0.0, |[a, b]| b.since(a) / 120.0);
        assert!((half(e.umbra) - partial).abs() < 0.4 && (half(e.core) - total).abs() < 0.4, "{jd}: {} {}", half(e.umbra), half(e.core));
    }
}

#[test]
fn who_stands_in_totality_on_the_12th_of_august_2026() {
    let (table, spins) = (Table::load(), spins());
    let cast = cast(&spins, true);
    let paths = |b, t| table.state(b, t);
    let e = one(&table, &cast, 2_461_265.241_041_667);
    let from = |lat: f64, lon: f64| {
        let observer = local::Observer { place: Place { lat_rad: lat * DEG, lon_rad: lon * DEG }, height_m: 0.0 };
        observer.seen(&cast, &paths, &e)
    };
    // Published (Instituto Geográfico Nacional; Icelandic almanac): A Coruña 76 s about 18:28 UTC, Reykjavík 1 min about 17:48:43.
    for (lat, lon, h, m, s, lasts) in [(43.37, -8.40, 18.0, 28.0, 15.0, 76.0), (64.147, -21.94, 17.0, 48.0, 43.0, 60.0)] {
        let l = from(lat, lon).unwrap();
        let [a, b] = l.inner.unwrap();
        let utc = hms(2_461_264.5, h, m, s);
        let late = (l.greatest.jd_tt() - utc) * DAY - 69.184;
        assert!(l.kind == Kind::Total && l.magnitude > 1.0 && l.star_altitude_rad > 0.0);
        assert!((b.since(a) - lasts).abs() < 4.0, "{lat}: {} s", b.since(a));
        assert!(late.abs() < 30.0, "{lat}: {late} s");
    }
    // Madrid and Barcelona: a sliver is left.
    for (lat, lon) in [(40.4168, -3.7038), (41.3874, 2.1686)] {
        let l = from(lat, lon).unwrap();
        assert!(l.kind == Kind::Partial && l.inner.is_none() && (0.99..1.0).contains(&l.magnitude), "{l:?}");
    }
    // Sydney sees nothing.
    assert_eq!(from(-33.87, 151.2), None);
}

#[test]
fn the_central_line_leads_through_the_place_of_greatest_eclipse() {
    let (table, spins) = (Table::load(), spins());
    let cast = cast(&spins, true);
    let paths = |b, t| table.state(b, t);
    let e = one(&table, &cast, 2_457_987.268_518_518_7);
    let line = solar::central_line(&cast, &paths, &e, 9);
    assert_eq!(line.len(), 9);
    // From the North Pacific to the Atlantic: canon, path of 2017-08-21: 39.7° N 171.5° W to 11.0° N 27.6° W.
    let (first, last) = (line[0].1, line[8].1);
    assert!((first.lat_rad / DEG - 39.7).abs() < 0.3 && (first.lon_rad / DEG + 171.5).abs() < 0.6, "{first:?}");
    assert!((last.lat_rad / DEG - 11.0).abs() < 0.3 && (last.lon_rad / DEG + 27.6).abs() < 0.6, "{last:?}");
    let centre = solar::centre(&cast, &paths, e.greatest).unwrap();
    assert!((centre.lat_rad - e.place.lat_rad).abs() < 1e-9 && (centre.lon_rad - e.place.lon_rad).abs() < 1e-9);
}

/// A star at the origin; a small body that passes before a large one 10,000 km aside of the centre line of both.
fn toy(miss_m: f64) -> (impl Fn(BodyId, Moment) -> State<Icrf>, [Shape; 3]) {
    let t0 = Moment::default();
    let paths = move |b: BodyId, t: Moment| {
        let s = t.since(t0);
        let r = match b.0 {
            0 => DVec3::ZERO,
            1 => DVec3::X * AU,
            _ => DVec3::new(AU - 4e8, 1000.0 * s, miss_m),
        };
        State { position: Position::new(r), velocity: Velocity::ZERO }
    };
    (paths, [Shape::sphere(7e8), Shape::sphere(7e6), Shape::sphere(2e6)])
}

#[test]
fn a_drawn_shadow_has_drawn_edges() {
    let spins = spins();
    let (paths, [sun, large, small]) = toy(0.0);
    let role = |k: usize, shape| Role { id: BodyId(u16::try_from(k).unwrap()), spin: &spins[0], shape };
    let cast = Cast { star: role(0, sun), caster: role(2, small), receiver: role(1, large) };
    let e = solar::describe(&cast, &paths, Moment::default()).unwrap();
    // Similar triangles, by hand: at 4e8 m behind, the penumbra is 2e6 + 4e8 (7e8 + 2e6)/(AU − 4e8) wide, the umbra 2e6 − 4e8 (7e8 − 2e6)/(…).
    let d = AU - 4e8;
    let (outer, inner) = (2e6 + 4e8 * 7.02e8 / d, 2e6 - 4e8 * 6.98e8 / d);
    let shadow = Shadow::at(&cast, &paths, Moment::default());
    assert!((shadow.penumbra(&cast).radius_m / outer - 1.0).abs() < 2e-5, "{}", shadow.penumbra(&cast).radius_m);
    assert!((-shadow.umbra(&cast).radius_m / inner - 1.0).abs() < 2e-4, "{}", shadow.umbra(&cast).radius_m);
    // Light left the caster 1.334 s ago: 1,334 m back.
    assert!((e.light_s - 4e8 / crate::units::SPEED_OF_LIGHT).abs() < 1e-6);
    assert!(e.kind == Kind::Total && e.central && e.gamma.abs() < 3e-4);
    // First to last touch: the shadow's edge moves 1/(1 − 4e8/AU) times faster than the caster.
    let lasts = 2.0 * (7e6 + outer) / (1000.0 / (1.0 - 4e8 / AU));
    assert!((e.penumbra[1].since(e.penumbra[0]) / lasts - 1.0).abs() < 1e-4, "{}", e.penumbra[1].since(e.penumbra[0]));
    // The place is the one below the star.
    assert!(e.place.lat_rad.abs() < 1e-9 && (e.star_altitude_rad - FRAC_PI_2).abs() < 1e-3, "{e:?}");
}

#[test]
fn neither_a_graze_nor_a_miss_is_invented() {
    let spins = spins();
    let reach = 9e6 + 4e8 * 7.02e8 / (AU - 4e8);
    for (miss, expected) in [(0.999, true), (1.001, false)] {
        // The axis passes the receiver AU/(AU − 4e8) farther out than the caster stands aside.
        let (paths, [sun, large, small]) = toy(miss * reach * (1.0 - 4e8 / AU));
        let role = |k: u16, shape| Role { id: BodyId(k), spin: &spins[0], shape };
        let cast = Cast { star: role(0, sun), caster: role(2, small), receiver: role(1, large) };
        let mut count = 0;
        let at = |s: f64| Moment::default().plus_s(s);
        let pace = Pace { closing_rad_s: 1e-5, closing_m_s: 1e4 };
        find(&cast, &paths, pace, at(-4e5), at(4e5), &mut |e| {
            count += 1;
            assert!(e.kind == Kind::Partial && e.magnitude < 0.01 && !e.central);
            true
        });
        assert_eq!(count == 1, expected, "{miss}");
        // Seen from the small one's far side of the star nothing is hidden: the caster behind the receiver throws no shadow on it.
        let behind = Cast { star: role(0, sun), caster: role(1, large), receiver: role(2, small) };
        find(&behind, &paths, pace, at(-4e5), at(4e5), &mut |_| panic!("the shadow runs away from the star"));
    }
    assert_eq!(SimTime::default(), Moment::default().tick);
}
