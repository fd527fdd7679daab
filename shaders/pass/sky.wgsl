// What the pass of every model of air has beside its model: what it binds, the vertex stage of its draw, its picture (`fragment`; up to a bank
// of fog, `front`), and its answer to given rays (`probe`). A model's file shaders/pass/sky_<model>.wgsl includes this one and defines,
// with what it binds as group 3,
//
//     fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight  // radiance: cd/m²; in a probe, per unit of the star's illuminance
//
// so that this file is no shader by itself. Rust side: engine/src/render/pass/sky/mod.rs and sky_probe.rs. Not here: what a pixel is
// (lib/sky_pixel.wgsl).
//
// `sky`, like all that a probe's branches hang on, is no uniform: see `compute_pipeline` of engine/src/render/pipeline.rs.

#include "lib/sky_pixel.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(1) @binding(1) var transmittance: texture_2d_array<f32>;
@group(1) @binding(2) var orders: texture_3d<f32>;
@group(1) @binding(4) var linear: sampler;
@group(1) @binding(8) var media: texture_2d_array<f32>;
@group(1) @binding(10) var sheets: texture_2d_array<f32>;
@group(2) @binding(0) var opaque: texture_2d<f32>;
@group(2) @binding(1) var depth: texture_depth_2d;
@group(2) @binding(2) var<storage, read> sky: Sky;
@group(2) @binding(3) var<storage, read> given: array<ProbeRay>;
@group(2) @binding(4) var<storage, read_write> found: array<ProbeLight>;

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    let uv = full_screen_uv(index);
    return Varying(full_screen_position(uv), uv);
}

// Mean over a pixel.
fn sky_mean(body: Body, view: SkyView, spread: SkySpread) -> AirLight {
    let rays = sky_rays(spread);
    var sum = AirLight(vec3<f32>(0.0), vec3<f32>(0.0));
    var clear = 1.0;
    // Asked at its end: a processor that stands in for a GPU goes once more through a loop that asks before, with nothing to do.
    var k = 0u;
    loop {
        let share = sky_across(body, view, spread, k);
        let light = sky_light(body, frame.star, share.view);
        sum.radiance += share.weight * light.radiance;
        sum.transmittance += share.weight * light.transmittance;
        clear -= share.weight;
        k++;
        if k >= rays {
            break;
        }
    }
    sum.transmittance += max(clear, 0.0);
    let present = sky_presence(frame, body, airs.list[u32(body.ids.z)]);
    return AirLight(present * sum.radiance, mix(vec3<f32>(1.0), sum.transmittance, present));
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));
    let light = sky_mean(body, view, sky_spread(frame, body, airs.list[u32(body.ids.z)], view));
    return sky_over(textureLoad(opaque, pixel, 0).rgb, light, exposure);
}

struct Front {
    @location(0) radiance: vec4<f32>,  // pre-exposed
    @location(1) transmittance: vec4<f32>,
}

// The air up to the middle of the way through a bank of fog that lies in it, at every second pixel of every second row: FRONT_RATE.
@fragment
fn front(in: Varying) -> Front {
    let pixel = 2u * vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    var view = sky_view(frame, (vec2<f32>(pixel) + 0.5) * frame.size.zw, textureLoad(depth, pixel, 0));
    let bank = bodies.list[sky.ids.w].centre.xyz;
    view.surface = min(view.surface, max(dot(view.ray, bank), 0.0));
    view.datum = false;
    let light = sky_light(body, frame.star, view);
    return Front(vec4<f32>(to_hdr(light.radiance, exposure.pre), 1.0), vec4<f32>(light.transmittance, 1.0));
}

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let asked = given[id.x];
    let body = sky_probe_body(bodies.list[sky.ids.x], asked);
    let star = sky_probe_star(frame, body, asked);
    let light = sky_light(body, star, sky_probe_view(asked));
    found[id.x] = ProbeLight(vec4<f32>(light.radiance, 0.0), vec4<f32>(light.transmittance, 1.0));
}
