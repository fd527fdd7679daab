// A baseline for `bench air`, not used by any picture: the sky by the 4-D table of lib/baseline_bruneton.wgsl, asked where the ray enters the air, less
// what lies behind the ground that is seen [Bruneton & Neyret 2008, §4]. Rust side: engine/src/render/pass/baseline_bruneton.rs.

#include "lib/sky_draw.wgsl"
#include "lib/sky_pixel.wgsl"
#include "lib/baseline_bruneton.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(1) @binding(1) var transmittance: texture_2d_array<f32>;
@group(1) @binding(4) var linear: sampler;
@group(1) @binding(8) var media: texture_2d_array<f32>;
@group(2) @binding(0) var opaque: texture_2d<f32>;
@group(2) @binding(1) var depth: texture_depth_2d;
@group(2) @binding(2) var<uniform> sky: Sky;
@group(3) @binding(0) var molecules: texture_3d<f32>;
@group(3) @binding(1) var others: texture_3d<f32>;

fn light_of(body: Body, air: Air, view: SkyView) -> AirLight {
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let end = sky_end(path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let sizes = vec4<u32>(sky.settings[0]);
    let slot = body.ids.z;
    let ground = path.ground >= 0.0;
    let whole = select(path.exit, path.ground, ground);
    let nu = dot(view.ray, body.sun.xyz);
    let here = BrunetonPoint(path.altitude, path.slope / path.radius, dot(path.up, body.sun.xyz), nu, ground);
    var air_light = bruneton_at(air, sizes, molecules, linear, here);
    var haze_light = bruneton_at(air, sizes, others, linear, here);
    var through = vec3<f32>(0.0);
    if ground || end < 0.9999 * whole {
        let h = clamp(air_altitude(air, path, end), 0.0, air.shape.y);
        let r = air.shape.x + h;
        let there = BrunetonPoint(h, (path.slope + end) / r, (path.radius * here.mu_s + end * nu) / r, nu, ground);
        through = bruneton_between(air, transmittance, linear, slot, here.altitude, here.mu, h, there.mu, ground);
        if end < 0.9999 * whole {
            air_light = max(air_light - through * bruneton_at(air, sizes, molecules, linear, there), vec3<f32>(0.0));
            haze_light = max(haze_light - through * bruneton_at(air, sizes, others, linear, there), vec3<f32>(0.0));
        }
    } else {
        through = air_sun_transmittance(air, transmittance, linear, slot, here.altitude, here.mu);
    }
    let phase = air_phase(air, media, slot, nu);
    return AirLight(air_light * phase.x + haze_light * phase.y, through);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let air = airs.list[u32(body.ids.z)];
    let view = sky_view(frame, in.uv, textureLoad(depth, pixel, 0));
    let rays = sky_rays(body, air, view);
    var sum = AirLight(vec3<f32>(0.0), vec3<f32>(0.0));
    for (var k = 0u; k < rays; k++) {
        let light = light_of(body, air, sky_across(body, view, k, rays));
        sum.radiance += light.radiance;
        sum.transmittance += light.transmittance;
    }
    return sky_over(textureLoad(opaque, pixel, 0).rgb, sum, rays, body, exposure);
}
