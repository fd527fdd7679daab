// The sky by the model `limb_table`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/limb_table.rs.

#include "pass/sky.wgsl"
#include "lib/limb_table.wgsl"

@group(3) @binding(0) var table: texture_2d<f32>;

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    return in_starlight(body, limb_table_light(body, airs.list[u32(body.ids.z)], table, linear, star, sky, view));
}
