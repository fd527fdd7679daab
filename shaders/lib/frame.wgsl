// Frame: what every pass knows of the picture, the bodies and the exposure. Mirrored by engine/src/scene/gpu_data.rs.
// Bind as group 0: @binding(0) var<uniform> frame: Frame; @binding(1) var<uniform> bodies: Bodies; @binding(2) var<uniform> exposure: Exposure;
// All positions are metres from the camera, ICRF axes. Not here: light and air (group 1).

const MAX_BODIES: u32 = 32u;
const MAX_OCCLUDERS: u32 = 8u;
const PI: f32 = 3.14159265358979;

struct Frame {
    clip_from_icrf: mat4x4<f32>,
    right: vec4<f32>,      // xyz: camera right × tan(fov_x / 2); w: near plane, m
    up: vec4<f32>,         // xyz: camera up × tan(fov_y / 2); w: angle of a pixel, rad
    forward: vec4<f32>,    // xyz: view direction; w: seconds since the last frame, negative where there was none
    size: vec4<f32>,       // width, height, 1 / width, 1 / height
    star: vec4<f32>,       // xyz: centre, m; w: radius, m
    intensity: vec4<f32>,  // rgb: luminous intensity of the star, cd
    counts: vec4<u32>,     // bodies, frame number (for noise), 0, 0
}

struct Body {
    centre: vec4<f32>,       // xyz: centre, m; w: radius, m
    fixed_x: vec4<f32>,      // columns of icrf_from_fixed
    fixed_y: vec4<f32>,
    fixed_z: vec4<f32>,
    up: vec4<f32>,           // xyz: from the centre to the camera, unit; w: altitude of the camera, m
    sun: vec4<f32>,          // xyz: to the star, unit; w: angular radius of the star, rad
    illuminance: vec4<f32>,  // rgb: by the star above the air, lx
    albedo: vec4<f32>,       // rgb: mean albedo
    ids: vec4<i32>,          // body id; occluders in use; slot of its air or −1; 1 where terrain tiles draw it
    lights: vec4<i32>,       // 1 where an occluder has air; layer of its own refracted light or −1; 1 where there is a second light; 1 where the star lights no air in view
    second: vec4<f32>,       // of the second light: xyz: to it, unit; w: its angular radius, rad
    second_illuminance: vec4<f32>,  // rgb: by it above the air, lx
    sheets: array<vec4<f32>, 16>,   // of each occluder: a direction across its shadow, first layer of its sheet or −1; the sheet's half width, m, its bend, root of the two: lib/eclipse_rings.wgsl
    casters: array<vec4<i32>, 2>,   // of each occluder: layer of the light that its air bends into its shadow, or −1
    occluders: array<vec4<f32>, MAX_OCCLUDERS>,  // xyz: centre, m; w: radius, m
}

struct Bodies {
    list: array<Body, MAX_BODIES>,
}

struct Exposure {
    pre: f32,        // stored HDR value = luminance (cd/m²) × pre
    final_: f32,     // exposure that the picture wants, in the same unit
    average: f32,    // trimmed mean luminance, cd/m²
    settled: f32,    // 1 once a histogram has been taken
}

// Direction (not unit) through a pixel; uv is 0…1 from the top left.
fn view_ray(frame: Frame, uv: vec2<f32>) -> vec3<f32> {
    return frame.forward.xyz + frame.right.xyz * (2.0 * uv.x - 1.0) + frame.up.xyz * (1.0 - 2.0 * uv.y);
}

// Distance along the view axis from stored depth (infinite reversed-Z); depth 0 is infinitely far.
fn axis_distance(frame: Frame, depth: f32) -> f32 {
    return frame.right.w / max(depth, 1e-30);
}

// Body-fixed direction of an ICRF direction.
fn fixed_from_icrf(body: Body, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(v, body.fixed_x.xyz), dot(v, body.fixed_y.xyz), dot(v, body.fixed_z.xyz));
}

// A triangle that covers the picture: position from the vertex index, uv = (0…1 from the top left).
fn full_screen_uv(index: u32) -> vec2<f32> {
    return vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
}
fn full_screen_position(uv: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0);
}

// What is stored in the HDR target: pre-exposed, kept inside half floats, never NaN.
fn to_hdr(luminance: vec3<f32>, pre: f32) -> vec3<f32> {
    let v = luminance * pre;
    return clamp(select(vec3<f32>(0.0), v, v == v), vec3<f32>(0.0), vec3<f32>(60000.0));
}
