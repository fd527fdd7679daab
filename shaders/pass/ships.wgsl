// Ships: the hull. Rust side: engine/src/render/pass/ships.rs.

#include "lib/frame.wgsl"
#include "lib/hull.wgsl"
#include "lib/ship.wgsl"
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

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) point: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) hull: vec3<f32>,
    @location(3) hull_normal: vec3<f32>,
    @location(4) @interpolate(flat) material: u32,
    @location(5) @interpolate(flat) host: i32,
    @location(6) @interpolate(flat) state: vec4<f32>,
}

@vertex
fn vertex(
    @location(0) position: vec4<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) retract: vec4<f32>,
    ship: Ship,
) -> Varying {
    var out: Varying;
    out.point = hull_point(ship, position.xyz, retract.xyz);
    out.position = frame.clip_from_icrf * vec4<f32>(out.point, 1.0);
    out.normal = icrf_from_hull(ship, normal.xyz);
    out.hull = position.xyz;
    out.hull_normal = normal.xyz;
    out.material = u32(position.w);
    out.host = i32(ship.centre.w);
    out.state = ship.state;
    return out;
}

// 1 on the inner side of a bell: its normal looks towards the axis of the nearest bell.
fn inside_of_bell(p: vec3<f32>, n: vec3<f32>) -> f32 {
    let x = select(0.0, 2.15 * sign(p.x), abs(p.x) > 1.2);
    let y = select(0.15, -0.15, abs(p.x) > 1.2);
    return step(dot(p.xy - vec2<f32>(x, y), n.xy), 0.0);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let n = normalize(in.normal);
    let v = -normalize(in.point);
    let throttle = in.state.x;
    var m = hull_material(in.material);

    // The belly of the ceramic body wears the heat shield; joints and a stripe are painted on.
    let pixel = length(in.point) * frame.up.w;
    if in.material == 0u {
        let belly = smoothstep(-0.25, -0.45, in.hull_normal.y - 0.12 * smoothstep(-3.0, -6.5, in.hull.z));
        let shield = hull_material(1u);
        m.albedo = mix(m.albedo, shield.albedo, belly);
        m.roughness = mix(m.roughness, shield.roughness, belly);
        let stripe = smoothstep(0.02, 0.0, abs(in.hull.y - 0.30) - 0.07) * step(-6.6, in.hull.z) * step(in.hull.z, 4.6) * step(abs(in.hull_normal.z), 0.6);
        m.albedo = mix(m.albedo, hull_material(6u).albedo, stripe * step(0.8, abs(in.hull.x)) * (1.0 - belly));
    }
    if in.material <= 1u {
        m.albedo *= panel_joints(in.hull, pixel);
    }

    // The star, and the share of its disc that is free here.
    let to_star = frame.star.xyz - in.point;
    let star_distance = length(to_star);
    let l = to_star / star_distance;
    let sigma = frame.star.w / star_distance;
    var sun = frame.intensity.rgb / star_distance / star_distance;
    // Formation lights wash the hull faintly, so that it is found in the dark.
    var ambient = vec3<f32>(0.02);
    var mirrored = vec3<f32>(0.0);
    var moonlit = vec3<f32>(0.0);
    let reflected = reflect(-v, n);
    for (var k = 0u; in.host >= 0 && k < light_count(bodies.list[in.host]); k++) {
        let body = in_light(bodies.list[in.host], k);
        let light = daylight(body, frame.star, in.point, airs.list[u32(max(body.ids.z, 0))], transmittance, irradiance, refracted, sheets, linear);
        let up = light.up;
        let sine = min(body.centre.w / length(body.centre.xyz - in.point), 0.99999);
        if k == 0u {
            sun *= light.sun;
        } else {
            moonlit = body.illuminance.rgb * light.sun * ggx_reflect(m, n, v, body.sun.xyz, body.sun.w);
        }
        ambient += body.illuminance.rgb * light.sky * (0.5 + 0.5 * dot(n, up));
        // The lit ground beneath the ship: Lambert, under its own daylight.
        let foot = in.point - up * max(altitude_of(body, in.point), 0.0);
        let below = daylight(body, frame.star, foot, airs.list[u32(max(body.ids.z, 0))], transmittance, irradiance, refracted, sheets, linear);
        let bright = ground_albedo(body, airs.list[u32(max(body.ids.z, 0))]);
        let ground = bright / PI * body.illuminance.rgb * (below.sun * sun_cosine(dot(up, body.sun.xyz), body.sun.w) + below.sky);
        ambient += PI * ground * sphere_form_factor(sine, dot(n, -up));
        // Ground and sky mirrored in the hull.
        let facing = dot(reflected, -up) - sqrt(1.0 - sine * sine);
        let soft = 0.5 * m.roughness + 0.02;
        mirrored += mix(body.illuminance.rgb * light.sky / PI, ground, smoothstep(-soft, soft, facing));
    }
    sun *= ship_shadow(shadow, shadow_map, shadow_compare, in.point + n * 0.05, sigma);

    var luminance = sun * ggx_reflect(m, n, v, l, sigma) + moonlit;
    luminance += ambient / PI * m.albedo * (1.0 - m.metallic);
    let f0 = mix(vec3<f32>(0.04), m.albedo, m.metallic);
    let fresnel = f0 + (max(vec3<f32>(1.0 - m.roughness), f0) - f0) * pow(1.0 - max(dot(n, v), 0.0), 5.0);
    luminance += mirrored * fresnel;

    // What shines by itself: lamps, bells under power, the hull at entry.
    luminance += m.albedo * m.lamp;
    if in.material == 5u {
        let inside = inside_of_bell(in.hull, in.hull_normal);
        luminance = luminance * (1.0 - 0.8 * inside) + heat_glow(throttle * (0.35 + 0.4 * inside));
    }
    let windward = clamp(0.35 - in.hull_normal.y * 0.55 - in.hull_normal.z * 0.6, 0.0, 1.0);
    luminance += heat_glow(in.state.z * windward);
    // The flame lights what looks aft.
    let aft = vec3<f32>(0.0, 0.0, 8.5) - in.hull;
    let flame = max(dot(in.hull_normal, normalize(aft)), 0.0) / (1.0 + dot(aft, aft) * 0.25);
    luminance += m.albedo * vec3<f32>(0.55, 0.75, 1.0) * 1.5e4 * flame * throttle;

    return vec4<f32>(to_hdr(luminance, exposure.pre), 1.0);
}
