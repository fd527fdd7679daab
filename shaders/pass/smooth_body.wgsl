// Smooth bodies: a sphere ray-traced inside a quad that bounds it. Rust side: engine/src/render/pass/smooth_body.rs.

#include "lib/lamps.wgsl"
#include "lib/frame.wgsl"
#include "lib/sphere.wgsl"
#include "lib/lambert.wgsl"
#include "lib/daylight.wgsl"
#include "lib/second_light.wgsl"
#include "lib/shadow.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(1) @binding(1) var transmittance: texture_2d_array<f32>;
@group(1) @binding(3) var irradiance: texture_2d_array<f32>;
@group(1) @binding(4) var linear: sampler;
@group(1) @binding(5) var shadow_map: texture_depth_2d;
@group(1) @binding(6) var shadow_compare: sampler_comparison;
@group(1) @binding(7) var<uniform> shadow: Shadow;
@group(1) @binding(9) var refracted: texture_2d_array<f32>;
@group(1) @binding(10) var sheets: texture_2d_array<f32>;
@group(2) @binding(0) var albedo_map: texture_2d<f32>;
@group(2) @binding(1) var night_map: texture_2d<f32>;
@group(2) @binding(2) var map_sampler: sampler;


struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) ray: vec3<f32>,
    @location(1) @interpolate(flat) body: u32,
}

struct Output {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    var corners = array<vec2<f32>, 6>(
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, -1.0), vec2<f32>(1.0, 1.0),
        vec2<f32>(-1.0, -1.0), vec2<f32>(1.0, 1.0), vec2<f32>(-1.0, 1.0));
    let corner = corners[vertex];
    let body = bodies.list[instance];
    let sine = body.centre.w / (body.centre.w + max(body.up.w, 0.0));
    var out: Varying;
    out.body = instance;
    if sine > 0.8 {
        // The limb is wider than a quad facing the centre can bound well: cover the picture.
        out.position = vec4<f32>(corner, 0.0, 1.0);
        out.ray = view_ray(frame, vec2<f32>(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y));
        return out;
    }
    let toward = -body.up.xyz;
    let side = normalize(cross(toward, select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 0.0, 1.0), abs(toward.z) < 0.9)));
    let reach = sine / sqrt(1.0 - sine * sine) + 2.0 * frame.up.w;
    out.ray = toward + (side * corner.x + cross(side, toward) * corner.y) * reach;
    // Far beyond the near plane, so that nothing in front of the camera is clipped; depth is written by the fragment.
    out.position = frame.clip_from_icrf * vec4<f32>(out.ray * frame.right.w * 1000.0, 1.0);
    return out;
}

// Latitudinal bands of a fluid world: two octaves along the latitude, bent a little by the longitude.
fn banded(albedo: vec3<f32>, fixed: vec3<f32>) -> vec3<f32> {
    let lat = asin(clamp(fixed.z, -1.0, 1.0));
    let lon = atan2(fixed.y, fixed.x);
    let wave = 0.012 * sin(7.0 * lon + 9.0 * lat) + 0.006 * sin(17.0 * lon - 21.0 * lat);
    let x = (lat + wave * cos(lat)) * 10.0;
    let band = 0.55 * sin(x) + 0.30 * sin(2.3 * x + 1.1) + 0.15 * sin(5.1 * x + 0.4);
    let warm = vec3<f32>(1.04, 1.0, 0.93);
    return albedo * mix(vec3<f32>(0.86), vec3<f32>(1.12) * warm, 0.5 + 0.5 * band);
}

@fragment
fn fragment(in: Varying) -> Output {
    let body = bodies.list[in.body];
    let ray = normalize(in.ray);
    let radius = body.centre.w;
    let hit = sphere_hit(ray, body.centre.xyz, radius, body.up.w);
    // Share of the pixel inside the limb.
    let cover = clamp((radius - hit.miss) / (max(hit.along, 1.0) * frame.up.w) + 0.5, 0.0, 1.0);

    let normal = normalize(ray * hit.distance - body.centre.xyz);
    let fixed = fixed_from_icrf(body, normal);
    let uv = equirect_uv(fixed);
    let mapped = textureDimensions(albedo_map).x > 1u;
    // The seam at ±180°: derivatives of whichever of two wrappings is smooth here.
    let wrapped = vec2<f32>(fract(uv.x + 0.5), uv.y);
    let dx = select(dpdx(wrapped), dpdx(uv), abs(dpdx(uv.x)) < abs(dpdx(wrapped.x)));
    let dy = select(dpdy(wrapped), dpdy(uv), abs(dpdy(uv.x)) < abs(dpdy(wrapped.x)));
    let map = textureSampleGrad(albedo_map, map_sampler, uv, dx, dy).rgb;
    let night = lamps(textureSampleGrad(night_map, map_sampler, uv, dx, dy).rgb);
    if cover <= 0.0 || hit.distance <= 0.0 {
        discard;
    }

    var albedo = body.albedo.rgb;
    if mapped {
        albedo = map;
    } else if radius > 2.0e7 {
        albedo = banded(albedo, fixed);
    }
    var luminance = night;
    for (var k = 0u; k < light_count(body); k++) {
        let by = in_light(body, k);
        let light = daylight(by, frame.star, ray * hit.distance, airs.list[u32(max(body.ids.z, 0))], transmittance, irradiance, refracted, sheets, linear);
        var open = 1.0;
        if k == 0u {
            open = ship_shadow(shadow, shadow_map, shadow_compare, ray * hit.distance, body.sun.w);
        }
        let lit = light.sun * (open * sun_cosine(dot(normal, by.sun.xyz), by.sun.w)) + light.sky;
        luminance += albedo / PI * by.illuminance.rgb * lit;
    }

    var out: Output;
    out.colour = vec4<f32>(to_hdr(luminance, exposure.pre) * cover, 1.0);
    out.depth = frame.right.w / max(hit.distance * dot(ray, frame.forward.xyz), frame.right.w);
    return out;
}
