// Table of the model `limb_table`: for every pair of cosines at the shell's top, the light gathered by a march in even steps.
// Rust side: engine/src/render/pass/sky/limb_table.rs.

#include "lib/limb_table.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var<uniform> sky: Sky;
@group(0) @binding(2) var table: texture_storage_2d<rgba16float, write>;

const LEAST_STEPS: f32 = 16.0;   // LimbTable::LEAST_STEPS
const MOST_STEPS: f32 = 4096.0;  // LimbTable::MOST_STEPS

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = textureDimensions(table);
    // Threads beyond the edge do the edge's work again.
    let id = min(thread.xy, size - 1u);
    let point = limb_point(air, f32(size.x), id);
    let top = air.shape.y;
    let q = top * (2.0 * air.shape.x + top);
    var path: AirPath;
    path.radius = air.shape.x + top;
    path.altitude = top;
    path.slope = -path.radius * point.x;
    let end = select(-2.0 * path.slope, q / (sqrt(max(path.slope * path.slope - q, 0.0)) - path.slope), point.z > 0.5);
    let hidden = limb_hidden(path, air.shape.x, point.y, limb_sides(-point.x, point.y).x);
    let count = u32(clamp(ceil(end / sky.settings[1].x), LEAST_STEPS, MOST_STEPS));
    let column = limb_column(air, path, end, sky.settings[0].w, LimbShadow(hidden, hidden, hidden, 0.0, 1.0), count, true);
    textureStore(table, id, vec4<f32>(sky.settings[0].rgb * column, 1.0));
}
