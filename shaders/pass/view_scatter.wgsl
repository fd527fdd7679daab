// Table of single scattering without its phase functions, for `view_table` [Elek 2008, eq. 3.4]: by the trapezoid rule, in the plane of
// zenith, ray and sun. Rust side: engine/src/render/pass/sky/view_table.rs.

#include "lib/view_table.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var<uniform> vt: ViewTable;
@group(0) @binding(4) var media: texture_2d_array<f32>;
@group(0) @binding(2) var table: texture_storage_3d<rgba16float, write>;
@group(0) @binding(3) var depth: texture_2d<f32>;

const SUN_RAD: f32 = 0.0047;  // ViewTable::SUN_RAD

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = textureDimensions(table);
    // Threads beyond the edge do the edge's work again.
    let id = min(thread, size - 1u);
    let graded = vt.counts.w > 0u;
    let x = vec3<f32>(id) / vec3<f32>(size - 1u);
    let top = air.shape.y;
    var path: AirPath;
    path.altitude = space_height(air, graded, x.z);
    path.radius = air.shape.x + path.altitude;
    let angle = space_view(air, graded, path.altitude, f32(id.x), f32(size.x));
    let mu = cos(angle.x);
    path.slope = path.radius * mu;
    let mu_s = space_sun(graded, x.y);
    let nu = mu * mu_s + sin(angle.x) * sqrt(max(1.0 - mu_s * mu_s, 0.0));
    let q = path.altitude * (2.0 * air.shape.x + path.altitude);
    var end = air_reach(path.slope, top * (2.0 * air.shape.x + top) - q);
    if angle.y > 0.5 {
        end = q / max(sqrt(max(path.slope * path.slope - q, 0.0)) - path.slope, 1e-6);
    }
    let steps = graded_steps(path, end);
    var out = vec4<f32>(0.0);
    var through = vec3<f32>(0.0);
    var from_s = 0.0;
    var from_matter = view_matter(air, media, 0, vt, path.altitude);
    var from_sun = view_sun(air, vt, depth, path.altitude, mu_s);
    for (var i = 1u; i <= vt.counts.x; i++) {
        let to_s = space_step(steps, graded, f32(i) / f32(vt.counts.x), end);
        let altitude = air_altitude(air, path, to_s);
        let matter = view_matter(air, media, 0, vt, altitude);
        let sun = view_sun(air, vt, depth, altitude, (path.radius * mu_s + to_s * nu) / (air.shape.x + max(altitude, 0.0)));
        let ds = to_s - from_s;
        let from_kept = from_sun.transmittance * exp(-through);
        through += (from_matter.extinction + matter.extinction) * (0.5 * ds);
        let kept = sun.transmittance * exp(-through);
        let lit = 0.5 * ds * visible_between(SUN_RAD, from_sun.elevation, sun.elevation);
        out += lit * vec4<f32>(from_matter.rgb * from_kept + matter.rgb * kept, from_matter.alpha * from_kept.g + matter.alpha * kept.g);
        from_s = to_s;
        from_matter = matter;
        from_sun = sun;
    }
    textureStore(table, id, sqrt(out));
}
