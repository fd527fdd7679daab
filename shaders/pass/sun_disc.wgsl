// The sun's disc and corona. Rust side: engine/src/render/pass/sun_disc.rs.

#include "lib/frame.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;

// Linear limb darkening in the visible: I(μ) = 1 − u (1 − μ) [Allen's Astrophysical Quantities, 4th ed., table 14.17], mean 1 − u/3.
const DARKENING: vec3<f32> = vec3<f32>(0.52, 0.60, 0.72);

// Half side of the quad, in radii of the star.
const REACH: f32 = 8.0;

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
    let reach = REACH * sine / sqrt(1.0 - sine * sine) + 2.0 * frame.up.w;
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
    // Mean luminance of the disc: illuminance over its solid angle, I/d² / (π R²/d²).
    let mean = frame.intensity.rgb / (PI * frame.star.w) / frame.star.w;
    let mu = sqrt(max(1.0 - miss * miss, 0.0));
    let disc = (vec3<f32>(1.0) - DARKENING * (1.0 - mu)) / (vec3<f32>(1.0) - DARKENING / 3.0);

    // Corona, in millionths of the disc [Baumbach 1937; Allen's Astrophysical Quantities, 4th ed., §14.10], streamers by angle.
    let r = max(miss, 1.0);
    let r2 = r * r;
    let offset = (ray * along - frame.star.xyz) / frame.star.w;
    let a = atan2(dot(offset, frame.up.xyz), dot(offset, frame.right.xyz));
    let streamers = 1.0 + (0.35 * sin(2.0 * a + 0.7) + 0.25 * sin(5.0 * a + 2.1) + 0.15 * sin(11.0 * a)) * smoothstep(1.0, 1.8, r);
    let profile = 0.0532 / (r2 * sqrt(r)) * streamers + 1.425 / (r2 * r2 * r2 * r) + 2.565 / (r2 * r2 * r2 * r2 * r2 * r2 * r2 * r2 * r);
    let edge = smoothstep(REACH, 0.7 * REACH, miss);
    return vec4<f32>(to_hdr(mean * mix(vec3<f32>(1e-6 * profile * edge), disc, cover), exposure.pre), 0.0);
}
