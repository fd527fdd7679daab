//! Readouts for tests: an ordinary one and extreme ones.

use crate::command::{Guidance, Hold};
use crate::world::readout::{Markers, OrbitReadout, Readout, Situation};
use engine::orbit::BodyId;
use engine::time::SimTime;
use glam::{DQuat, DVec3};

/// A ship in a low orbit.
pub fn readout() -> Readout {
    Readout {
        time: SimTime::from_jd_tdb(2_461_265.2),
        warp: crate::command::WARP_ONE,
        warp_asked: crate::command::WARP_ONE,
        body: BodyId(0),
        situation: Situation::Coasting,
        altitude_m: 420_000.0,
        ground_m: 0.0,
        lat_lon_rad: (0.7, -0.2),
        orbital_speed_m_s: 7_660.0,
        surface_speed_m_s: 7_300.0,
        vertical_speed_m_s: -1.5,
        orbit: OrbitReadout {
            apoapsis_m: 422_000.0,
            periapsis_m: 418_000.0,
            period_s: 5_570.0,
            eccentricity: 0.000_3,
            inclination_rad: 0.9,
            to_apoapsis_s: 900.0,
            to_periapsis_s: 3_700.0,
        },
        heading_pitch_roll_rad: [1.2, 0.1, 0.0],
        angular_rate_rad_s: DVec3::ZERO,
        icrf_from_hull: DQuat::IDENTITY,
        markers: Markers {
            prograde: DVec3::NEG_Z,
            surface_prograde: DVec3::new(0.05, 0.0, -1.0).normalize(),
            normal: DVec3::NEG_X,
            radial_out: DVec3::Y,
            zenith: DVec3::Y,
            north: DVec3::new(-0.6, 0.0, -0.8),
            target: DVec3::ZERO,
            node: DVec3::ZERO,
            sun: DVec3::new(0.3, 0.8, 0.2).normalize(),
        },
        density_kg_m3: 0.0,
        pressure_pa: 0.0,
        dynamic_pressure_pa: 0.0,
        mach: 0.0,
        heat_flux_w_m2: 0.0,
        load_g: 0.0,
        throttle: 0.0,
        rcs: 0.0,
        mass_kg: 60_000.0,
        propellant_kg: (20_000.0, 40_000.0),
        delta_v_m_s: 21_000.0,
        gear_down: false,
        hold: Hold::Rate,
        guidance: Guidance::Manual,
        guidance_phase: "",
        target: None,
        node: None,
        sun_visible: 1.0,
        eclipsed_by: None,
        eclipse: None,
        warnings: Vec::new(),
        last_contact: None,
    }
}

/// Readouts with values that a display must survive.
pub fn extremes() -> Vec<Readout> {
    use crate::command::{Spot, Target};
    use crate::world::readout::{NodeReadout, TargetReadout, Warning};
    let mut escape = readout();
    escape.orbit = OrbitReadout {
        apoapsis_m: f64::INFINITY,
        period_s: f64::INFINITY,
        to_apoapsis_s: f64::INFINITY,
        to_periapsis_s: -1e9,
        ..escape.orbit
    };
    escape.warnings = vec![Warning::Crashed, Warning::PullUp, Warning::Heat, Warning::WarpLowered];
    escape.sun_visible = 0.57;
    escape.eclipsed_by = Some(BodyId(1));
    escape.guidance_phase = "braking";
    escape.target = Some(TargetReadout {
        target: Target { body: BodyId(1), spot: Some(Spot { lat_udeg: 1, lon_udeg: -1 }) },
        distance_m: 1e13,
        closing_m_s: -3e5,
        ground_distance_m: Some(1.0),
    });
    let broken = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX].map(|x| {
        let v = DVec3::splat(x);
        let markers =
            Markers { prograde: v, surface_prograde: v, normal: v, radial_out: v, zenith: v, north: v, target: v, node: v, sun: v };
        Readout {
            altitude_m: x,
            ground_m: x,
            lat_lon_rad: (x, x),
            orbital_speed_m_s: x,
            surface_speed_m_s: x,
            vertical_speed_m_s: x,
            orbit: OrbitReadout {
                apoapsis_m: x,
                periapsis_m: x,
                period_s: x,
                eccentricity: x,
                inclination_rad: x,
                to_apoapsis_s: x,
                to_periapsis_s: x,
            },
            heading_pitch_roll_rad: [x; 3],
            markers,
            density_kg_m3: x,
            dynamic_pressure_pa: x,
            mach: x,
            heat_flux_w_m2: x,
            load_g: x,
            throttle: x,
            propellant_kg: (x, x),
            delta_v_m_s: x,
            sun_visible: x,
            last_contact: Some((x, 0)),
            node: Some(NodeReadout { count: 3, to_node_s: x, to_burn_s: x, burn_s: x, dv_m_s: x, left_m_s: x }),
            target: Some(TargetReadout { distance_m: x, closing_m_s: x, ground_distance_m: Some(x), ..escape.target.unwrap() }),
            ..readout()
        }
    });
    let mut all = vec![escape];
    all.extend(broken);
    all
}

/// A small World.
pub fn world() -> crate::world::World {
    crate::save::fixture::worlds().remove(0)
}

/// Runs two frames of a HUD without a window and returns the texts of the second one.
pub fn run(show: impl FnMut(&egui::Context)) -> Vec<String> {
    run_at((1280.0, 720.0), 1.0, show)
}

/// The same in a window of so many points, each of so many pixels.
pub fn run_at(size: (f32, f32), pixels_per_point: f32, mut show: impl FnMut(&egui::Context)) -> Vec<String> {
    let ctx = egui::Context::default();
    ctx.set_pixels_per_point(pixels_per_point);
    super::style::apply(&ctx);
    let mut texts = Vec::new();
    for _ in 0..2 {
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(size.0, size.1))),
            ..Default::default()
        };
        let output = ctx.run_ui(input, |ui| show(ui.ctx()));
        texts.clear();
        for shape in &output.shapes {
            collect(&shape.shape, &mut texts);
        }
        for text in &texts {
            let font = super::style::words(12.0);
            let missing: String = text.chars().filter(|c| !c.is_whitespace() && !ctx.fonts_mut(|f| f.has_glyph(&font, *c))).collect();
            assert!(missing.is_empty(), "no font has `{missing}` of `{text}`");
        }
        let _ = ctx.tessellate(output.shapes.clone(), pixels_per_point);
        output.drop_without_applying_deltas();
    }
    texts
}

fn collect(shape: &egui::Shape, texts: &mut Vec<String>) {
    match shape {
        egui::Shape::Text(text) => texts.push(text.galley.text().to_owned()),
        egui::Shape::Vec(all) => all.iter().for_each(|s| collect(s, texts)),
        egui::Shape::Mesh(mesh) => assert!(mesh.vertices.iter().all(|v| v.pos.is_finite()), "a vertex that is nowhere"),
        _ => {}
    }
}
