// The sky by the model `thickness`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/thickness.rs.

#include "pass/sky.wgsl"
#include "lib/thickness.wgsl"

@group(3) @binding(0) var front_radiance: texture_2d<f32>;
@group(3) @binding(1) var front_transmittance: texture_2d<f32>;

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    return in_starlight(body, thickness_light(body, airs.list[u32(body.ids.z)], star, sky, view));
}

// A bank of fog within another's air A. What is behind has all of A's light already; it belongs before the bank as far as it comes from there:
// A₀ + T₀ (fog + T · rest), with A₀, T₀ of A up to the bank's middle and rest = (behind − A₀) / T₀.
@fragment
fn held(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));
    let rays = sky_rays(body, airs.list[u32(body.ids.z)], view);
    let sum = sky_sum(body, view, rays);
    let place = min(pixel / 2u, textureDimensions(front_radiance) - 1u);
    let before = textureLoad(front_radiance, place, 0).rgb;
    let through = textureLoad(front_transmittance, place, 0).rgb;
    let clear = sum.transmittance / f32(rays);
    let fog = sum.radiance * (exposure.pre / f32(rays));
    return vec4<f32>(to_hdr(clear * textureLoad(opaque, pixel, 0).rgb + (1.0 - clear) * before + through * fog, 1.0), 1.0);
}
