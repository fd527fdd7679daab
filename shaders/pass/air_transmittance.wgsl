// Tables of transmittance to the top of the air, by altitude and zenith cosine: of all light, and of the beam that the further orders of
// scattering know. Rust side: engine/src/render/pass/air_tables.rs.

#include "lib/air.wgsl"

@group(0) @binding(0) var<uniform> air: Air;
@group(0) @binding(1) var table: texture_storage_2d_array<rgba16float, write>;
@group(0) @binding(2) var media: texture_2d_array<f32>;

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(vec2<f32>(id.xy) >= TRANSMITTANCE_SIZE) {
        return;
    }
    let point = transmittance_point(air, table_x(id.xy, TRANSMITTANCE_SIZE));
    var path: AirPath;
    path.radius = air.shape.x + point.x;
    path.altitude = point.x;
    path.slope = path.radius * point.y;
    let depth = air_optical_depths(air, media, 0, path, point.z, 8u);
    textureStore(table, id.xy, 0, transmittance_encode(vec4<f32>(exp(-depth[0]), 1.0)));
    textureStore(table, id.xy, 1, transmittance_encode(vec4<f32>(exp(depth[1] - depth[0]), exp(-depth[1].g))));
}
