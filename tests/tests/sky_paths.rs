//! Where rays of sight end in `shaders/lib/sky_pixel.wgsl`: between the datum's horizon and that of ground which lies deeper nothing is drawn,
//! and no datum may end a ray there; a dark band along the plains of Mars came of that. Also how bright the ground is that ends them.
//!
//! Not here: what is found along them (`sky.rs`, `sky_orders.rs`).

use engine::air::model::shell::Chord;
use engine::space::relative::narrow;
use glam::DVec3;

/// Mars, with the air of its file.
const R: f64 = 3.3895e6;
const TOP: f64 = 1.4e5;

const SHADER: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    let q = id.x * 2u;
    if q >= arrayLength(&given) { return; }
    var body: Body;
    var air: Air;
    let asked = given[q];
    body.up = vec4<f32>(0.0, 0.0, 1.0, asked.x);
    body.ids.w = i32(asked.z);
    air.shape = vec4<f32>(given[q + 1u].xy, 0.0, 0.0);
    let view = SkyView(vec3<f32>(cos(asked.y), 0.0, -sin(asked.y)), 1e30, true, asked.w);
    let path = sky_path(body, air, view);
    found[q] = vec4<f32>(path.start, sky_end(air, path, view), path.exit, path.ground);
}";

/// From an altitude, so many degrees under the horizontal; relief or none; angle of a pixel.
fn end_m(questions: &[(f64, f64, bool, f64)]) -> Vec<f64> {
    let parts: Vec<[f32; 4]> = questions
        .iter()
        .flat_map(|&(altitude, below_deg, relief, pixel)| {
            let relief = if relief { 1.0 } else { 0.0 };
            [[narrow(altitude), narrow(below_deg.to_radians()), relief, narrow(pixel)], [narrow(R), narrow(TOP), 0.0, 0.0]]
        })
        .collect();
    let answers = tests::ask_shader("lib/thickness.wgsl", SHADER, "ask", &parts);
    answers.chunks(2).map(|a| f64::from(a[0][1])).collect()
}

/// Length of the way through air over ground of radius `bottom`.
fn truth_m(altitude: f64, below_deg: f64, bottom: f64) -> f64 {
    let (sine, cosine) = libm::sincos(below_deg.to_radians());
    let chord = Chord::new(DVec3::Z * (R + altitude), DVec3::new(cosine, 0.0, -sine), bottom, R + TOP - bottom).expect("it meets the air");
    chord.end_m(None) - chord.start_m
}

#[test]
fn over_deep_ground_the_datum_ends_no_ray_that_a_picture_left_open() {
    // From 4 km the datum's horizon lies 2.78° under the horizontal; that of ground 5 km deeper, 4.2°.
    let pixel = 1e-3;
    let questions = [
        (4000.0, 2.0, true, pixel),
        (4000.0, 2.9, true, pixel),
        (4000.0, 4.1, true, pixel),
        // A smooth world has no deeper ground; a given ray of no width asks for the datum.
        (4000.0, 4.1, false, pixel),
        (4000.0, 4.1, true, 0.0),
        // Not through the planet, where a tile of the ground is missing.
        (4000.0, 30.0, true, pixel),
        // From above the air what is deeper is less than a pixel.
        (4.0e5, 27.0, true, pixel),
    ];
    let deep = R - 1.0e4;
    let wanted = [
        truth_m(4000.0, 2.0, deep),
        truth_m(4000.0, 2.9, deep),
        truth_m(4000.0, 4.1, deep),
        truth_m(4000.0, 4.1, R),
        truth_m(4000.0, 4.1, R),
        truth_m(4000.0, 30.0, R),
        truth_m(4.0e5, 27.0, R),
    ];
    for ((question, found), wanted) in questions.iter().zip(end_m(&questions)).zip(wanted) {
        assert!((found / wanted - 1.0).abs() < 1e-3, "{question:?}: {found}, {wanted}");
    }
    assert!(wanted[2] > 5.0 * wanted[3]);
}

#[test]
fn ground_under_air_is_as_bright_as_that_air_takes_it_for() {
    // What is drawn of the ground of Venus is not what its clouds throw back; without air, or where air says nothing, a world's own albedo counts.
    let ask = "
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) { return; }
    var body: Body;
    var air: Air;
    body.albedo = vec4<f32>(0.76, 0.69, 0.56, 0.0);
    body.ids.z = i32(given[id.x].w);
    air.albedo = vec4<f32>(given[id.x].rgb, 0.5);
    found[id.x] = vec4<f32>(ground_albedo(body, air), 0.0);
}";
    let told = [0.15, 0.1, 0.06];
    let found =
        tests::ask_shader("lib/daylight.wgsl", ask, "ask", &[[0.15, 0.1, 0.06, 3.0], [0.15, 0.1, 0.06, -1.0], [0.0, 0.0, 0.0, 0.0]]);
    let rgb = |i: usize| [found[i][0], found[i][1], found[i][2]];
    assert_eq!([rgb(0), rgb(1), rgb(2)], [told, [0.76, 0.69, 0.56], [0.76, 0.69, 0.56]]);
}
