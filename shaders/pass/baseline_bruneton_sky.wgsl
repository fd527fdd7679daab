// A baseline for `bench air`, not used by any picture: the sky by the 4-D table of lib/baseline_bruneton.wgsl, asked where the ray enters the air, less
// what lies behind the ground that is seen [Bruneton & Neyret 2008, §4]. Rust side: engine/src/render/pass/baseline_bruneton.rs.

#include "pass/sky.wgsl"
#include "lib/baseline_bruneton.wgsl"

@group(3) @binding(0) var molecules: texture_3d<f32>;
@group(3) @binding(1) var others: texture_3d<f32>;

fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    let air = airs.list[u32(body.ids.z)];
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let end = sky_end(air, path, view);
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
    return in_starlight(body, AirLight(air_light * phase.x + haze_light * phase.y, through));
}
