//! Pictures, by their light: no NaN and no hole at any height, day and night; the Moon's shadow is dark from within and from
//! afar; air thins smoothly on a climb; what deep space skips changes nothing.
//!
//! All are stills of a few thousand pixels, drawn by one renderer and read before exposure (cd/m²). Not here: what the sky's
//! radiance should be (`sky.rs`), what the World does (`replays.rs`).

use engine::air::Model;
use engine::air::model::ViewTable;
use engine::render::{FrameReport, HdrImage};
use engine::scene::Force;
use engine::time::SimTime;
use game::assets::Assets;
use game::mode::studio::Studio;
use game::view::Rig;
use game::world::World;
use game::world::ship::contact;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};

const SIZE: (u32, u32) = (96, 54);

/// A plain in Spain, two days before the eclipse: the Moon is far from the sun.
const NOON: f64 = 2_461_263.0;
const SUNSET: f64 = 2_461_263.299_5;
const NIGHT: f64 = 2_461_263.45;
/// On Mars, at 18.4° N, 77.5° E.
const MARS_SUNSET: f64 = 2_461_264.992;
/// Totality west of Iceland (at 65.2° N, 25.2° W it is greatest), and an hour before.
const TOTALITY: f64 = 2_461_265.241_1;
const BEFORE: f64 = TOTALITY - 1.0 / 24.0;

/// One renderer, and Worlds by the name of their start.
struct Stage {
    studio: Studio,
    worlds: BTreeMap<&'static str, World>,
}

fn stage() -> MutexGuard<'static, Stage> {
    static STAGE: OnceLock<Mutex<Stage>> = OnceLock::new();
    let stage = STAGE.get_or_init(|| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ has a parent");
        let assets = Assets::new(root.join("assets"), Vec::new());
        let system = assets.system("sol", &|_, _| ()).unwrap_or_else(|e| panic!("{e}"));
        let worlds = ["leo", "deep_space"].map(|key| {
            let spec = assets.start(key).unwrap_or_else(|e| panic!("{e}"));
            let ship = assets.ship(&spec.ship).unwrap_or_else(|e| panic!("{e}"));
            (key, assets.world(key, &spec, system.clone(), ship).unwrap_or_else(|e| panic!("{e}")))
        });
        let studio = Studio::open(None, SIZE, Force::default()).expect("pictures need a graphics device; a software one will do");
        Mutex::new(Stage { studio, worlds: worlds.into() })
    });
    // A failed test leaves the stage as good as it was: every picture sets what it needs.
    stage.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// A picture that was taken: its light, its bytes, and what ran for it.
struct Taken {
    what: String,
    hdr: HdrImage,
    bytes: Vec<u8>,
    report: FrameReport,
}

impl Stage {
    fn take(&mut self, start: &str, jd_tdb: Option<f64>, camera: &str, size: (u32, u32), force: Force) -> Taken {
        let mut world = self.worlds[start].clone();
        if let Some(jd) = jd_tdb {
            world.move_clock(SimTime::from_jd_tdb(jd));
        }
        let rig = Rig::parse(camera, &world.system).unwrap_or_else(|e| panic!("{e}"));
        self.studio.resize(size);
        self.studio.force(force);
        let report = self.studio.draw(&world, &rig).unwrap_or_else(|e| panic!("{camera}: {e}"));
        let hdr = self.studio.hdr().unwrap_or_else(|e| panic!("{camera}: {e}"));
        let bytes = self.studio.pixels().unwrap_or_else(|e| panic!("{camera}: {e}"));
        let taken = Taken { what: format!("{camera} at {jd_tdb:?}"), hdr, bytes, report };
        taken.has_no_nan();
        taken
    }
    fn at(&mut self, jd_tdb: f64, camera: &str) -> Taken {
        let taken = self.take("leo", Some(jd_tdb), camera, SIZE, Force::default());
        taken.has_no_hole();
        taken
    }
}

