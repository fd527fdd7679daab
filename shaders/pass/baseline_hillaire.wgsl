// A baseline for `bench air`, not used by any picture: the table of isotropic multiple scattering
// [Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", §5.5]:
// second-order light averaged over 64 directions, times the geometric series of all further orders. One workgroup per texel.
// Rust side: engine/src/render/pass/baseline_hillaire.rs. What the model `physical` does instead: air_orders.wgsl.

#include "lib/air.wgsl"
#include "lib/sunlight.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var table: texture_storage_2d<rgba16float, write>;
@group(0) @binding(2) var media: texture_2d_array<f32>;
@group(0) @binding(3) var transmittance: texture_2d_array<f32>;
@group(0) @binding(4) var linear: sampler;

const MULTIPLE_SIZE: vec2<f32> = vec2<f32>(64.0, 32.0);
const DIRECTIONS: u32 = 64u;
const PANELS: u32 = 4u;
const SUN_RAD: f32 = 0.0047;

// Mapped by √altitude and by the signed root of the sun's cosine.
fn lit_point(air: Air, x: vec2<f32>) -> vec2<f32> {
    let root = 2.0 * x.x - 1.0;
    return vec2<f32>(x.y * x.y * air.shape.y, root * abs(root));
}

var<workgroup> second: array<vec3<f32>, DIRECTIONS>;
var<workgroup> share: array<vec3<f32>, DIRECTIONS>;

@compute @workgroup_size(64)
fn bake(@builtin(workgroup_id) texel: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    let point = lit_point(air, table_x(texel.xy, MULTIPLE_SIZE));
    let mu_s = point.y;
    let sun = vec3<f32>(sqrt(max(1.0 - mu_s * mu_s, 0.0)), 0.0, mu_s);
    // A Fibonacci spiral over the sphere.
    let z = 1.0 - (2.0 * f32(index) + 1.0) / f32(DIRECTIONS);
    let turn = f32(index) * 2.39996323;
    let ray = vec3<f32>(sqrt(1.0 - z * z) * vec2<f32>(cos(turn), sin(turn)), z);
    let path = air_path(air, vec3<f32>(0.0, 0.0, 1.0), clamp(point.x, 1.0, air.shape.y - 1.0), ray);
    let hits = path.ground >= 0.0;
    let end = select(path.exit, path.ground, hits);

    var depth = vec3<f32>(0.0);
    var light = vec3<f32>(0.0);
    var scattered = vec3<f32>(0.0);
    var begin = 0.0;
    for (var k = 0u; k < 24u && begin < end; k++) {
        let next = air_next_cut(air, path, begin, end, NO_CUTS, NO_CUTS);
        for (var i = 0u; i < PANELS; i++) {
            let nodes = air_nodes(air, path, begin, next, i, PANELS);
            var extinction: mat4x3<f32>;
            var gain: mat4x3<f32>;
            for (var j = 0u; j < 4u; j++) {
                let matter = air_matter(air, media, 0, nodes.altitude[j]);
                extinction[j] = matter.extinction * nodes.span[j];
                gain[j] = (matter.scattering * vec4<f32>(1.0)) * (nodes.span[j] * GAUSS_WEIGHT[j]);
            }
            let run = extinction * GAUSS_RUN;
            for (var j = 0u; j < 4u; j++) {
                let h = nodes.altitude[j];
                let c = (path.radius * mu_s + nodes.s[j] * dot(ray, sun)) / (air.shape.x + h);
                let lit = visible_above_limb(SUN_RAD, sun_elevation(air.shape.x, h, c)) * air_sun_transmittance(air, transmittance, linear, 0, h, c);
                let share = exp(-depth - run[j]) * gain[j];
                light += share * lit / 12.5663706144;
                scattered += share;
            }
            depth += extinction * GAUSS_WEIGHT;
        }
        begin = next;
    }
    let through = exp(-depth);
    if hits {
        let c = (path.radius * mu_s + end * dot(ray, sun)) / air.shape.x;
        light += through * air.albedo.rgb / 3.14159265359 * max(c, 0.0) * air_sun_transmittance(air, transmittance, linear, 0, 0.0, c);
    }
    second[index] = light;
    share[index] = scattered;
    workgroupBarrier();
    for (var half = DIRECTIONS / 2u; half > 0u; half /= 2u) {
        if index < half {
            second[index] += second[index + half];
            share[index] += share[index + half];
        }
        workgroupBarrier();
    }
    if index == 0u {
        let all = (second[0] / f32(DIRECTIONS)) / max(1.0 - share[0] / f32(DIRECTIONS), vec3<f32>(1e-3));
        textureStore(table, texel.xy, vec4<f32>(sqrt(all), 1.0));
    }
}
