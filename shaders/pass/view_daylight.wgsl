// What lights the ground under `view_table`, in the form in which ground and ships ask (lib/air.wgsl): the sun through the table of
// optical depth [Elek 2008, eq. 3.6], the sky by the ambient table, which knows no height [eq. 3.7]. Into the slot of the body's air.
// Rust side: engine/src/render/pass/sky/view_table.rs.

#include "lib/air.wgsl"
#include "lib/view_table.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var<uniform> vt: ViewTable;
@group(0) @binding(2) var transmittance: texture_storage_2d<rgba16float, write>;
@group(0) @binding(3) var irradiance: texture_storage_2d<rgba16float, write>;
@group(0) @binding(4) var depth: texture_2d<f32>;
@group(0) @binding(5) var ambient: texture_2d<f32>;
@group(0) @binding(6) var linear: sampler;

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) id: vec3<u32>) {
    let sun = textureDimensions(transmittance);
    if all(id.xy < sun) {
        let point = transmittance_point(air, table_x(id.xy, vec2<f32>(sun)));
        let through = exp(-view_depth(air, vt, depth, point.x, point.y));
        textureStore(transmittance, id.xy, transmittance_encode(vec4<f32>(through, 1.0)));
    }
    let sky = textureDimensions(irradiance);
    if all(id.xy < sky) {
        let at = table_x(id.xy, vec2<f32>(sky));
        let mu_s = orders_sun_mu(air, horizon_dip(air.shape.x, orders_altitude(air, id.y)), at.x);
        let size = f32(textureDimensions(ambient).x);
        let x = (space_sun_x(vt.counts.w > 0u, mu_s) * (size - 1.0) + 0.5) / size;
        // Its square roots become the fourth roots of that table.
        textureStore(irradiance, id.xy, sqrt(textureSampleLevel(ambient, linear, vec2<f32>(x, 0.5), 0.0)));
    }
}