impl Taken {
    fn width(&self) -> usize {
        self.hdr.size[0] as usize
    }
    fn height(&self) -> usize {
        self.hdr.size[1] as usize
    }
    fn rgb(&self, x: usize, y: usize) -> [f32; 3] {
        let i = (y * self.width() + x) * 4;
        [self.hdr.rgba[i], self.hdr.rgba[i + 1], self.hdr.rgba[i + 2]]
    }
    /// Luminance of a pixel, cd/m².
    fn nits(&self, x: usize, y: usize) -> f32 {
        let [r, g, b] = self.rgb(x, y);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }
    /// Luminances of a block of pixels, sorted.
    fn sorted(&self, xs: std::ops::Range<usize>, ys: std::ops::Range<usize>) -> Vec<f32> {
        let mut all: Vec<f32> = ys.flat_map(|y| xs.clone().map(move |x| (x, y))).map(|(x, y)| self.nits(x, y)).collect();
        all.sort_by(f32::total_cmp);
        all
    }
    /// Median luminance of a block: stars and hull do not count.
    fn median(&self, xs: std::ops::Range<usize>, ys: std::ops::Range<usize>) -> f32 {
        let all = self.sorted(xs, ys);
        all[all.len() / 2]
    }
    fn median_of_all(&self) -> f32 {
        self.median(0..self.width(), 0..self.height())
    }
    /// Mean of the brightest fifth of all bytes of red, green and blue, 0 … 255.
    fn bright_byte(&self) -> u32 {
        let mut all: Vec<u32> = self.bytes.chunks_exact(4).flat_map(|p| &p[..3]).map(|b| u32::from(*b)).collect();
        all.sort_unstable();
        let fifth = &all[all.len() * 4 / 5..];
        fifth.iter().sum::<u32>() / u32::try_from(fifth.len()).expect("a small picture")
    }
    /// Neither NaN nor infinity.
    fn has_no_nan(&self) {
        let bad = self.hdr.rgba.iter().filter(|v| !v.is_finite() || **v < 0.0).count();
        assert_eq!(bad, 0, "{}: values that are NaN, infinite or negative", self.what);
    }
    /// No black pixel whose neighbours are all lit: shaders store a NaN as black, and a crack shows the dark behind.
    fn has_no_hole(&self) {
        let lit = 0.1 * self.median_of_all().max(0.1);
        let mut holes = Vec::new();
        for y in 1..self.height() - 1 {
            for x in 1..self.width() - 1 {
                let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                if self.rgb(x, y) == [0.0; 3] && around.iter().all(|(x, y)| self.nits(*x, *y) > lit) {
                    holes.push((x, y));
                }
            }
        }
        assert!(holes.is_empty(), "{}: black pixels among lit ones at {holes:?}", self.what);
    }
    /// Greatest ratio of luminance between pixels side by side or one above the other in the rows above `rows`.
    fn roughest_step(&self, rows: usize) -> f32 {
        let ratio = |a: f32, b: f32| (a / b).max(b / a);
        let mut worst = 1.0_f32;
        for y in 0..rows {
            for x in 0..self.width() {
                if x + 1 < self.width() {
                    worst = worst.max(ratio(self.nits(x, y), self.nits(x + 1, y)));
                }
                if y + 1 < rows {
                    worst = worst.max(ratio(self.nits(x, y), self.nits(x, y + 1)));
                }
            }
        }
        worst
    }
}

#[test]
fn from_two_metres_to_sixty_thousand_kilometres_by_day() {
    let mut stage = stage();
    for (height_m, pitch) in [(2.0, -3), (200.0, -5), (1e4, -8), (1e5, -15), (4e5, -25), (5e6, -70), (6e7, -90)] {
        let fov = if height_m > 1e7 { 16 } else { 55 };
        let taken = stage.at(NOON, &format!("at:earth,42.36,-3.62,{height_m},60,{pitch},{fov}"));
        let brightest = *taken.sorted(0..96, 0..54).last().expect("it has pixels");
        println!("{}: median {:.1}, most {brightest:.0} cd/m², bright byte {}", taken.what, taken.median_of_all(), taken.bright_byte());
        assert!(taken.bright_byte() > 70, "{}: a bright byte of {} by day is black", taken.what, taken.bright_byte());
        // Nothing lit by the sun at one astronomical unit is brighter than a white sheet that faces it.
        assert!((300.0..45_000.0).contains(&brightest), "{}: {brightest} cd/m²", taken.what);
    }
}

