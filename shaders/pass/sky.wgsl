// Sky and aerial perspective: the air of every body in view, far to near, over the opaque picture. Rust side: engine/src/render/pass/sky.rs.

#include "lib/air_march.wgsl"

struct Sky {
    order: array<vec4<u32>, 4>,  // indices of bodies, far to near
    counts: vec4<u32>,           // how many; steps of a long march
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(1) @binding(1) var transmittance: texture_2d_array<f32>;
@group(1) @binding(2) var multiple: texture_2d_array<f32>;
@group(1) @binding(4) var linear: sampler;
@group(2) @binding(0) var opaque: texture_2d<f32>;
@group(2) @binding(1) var depth: texture_depth_2d;
@group(2) @binding(2) var<uniform> sky: Sky;

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    var out: Varying;
    out.uv = full_screen_uv(index);
    out.position = full_screen_position(out.uv);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    var colour = textureLoad(opaque, pixel, 0).rgb;
    let stored = textureLoad(depth, pixel, 0);
    let through = view_ray(frame, in.uv);
    let stretch = length(through);
    let ray = through / stretch;
    // Distance to what is seen; where nothing is, far beyond any air.
    let surface = select(1e30, axis_distance(frame, stored) * stretch, stored > 0.0);
    for (var i = 0u; i < sky.counts.x; i++) {
        let body = bodies.list[sky.order[i / 4u][i % 4u]];
        let slot = body.ids.z;
        let air = airs.list[u32(max(slot, 0))];
        let path = air_path(air, body.up.xyz, body.up.w, ray);
        if slot < 0 || path.start < 0.0 || surface <= path.start {
            continue;
        }
        let sun = AirSun(body.sun.xyz, body.sun.w, 1.0, 1.0);
        // From afar the air at the limb is thinner than a pixel: there, several rays across it stand for one.
        let pixel = frame.up.w * (path.start + path.exit);
        let low = air_altitude(air, path, clamp(-path.slope, 0.0, path.exit));
        // From within the air, ground that was drawn ends the ray where it stands.
        let afar = path.start > 0.0 || stored <= 0.0;
        let thin = afar && pixel > 0.05 * air.shape.y && low < air.shape.y + pixel && low > -pixel;
        let rays = select(1u, 5u, thin);
        var radiance = vec3<f32>(0.0);
        var kept = vec3<f32>(0.0);
        for (var k = 0u; k < rays; k++) {
            var along = ray;
            var way = path;
            if thin {
                let aside = ((f32(k) + 0.5) / f32(rays) - 0.5) * frame.up.w;
                along = normalize(ray + normalize(body.up.xyz - ray * dot(ray, body.up.xyz)) * aside);
                way = air_path(air, body.up.xyz, body.up.w, along);
            }
            if way.start < 0.0 || surface <= way.start {
                kept += vec3<f32>(1.0);
                continue;
            }
            var end = min(way.exit, surface - way.start);
            if way.ground >= 0.0 && (stored <= 0.0 || thin) {
                end = way.ground;  // no ground was drawn here: the datum stands for it
            } else if thin {
                end = way.exit;
            }
            // A short way needs few steps; the count grows evenly, and its error is small enough that no edge shows.
            let share = clamp(end / (0.25 * air.shape.y), 0.0, 1.0);
            let count = u32(mix(6.0, f32(sky.counts.y), share));
            let light = air_march(air, transmittance, multiple, linear, slot, way, end, along, sun, body, frame.star, count);
            radiance += light.radiance;
            kept += light.transmittance;
        }
        colour = (colour * kept + radiance * body.illuminance.rgb * exposure.pre) / f32(rays);
    }
    return vec4<f32>(to_hdr(colour, 1.0), 1.0);
}
