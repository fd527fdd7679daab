// A baseline for `bench air`, not used by any picture: the table of isotropic multiple scattering [Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", §5.5]:
// second-order light averaged over 64 directions, times the geometric series of all further orders. One workgroup per texel.
// What the model `physical` does instead: air_orders.wgsl.

#include "lib/air.wgsl"
#include "lib/sunlight.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var table: texture_storage_2d<rgba16float, write>;
@group(0) @binding(2) var transmittance: texture_2d_array<f32>;
@group(0) @binding(3) var linear: sampler;

const MULTIPLE_SIZE: vec2<f32> = vec2<f32>(64.0, 32.0);
const DIRECTIONS: u32 = 64u;
const STEPS: u32 = 24u;
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

    let steps = air_steps(path, end);
    var through = vec3<f32>(1.0);
    var light = vec3<f32>(0.0);
    var scattered = vec3<f32>(0.0);
    var from_s = 0.0;
    for (var i = 1u; i <= STEPS; i++) {
        let to_s = air_step(steps, f32(i) / f32(STEPS));
        let s = 0.5 * (from_s + to_s);
        let h = air_altitude(air, path, s);
        let c = (path.radius * mu_s + s * dot(ray, sun)) / (air.shape.x + h);
        let density = air_density(air, h);
        let extinction = max(air.extinction * density, vec3<f32>(1e-20));
        let kept = exp(-extinction * (to_s - from_s));
        let gain = through * (air.scattering * density) * (1.0 - kept) / extinction;
        let lit = visible_above_limb(SUN_RAD, sun_elevation(air.shape.x, h, c)) * air_sun_transmittance(air, transmittance, linear, 0, h, c);
        light += gain * lit / 12.5663706144;
        scattered += gain;
        through *= kept;
        from_s = to_s;
    }
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
