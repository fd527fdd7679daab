// Table of optical depth to the top by height and angle, for `view_table` [Elek 2008, eq. 3.3]: by the trapezoid rule.
// A ray that would meet the ground goes on through air of the ground's density. Rust side: engine/src/render/pass/sky/view_table.rs.

#include "lib/view_table.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var<uniform> vt: ViewTable;
@group(0) @binding(4) var media: texture_2d_array<f32>;
@group(0) @binding(2) var table: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = textureDimensions(table);
    // Threads beyond the edge do the edge's work again.
    let id = min(thread.xy, size - 1u);
    let graded = vt.counts.w > 0u;
    let x = vec2<f32>(id) / vec2<f32>(size - 1u);
    var path: AirPath;
    path.altitude = space_height(air, graded, x.y);
    path.radius = air.shape.x + path.altitude;
    path.slope = path.radius * space_depth(air, graded, path.altitude, x.x);
    let top = air.shape.y;
    let end = air_reach(path.slope, top * (2.0 * air.shape.x + top) - path.altitude * (2.0 * air.shape.x + path.altitude));
    let steps = graded_steps(path, end);
    var sum = vec3<f32>(0.0);
    var from_s = 0.0;
    var from_extinction = view_matter(air, media, 0, vt, path.altitude).extinction;
    for (var i = 1u; i <= vt.counts.y; i++) {
        let to_s = space_step(steps, graded, f32(i) / f32(vt.counts.y), end);
        let to_extinction = view_matter(air, media, 0, vt, air_altitude(air, path, to_s)).extinction;
        sum += (from_extinction + to_extinction) * (0.5 * (to_s - from_s));
        from_s = to_s;
        from_extinction = to_extinction;
    }
    textureStore(table, id, vec4<f32>(sum, 1.0));
}
