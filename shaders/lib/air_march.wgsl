// Light along a ray through air: single scattering marched, further orders from the table, sun and shadow at every step.
//
// Each step takes densities by Simpson's rule, the sun at its middle, the planet's own shadow averaged over its length, and integrates
// a constant source exactly: ∫ S e^(−σt) dt = S (1 − e^(−σΔ)) / σ [Hillaire 2015, "Physically Based and Unified Volumetric Rendering"].

#include "lib/air.wgsl"
#include "lib/sky_pixel.wgsl"
#include "lib/sunlight.wgsl"

// What lights the air.
struct AirSun {
    direction: vec3<f32>,
    angular_radius: f32,
    single: f32,    // 1; 0 leaves direct light out
    multiple: f32,  // 1; 0 leaves further orders out
}

// From the path's start to `end` metres further, in `count` steps. `ray` is the direction of sight, `star` the star's sphere.
fn air_march(
    air: Air, transmittance: texture_2d_array<f32>, orders: texture_3d<f32>, linear: sampler, slot: i32,
    path: AirPath, end: f32, ray: vec3<f32>, sun: AirSun, body: Body, star: vec4<f32>, count: u32,
) -> AirLight {
    let phase = air_phase(air, dot(ray, sun.direction)) * sun.single;
    let up_sun = path.radius * dot(path.up, sun.direction);
    let ray_sun = dot(ray, sun.direction);
    let steps = air_steps(path, end);
    let shaded = body.ids.y > 0;
    var out = AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    var from_s = 0.0;
    var from_density = air_density(air, path.altitude);
    var from_sun = sun_elevation(air.shape.x, path.altitude, up_sun / path.radius);
    for (var i = 1u; i <= count; i++) {
        let to_s = air_step(steps, f32(i) / f32(count));
        let s = 0.5 * (from_s + to_s);
        let altitude = air_altitude(air, path, s);
        let mu_s = (up_sun + s * ray_sun) / (air.shape.x + altitude);
        let to_altitude = air_altitude(air, path, to_s);
        let to_density = air_density(air, to_altitude);
        let to_sun = sun_elevation(air.shape.x, to_altitude, (up_sun + to_s * ray_sun) / (air.shape.x + to_altitude));
        let density = (from_density + 4.0 * air_density(air, altitude) + to_density) / 6.0;

        var eclipse = Eclipse(1.0, 1.0);
        if shaded {
            eclipse = eclipse_at(body, star, ray * (path.start + s), air.shape.y);
        }
        let direct = visible_between(sun.angular_radius, from_sun, to_sun) * eclipse.direct;
        var source = air.scattering * density * (sun.multiple * eclipse.diffuse)
            * air_orders(air, orders, linear, slot, altitude, mu_s, (path.slope + s) / (air.shape.x + altitude), ray_sun);
        if direct > 0.0 {
            source += air.scattering * (density * phase) * direct
                * air_sun_transmittance(air, transmittance, linear, slot, altitude, mu_s);
        }
        let extinction = air.extinction * density;
        let depth = extinction * (to_s - from_s);
        let kept = exp(-depth);
        let length = select((1.0 - kept) / max(extinction, vec3<f32>(1e-20)), (to_s - from_s) * (1.0 - 0.5 * depth), depth < vec3<f32>(1e-3));
        out.radiance += out.transmittance * source * length;
        out.transmittance *= kept;
        from_s = to_s;
        from_density = to_density;
        from_sun = to_sun;
    }
    return out;
}
