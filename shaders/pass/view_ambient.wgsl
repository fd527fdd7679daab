// Table of the sky's light on level ground by sun angle, for `view_table` [Elek 2008, eq. 3.7]: the table of scattering seen from the ground,
// weighted by the cosine over the half sphere. Square roots.
// Rust side: engine/src/render/pass/sky/view_table.rs.

#include "lib/view_table.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var<uniform> vt: ViewTable;
@group(0) @binding(2) var table: texture_storage_2d<rgba16float, write>;
@group(0) @binding(3) var scatter: texture_3d<f32>;
@group(0) @binding(4) var media: texture_2d_array<f32>;
@group(0) @binding(5) var linear: sampler;

@compute @workgroup_size(8)
fn bake(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = textureDimensions(table).x;
    // Threads beyond the edge do the edge's work again.
    let id = min(thread.x, size - 1u);
    let mu_s = space_sun(vt.counts.w > 0u, f32(id) / f32(size - 1u));
    let sines = sqrt(max(1.0 - mu_s * mu_s, 0.0));
    let n = vt.counts.z;
    var sum = vec3<f32>(0.0);
    for (var i = 0u; i < n; i++) {
        let phi = (f32(i) + 0.5) / f32(n) * 0.5 * HALF_TURN;
        let mu = cos(phi);
        let entry = view_entry(air, vt, scatter, linear, 0.0, mu, false, mu_s);
        var phases = vec2<f32>(0.0);
        for (var k = 0u; k < n; k++) {
            let omega = (f32(k) + 0.5) / f32(n) * HALF_TURN;
            let values = air_phase(air, media, 0, mu * mu_s + sin(phi) * sines * cos(omega));
            phases += vec2<f32>(dot(values, vt.rgb_phase), dot(values, vt.alpha_phase));
        }
        sum += view_colour(vt, entry, phases) * (mu * sin(phi));
    }
    textureStore(table, vec2<u32>(id, 0u), vec4<f32>(sqrt(sum * (HALF_TURN * HALF_TURN / f32(n * n))), 1.0));
}
