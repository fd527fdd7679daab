// The sky by the model `thickness`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/thickness.rs.

#include "lib/sky_draw.wgsl"
#include "lib/thickness.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(2) @binding(0) var opaque: texture_2d<f32>;
@group(2) @binding(1) var depth: texture_depth_2d;
@group(2) @binding(2) var<uniform> sky: Sky;
@group(2) @binding(3) var<storage, read> given: array<ProbeRay>;
@group(2) @binding(4) var<storage, read_write> found: array<ProbeLight>;

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));
    let rays = sky_rays(body, air, view);
    var sum = AirLight(vec3<f32>(0.0), vec3<f32>(0.0));
    for (var k = 0u; k < rays; k++) {
        let light = thickness_light(body, air, frame.star, sky, sky_across(body, view, k, rays));
        sum.radiance += light.radiance;
        sum.transmittance += light.transmittance;
    }
    return sky_over(textureLoad(opaque, pixel, 0).rgb, sum, rays, body, exposure);
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let asked = given[id.x];
    let body = sky_probe_body(bodies.list[sky.ids.x], asked);
    let star = sky_probe_star(frame, body, asked);
    let light = thickness_light(body, airs.list[u32(body.ids.z)], star, sky, sky_probe_view(asked));
    found[id.x] = ProbeLight(vec4<f32>(light.radiance, 0.0), vec4<f32>(light.transmittance, 1.0));
}
