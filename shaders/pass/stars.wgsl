// Stars and distant bodies: sprites of constant total flux. Rust side: engine/src/render/pass/stars.rs.

#include "lib/frame.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;

const SIGMA_PX: f32 = 0.65;   // of the Gaussian; under half a pixel it would flicker
const REACH_PX: f32 = 2.5;    // half side of the sprite

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) offset: vec2<f32>,                        // from the centre, pixels
    @location(1) @interpolate(flat) peak: vec3<f32>,       // stored HDR value at the centre
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @location(0) point: vec3<f32>, @location(1) illuminance: vec3<f32>) -> Varying {
    var corners = array<vec2<f32>, 6>(
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, -1.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, 1.0), vec2<f32>(-1.0, 1.0));
    var out: Varying;
    let clip = frame.clip_from_icrf * vec4<f32>(point, 1.0);
    // A pixel off the axis covers cos³ of the solid angle of the central one.
    let cosine = dot(normalize(point * 1e-9), frame.forward.xyz);
    let solid_angle = frame.up.w * frame.up.w * cosine * cosine * cosine;
    out.peak = illuminance / (solid_angle * 2.0 * PI * SIGMA_PX * SIGMA_PX) * exposure.pre;
    // Behind the camera, or too faint to change the smallest stored value: no area.
    if cosine <= 0.0 || max(out.peak.r, max(out.peak.g, out.peak.b)) < 1e-4 {
        out.position = vec4<f32>(0.0, 0.0, 2.0, 1.0);
        return out;
    }
    out.offset = corners[index] * REACH_PX;
    let ndc = clip.xy / clip.w + out.offset * 2.0 * frame.size.zw;
    out.position = vec4<f32>(ndc, clip.z / clip.w, 1.0);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let weight = exp(-0.5 * dot(in.offset, in.offset) / (SIGMA_PX * SIGMA_PX));
    return vec4<f32>(min(in.peak * weight, vec3<f32>(60000.0)), 0.0);
}
