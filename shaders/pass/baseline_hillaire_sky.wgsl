// A baseline for `bench air`, not used by any picture: the sky after Hillaire 2020, as lib/baseline_hillaire.wgsl tells. Rust side:
// engine/src/render/pass/baseline_hillaire_sky.rs.
//
// From within the air: `see` and `froxels` make the two tables that hang on the eye, `by_tables` asks the one for pixels of the sky, the other
// for ground in its reach, and marches to ground beyond. From space `fragment` (of pass/sky.wgsl) marches at every pixel.

#include "pass/sky.wgsl"
#include "lib/baseline_hillaire.wgsl"

@group(3) @binding(0) var multiple: texture_2d<f32>;
@group(3) @binding(1) var seen: texture_2d<f32>;
@group(3) @binding(2) var near: texture_3d<f32>;
@group(3) @binding(3) var seen_out: texture_storage_2d<rgba16float, write>;
@group(3) @binding(4) var near_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(8, 4)
fn see(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= HILLAIRE_SKY) {
        return;
    }
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let angles = hillaire_sky_ray(horizon_dip(air.shape.x, body.up.w), id.xy);
    let mu_s = dot(body.up.xyz, body.sun.xyz);
    let up = body.up.xyz;
    let level = normalize(body.sun.xyz - up * mu_s + 1e-6 * body.fixed_x.xyz);
    let aside = cross(up, level);
    let sines = sqrt(max(1.0 - angles * angles, vec2<f32>(0.0)));
    let ray = normalize(up * angles.x + sines.x * (level * angles.y + aside * sines.y));
    let path = air_path(air, up, body.up.w, ray);
    let ground = id.y >= HILLAIRE_SKY.y / 2u && path.ground >= 0.0;
    let end = select(path.exit, path.ground, ground);
    let light = hillaire_march(air, media, transmittance, multiple, linear, body.ids.z, path, end, ray, body.sun, sky.ids.y);
    textureStore(seen_out, id.xy, vec4<f32>(to_hdr(light.radiance * body.illuminance.rgb, exposure.pre), 1.0));
}

// A thread for a column of cells away from the eye; slices lie by the square of the distance, with one sample each.
@compute @workgroup_size(8, 4)
fn froxels(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let ray = normalize(view_ray(frame, (vec2<f32>(id.xy) + 0.5) / f32(HILLAIRE_FROXELS)));
    let path = air_path(air, body.up.xyz, body.up.w, ray);
    let nu = dot(ray, body.sun.xyz);
    let phase = air_phase(air, media, body.ids.z, nu);
    var light = AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    var begin = 0.0;
    for (var k = 0u; k < HILLAIRE_FROXELS; k++) {
        let w = (f32(k) + 0.5) / f32(HILLAIRE_FROXELS);
        let end = w * w * HILLAIRE_REACH_M;
        let step = hillaire_step(
            air, media, transmittance, multiple, linear, body.ids.z, path, body.sun, nu, phase, 0.5 * (begin + end), end - begin);
        light.radiance += light.transmittance * step.light;
        light.transmittance *= step.through;
        begin = end;
        let through = dot(light.transmittance, vec3<f32>(1.0 / 3.0));
        textureStore(near_out, vec3<u32>(id.xy, k), vec4<f32>(to_hdr(light.radiance * body.illuminance.rgb, exposure.pre), through));
    }
}

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    let air = airs.list[u32(body.ids.z)];
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let end = sky_end(air, path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    return in_starlight(body, hillaire_march(air, media, transmittance, multiple, linear, body.ids.z, path, end, view.ray, body.sun, sky.ids.y));
}

@fragment
fn by_tables(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let behind = textureLoad(opaque, pixel, 0).rgb;
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));
    if view.datum {
        let up = body.up.xyz;
        let mu = dot(view.ray, up);
        let mu_s = dot(body.sun.xyz, up);
        let azimuth = orders_azimuth(mu, mu_s, dot(view.ray, body.sun.xyz)).x;
        let uv = hillaire_sky_uv(horizon_dip(air.shape.x, body.up.w), mu, azimuth);
        let through = air_sun_transmittance(air, transmittance, linear, body.ids.z, body.up.w, mu);
        return vec4<f32>(to_hdr(behind * through + textureSampleLevel(seen, linear, uv, 0.0).rgb, 1.0), 1.0);
    }
    if view.surface <= HILLAIRE_REACH_M {
        let w = sqrt(view.surface / HILLAIRE_REACH_M);
        let cell = textureSampleLevel(near, linear, vec3<f32>(in.uv, w), 0.0);
        let weight = min(2.0 * w * f32(HILLAIRE_FROXELS), 1.0);
        return vec4<f32>(to_hdr(behind * mix(1.0, cell.a, weight) + cell.rgb * weight, 1.0), 1.0);
    }
    return sky_over(behind, sky_light(body, frame.star, view), exposure);
}
