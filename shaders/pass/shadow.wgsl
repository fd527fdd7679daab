// The ship's shadow map: depth along the light only. Rust side: engine/src/render/pass/shadow.rs.

#include "lib/ship.wgsl"
#include "lib/shadow.wgsl"

@group(1) @binding(0) var<uniform> shadow: Shadow;

@vertex
fn vertex(
    @location(0) position: vec4<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) retract: vec4<f32>,
    ship: Ship,
) -> @builtin(position) vec4<f32> {
    return shadow.map_from_icrf * vec4<f32>(hull_point(ship, position.xyz, retract.xyz), 1.0);
}
