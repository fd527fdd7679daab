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
