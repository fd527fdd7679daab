// The sky by the model `thickness`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/thickness.rs.

#include "pass/sky.wgsl"
#include "lib/thickness.wgsl"
#include "lib/daylight.wgsl"
#include "lib/second_light.wgsl"

@group(1) @binding(3) var irradiance: texture_2d_array<f32>;
@group(1) @binding(9) var refracted: texture_2d_array<f32>;
@group(3) @binding(0) var front_radiance: texture_2d<f32>;
@group(3) @binding(1) var front_transmittance: texture_2d<f32>;

// Set to true in the pipeline for a bank within another's air whose tables tell what it lets through.
override IN_AIR: bool = false;

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    let air = airs.list[u32(body.ids.z)];
    if !IN_AIR {
        return in_starlight(body, thickness_light(body, air, star, sky, view));
    }
    let path = thickness_path(body, air, sky, view);
    let end = sky_end(air, path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let width = end * sky.settings[1].x;
    let lit = light_in_air(bodies.list[sky.ids.w], star, view.ray * (path.start + 0.5 * end));
    return AirLight(sky.settings[0].rgb * width * lit, vec3<f32>(exp(-sky.settings[1].y * width)));
}

// What lights a bank at a point of another's air, lx: the sun as that air lets it through, and its sky. Of a sky that is even over half of all
// directions twice as much passes through a drop as falls on level ground; of the sun as much as falls on what faces it.
fn light_in_air(holder: Body, star: vec4<f32>, point: vec3<f32>) -> vec3<f32> {
    let air = airs.list[u32(max(holder.ids.z, 0))];
    var sum = vec3<f32>(2.0 * STARLIGHT_LX);
    for (var k = 0u; k < light_count(holder); k++) {
        let by = in_light(holder, k);
        let light = daylight(by, star, point, air, transmittance, irradiance, refracted, sheets, linear);
        sum += by.illuminance.rgb * (light.sun + 2.0 * light.sky);
    }
    return sum;
}

// A bank of fog within another's air A. What is behind has all of A's light already; it belongs before the bank as far as it comes from there:
// A₀ + T₀ (fog + T · rest), with A₀, T₀ of A up to the bank's middle and rest = (behind − A₀) / T₀.
@fragment
fn held(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));
    let light = sky_mean(body, view, sky_spread(frame, body, airs.list[u32(body.ids.z)], view));
    let place = min(pixel / 2u, textureDimensions(front_radiance) - 1u);
    let before = textureLoad(front_radiance, place, 0).rgb;
    let through = textureLoad(front_transmittance, place, 0).rgb;
    let clear = light.transmittance;
    return vec4<f32>(to_hdr(clear * textureLoad(opaque, pixel, 0).rgb + (1.0 - clear) * before + through * (exposure.pre * light.radiance), 1.0), 1.0);
}
