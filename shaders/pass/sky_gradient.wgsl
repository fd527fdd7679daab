// The sky by the model `gradient`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/gradient.rs.

#include "pass/sky.wgsl"
#include "lib/gradient.wgsl"

@group(3) @binding(0) var shell_map: texture_2d<f32>;
@group(3) @binding(1) var ground_map: texture_2d<f32>;

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    return in_starlight(body, gradient_light(body, airs.list[u32(body.ids.z)], shell_map, ground_map, star, sky, view));
}
