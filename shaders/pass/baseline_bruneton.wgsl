// A baseline for `bench air`, not used by any picture: the bake of the 4-D table [Bruneton & Neyret 2008, algorithm 4.1]. Rust side:
// engine/src/render/pass/baseline_bruneton.rs. What a texel stands for: lib/baseline_bruneton.wgsl.
//
// `single`: light scattered once, by the molecules (the air's first class) and by all others, each without its phase function. Then for every
// order: `ground`, what of the order before falls on the ground; `turn`, what of it is scattered into each direction at each point; `gather`, that along
// each ray; `sum`, added to the table of molecules over their phase function.

#include "lib/baseline_bruneton.wgsl"
#include "lib/sunlight.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var media: texture_2d_array<f32>;
@group(0) @binding(2) var transmittance: texture_2d_array<f32>;
@group(0) @binding(3) var linear: sampler;
@group(0) @binding(4) var<storage, read> job: Job;  // no uniform: branches hang on it, see `compute_pipeline` of engine/src/render/pipeline.rs
@group(0) @binding(5) var molecules: texture_3d<f32>;
@group(0) @binding(6) var others: texture_3d<f32>;
@group(0) @binding(7) var order_before: texture_3d<f32>;
@group(0) @binding(8) var turned: texture_3d<f32>;
@group(0) @binding(9) var lit_ground: texture_2d<f32>;
@group(0) @binding(10) var out_a: texture_storage_3d<rgba16float, write>;
@group(0) @binding(11) var out_b: texture_storage_3d<rgba16float, write>;
@group(0) @binding(12) var out_ground: texture_storage_2d<rgba16float, write>;

struct Job {
    sizes: vec4<u32>,   // altitude, μ, μₛ, ν
    counts: vec4<u32>,  // order that is made; points along a ray; directions over π; 0
    sun: vec4<f32>,     // angular radius of the sun, 0, 0, 0
}

const PI_: f32 = 3.14159265359;
const TURNED_SCALE: f32 = 1e4;  // the source's, m⁻¹, on top of BRUNETON_SCALE

fn end_of(p: BrunetonPoint) -> f32 {
    let rho2 = p.altitude * (2.0 * air.shape.x + p.altitude);
    let slope = (air.shape.x + p.altitude) * p.mu;
    if p.ground {
        return rho2 / max(sqrt(max(slope * slope - rho2, 0.0)) - slope, 1e-3);
    }
    return air_reach(slope, bruneton_h2(air) - rho2);
}

// A point `s` further along the ray.
fn along(p: BrunetonPoint, s: f32) -> BrunetonPoint {
    var path: AirPath;
    path.altitude = p.altitude;
    path.radius = air.shape.x + p.altitude;
    path.slope = path.radius * p.mu;
    let h = clamp(air_altitude(air, path, s), 0.0, air.shape.y);
    let r = air.shape.x + h;
    return BrunetonPoint(h, clamp((path.slope + s) / r, -1.0, 1.0), clamp((path.radius * p.mu_s + s * p.nu) / r, -1.0, 1.0), p.nu, p.ground);
}

fn sunlight(h: f32, mu_s: f32) -> vec3<f32> {
    return visible_above_limb(job.sun.x, sun_elevation(air.shape.x, h, mu_s)) * air_sun_transmittance(air, transmittance, linear, 0, h, mu_s);
}

// Trapezoids, as he takes them.
@compute @workgroup_size(4, 4, 4)
fn single(@builtin(global_invocation_id) id: vec3<u32>) {
    let p = bruneton_point(air, job.sizes, id);
    let ds = end_of(p) / f32(job.counts.y);
    var by_molecules = vec3<f32>(0.0);
    var by_others = vec3<f32>(0.0);
    for (var i = 0u; i <= job.counts.y; i++) {
        let q = along(p, f32(i) * ds);
        let way = bruneton_between(air, transmittance, linear, 0, p.altitude, p.mu, q.altitude, q.mu, p.ground);
        let weight = select(ds, 0.5 * ds, i == 0u || i == job.counts.y);
        let matter = air_matter(air, media, 0, q.altitude);
        let light = way * sunlight(q.altitude, q.mu_s) * weight;
        by_molecules += light * matter.scattering[0];
        by_others += light * (matter.scattering * vec4<f32>(0.0, 1.0, 1.0, 1.0));
    }
    textureStore(out_a, id, vec4<f32>(by_molecules * BRUNETON_SCALE, 0.0));
    textureStore(out_b, id, vec4<f32>(by_others * BRUNETON_SCALE, 0.0));
}

// Radiance of the order before.
fn arriving(p: BrunetonPoint) -> vec3<f32> {
    if job.counts.x == 2u {
        let phase = air_phase(air, media, 0, p.nu);
        return bruneton_at(air, job.sizes, molecules, linear, p) * phase.x + bruneton_at(air, job.sizes, others, linear, p) * phase.y;
    }
    return bruneton_at(air, job.sizes, order_before, linear, p);
}