#[test]
fn the_sky_has_no_seam_and_is_the_same_left_and_right_of_the_sun() {
    let mut stage = stage();
    for (jd, camera, allowed) in [
        (NOON, "at:earth,42.36,-3.62,200,sun+180,30,55", 1.2),
        (NOON, "at:earth,42.36,-3.62,10000,sun+180,30,55", 1.2),
        (SUNSET, "at:earth,42.36,-3.62,200,sun+180,30,55", 1.3),
    ] {
        let taken = stage.at(jd, camera);
        let step = taken.roughest_step(54);
        let aside = (0..54).flat_map(|y| (0..48).map(move |x| (x, y))).map(|(x, y)| (taken.nits(x, y) / taken.nits(95 - x, y) - 1.0).abs());
        let aside = aside.fold(0.0, f32::max);
        println!("{}: steps up to {step:.3}, left and right differ by {aside:.4}", taken.what);
        assert!(step < allowed, "{}: neighbours differ by a factor of {step}", taken.what);
        assert!(aside < 0.03, "{}: left and right differ by {aside}", taken.what);
    }
}

#[test]
fn the_limb_fades_into_space_without_a_band() {
    let taken = stage().at(NOON, "at:earth,42.36,-3.62,400000,sun+180,-19,8");
    // Upwards from the brightest row the light of a column never grows, and ends in darkness.
    for x in [4, 48, 91] {
        let column: Vec<f32> = (0..54).rev().map(|y| taken.median(x - 3..x + 4, y..y + 1)).collect();
        println!("{x}: {column:.1?}");
        let peak = (0..54).max_by(|a, b| column[*a].total_cmp(&column[*b])).expect("a column has rows");
        let rise = column[peak..].windows(2).map(|w| w[1] - w[0]).fold(0.0, f32::max);
        assert!(rise <= 0.02 * column[peak], "column {x}: brighter by {rise} cd/m² one row up");
        assert!(column[53] < 1e-3 * column[peak], "column {x}: {} above a limb of {} cd/m²", column[53], column[peak]);
    }
}

#[test]
fn sunset_is_red_and_night_is_dark() {
    let mut stage = stage();
    let noon = stage.at(NOON, "at:earth,42.36,-3.62,2,sun+90,20,55");
    let sunset = stage.at(SUNSET, "at:earth,42.36,-3.62,2,sun+25,8,30");
    let night = stage.at(NIGHT, "at:earth,42.36,-3.62,2,sun+90,20,55");
    let [r, _, b] = sunset.rgb(0, 32);
    let [day_r, _, day_b] = noon.rgb(48, 8);
    println!("noon {:.0}, sunset {:.0}, night {:.2e} cd/m²", noon.median_of_all(), sunset.median_of_all(), night.median_of_all());
    println!("red over blue: {:.2} at sunset, {:.2} at noon", r / b, day_r / day_b);
    assert!(r > 1.5 * b && day_b > day_r);
    assert!(sunset.median_of_all() < noon.median_of_all() && night.median_of_all() < 1e-5 * noon.median_of_all());
    for height_m in [1e4, 4e5, 5e6] {
        for jd in [SUNSET, NIGHT] {
            stage.at(jd, &format!("at:earth,42.36,-3.62,{height_m},sun,-30,55"));
        }
    }
}

