//! With our own ephemeris, loaded from the assets: the canon's eclipses, towns under the shadow, what the HUD is told, visits.
//! Not here: the geometry alone, which the engine tests on DE440's positions.

use super::almanac::{self, Event};
use super::visit::{self, Seat};
use crate::assets::Assets;
use crate::world::World;
use crate::world::ship::Motion;
use crate::world::system::System;
use engine::orbit::BodyId;
use engine::orbit::eclipse::local::Observer;
use engine::orbit::eclipse::{Eclipse, Kind, Place};
use engine::space::sphere;
use engine::time::{Moment, SimTime};
use engine::units::{DAY, DEG};
use std::path::Path;
use std::sync::{Arc, OnceLock};

fn assets() -> Assets {
    Assets::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets"), Vec::new())
}

/// Loaded once for all tests.
fn sol() -> Arc<System> {
    static SOL: OnceLock<Arc<System>> = OnceLock::new();
    SOL.get_or_init(|| assets().system("sol", &|_, _| ()).unwrap_or_else(|e| panic!("{}", e.text()))).clone()
}

fn id(system: &System, key: &str) -> BodyId {
    system.find(key).unwrap_or_else(|| panic!("no {key}"))
}

fn event(system: &System, on: &str, by: &str, jd_tt: f64) -> Event {
    let (on, by) = (id(system, on), id(system, by));
    let mut found = Vec::new();
    let around = |d: f64| Moment::from_jd_tt(jd_tt + d);
    almanac::find(system, on, by, around(-1.0), around(1.0), &mut |e| {
        found.push(e);
        true
    });
    assert_eq!(found.len(), 1, "{jd_tt}: {found:?}");
    Event { on, by, eclipse: found[0] }
}

#[test]
fn eclipses_are_those_of_the_canon_by_our_own_ephemeris() {
    // [Espenak & Meeus 2006, 2009]: JD of greatest eclipse (TT), kind, gamma, latitude and longitude (solar).
    type Row = (bool, f64, Kind, f64, Option<(f64, f64)>);
    let canon: [Row; 8] = [
        (true, 2_460_409.262_836, Kind::Total, 0.3431, Some((25.3, -104.1))),
        (true, 2_460_763.950_417, Kind::Partial, 1.0405, Some((61.1, -77.1))),
        (false, 2_460_748.791_620, Kind::Total, 0.3484, None),
        (true, 2_461_089.009_097, Kind::Annular, -0.9743, Some((-64.7, 86.8))),
        (true, 2_461_265.241_042, Kind::Total, 0.8977, Some((65.2, -25.2))),
        (false, 2_461_280.676_435, Kind::Partial, 0.4964, None),
        (true, 2_461_619.922_106, Kind::Total, 0.1421, Some((25.5, 33.2))),
        (false, 2_462_313.641_227, Kind::Total, 0.0124, None),
    ];
    let s = sol();
    for (solar, jd, kind, gamma, place) in canon {
        let (on, by) = if solar { ("earth", "moon") } else { ("moon", "earth") };
        let event = event(&s, on, by, jd);
        let e = &event.eclipse;
        let cast = almanac::cast(&s, event.on, event.by).unwrap();
        let late = (e.canonical(&cast).jd_tt() - jd) * DAY;
        assert!(e.kind == kind && late.abs() < 1.0, "{jd}: {:?}, {late} s", e.kind);
        assert!((e.gamma - gamma).abs() < 1.5e-4, "{jd}: {}", e.gamma);
        if let Some((lat, lon)) = place {
            let off = [e.place.lat_rad / DEG - lat, (e.place.lon_rad / DEG - lon) * libm::cos(e.place.lat_rad)];
            assert!(off.iter().all(|x| x.abs() < 0.1), "{jd}: {off:?}");
        }
    }
}

#[test]
#[ignore = "integrates a century: half a minute"]
fn the_21st_century_has_the_canon_s_counts() {
    let s = sol();
    let mut counts = [[0; 5]; 2];
    for (k, (on, by)) in [("earth", "moon"), ("moon", "earth")].into_iter().enumerate() {
        let [from, to] = [2_451_910.5, 2_488_434.5].map(Moment::from_jd_tt);
        almanac::find(&s, id(&s, on), id(&s, by), from, to, &mut |e| {
            counts[k][e.kind as usize] += 1;
            true
        });
    }
    // Penumbral, partial, annular, hybrid, total.
    assert_eq!(counts, [[0, 77, 72, 7, 68], [86, 57, 0, 0, 85]]);
}

#[test]
fn towns_on_the_12th_of_august_2026() {
    let s = sol();
    let event = event(&s, "earth", "moon", 2_461_265.241);
    let seen = |lat: f64, lon: f64| {
        let observer = Observer { place: Place { lat_rad: lat * DEG, lon_rad: lon * DEG }, height_m: 0.0 };
        almanac::with_paths(&s, &event, |cast, paths| observer.seen(cast, paths, &event.eclipse)).flatten().unwrap()
    };
    let kinds = [(43.37, -8.40), (64.147, -21.94), (40.4168, -3.7038), (41.3874, 2.1686)].map(|(lat, lon)| {
        let local = seen(lat, lon);
        assert!(local.star_altitude_rad > 0.0);
        local.kind
    });
    assert_eq!(kinds, [Kind::Total, Kind::Total, Kind::Partial, Kind::Partial], "A Coruña, Reykjavík, Madrid, Barcelona");
}

