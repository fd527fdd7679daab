//! Twin: `shaders/lib/medium.wgsl` against `engine::air` in f64: densities and phase functions of every kind as formulas, and media of any
//! number of layers, tables among them, by what the GPU is handed of them.

use engine::air::{Classes, Layer, Medium, Phase, Profile};
use engine::scene::gpu_data::{AirUniform, MEDIA_COLUMNS, MEDIA_ROWS, media_rows};
use glam::{DVec3, Vec3};
use std::fmt::Write as _;

/// `(kind, altitude, cosine, 0)`: extinction for kind 0; light scattered into the angle, summed over the classes, for kind 1.
const MAIN: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) { return; }
    let q = given[id.x];
    let air = the_air();
    let density = air_density(air, q.y);
    if q.x < 0.5 {
        found[id.x] = vec4<f32>(air.extinction * density, 0.0);
    } else {
        found[id.x] = vec4<f32>(air.scattering * (density * phase_values(air.phases, q.z)), 0.0);
    }
}";

/// The uniform as WGSL: the shader is asked without a binding for it.
fn written(air: &AirUniform) -> String {
    let v4 = |v: [f32; 4]| format!("vec4<f32>({:e}, {:e}, {:e}, {:e})", v[0], v[1], v[2], v[3]);
    let m = |m: [[f32; 4]; 4]| {
        let columns: Vec<String> = m.iter().map(|v| format!("vec3<f32>({:e}, {:e}, {:e})", v[0], v[1], v[2])).collect();
        format!("mat4x3<f32>({})", columns.join(", "))
    };
    let p = air.phases;
    let phases = format!("Phases({}, {}, {}, {})", v4(p.g), v4(p.x), v4(p.y), v4(p.z));
    let fields = [
        ("shape", v4(air.shape)),
        ("albedo", v4(air.albedo)),
        ("scattering", m(air.scattering)),
        ("extinction", m(air.extinction)),
        ("inverse_height", v4(air.inverse_height)),
        ("tent_bottom", v4(air.tent_bottom)),
        ("tent_rise", v4(air.tent_rise)),
        ("tent_top", v4(air.tent_top)),
        ("tent_fall", v4(air.tent_fall)),
        ("phases", phases),
    ];
    let mut text = "fn the_air() -> Air {\n    var air: Air;\n".to_owned();
    for (field, value) in fields {
        let _ = writeln!(text, "    air.{field} = {value};");
    }
    text += "    return air;\n}\n";
    text += MAIN;
    text
}

fn layer(scattering: [f32; 3], absorption: f32, profile: Profile, phase: Phase) -> Layer {
    Layer { scattering_per_m: Vec3::from(scattering), absorption_per_m: Vec3::splat(absorption), profile, phase }
}

fn medium(layers: Vec<Layer>) -> Medium {
    Medium { bottom_radius_m: 6.36e6, top_altitude_m: 1.0e5, ground_albedo: Vec3::splat(0.1), layers }
}

/// Every analytic kind, four at a time.
fn direct() -> Vec<Medium> {
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    let tent = Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 };
    let fog = Profile::Constant { bottom_m: 0.0, top_m: 300.0 };
    let cloud = Profile::Constant { bottom_m: 2000.0, top_m: 2600.0 };
    vec![
        medium(vec![
            layer([5.8e-6, 1.36e-5, 3.3e-5], 0.0, exponential(8000.0), Phase::Rayleigh),
            layer([4e-6; 3], 4e-7, exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
            layer([0.0; 3], 1.8e-6, tent.clone(), Phase::Rayleigh),
            layer([1e-4; 3], 0.0, fog, Phase::HenyeyGreenstein { g: 0.85 }),
        ]),
        medium(vec![
            layer([5.8e-6, 1.36e-5, 3.3e-5], 0.0, tent, Phase::ElekRayleigh),
            layer([3e-6; 3], 4e-7, exponential(900.0), Phase::HenyeyGreenstein { g: -0.99 }),
            layer([1e-3, 2e-3, 1e-3], 0.0, cloud, Phase::Isotropic),
            layer([2e-6; 3], 0.0, exponential(4000.0), Phase::CornetteShanks { g: 0.99 }),
        ]),
        medium(Vec::new()),
    ]
}

