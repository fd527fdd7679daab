// The sun's disc. Rust side: engine/src/render/pass/sun_disc.rs.

#include "lib/frame.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;

// Linear limb darkening in the visible: I(μ) = 1 − u (1 − μ) [Allen's Astrophysical Quantities, 4th ed., table 14.17], mean 1 − u/3.
const DARKENING: vec3<f32> = vec3<f32>(0.52, 0.60, 0.72);

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) ray: vec3<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    var corners = array<vec2<f32>, 6>(
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, -1.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, 1.0), vec2<f32>(-1.0, 1.0));
    let distance = length(frame.star.xyz);
    let toward = frame.star.xyz / distance;
    let side = normalize(cross(toward, select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 0.0, 1.0), abs(toward.z) < 0.9)));
    let sine = min(frame.star.w / distance, 0.9);
    let reach = sine / sqrt(1.0 - sine * sine) + 2.0 * frame.up.w;
    var out: Varying;
    out.ray = toward + (side * corners[index].x + cross(side, toward) * corners[index].y) * reach;
    let clip = frame.clip_from_icrf * vec4<f32>(out.ray * distance, 1.0);
    out.position = clip;
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let ray = normalize(in.ray);
    let along = dot(ray, frame.star.xyz);
    let miss = length(ray * along - frame.star.xyz) / frame.star.w;
    let cover = clamp((1.0 - miss) * frame.star.w / (along * frame.up.w) + 0.5, 0.0, 1.0);
    if cover <= 0.0 {
        discard;
    }
    let mu = sqrt(max(1.0 - miss * miss, 0.0));
    let shape = (vec3<f32>(1.0) - DARKENING * (1.0 - mu)) / (vec3<f32>(1.0) - DARKENING / 3.0);
    // Mean luminance: illuminance over the solid angle of the disc, I/d² / (π R²/d²).
    let mean = frame.intensity.rgb / (PI * frame.star.w) / frame.star.w;
    return vec4<f32>(to_hdr(mean * shape, exposure.pre) * cover, 1.0);
}