#[test]
fn the_sun_of_mars_sets_in_a_blue_glow_in_a_brown_sky() {
    // The sun stands 3° high; the glow is 2° beside it, the sky 50°. A pixel is half a degree.
    let mut stage = stage();
    let glow = stage.at(MARS_SUNSET, "at:mars,18.4,77.5,2,sun+15,8,27");
    let beyond = stage.at(MARS_SUNSET, "at:mars,18.4,77.5,2,sun+60,20,27");
    let ratio = |taken: &Taken, x: usize, y: usize| taken.rgb(x, y)[2] / taken.rgb(x, y)[0];
    let [near, aside, far] = [ratio(&glow, 14, 37), ratio(&glow, 48, 30), ratio(&beyond, 48, 27)];
    println!("blue over red: {near:.2} beside the sun, {aside:.2} at 15°, {far:.2} far from it");
    assert!(near > 1.2 && aside < 0.9 && far < 0.6 && near > 2.5 * far, "{near} {aside} {far}");
}

#[test]
fn totality_is_night_at_day() {
    let mut stage = stage();
    // Within the umbra: the open sky keeps 1e-4 … 1e-3 of its light, as measured in totalities; towards the horizon the day goes on.
    for (camera, darker) in [
        ("at:earth,65.2,-25.2,2,sun+180,60,55", 1e3..1e4),
        ("at:earth,65.2,-25.2,2,sun+180,30,55", 5e2..1e4),
        ("at:earth,65.2,-25.2,10000,sun+120,-10,55", 1e2..1e4),
    ] {
        let (before, within) = (stage.at(BEFORE, camera), stage.at(TOTALITY, camera));
        let (b, w) = (before.median_of_all(), within.median_of_all());
        println!("{camera}: {b:.1} cd/m² an hour before, {w:.3} in the umbra: {:.0} times darker", b / w);
        assert!(w > 0.0 && darker.contains(&(b / w)), "{camera}: {b} and {w} cd/m²");
    }
}

#[test]
fn the_moon_s_shadow_is_seen_from_sixty_thousand_kilometres() {
    let mut stage = stage();
    let camera = "at:earth,65.2,-25.2,60000000,0,-90,14";
    let (before, within) = (stage.at(BEFORE, camera), stage.at(TOTALITY, camera));
    let share = |x: usize, y: usize| within.median(x - 1..x + 2, y - 1..y + 2) / before.median(x - 1..x + 2, y - 1..y + 2);
    // The disc has a radius of 20 pixels; the shadow lies in its middle, and southwards the day goes on.
    println!("shares southwards: {:?}", (0..18).map(|i| share(48, 27 + i)).collect::<Vec<_>>());
    assert!(share(48, 27) < 0.15, "in the shadow {} of the light is left", share(48, 27));
    assert!((0.75..1.35).contains(&share(48, 42)), "far from the shadow: {}", share(48, 42));
}

#[test]
fn the_sky_darkens_smoothly_on_a_climb_into_space() {
    let mut stage = stage();
    // The sun stands 62° high: 30° from it, the other side of the zenith.
    let sky = |stage: &mut Stage, height_m: f64| {
        let camera = format!("at:earth,42.36,-3.62,{height_m},sun+180,88,20");
        stage.take("leo", Some(NOON), &camera, (32, 18), Force::default()).median_of_all()
    };
    let heights: Vec<f64> = (0..24).map(|i| 10.0 * libm::exp10(5.0 * f64::from(i) / 23.0)).collect();
    let light: Vec<f32> = heights.iter().map(|h| sky(&mut stage, *h)).collect();
    for (h, l) in heights.windows(2).zip(light.windows(2)) {
        println!("{:9.0} m: {:.4e} cd/m²", h[1], l[1]);
        // Light from above never grows, and never thins faster than air does where it is coldest (a scale height of 5.3 km).
        let least = libm::exp(-(h[1] - h[0]) / 5.0e3);
        assert!(l[1] <= 1.01 * l[0] && f64::from(l[1] / l[0]) >= 0.95 * least, "{} cd/m² at {} m, {} at {} m", l[0], h[0], l[1], h[1]);
    }
    assert!(light[0] > 300.0 && light[23] < 1e-3, "{} cd/m² at 10 m, {} at 1,000 km", light[0], light[23]);
}

