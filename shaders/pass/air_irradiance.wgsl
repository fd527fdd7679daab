// Table of the illuminance that the sky gives horizontal ground, per unit of the sun's above the air. One workgroup per texel: 64
// cosine-weighted directions of the upper half. Rust side: engine/src/render/pass/air_tables.rs.

#include "lib/air_march.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var table: texture_storage_2d<rgba16float, write>;
@group(0) @binding(2) var media: texture_2d_array<f32>;
@group(0) @binding(3) var transmittance: texture_2d_array<f32>;
@group(0) @binding(4) var linear: sampler;
@group(0) @binding(5) var multiple: texture_2d_array<f32>;

const DIRECTIONS: u32 = 64u;
const STEPS: u32 = 24u;

var<workgroup> light: array<vec3<f32>, DIRECTIONS>;

@compute @workgroup_size(64)
fn bake(@builtin(workgroup_id) texel: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let point = lit_point(air, table_x(texel.xy, IRRADIANCE_SIZE));
    // Nusselt's analogue: points even on the disc are cosine-weighted on the half sphere.
    let r = sqrt((f32(index) + 0.5) / f32(DIRECTIONS));
    let turn = f32(index) * 2.39996323;
    let ray = vec3<f32>(r * vec2<f32>(cos(turn), sin(turn)), sqrt(1.0 - r * r));
    let path = air_path(air, vec3<f32>(0.0, 0.0, 1.0), min(point.x, air.shape.y - 1.0), ray);
    let sun = AirSun(vec3<f32>(sqrt(max(1.0 - point.y * point.y, 0.0)), 0.0, point.y), 0.0047, 1.0, 1.0);
    var alone: Body;
    light[index] = air_march(air, media, transmittance, multiple, linear, 0, path, path.exit, ray, sun, alone, vec4<f32>(0.0), STEPS).radiance;
    workgroupBarrier();
    for (var half = DIRECTIONS / 2u; half > 0u; half /= 2u) {
        if index < half {
            light[index] += light[index + half];
        }
        workgroupBarrier();
    }
    if index == 0u {
        textureStore(table, texel.xy, vec4<f32>(sqrt(light[0] * (3.14159265359 / f32(DIRECTIONS))), 1.0));
    }
}
