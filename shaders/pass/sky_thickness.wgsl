// The sky by the model `thickness`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/thickness.rs.

#include "pass/sky.wgsl"
#include "lib/thickness.wgsl"

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    return in_starlight(body, thickness_light(body, airs.list[u32(body.ids.z)], star, sky, view));
}