// Irradiance of the ground by the order before; that by the sun itself for the second order. By the sun's coordinate.
@compute @workgroup_size(64)
fn ground(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = textureDimensions(out_ground).x;
    if id.x >= count {
        return;
    }
    let mu_s = bruneton_sun_mu(air, f32(id.x) / f32(count - 1u));
    var sum = vec3<f32>(0.0);
    if job.counts.x == 2u {
        sum = max(mu_s, 0.0) * sunlight(0.0, mu_s);
    } else {
        // The sky by the order before the one that is now gathered was itself asked for its own before: `order_before` is that sky.
        let step = PI_ / 32.0;
        let sun = vec3<f32>(sqrt(max(1.0 - mu_s * mu_s, 0.0)), 0.0, mu_s);
        for (var l = 0u; l < 16u; l++) {
            let theta = (f32(l) + 0.5) * step;
            for (var m = 0u; m < 64u; m++) {
                let phi = (f32(m) + 0.5) * step;
                let w = vec3<f32>(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
                var light = vec3<f32>(0.0);
                let p = BrunetonPoint(0.0, w.z, mu_s, dot(w, sun), false);
                if job.counts.x == 3u {
                    let phase = air_phase(air, media, 0, p.nu);
                    light = bruneton_at(air, job.sizes, molecules, linear, p) * phase.x + bruneton_at(air, job.sizes, others, linear, p) * phase.y;
                } else {
                    light = bruneton_at(air, job.sizes, order_before, linear, p);
                }
                sum += light * (w.z * sin(theta) * step * step);
            }
        }
    }
    textureStore(out_ground, vec2<u32>(id.x, 0u), vec4<f32>(sum * BRUNETON_SCALE, 0.0));
}

@compute @workgroup_size(4, 4, 4)
fn turn(@builtin(global_invocation_id) id: vec3<u32>) {
    let p = bruneton_point(air, job.sizes, id);
    let matter = air_matter(air, media, 0, p.altitude);
    let sine = sqrt(max(1.0 - p.mu * p.mu, 0.0));
    let view = vec3<f32>(sine, 0.0, p.mu);
    let sun_x = select((p.nu - p.mu * p.mu_s) / max(sine, 1e-6), 0.0, sine < 1e-6);
    let sun = vec3<f32>(sun_x, sqrt(max(1.0 - sun_x * sun_x - p.mu_s * p.mu_s, 0.0)), p.mu_s);
    let horizon = -horizon_dip(air.shape.x, p.altitude).x;
    let step = PI_ / f32(job.counts.z);
    var sum = vec3<f32>(0.0);
    for (var l = 0u; l < job.counts.z; l++) {
        let theta = (f32(l) + 0.5) * step;
        let c = cos(theta);
        let down = BrunetonPoint(p.altitude, c, p.mu_s, 0.0, c < horizon);
        var albedo = vec3<f32>(0.0);
        var reach = 0.0;
        if down.ground {
            reach = end_of(down);
            let there = along(down, reach);
            albedo = bruneton_between(air, transmittance, linear, 0, p.altitude, c, 0.0, there.mu, true) * air.albedo.rgb / PI_;
        }
        for (var m = 0u; m < 2u * job.counts.z; m++) {
            let phi = (f32(m) + 0.5) * step;
            let w = vec3<f32>(sin(theta) * cos(phi), sin(theta) * sin(phi), c);
            let nu = dot(sun, w);
            let phased = matter.scattering * air_phase(air, media, 0, dot(view, w));
            var light = arriving(BrunetonPoint(p.altitude, c, p.mu_s, nu, down.ground));
            if down.ground {
                let mu_ground = ((air.shape.x + p.altitude) * p.mu_s + reach * nu) / air.shape.x;
                let x = table_uv(vec2<f32>(bruneton_sun_x(air, clamp(mu_ground, -1.0, 1.0)), 0.0), vec2<f32>(textureDimensions(lit_ground)));
                light += albedo * textureSampleLevel(lit_ground, linear, x, 0.0).rgb / BRUNETON_SCALE;
            }
            sum += phased * light * (sin(theta) * step * step);
        }
    }
    textureStore(out_a, id, vec4<f32>(min(sum * (BRUNETON_SCALE * TURNED_SCALE), vec3<f32>(6e4)), 0.0));
}

@compute @workgroup_size(4, 4, 4)
fn gather(@builtin(global_invocation_id) id: vec3<u32>) {
    let p = bruneton_point(air, job.sizes, id);
    let ds = end_of(p) / f32(job.counts.y);
    var sum = vec3<f32>(0.0);
    for (var i = 0u; i <= job.counts.y; i++) {
        let q = along(p, f32(i) * ds);
        let way = bruneton_between(air, transmittance, linear, 0, p.altitude, p.mu, q.altitude, q.mu, p.ground);
        let weight = select(ds, 0.5 * ds, i == 0u || i == job.counts.y);
        sum += way * bruneton_at(air, job.sizes, turned, linear, q) * (weight / TURNED_SCALE);
    }
    textureStore(out_a, id, vec4<f32>(sum * BRUNETON_SCALE, 0.0));
}

@compute @workgroup_size(4, 4, 4)
fn sum(@builtin(global_invocation_id) id: vec3<u32>) {
    let phase = air_phase(air, media, 0, bruneton_point(air, job.sizes, id).nu).x;
    let all = textureLoad(molecules, id, 0).rgb + textureLoad(order_before, id, 0).rgb / max(phase, 1e-4);
    textureStore(out_a, id, vec4<f32>(min(all, vec3<f32>(6e4)), 0.0));
}