#[test]
fn the_next_event_is_the_same_from_any_window() {
    let s = sol();
    let earth = id(&s, "earth");
    let e = event(&s, "earth", "moon", 2_461_265.241).eclipse;
    let same =
        |found: Option<Event>| found.is_some_and(|f| f.eclipse.kind == Kind::Total && f.eclipse.greatest.since(e.greatest).abs() < 1e-3);
    // Before, in force, and until the penumbra leaves.
    for s_before in [9.0 * DAY, 2.0 * DAY, 3600.0, 10.0, -10.0, -7_000.0] {
        assert!(same(s.next_event(earth, e.greatest.plus_s(-s_before).tick)), "{s_before} s before");
    }
    assert!(!same(s.next_event(earth, e.penumbra[1].plus_s(1.0).next_tick())));
    // At Jupiter there is always one to come, and it is the soonest of all.
    let jupiter = id(&s, "jupiter");
    let now = SimTime::from_jd_tdb(2_461_265.0);
    let next = s.next_event(jupiter, now).unwrap();
    assert!(s.body(next.by).parent == Some(jupiter) && next.eclipse.penumbra[1].since(now.into()) >= 0.0);
    let listed = almanac::coming(&s, jupiter, now, 3.0, 50, &|_| ());
    let first = listed.iter().map(|e| e.eclipse.penumbra[0].since(now.into())).fold(f64::INFINITY, f64::min);
    assert!(next.eclipse.penumbra[0].since(now.into()) <= first + 1e-3, "{listed:?}");
    assert!(listed.windows(2).all(|w| w[1].eclipse.greatest.since(w[0].eclipse.greatest) >= 0.0));
    assert!(listed.iter().any(|e| s.body(e.by).key == "io") && listed.iter().any(|e| s.body(e.by).key == "europa"));
}

#[test]
fn who_can_darken_whom() {
    let s = sol();
    let keys = |on: &str| almanac::casters_of(&s, id(&s, on)).iter().map(|b| s.body(*b).key.clone()).collect::<Vec<_>>();
    assert_eq!((keys("earth"), keys("moon"), keys("venus")), (vec!["moon".to_owned()], vec!["earth".to_owned()], vec![]));
    assert_eq!(keys("io"), ["jupiter", "europa", "ganymede", "callisto"]);
    assert!(almanac::cast(&s, id(&s, "earth"), id(&s, "earth")).is_none() && almanac::cast(&s, id(&s, "sun"), id(&s, "moon")).is_none());
    let e = event(&s, "earth", "moon", 2_461_265.241);
    assert_eq!(almanac::title(&s, &e), "Total eclipse: Moon before Sun");
    let e = event(&s, "moon", "earth", 2_461_280.68);
    assert_eq!(almanac::title(&s, &e), "Partial eclipse: Moon in the shadow of Earth");
}

/// The World of a visit, and the moment that it is for.
fn visit(s: &Arc<System>, event: &Event, seat: Seat) -> (World, Eclipse) {
    let start = visit::start(s, event, "torch", seat).unwrap();
    let world = World::from_start(s.clone(), assets().ship(&start.ship).unwrap(), &start).unwrap_or_else(|e| panic!("{start:?}: {e}"));
    (world, event.eclipse)
}

#[test]
fn a_visitor_on_the_ground_stands_in_the_dark() {
    let s = sol();
    for (on, by, jd) in [("earth", "moon", 2_461_265.241), ("moon", "earth", 2_460_748.79)] {
        let event = event(&s, on, by, jd);
        let (mut world, e) = visit(&s, &event, Seat::Ground);
        assert!((e.greatest.since(world.time.into()) - visit::BEFORE_S).abs() < 0.1);
        assert!(on == "moon" || world.readout().sun_visible > 0.0, "not yet");
        let star = world.readout().markers.sun;
        assert!(star.x.abs() < 0.1 && (star.z < 0.0 || star.y > 0.9), "the star stands ahead, or overhead: {star}");
        world.move_clock(e.greatest.tick);
        let readout = world.readout();
        assert!(readout.sun_visible == 0.0 && readout.eclipsed_by == Some(event.by), "{on}: {}", readout.sun_visible);
        let told = readout.eclipse.unwrap();
        assert!(told.to_greatest_s.abs() < 0.1 && told.to_first_s < 0.0 && told.to_last_s > 0.0 && told.event.by == event.by);
    }
}

#[test]
fn a_visitor_in_orbit_passes_over_the_place() {
    let s = sol();
    let event = event(&s, "earth", "moon", 2_461_265.241);
    let (world, e) = visit(&s, &event, Seat::Orbit);
    let Motion::Coast(coast) = &world.ship.motion else { panic!("no orbit") };
    let r = coast.path.sample(e.greatest.tick).position.0;
    let axes = s.body(event.on).spin.icrf_from_fixed_at(e.greatest);
    let (lat, lon) = sphere::lat_lon_of(axes.inverse().raw(r));
    // On the sphere the axis lands some tenths of a degree from where the ellipsoid has it.
    assert!((lat - e.place.lat_rad).abs() < 0.4 * DEG && (lon - e.place.lon_rad).abs() < 0.8 * DEG, "{} {}", lat / DEG, lon / DEG);
    // A giant has no ground to stand on, but an orbit.
    let io = Event { on: id(&s, "jupiter"), by: id(&s, "io"), ..super::tests::event(&s, "jupiter", "io", 2_461_202.35) };
    assert!(!visit::has_ground(&s, &io) && visit::start(&s, &io, "torch", Seat::Orbit).is_some());
}
