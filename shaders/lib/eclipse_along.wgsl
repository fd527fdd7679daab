// An eclipse on a whole ray of air, for models that keep light in tables: the free fraction of the sun's disc, averaged over four places of
// the ray that lie closer where its air is denser. The shadow is right where it stands, its cone in the air is not drawn.

#include "lib/graded.wgsl"
#include "lib/sky_pixel.wgsl"
#include "lib/sunlight.wgsl"

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
