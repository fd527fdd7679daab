// Sheets of lib/eclipse_rings.wgsl: the free fraction of the sun's disc on rings about every place of a body's day side, behind one occluder.
// Rust side: engine/src/render/pass/eclipse_rings.rs.

#include "lib/eclipse_rings.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(1) @binding(1) var<storage, read> asked: vec4<u32>;  // index of the body, of its occluder, slot of its air
@group(1) @binding(2) var sheets: texture_storage_2d_array<rgba16float, write>;

const AZIMUTHS: u32 = 12u;

@compute @workgroup_size(8, 8)
fn bake(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = bodies.list[asked.x];
    let star = frame.star;
    let sheet = sheet_of(body, star, asked.y);
    let ball = sheet.ball;
    let axes = sheet.axes;
    let x = sheet_offset(sheet.shape, 2.0 * vec2<f32>(id.xy) / (SHEET - 1.0) - 1.0);
    // On the ground of the day side; beyond the limb, in the plane of the limb.
    let from_ball = body.centre.xyz - ball.xyz;
    let aside = axes[0] * (x.x - dot(from_ball, axes[0])) + axes[1] * (x.y - dot(from_ball, axes[1]));
    let height = sqrt(max(body.centre.w * body.centre.w - dot(aside, aside), 0.0));
    let out = aside - axes[2] * height;
    let point = body.centre.xyz + out;
    let level = sheet_level(axes[0], normalize(out));
    var mean = vec4<f32>(0.0);
    var cosine = vec4<f32>(0.0);
    var sine = vec4<f32>(0.0);
    for (var j = 0u; j < AZIMUTHS; j++) {
        let azimuth = 2.0 * PI * (f32(j) + 0.5) / f32(AZIMUTHS);
        let along = level * vec2<f32>(cos(azimuth), sin(azimuth));
        var free = vec4<f32>(0.0);
        for (var part = 0u; part < 3u; part++) {
            let radius = airs.list[asked.z].ring_parts[part];
            for (var k = 0u; k < 4u; k++) {
                let at = point + along * dot(radius, select(vec4<f32>(0.0), vec4<f32>(1.0), vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(k)));
                free[k] += visible_behind(ball, star_seen(star, at), at) / 3.0;
            }
        }
        mean += free;
        cosine += free * cos(2.0 * azimuth);
        sine += free * sin(2.0 * azimuth);
    }
    textureStore(sheets, id.xy, 0, mean / f32(AZIMUTHS));
    textureStore(sheets, id.xy, 1, cosine / f32(AZIMUTHS));
    textureStore(sheets, id.xy, 2, sine / f32(AZIMUTHS));
}