#[test]
fn the_sea_mirrors_the_sky_of_view_table() {
    // Elek's sea is a flat mirror: below the horizon there stands what is as far above it, by (1 − cos) of the view [Elek 2008, eq. 3.8].
    let mut stage = stage();
    let mut world = stage.worlds["leo"].clone();
    let earth = world.system.find("earth").expect("there is one");
    let system = Arc::make_mut(&mut world.system);
    system.bodies[usize::from(earth.0)].look.as_mut().expect("it has air").model = Model::ViewTable(ViewTable::default());
    stage.worlds.insert("mirror", world);
    let (size, fov_deg) = ((64, 64), 16.0);
    let taken = stage.take("mirror", Some(NOON), "at:earth,30,-40,3,sun+150,0,16", size, Force::default());
    stage.worlds.remove("mirror");
    // What this model said of the ground's light is forgotten with it.
    let camera = "at:earth,42.36,-3.62,200,60,-5,55";
    let after = stage.take("leo", Some(NOON), camera, (64, 64), Force::default());
    stage.take("leo", Some(NOON), camera, (64, 64), Force { all: true });
    let fresh = stage.take("leo", Some(NOON), camera, (64, 64), Force::default());
    assert!(after.hdr == fresh.hdr, "the light of the model before is left on the ground");
    let row = |y: usize| (0..64).map(|x| f64::from(taken.rgb(x, y)[1])).sum::<f64>() / 64.0;
    for k in [8, 12, 16, 20] {
        let rise = (f64::from(k) + 0.5) / 64.0 * fov_deg;
        let (above, below) = (row(31 - k as usize), row(32 + k as usize));
        let truth = above * (1.0 - rise.to_radians().sin());
        println!("{rise:.1}°: {below:.0} cd/m² of {above:.0}, by the equation {truth:.0}");
        assert!((below / truth - 1.0).abs() < 0.1, "{rise}° below the horizon: {below} cd/m², by the equation {truth}");
    }
}

#[test]
fn what_deep_space_skips_changes_nothing() {
    let mut stage = stage();
    let camera = "chase:30,10";
    let plain = stage.take("deep_space", None, camera, (160, 90), Force::default());
    for name in ["tile_heights", "terrain", "shadow", "sky"] {
        // A pass that the frame does not have is not asked.
        if let Some(pass) = plain.report.pass(name) {
            println!("{name}: {}", pass.reason);
            assert!(!pass.ran && !pass.reason.is_empty(), "{name} ran in deep space: {}", pass.reason);
        }
    }
    for name in ["shadow", "sky"] {
        assert!(plain.report.pass(name).is_some(), "the report has no {name}");
    }
    let (ran, why) = contact::subsystem(&stage.worlds["deep_space"].ship);
    assert!(!ran && !why.is_empty(), "contact in deep space: {why}");
    let forced = stage.take("deep_space", None, camera, (160, 90), Force { all: true });
    for pass in &forced.report.passes {
        assert!(pass.ran || pass.name == "overlay", "{} was forced and did not run: {}", pass.name, pass.reason);
    }
    assert!(plain.bytes == forced.bytes, "forced passes changed the picture");
    assert!(plain.hdr == forced.hdr, "forced passes changed the light");
}

#[test]
fn what_the_ground_skips_changes_nothing() {
    let mut stage = stage();
    let camera = "at:earth,42.36,-3.62,200,60,-5,55";
    let plain = stage.take("leo", Some(NOON), camera, SIZE, Force::default());
    let forced = stage.take("leo", Some(NOON), camera, SIZE, Force { all: true });
    // Forced, the air is marched at every pixel; else a pixel between four that agree takes their mean (see sky_physical.wgsl).
    let (mut worst, mut squares) = (0.0_f32, 0.0_f64);
    for (a, b) in plain.hdr.rgba.iter().zip(&forced.hdr.rgba) {
        let off = (a - b).abs() / b.abs().max(1e-3);
        worst = worst.max(off);
        squares += f64::from(off * off);
    }
    let rms = (squares / plain.hdr.rgba.len() as f64).sqrt();
    println!("the air at half rate: {rms:.2e} rms, {worst:.2e} at worst");
    assert!(worst < 0.015 && rms < 1.7e-3, "forced passes changed the light: {rms} rms, {worst} at worst");
}