#[test]
fn formulas_are_the_same() {
    for medium in direct() {
        let classes = Classes::of(&medium);
        assert!(classes.direct);
        let mut questions = Vec::new();
        for i in 0..1500 {
            let x = f64::from(i) / 1499.0;
            // Altitudes that f32 holds, off the edges of steps by more than it rounds.
            let h = (x * x * 1.2e5 - 1.2e4 + 0.37) as f32;
            let c = (1.0 - 2.0 * (x * 13.7).fract().powi(3)) as f32;
            questions.push([0.0, h, c, 0.0]);
            questions.push([1.0, h, c, 0.0]);
        }
        questions.extend([1.0, -1.0, 0.999_999, -0.999_999].map(|c| [1.0, 2200.0, c, 0.0]));
        let answers = tests::ask_shader("lib/medium.wgsl", &written(&AirUniform::new(&medium, &classes)), "ask", &questions);
        for (q, a) in questions.iter().zip(answers) {
            let (h, c) = (f64::from(q[1]), f64::from(q[2]));
            let truth: DVec3 =
                if q[0] < 0.5 { medium.extinction(h) } else { classes.list.iter().map(|k| k.scattering(&medium, h) * k.value(c)).sum() };
            for channel in 0..3 {
                let error = (f64::from(a[channel]) - truth[channel]).abs();
                // What a rounded cosine may do to the sharpest peak: 6e-8 of (1 − g)² / 2g = 5e-5.
                assert!(error <= 4e-3 * truth[channel] + 1e-16, "{q:?} channel {channel}: {} of {}", a[channel], truth[channel]);
                let blunt = q[2].abs() < 0.99;
                assert!(!blunt || error <= 3e-5 * truth[channel] + 1e-16, "{q:?} channel {channel}: {} of {}", a[channel], truth[channel]);
            }
        }
    }
}

/// What the shader makes of the tables, in f64: linear between columns.
fn looked_up(rows: &[[f32; 4]], row: usize, column: f64) -> DVec3 {
    let at = column.clamp(0.0, (MEDIA_COLUMNS - 1) as f64);
    let low = (at.floor() as usize).min(MEDIA_COLUMNS - 2);
    let texel = |i: usize| Vec3::from_slice(&rows[row * MEDIA_COLUMNS + i]).as_dvec3();
    texel(low).lerp(texel(low + 1), at - low as f64)
}

#[test]
fn tables_hold_the_layers() {
    let table = Profile::Table { altitude_m: vec![0.0, 1.0e4, 3.0e4, 6.0e4], density: vec![1.0, 0.8, 0.1, 0.0] };
    let halo = Phase::Table { angle_deg: vec![0.0, 5.0, 20.0, 22.0, 24.0, 120.0, 180.0], value: vec![9.0, 4.0, 1.0, 3.0, 1.0, 0.3, 0.5] };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    let medium = medium(vec![
        layer([5.8e-6, 1.36e-5, 3.3e-5], 0.0, exponential(8000.0), Phase::Rayleigh),
        layer([4e-6; 3], 4e-7, exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
        layer([2e-6; 3], 1e-7, table, halo.normalised()),
        layer([0.0; 3], 1.8e-6, Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 }, Phase::Rayleigh),
        layer([1e-6; 3], 0.0, exponential(3000.0), Phase::Rayleigh),
    ]);
    let classes = Classes::of(&medium);
    assert!(!classes.direct && classes.list.len() == 3);
    let rows = media_rows(&medium, &classes);
    assert_eq!(rows.len(), MEDIA_ROWS * MEDIA_COLUMNS);
    let floor = (1e4_f64 / 1e5).sqrt();
    let (mut worst, mut worst_phase) = (0.0_f64, 0.0_f64);
    for i in 0..4000 {
        let x = f64::from(i) / 3999.0;
        let h = x * x * 1.1e5 - 1.0e4;
        let root = (h.abs() / 1e5).sqrt() * h.signum();
        let column = (root + floor) / (1.0 + floor) * (MEDIA_COLUMNS - 1) as f64;
        let truth = medium.extinction(h);
        // Of the value, beside 1e-4 of what there is at the ground: bends of a profile fall between columns.
        worst = worst.max(((looked_up(&rows, 4, column) - truth).abs() / (truth + 1e-7)).max_element());
        let c = 2.0 * x - 1.0;
        let phases = looked_up(&rows, 5, (c.acos() / std::f64::consts::PI).sqrt() * (MEDIA_COLUMNS - 1) as f64);
        for (k, class) in classes.list.iter().enumerate() {
            worst_phase = worst_phase.max((phases[k] / class.value(c) - 1.0).abs());
        }
    }
    println!("extinction off by {worst:.1e}, phase by {worst_phase:.1e}");
    // The halo's bends lie up to half a column, 0.06°, beside the table's.
    assert!(worst < 2e-2 && worst_phase < 3e-2, "{worst} {worst_phase}");
}
