// Refracted light: what of the star reaches a point behind a planet, round its limb and through its air, in colour.
//
// The table and its meaning: engine/src/air/refraction/shade.rs, `Shade::read` is the twin of `refracted_light`. A layer per planet whose
// shadow falls on something drawn (Body.casters, Body.lights.y); bind from group 1: @binding(9) refracted: texture_2d_array<f32>.

#include "lib/sunlight.wgsl"

const REFRACTED_COLUMNS: u32 = 193u;
const REFRACTED_HALF: f32 = 96.0;
const REFRACTED_ROWS: u32 = 288u;
const REFRACTED_PER_OCTAVE: f32 = 20.0;

// Light over that of the free disc. `limb` is limb_of_sphere's, of a planet of this radius at this distance.
fn refracted_light(table: texture_2d_array<f32>, layer: i32, radius: f32, distance: f32, limb: vec3<f32>) -> vec3<f32> {
    let nearest = textureLoad(table, vec2<u32>(REFRACTED_COLUMNS, 0u), layer, 0).w;
    let to_limb = sqrt(max(distance - radius, 0.0) * (distance + radius));
    let v = min(log2(max(to_limb / max(nearest, 1.0), 1.0)) * REFRACTED_PER_OCTAVE, f32(REFRACTED_ROWS) - 1.001);
    let row = u32(v);
    let part = v - f32(row);
    let root = mix(refracted_root(table, layer, row, limb.y), refracted_root(table, layer, row + 1u, limb.y), part);
    return root * root * root * root;
}

// Fourth root of the light in a row, where the star's centre stands `gap` outside of the limb.
fn refracted_root(table: texture_2d_array<f32>, layer: i32, row: u32, gap: f32) -> vec3<f32> {
    let span = textureLoad(table, vec2<u32>(REFRACTED_COLUMNS, row), layer, 0);
    let inner = sqrt(clamp((gap - span.x) / max(span.y - span.x, 1e-9), 0.0, 1.0));
    let x = (inner + clamp((gap - span.y) / max(span.z - span.y, 1e-9), 0.0, 1.0)) * REFRACTED_HALF;
    let column = min(u32(x), REFRACTED_COLUMNS - 2u);
    let low = textureLoad(table, vec2<u32>(column, row), layer, 0).rgb;
    return mix(low, textureLoad(table, vec2<u32>(column + 1u, row), layer, 0).rgb, x - f32(column));
}

// Light of the star at a point, over that of the free disc: past worlds without air as eclipse_visible, past others through their air.
fn eclipse_light(body: Body, star: vec4<f32>, point: vec3<f32>, table: texture_2d_array<f32>) -> vec3<f32> {
    let seen = star_seen(star, point);
    var out = vec3<f32>(1.0);
    for (var i = 0u; i < min(u32(max(body.ids.y, 0)), MAX_OCCLUDERS); i++) {
        let ball = body.occluders[i];
        let away = length(ball.xyz - point);
        let layer = body.casters[i / 4u][i % 4u];
        if layer < 0 {
            out *= visible_behind(ball, seen, point);
        } else if away <= seen.distance {
            out *= refracted_light(table, layer, ball.w, away, limb_of_sphere(seen.direction, ball.xyz - point, ball.w));
        }
    }
    return out;
}

// The same behind the body itself, for points above its air; Body.lights.y is the layer.
fn own_limb_light(body: Body, star: vec4<f32>, point: vec3<f32>, altitude: f32, table: texture_2d_array<f32>) -> vec3<f32> {
    let limb = limb_of_sphere(normalize(star.xyz - point), body.centre.xyz - point, body.centre.w);
    return refracted_light(table, body.lights.y, body.centre.w, body.centre.w + altitude, limb);
}
