// The sky along given rays, by the march that draws it. Rust side: engine/src/render/pass/sky_probe.rs.

#include "lib/air_march.wgsl"

struct ProbeRay {
    up: vec4<f32>,
    ray: vec4<f32>,
    sun: vec4<f32>,
}

struct ProbeLight {
    radiance: vec4<f32>,
    transmittance: vec4<f32>,
}

@group(0) @binding(0) var<uniform> airs: Airs;
@group(0) @binding(1) var transmittance: texture_2d_array<f32>;
@group(0) @binding(2) var multiple: texture_2d_array<f32>;
@group(0) @binding(3) var linear: sampler;
@group(0) @binding(4) var<uniform> wanted: vec4<u32>;  // steps, 1 where further orders are added, 0, 0
@group(0) @binding(5) var<storage, read> given: array<ProbeRay>;
@group(0) @binding(6) var<storage, read_write> found: array<ProbeLight>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) {
        return;
    }
    let asked = given[id.x];
    let air = airs.list[0];
    let path = air_path(air, asked.up.xyz, asked.up.w, asked.ray.xyz);
    if path.start < 0.0 {
        found[id.x] = ProbeLight(vec4<f32>(0.0), vec4<f32>(1.0));
        return;
    }
    let end = select(path.exit, path.ground, path.ground >= 0.0);
    let sun = AirSun(asked.sun.xyz, asked.sun.w, 1.0, f32(wanted.y));
    var alone: Body;
    let light = air_march(air, transmittance, multiple, linear, 0, path, end, asked.ray.xyz, sun, alone, vec4<f32>(0.0), wanted.x);
    found[id.x] = ProbeLight(vec4<f32>(light.radiance, 0.0), vec4<f32>(light.transmittance, 1.0));
}
