// Flames: a glowing plume behind each bell, the line integral of a Gaussian column along the view ray. Rust side: ships.rs.

#include "lib/frame.wgsl"
#include "lib/ship.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;

// BELLS of engine/src/render/pass/ship_mesh.rs: centre of the mouth and radius, m.
const BELLS = array<vec4<f32>, 3>(
    vec4<f32>(0.0, 0.15, 7.5, 0.92), vec4<f32>(-2.15, -0.15, 7.1, 0.62), vec4<f32>(2.15, -0.15, 7.1, 0.62));
const PEAK_CD_M2: f32 = 6.0e5;

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) point: vec3<f32>,
    @location(1) @interpolate(flat) mouth: vec4<f32>,   // xyz: m from the camera; w: radius, m
    @location(2) @interpolate(flat) axis: vec4<f32>,    // xyz: aft; w: length, m
    @location(3) @interpolate(flat) throttle: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, ship: Ship) -> Varying {
    var bells = BELLS;
    let bell = bells[index / 6u];
    var corners = array<vec2<f32>, 6>(
        vec2<f32>(-1.0, 0.0), vec2<f32>(1.0, 0.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, 0.0), vec2<f32>(1.0, 1.0), vec2<f32>(-1.0, 1.0));
    let corner = corners[index % 6u];
    var out: Varying;
    let throttle = ship.state.x;
    let mouth = ship.centre.xyz + icrf_from_hull(ship, bell.xyz);
    let axis = ship.hull_z.xyz;
    let length_m = bell.w * (6.0 + 26.0 * throttle);
    let wide = bell.w * 4.0;
    // A ribbon along the axis that faces the camera, closed off round both ends.
    let middle = mouth + axis * (0.5 * length_m);
    let view = normalize(middle);
    let across = cross(axis, view);
    let side = select(vec3<f32>(0.0), across / max(length(across), 1e-4), length(across) > 1e-4);
    let along = normalize(cross(view, side) + axis * 1e-4);
    let flip = select(-1.0, 1.0, dot(along, axis) >= 0.0);
    let reach = 0.5 * length_m * abs(dot(along, axis)) + wide;
    out.point = middle + side * (corner.x * wide) + along * (flip * (corner.y * 2.0 - 1.0) * reach);
    out.mouth = vec4<f32>(mouth, bell.w);
    out.axis = vec4<f32>(axis, length_m);
    out.throttle = throttle;
    out.position = frame.clip_from_icrf * vec4<f32>(out.point, 1.0);
    if throttle <= 0.0 {
        out.position = vec4<f32>(0.0, 0.0, 2.0, 1.0);
    }
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    // Closest approach of the ray and the axis.
    let ray = normalize(in.point);
    let axis = in.axis.xyz;
    let b = dot(ray, axis);
    let denominator = max(1.0 - b * b, 0.02);
    let along_ray = dot(ray, in.mouth.xyz);
    let along_axis = dot(axis, in.mouth.xyz);
    let s = (b * along_ray - along_axis) / denominator;   // along the plume, from the mouth
    let t = max(along_ray + s * b, 0.0);
    let gap = length(ray * t - in.mouth.xyz - axis * s);
    let x = s / in.axis.w;
    if x > 1.0 || x < -0.1 {
        discard;
    }
    let w = in.mouth.w * (0.55 + 1.5 * max(x, 0.0));
    // ∫ exp(−r²/w²) along the ray is √π w / sin θ · exp(−gap²/w²); density falls as the plume widens.
    let column = exp(-gap * gap / (w * w)) * in.mouth.w / w / sqrt(denominator);
    let fade = exp(-3.2 * max(x, 0.0)) * smoothstep(1.0, 0.6, x) * smoothstep(-0.1, 0.02, x);
    let core = exp(-4.0 * gap * gap / (w * w)) * exp(-9.0 * max(x, 0.0));
    let colour = mix(vec3<f32>(0.16, 0.34, 1.0), vec3<f32>(0.85, 0.93, 1.0), clamp(core, 0.0, 1.0));
    return vec4<f32>(to_hdr(colour * (column * fade * in.throttle * PEAK_CD_M2 * (0.06 + core)), exposure.pre), 0.0);
}
