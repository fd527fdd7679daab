// The model `gradient` along a ray: colours out of two small maps. Twin of engine/src/air/model/gradient.rs, which explains it.
//
// Numbers of Sky: settings[0] stretch, stretch + fade stretch, visibility in m, transparency; settings[1] brightness / π, opacity, 0, 0.
// Maps are linear RGBA, read between their texels by hand: filters of samplers keep 8 bits. Bound by pass/sky_gradient.wgsl.
// Under an eclipse the air's own light fades, all along a ray alike; what it makes of light from behind does not.

#include "lib/eclipse_along.wgsl"

fn gradient_light(
    body: Body, air: Air, shell_map: texture_2d<f32>, ground_map: texture_2d<f32>, star: vec4<f32>, sky: Sky, view: SkyView,
) -> AirLight {
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let end = sky_end(air, path, view);
    if end <= 0.0 {
        return AirLight(vec3<f32>(0.0), vec3<f32>(1.0));
    }
    let light = gradient_painted(body, air, shell_map, ground_map, sky, view, path, end);
    return AirLight(light.radiance * eclipse_along(body, star, air, path, view.ray, end), light.transmittance);
}

// Without eclipses.
fn gradient_painted(
    body: Body, air: Air, shell_map: texture_2d<f32>, ground_map: texture_2d<f32>, sky: Sky, view: SkyView, path: AirPath, end: f32,
) -> AirLight {
    let top = air.shape.y;
    let sun = body.sun.xyz;
    let brightness = sky.settings[1].x;
    let rise = dot(view.ray, sun);
    let start = path.radius * dot(path.up, sun);
    let far = clamp((start + path.exit * rise) / (air.shape.x + top), -1.0, 1.0);
    let low = air_altitude(air, path, clamp(-path.slope, 0.0, path.exit));
    let height = clamp(1.0 - low / top, 0.0, 1.0);
    let across = gradient_across(sky.settings[0].xy, far, dot(path.up, sun), dot(body.up.xyz, sun));
    let texel = gradient_map(shell_map, vec2<f32>(across.x, height));
    let alpha = height * across.y * texel.a;
    let shell = AirLight(texel.rgb * (alpha * brightness), vec3<f32>(1.0 - sky.settings[1].y * alpha));
    if end >= path.exit {
        return shell;
    }

    // Something stands in the air: the ground's formula by how low it is, the shell's by the rest and by the way before it.
    let altitude = air_altitude(air, path, end);
    let mu_s = clamp((start + end * rise) / max(air.shape.x + altitude, 1.0), -1.0, 1.0);
    let deep = clamp(1.0 - altitude / top, 0.0, 1.0);
    let passed = (1.0 - deep) * clamp(end / max(path.exit, 1e-6), 0.0, 1.0);
    let visibility = sky.settings[0].z;
    let attenuation = clamp((path.start + end - visibility) / (top + min(top, visibility)), 0.0, 1.0);
    let u = 0.5 + 0.5 * mu_s;
    let sunlight = gradient_map(ground_map, vec2<f32>(u, 0.75)).rgb;
    let haze = gradient_map(ground_map, vec2<f32>(u, 0.25)).rgb * sunlight * (min(sky.settings[0].w, attenuation) * brightness);
    return AirLight(
        haze * deep + shell.radiance * passed,
        mix(vec3<f32>(1.0), sunlight, deep) * mix(vec3<f32>(1.0), shell.transmittance, passed),
    );
}

// uv.x and alpha of the shell, from the sun's cosine where the ray leaves it, where it enters, and at the camera.
fn gradient_across(stretch: vec2<f32>, far: f32, near: f32, camera: f32) -> vec2<f32> {
    let reached = clamp(max(far + stretch, vec2<f32>(0.0)) + max(near + stretch, vec2<f32>(0.0)) * camera, vec2<f32>(0.0), vec2<f32>(1.0));
    return vec2<f32>(reached.x * clamp(camera + 1.0 + stretch.x, 0.0, 1.0), reached.y);
}

fn gradient_map(map: texture_2d<f32>, uv: vec2<f32>) -> vec4<f32> {
    let last = vec2<i32>(textureDimensions(map)) - 1;
    let x = clamp(uv * vec2<f32>(last + 1) - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let low = vec2<i32>(x);
    let high = min(low + 1, last);
    let t = x - vec2<f32>(low);
    let upper = mix(textureLoad(map, low, 0), textureLoad(map, vec2<i32>(high.x, low.y), 0), t.x);
    let lower = mix(textureLoad(map, vec2<i32>(low.x, high.y), 0), textureLoad(map, high, 0), t.x);
    return mix(upper, lower, t.y);
}
