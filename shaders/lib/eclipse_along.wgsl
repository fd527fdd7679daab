// What models that keep light in tables share: an eclipse on a whole ray, and the pixels that the ground's edge parts.

#include "lib/graded.wgsl"
#include "lib/sky_pixel.wgsl"
#include "lib/sunlight.wgsl"

// The free fraction of the sun's disc, averaged over four places of the ray that lie closer where its air is denser. The shadow is right
// where it stands, its cone in the air is not drawn.
fn eclipse_along(body: Body, star: vec4<f32>, air: Air, path: AirPath, ray: vec3<f32>, end: f32) -> f32 {
    if body.ids.y <= 0 {
        return 1.0;
    }
    let steps = graded_steps(path, end);
    var sum = 0.0;
    for (var i = 0u; i < 4u; i++) {
        sum += eclipse_visible(body, star, ray * (path.start + graded_step(steps, (f32(i) + 0.5) / 4.0)));
    }
    return 0.25 * sum;
}

// Share of a pixel that lies beyond the edge of the drawn ground, where the eye is in the air: the ground was drawn by its share of the
// pixel, so the air behind it has the rest. 0 elsewhere.
fn edge_share(air: Air, path: AirPath, view: SkyView, end: f32) -> f32 {
    let reach = -path.slope;
    if view.datum || path.start > 0.0 || reach <= 0.0 || end < 0.5 * reach {
        return 0.0;
    }
    let pixel = view.pixel * reach;
    let low = air_altitude(air, path, min(reach, path.exit));
    if abs(low) > pixel || air_altitude(air, path, end) > pixel {
        return 0.0;
    }
    return clamp(low / max(pixel, 1e-3) + 0.5, 0.0, 1.0);
}
