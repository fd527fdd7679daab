// The model `physical` along a ray: the march of lib/air_march.wgsl, from where the air begins to what is seen.
// Numbers of Sky: [0].rgb the greatest extinction between datum and top, m⁻¹; [0].a: by how much of its light a pixel may err by interpolation; [1]: the
// part of the picture that is drawn, pixels from the upper left to beyond the lower right. Bound by pass/sky_physical.wgsl.

#include "lib/air_march.wgsl"

fn physical_light(
    body: Body, air: Air, media: texture_2d_array<f32>, transmittance: texture_2d_array<f32>, orders: texture_3d<f32>, linear: sampler,
    star: vec4<f32>, sheets: texture_2d_array<f32>, sky: Sky, view: SkyView,
) -> AirLight {
    let path = sky_path(body, air, view);
    let end = sky_end(air, path, view);
    // A line of no width that begins on the datum or under it and falls meets ground at once; a picture that drew none there looks on.
    let grounded = view.pixel <= 0.0 && view.datum && path.altitude <= 0.0 && path.slope < 0.0;
    if end <= 0.0 || grounded {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let sun = AirSun(body.sun.xyz, body.sun.w, 1.0, select(1.0, 0.0, (sky.ids.z & SKY_SINGLE) != 0u));
    return air_march(
        air, media, transmittance, orders, linear, body.ids.z, path, end, view.ray, sun, body, star, sheets, sky.ids.y);
}
