// The sky by the model `physical`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/physical.rs.
//
// `fragment` (of pass/sky.wgsl) marches at every pixel. Else there are levels, of every eighth pixel of every eighth row to every pixel, each two textures.
// `march_level` marches at all of the first; on the others `take_level` gives what lies between four texels of the level before that agree the mean of
// those, and `march_level` marches at what that has left, which the stencil tells. `lay` draws the picture from the last.

#include "pass/sky.wgsl"
#include "lib/physical.wgsl"
#include "lib/second_light.wgsl"

@group(3) @binding(0) var coarse_radiance: texture_2d<f32>;
@group(3) @binding(1) var coarse_transmittance: texture_2d<f32>;

// Pixels from one texel of the level to the next.
override RATE: u32 = 2u;

struct Level {
    @location(0) radiance: vec4<f32>,       // pre-exposed; a: depth of the surface seen, from where the air begins, times DEPTH_SCALE
    @location(1) transmittance: vec4<f32>,  // a: 1 where one ray stands for the pixel
}

// By how much of its light a pixel may err because the mean of the surfaces around it is not its own.
const AGREE_DEPTH: f32 = 0.01;
// Half floats then hold depths of surfaces from 1 m to 800,000 km to a two-thousandth, for a near plane of 0.2 m.
const DEPTH_SCALE: f32 = 262144.0;
const DEPTH_MOST: f32 = 6e4;

// By the air's own medium, or by its two band media; in the star's light and the second one.
fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    let air = airs.list[u32(body.ids.z)];
    var luminance = vec3<f32>(0.0);
    var through = vec3<f32>(0.0);
    let first = u32(max(body.lights.w, 0));
    for (var l = first; l < light_count(body); l++) {
        var by = in_light(body, l);
        var radiance = vec3<f32>(0.0);
        for (var k = 0u; k < u32(air.bands[1].w); k++) {
            by.ids.z = i32(air.bands[3u * k].w);
            let light = physical_light(by, airs.list[u32(by.ids.z)], media, transmittance, orders, linear, star, sky, view);
            radiance += air_to_rgb(air, k) * light.radiance;
            through += air_to_rgb(air, k) * light.transmittance * select(0.0, 1.0, l == first);
        }
        luminance += max(radiance, vec3<f32>(0.0)) * by.illuminance.rgb;
    }
    return AirLight(luminance, clamp(through, vec3<f32>(0.0), vec3<f32>(1.0)));
}

// The surface of a pixel, as levels hold it: its depth from where the air begins, times DEPTH_SCALE; the way to it from there.
fn surface_in_air(body: Body, view: SkyView, own_depth: f32) -> vec2<f32> {
    let path = air_path(airs.list[u32(body.ids.z)], body.up.xyz, body.up.w, view.ray);
    let way = max(view.surface - max(path.start, 0.0), 1e-3 * view.surface);
    return vec2<f32>(min(own_depth * DEPTH_SCALE * (view.surface / way), DEPTH_MOST), way);
}

// What a pixel takes of the four texels around it.
struct Between {
    radiance: vec3<f32>,
    transmittance: vec3<f32>,
    fine: bool,
}
fn between(at: vec2<u32>, view: SkyView, own: vec2<f32>, behind: vec3<f32>) -> Between {
    let size = textureDimensions(coarse_radiance);
    let a = at / 2u;
    let d = a + (at & vec2<u32>(1u));
    let ra = textureLoad(coarse_radiance, a, 0);
    let rb = textureLoad(coarse_radiance, vec2<u32>(d.x, a.y), 0);
    let rc = textureLoad(coarse_radiance, vec2<u32>(a.x, d.y), 0);
    let rd = textureLoad(coarse_radiance, d, 0);
    let mean = 0.25 * (ra + rb + rc + rd);
    let least = min(min(ra, rb), min(rc, rd));
    var spread = max(max(ra, rb), max(rc, rd)).rgb - least.rgb;
    // Their mean again, by the sampler.
    let through = textureSampleLevel(coarse_transmittance, linear, (0.5 * vec2<f32>(at) + 0.5) / vec2<f32>(size), 0.0);
    // A loop of one turn or none, and not a branch: where a processor stands in for a GPU it takes both sides of a branch.
    for (var bright = select(0u, 1u, any(behind > vec3<f32>(0.0))); bright > 0u; bright--) {
        let ta = textureLoad(coarse_transmittance, a, 0);
        let tb = textureLoad(coarse_transmittance, vec2<u32>(d.x, a.y), 0);
        let tc = textureLoad(coarse_transmittance, vec2<u32>(a.x, d.y), 0);
        let td = textureLoad(coarse_transmittance, d, 0);
        spread += behind * (max(max(ta, tb), max(tc, td)) - min(min(ta, tb), min(tc, td))).rgb;
    }
    // The surfaces seen there and here: all or none, and as far as it matters alike. Stored depth is linear on a plane, so that ground that
    // stretches away from the eye is between those around it.
    // A surface moved by ds changes the light before it by T β ds of 1 − T, at most.
    let apart = own.y * abs(own.x / max(mean.a, 1e-6) - 1.0);
    let moved = through.rgb * sky.settings[0].rgb * apart;
    let alike = select(
        least.a > 0.0 && own.x < DEPTH_MOST && all(moved <= AGREE_DEPTH * (1.0 - through.rgb)), mean.a <= 0.0, view.datum);
    // Beyond the last texel there is nothing to be between.
    let fine = alike && all(d < size) && through.a > 0.999 && all(spread <= sky.settings[0].a * (behind * through.rgb + mean.rgb));
    return Between(mean.rgb, through.rgb, fine);
}

@fragment
fn take_level(in: Varying) -> Level {
    let at = vec2<u32>(in.position.xy);
    let pixel = RATE * at;
    let own = textureLoad(depth, pixel, 0);
    let view = sky_view(frame, (vec2<f32>(pixel) + 0.5) * frame.size.zw, own);
    let surface = surface_in_air(bodies.list[sky.ids.x], view, own);
    let taken = between(at, view, surface, textureLoad(opaque, pixel, 0).rgb);
    if !taken.fine {
        discard;
    }
    return Level(vec4<f32>(taken.radiance, surface.x), vec4<f32>(taken.transmittance, 1.0));
}

@fragment
fn march_level(in: Varying) -> Level {
    let pixel = RATE * vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let own = textureLoad(depth, pixel, 0);
    let view = sky_view(frame, (vec2<f32>(pixel) + 0.5) * frame.size.zw, own);
    let rays = sky_rays(body, air, view);
    // Texels that are only asked by others need no more than one: where more would stand for a pixel, they are not asked.
    let sum = sky_sum(body, view, select(1u, rays, RATE == 1u));
    let share = select(1.0, 1.0 / f32(rays), RATE == 1u);
    return Level(
        vec4<f32>(to_hdr(sum.radiance * share, exposure.pre), surface_in_air(body, view, own).x),
        vec4<f32>(sum.transmittance * share, select(0.0, 1.0, rays <= 1u)));
}

@fragment
fn lay(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let light = textureLoad(coarse_radiance, pixel, 0).rgb;
    let behind = textureLoad(opaque, pixel, 0).rgb * textureLoad(coarse_transmittance, pixel, 0).rgb;
    return vec4<f32>(to_hdr(behind + light, 1.0), 1.0);
}
