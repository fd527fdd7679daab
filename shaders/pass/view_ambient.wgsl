// Table of the sky's light on level ground by sun angle, for `view_table` [Elek 2008, eq. 3.7]: the table of scattering seen from the ground,
// weighted by the cosine over the half sphere. One workgroup per texel; square roots. Rust side: engine/src/render/pass/sky/view_table.rs.

#include "lib/view_table.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var<uniform> vt: ViewTable;
@group(0) @binding(2) var table: texture_storage_2d<rgba16float, write>;
@group(0) @binding(3) var scatter: texture_3d<f32>;
@group(0) @binding(4) var media: texture_2d_array<f32>;
@group(0) @binding(5) var linear: sampler;

const THREADS: u32 = 64u;

var<workgroup> sums: array<vec3<f32>, THREADS>;

@compute @workgroup_size(64)
fn bake(@builtin(workgroup_id) texel: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let mu_s = space_sun(vt.counts.w > 0u, f32(texel.x) / f32(textureDimensions(table).x - 1u));
    let sines = sqrt(max(1.0 - mu_s * mu_s, 0.0));
    let n = vt.counts.z;
    var sum = vec3<f32>(0.0);
    for (var k = index; k < n * n; k += THREADS) {
        let phi = (f32(k / n) + 0.5) / f32(n) * 0.5 * HALF_TURN;
        let omega = (f32(k % n) + 0.5) / f32(n) * HALF_TURN;
        let mu = cos(phi);
        let values = air_phase(air, media, 0, mu * mu_s + sin(phi) * sines * cos(omega));
        let entry = view_entry(air, vt, scatter, linear, 0.0, mu, false, mu_s);
        sum += view_colour(vt, entry, vec2<f32>(dot(values, vt.rgb_phase), dot(values, vt.alpha_phase))) * (mu * sin(phi));
    }
    sums[index] = sum;
    workgroupBarrier();
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        if index < half {
            sums[index] += sums[index + half];
        }
        workgroupBarrier();
    }
    if index == 0u {
        textureStore(table, texel.xy, vec4<f32>(sqrt(sums[0] * (HALF_TURN * HALF_TURN / f32(n * n))), 1.0));
    }
}
