// What an air that is drawn in bands does to surfaces, in linear sRGB: the tables of its one or two band media, mixed into its own. Further
// orders stay apart: they are mixed with the rest along a ray (pass/sky_physical.wgsl). Rust side: engine/src/render/pass/air_bands.rs.

#include "lib/air.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var transmittance: texture_storage_2d<rgba16float, write>;
@group(0) @binding(2) var irradiance: texture_storage_2d<rgba16float, write>;
@group(0) @binding(3) var one_transmittance: texture_2d_array<f32>;
@group(0) @binding(4) var other_transmittance: texture_2d_array<f32>;
@group(0) @binding(5) var one_irradiance: texture_2d_array<f32>;
@group(0) @binding(6) var other_irradiance: texture_2d_array<f32>;

fn mixed(one: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    return max(air_to_rgb(air, 0u) * one + air_to_rgb(air, 1u) * other, vec3<f32>(0.0));
}
fn square(v: vec3<f32>) -> vec3<f32> {
    return v * v;
}

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = id.xy;
    if all(vec2<f32>(at) < TRANSMITTANCE_SIZE) {
        let one = transmittance_decode(textureLoad(one_transmittance, at, 0, 0)).rgb;
        let other = transmittance_decode(textureLoad(other_transmittance, at, 0, 0)).rgb;
        textureStore(transmittance, at, transmittance_encode(vec4<f32>(mixed(one, other), 1.0)));
    }
    // Of fourth roots.
    if all(vec2<f32>(at) < IRRADIANCE_SIZE) {
        let one = square(square(textureLoad(one_irradiance, at, 0, 0).rgb));
        let other = square(square(textureLoad(other_irradiance, at, 0, 0).rgb));
        textureStore(irradiance, at, vec4<f32>(sqrt(sqrt(mixed(one, other))), 1.0));
    }
}
