// How the steps of a march lie on a stretch of a path from 0 to `end`: squares of equal parts counted from the lowest point, where air is
// densest, so that steps grow with the distance from it. For the models that keep light in tables; twin of `Trapezoid` in
// engine/src/air/model/view_space.rs.

#include "lib/air_path.wgsl"

struct Graded {
    low: f32,
    scale: f32,
    offset: f32,
}
fn graded_steps(path: AirPath, end: f32) -> Graded {
    let low = clamp(-path.slope, 0.0, end);
    let before = sqrt(low);
    let both = before + sqrt(end - low);
    return Graded(low, both * both, before / max(both, 1e-12));
}
// x from 0 to 1.
fn graded_step(steps: Graded, x: f32) -> f32 {
    let y = x - steps.offset;
    return max(steps.low + steps.scale * y * abs(y), 0.0);
}

// The path of an eye that stands on the datum or under it and looks down where nothing was drawn: `exit` is 0 on the datum, which it sees
// at once; under it the ray is taken for a level one, as from a basin whose floor was not drawn.
fn graded_above(air: Air, path: AirPath, datum: bool) -> AirPath {
    var out = path;
    if datum && path.altitude <= 0.0 && path.slope < 0.0 && path.start <= 0.0 {
        out.slope = 0.0;
        let top = air.shape.y * (2.0 * air.shape.x + air.shape.y);
        out.exit = select(0.0, air_reach(0.0, top - path.altitude * (2.0 * air.shape.x + path.altitude)), path.altitude < -1.0);
        out.ground = -1.0;
    }
    return out;
}
