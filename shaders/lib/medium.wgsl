// The medium: up to four layers of one atmosphere side by side in vectors. Twin of engine/src/air/medium.rs; the struct is
// mirrored in engine/src/scene/gpu_data.rs. Lengths in m, coefficients in m⁻¹ per linear sRGB channel.

#include "lib/phase.wgsl"

const MAX_AIRS: u32 = 16u;
const AIR_FLOOR_M: f32 = 10000.0;  // Medium::FLOOR_M

struct Air {
    shape: vec4<f32>,           // radius of the datum, altitude of the top, 0, 0
    albedo: vec4<f32>,          // rgb: of the ground
    scattering: mat4x3<f32>,    // a column per layer
    extinction: mat4x3<f32>,
    inverse_height: vec4<f32>,  // 1 / scale height
    tent_bottom: vec4<f32>,
    tent_rise: vec4<f32>,       // 1 / (peak − bottom); 0: the profile is exponential
    tent_top: vec4<f32>,
    tent_fall: vec4<f32>,       // 1 / (top − peak)
    asymmetry: vec4<f32>,       // of the phase function; PHASE_RAYLEIGH
    orders: vec4<f32>,          // how the sun's height is mapped in the table of further orders: SunMap of engine/src/air/model/orders.rs, 0
}

struct Airs {
    list: array<Air, MAX_AIRS>,
}

// Relative density of each layer.
fn air_density(air: Air, altitude: f32) -> vec4<f32> {
    let h = max(altitude, -AIR_FLOOR_M);
    let exponential = exp(-h * air.inverse_height);
    let tent = max(min((h - air.tent_bottom) * air.tent_rise, (air.tent_top - h) * air.tent_fall), vec4<f32>(0.0));
    return select(exponential, tent, air.tent_rise > vec4<f32>(0.0));
}

// Phase function of each layer.
fn air_phase(air: Air, c: f32) -> vec4<f32> {
    let g = air.asymmetry;
    return vec4<f32>(layer_phase(g.x, c), layer_phase(g.y, c), layer_phase(g.z, c), layer_phase(g.w, c));
}
