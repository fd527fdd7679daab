// Eclipsed surroundings: the free fraction of the sun's disc on rings about a point, from which light comes that is scattered there not for the
// first time.
//
// A sheet holds it for every place of a body's day side, across the shadow of one occluder: places go by their two coordinates across the shadow's
// axis, the denser the nearer to it. Per ring: the mean over the azimuth φ, and the means times cos 2φ and sin 2φ. Three layers of a texture each,
// made by pass/eclipse_rings.wgsl; Body.sheets has the layer and the frame. Bind from group 1: @binding(10) sheets: texture_2d_array<f32>.

#include "lib/sunlight.wgsl"

const SHEET: f32 = 80.0;  // texels each way: SHEET of engine/src/render/pass/eclipse_rings.rs

// What a ring's second moment weighs in light scattered across it, over the square of the sine of the eye's zenith angle: Rayleigh's half, less
// what does not come level.
const RING_TURN: f32 = 0.4;

// Coordinates across a shadow, m, and those in its sheet, −1 … 1.
fn sheet_place(shape: vec4<f32>, x: vec2<f32>) -> vec2<f32> {
    return sign(x) * (sqrt(abs(x) / shape.x + shape.y * shape.y) - shape.y) / shape.z;
}
fn sheet_offset(shape: vec4<f32>, t: vec2<f32>) -> vec2<f32> {
    let root = abs(t) * shape.z + shape.y;
    return sign(t) * shape.x * (root * root - shape.y * shape.y);
}

// One of a body's sheets.
struct Sheet {
    axes: mat3x3<f32>,  // across the shadow, the first along Body.sheets, and away from the star
    ball: vec4<f32>,    // the occluder
    shape: vec4<f32>,
    layer: i32,         // −1: none
}
fn sheet_of(body: Body, star: vec4<f32>, i: u32) -> Sheet {
    let ball = body.occluders[i];
    let first = body.sheets[2u * i];
    let axis = normalize(ball.xyz - star.xyz);
    return Sheet(mat3x3<f32>(first.xyz, cross(axis, first.xyz), axis), ball, body.sheets[2u * i + 1u], i32(first.w));
}
// Directions on the ground from which azimuths count: φ = 0 and φ = ¼ turn.
fn sheet_level(first: vec3<f32>, up: vec3<f32>) -> mat2x3<f32> {
    let ahead = normalize(first - up * dot(first, up));
    return mat2x3<f32>(ahead, cross(up, ahead));
}

// A moment of each ring's free fraction at a point.
fn sheet_at(sheets: texture_2d_array<f32>, linear: sampler, sheet: Sheet, point: vec3<f32>, moment: i32) -> vec4<f32> {
    let d = point - sheet.ball.xyz;
    let t = sheet_place(sheet.shape, vec2<f32>(dot(d, sheet.axes[0]), dot(d, sheet.axes[1])));
    let uv = ((0.5 + 0.5 * clamp(t, vec2<f32>(-1.0), vec2<f32>(1.0))) * (SHEET - 1.0) + 0.5) / SHEET;
    return textureSampleLevel(sheets, linear, uv, sheet.layer + moment, 0.0);
}

// Free fraction on each of the rings, all occluders considered: their product, see engine/src/light/occlusion.rs.
fn eclipse_around(sheets: texture_2d_array<f32>, linear: sampler, body: Body, star: vec4<f32>, point: vec3<f32>) -> vec4<f32> {
    var around = vec4<f32>(1.0);
    for (var i = 0u; i < min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS); i++) {
        let sheet = sheet_of(body, star, i);
        around *= select(vec4<f32>(1.0), sheet_at(sheets, linear, sheet, point, 0), sheet.layer >= 0);
    }
    return around;
}

// The same of one occluder as it counts for an eye that looks along `ray`: of light from around the horizon more is scattered ahead and back than
// aside. Along a ray that more shadows than one touch the deepest alone is asked.
fn sheet_seen(sheets: texture_2d_array<f32>, linear: sampler, sheet: Sheet, up: vec3<f32>, point: vec3<f32>, ray: vec3<f32>) -> vec4<f32> {
    let level = ray * sheet_level(sheet.axes[0], up);
    let double = vec2<f32>(level.x * level.x - level.y * level.y, 2.0 * level.x * level.y) * (RING_TURN / (1.0 + 0.5 * dot(level, level)));
    let turned = double.x * sheet_at(sheets, linear, sheet, point, 1) + double.y * sheet_at(sheets, linear, sheet, point, 2);
    return select(vec4<f32>(1.0), max(sheet_at(sheets, linear, sheet, point, 0) + turned, vec4<f32>(0.0)), sheet.layer >= 0);
}

// Light scattered for a further time, over that without an eclipse: `sum` and what the point's own free fraction has of it.
struct Further {
    around: vec3<f32>,
    own: vec3<f32>,
}
fn eclipse_further(rings: Rings, around: vec4<f32>) -> Further {
    return Further(rings.weight * around, vec3<f32>(1.0) - rings.weight * vec4<f32>(1.0));
}
