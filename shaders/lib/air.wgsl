// Air for other passes: how sunlight is reddened on its way to a point, and how the sky lights the ground.
//
// The tables are 2-D arrays, a layer per slot (two of transmittance; Body.ids.z; −1: no air, ask nothing). Bind from group 1: @binding(0) var<uniform>
// airs: Airs; @binding(1) transmittance, @binding(3) irradiance: texture_2d_array<f32>; @binding(2) orders: texture_3d<f32>; @binding(4) sampler.
// Altitudes are above the datum in m and may be negative; `mu_s` is the cosine of the sun's zenith angle at the point.
// Made by engine/src/render/pass/air_tables.rs. Not here: light along a ray of sight (lib/air_march.wgsl); all of it together for a surface (lib/daylight.wgsl).

#include "lib/air_orders.wgsl"
#include "lib/air_quadrature.wgsl"

const TRANSMITTANCE_SIZE: vec2<f32> = vec2<f32>(128.0, 128.0);
const IRRADIANCE_SIZE: vec2<f32> = vec2<f32>(32.0, 16.0);  // ORDERS_SUNS, ORDERS_ALTITUDES

// 0…1 to the centres of the first and last texel, and back.
fn table_uv(x: vec2<f32>, size: vec2<f32>) -> vec2<f32> {
    return (clamp(x, vec2<f32>(0.0), vec2<f32>(1.0)) * (size - 1.0) + 0.5) / size;
}
fn table_x(texel: vec2<u32>, size: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(texel) / (size - 1.0);
}

// Transmittance is mapped by distances to the top, which vary most where it does: near the horizon [Bruneton 2017, "Precomputed
// Atmospheric Scattering: a New Implementation", transmittance section].
fn transmittance_x(air: Air, altitude: f32, mu: f32) -> vec2<f32> {
    let bottom = air.shape.x;
    let top = air.shape.y;
    let h = clamp(altitude, 0.0, top);
    let rho2 = h * (2.0 * bottom + h);
    let all2 = top * (2.0 * bottom + top);
    let reach = air_reach((bottom + h) * mu, all2 - rho2);
    let least = top - h;
    let most = sqrt(rho2) + sqrt(all2);
    return vec2<f32>((reach - least) / (most - least), sqrt(rho2 / all2));
}
// The inverse: altitude, zenith cosine, distance to the top.
fn transmittance_point(air: Air, x: vec2<f32>) -> vec3<f32> {
    let bottom = air.shape.x;
    let top = air.shape.y;
    let all2 = top * (2.0 * bottom + top);
    let rho = x.y * sqrt(all2);
    let h = min(rho * rho / (bottom + sqrt(bottom * bottom + rho * rho)), top);
    let least = top - h;
    let reach = least + x.x * (rho + sqrt(all2) - least);
    let mu = (all2 - rho * rho - reach * reach) / (2.0 * (bottom + h) * max(reach, 1e-3));
    return vec3<f32>(h, select(clamp(mu, -1.0, 1.0), 1.0, reach < 1e-3), reach);
}

// The table holds what its fourth root lacks to 1. It falls by e^n from row to row where depth grows by n: in between, what is found of fourth roots errs
// by a quarter of what is found of itself, and half floats near 0 tell it apart as finely as ever where little is lost.
fn transmittance_encode(t: vec4<f32>) -> vec4<f32> {
    return 1.0 - sqrt(sqrt(t));
}
fn transmittance_decode(code: vec4<f32>) -> vec4<f32> {
    let root = 1.0 - code;
    return (root * root) * (root * root);
}

// Transmittance from a point to the top of the air towards the sun; below the horizon: that of the horizon.
fn air_sun_transmittance(air: Air, table: texture_2d_array<f32>, linear: sampler, slot: i32, altitude: f32, mu_s: f32) -> vec3<f32> {
    let uv = table_uv(transmittance_x(air, altitude, mu_s), TRANSMITTANCE_SIZE);
    return transmittance_decode(textureSampleLevel(table, linear, uv, 2 * slot, 0.0)).rgb;
}
// The same of the beam, which has the light that scattering left going straight on (layer 2 slot + 1); a: which part of it was never
// scattered. Of layer 2 slot: that part alone.
fn air_sun_beam(air: Air, table: texture_2d_array<f32>, linear: sampler, layer: i32, altitude: f32, mu_s: f32) -> vec4<f32> {
    let uv = table_uv(transmittance_x(air, altitude, mu_s), TRANSMITTANCE_SIZE);
    return transmittance_decode(textureSampleLevel(table, linear, uv, layer, 0.0));
}

// Illuminance by the sky on horizontal ground, per unit of the sun's illuminance above the air. On a slope whose normal makes
// the cosine c with the zenith, take (0.5 + 0.5 c) of it. The table holds fourth roots, by the coordinates of further orders.
fn air_sky_irradiance(air: Air, table: texture_2d_array<f32>, linear: sampler, slot: i32, altitude: f32, mu_s: f32) -> vec3<f32> {
    let x = vec2<f32>(orders_sun_x(air, horizon_dip(air.shape.x, altitude), mu_s), orders_altitude_y(air, altitude));
    let root = textureSampleLevel(table, linear, table_uv(x, IRRADIANCE_SIZE), slot, 0.0).rgb;
    return root * root * root * root;
}
