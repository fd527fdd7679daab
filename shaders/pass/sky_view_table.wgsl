// The sky by the model `view_table`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/view_table.rs.

#include "pass/sky.wgsl"
#include "lib/view_table.wgsl"

@group(3) @binding(0) var<storage, read> vt: ViewTable;
@group(3) @binding(1) var scatter: texture_3d<f32>;
@group(3) @binding(2) var depths: texture_2d<f32>;

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    return in_starlight(body, view_table_light(body, airs.list[u32(body.ids.z)], media, vt, scatter, depths, linear, star, view));
}
