// Light of air between rays: cells of a level of the picture, with a ray at each corner, and what lies between by differences along their sides.
//
// Along a side, f(u) = (1 − u) f₀ + u f₁ − ½ u (1 − u) b, with b the mean of the second differences at its two ends: the cubic through four
// texels at the middle [Everett 1901, "On a New Interpolation Formula"; the terms of second order]. Where the next texel is no more of the same kind, the
// second difference of the other end stands for that of this one. Nothing is bound here: pass/sky_physical.wgsl.

#include "lib/sky_pixel.wgsl"

// By how much of its light a pixel may err because the surface around it is not its own.
const SKY_AGREE_DEPTH: f32 = 0.01;
// Half floats then hold depths of surfaces from 1 m to 800,000 km to a two-thousandth, for a near plane of 0.2 m; differences of them to this.
const SKY_DEPTH_SCALE: f32 = 262144.0;
const SKY_DEPTH_MOST: f32 = 6e4;
const SKY_DEPTH_NOISE: f32 = 1.2e-3;
// Pre-exposed light of which nobody sees an error: a thousandth of white.
const SKY_UNSEEN: f32 = 1e-3;

// The surface of a pixel, as levels hold it: its depth from where the air begins, times SKY_DEPTH_SCALE; the way to it from there.
fn sky_surface(body: Body, air: Air, view: SkyView, own_depth: f32) -> vec2<f32> {
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let way = max(view.surface - max(path.start, 0.0), 1e-3 * view.surface);
    return vec2<f32>(min(own_depth * SKY_DEPTH_SCALE * (view.surface / way), SKY_DEPTH_MOST), way);
}

// A surface moved by ds changes the light before it by T β ds of 1 − T, at most. Of that share of the way to it that half floats do not hold nobody knows.
fn sky_near_enough(extinction: vec3<f32>, way: f32, apart: f32, through: vec3<f32>) -> bool {
    return all(through * extinction * (way * max(apart - SKY_DEPTH_NOISE, 0.0)) <= SKY_AGREE_DEPTH * (1.0 - through));
}

// Of a corner between texels of a target of this size. Nothing is cut off at its edge, which would be slow.
fn sky_texel_position(texel: vec2<u32>, size: vec2<f32>) -> vec4<f32> {
    return full_screen_position(min(vec2<f32>(texel) / size, vec2<f32>(1.0)));
}

// A ray: radiance and depth of its surface; transmittance and 1 where the texel can be used.
struct SkyTexel {
    radiance: vec4<f32>,
    transmittance: vec4<f32>,
}

// Bends of a side, times ½.
struct SkySide {
    radiance: vec4<f32>,
    transmittance: vec3<f32>,
}

// By how much what lies between may err.
struct SkyDoubt {
    radiance: vec4<f32>,
    transmittance: vec3<f32>,
}

// With x and y from 0 to 1: value = 0 + x·x₁ + y·y₁ + xy·xy₁ − x (1 − x) bend − y (1 − y) bend. Bends of radiance lead over from one side to the
// opposite one; those of transmittance are the mean of the two.
struct SkyCell {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) r0: vec4<f32>,
    @location(1) @interpolate(flat) rx: vec4<f32>,
    @location(2) @interpolate(flat) ry: vec4<f32>,
    @location(3) @interpolate(flat) rxy: vec4<f32>,
    @location(4) @interpolate(flat) bend_x: vec4<f32>,
    @location(5) @interpolate(flat) bend_xy: vec4<f32>,  // rise of that with y
    @location(6) @interpolate(flat) bend_y: vec4<f32>,
    @location(7) @interpolate(flat) bend_yx: vec4<f32>,
    @location(8) @interpolate(flat) t0: vec4<f32>,
    @location(9) @interpolate(flat) tx: vec4<f32>,
    @location(10) @interpolate(flat) ty: vec4<f32>,
    @location(11) @interpolate(flat) txy: vec4<f32>,
    @location(12) @interpolate(flat) t_bend_x: vec4<f32>,
    @location(13) @interpolate(flat) t_bend_y: vec4<f32>,
}

// Of the side from b to c, with a before and d behind.
fn sky_side(a: SkyTexel, b: SkyTexel, c: SkyTexel, d: SkyTexel) -> SkySide {
    let before = a.transmittance.a;
    let behind = d.transmittance.a;
    let share = 0.5 / max(before + behind, 1.0);
    return SkySide(
        share * (before * (a.radiance - 2.0 * b.radiance + c.radiance) + behind * (b.radiance - 2.0 * c.radiance + d.radiance)),
        share * (before * (a.transmittance - 2.0 * b.transmittance + c.transmittance)
            + behind * (b.transmittance - 2.0 * c.transmittance + d.transmittance)).rgb);
}

// Of the side from c to d of six texels in a row: by fourth differences, or by what there is of them. Of what is smooth they overrate the error
// of the cubic fivefold; of a kink between two texels they find a third.
fn sky_doubt(a: SkyTexel, b: SkyTexel, c: SkyTexel, d: SkyTexel, e: SkyTexel, f: SkyTexel) -> SkyDoubt {
    let has = vec4<bool>(
        a.transmittance.a * b.transmittance.a > 0.5, b.transmittance.a > 0.5, e.transmittance.a > 0.5, e.transmittance.a * f.transmittance.a > 0.5);
    return SkyDoubt(
        row_doubt(has, a.radiance, b.radiance, c.radiance, d.radiance, e.radiance, f.radiance),
        row_doubt(has, a.transmittance, b.transmittance, c.transmittance, d.transmittance, e.transmittance, f.transmittance).rgb);
}
fn row_doubt(has: vec4<bool>, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>, e: vec4<f32>, f: vec4<f32>) -> vec4<f32> {
    var second = mat4x4<f32>(a - 2.0 * b + c, b - 2.0 * c + d, c - 2.0 * d + e, d - 2.0 * e + f);
    second[1] = select(second[2], second[1], has.y);
    second[2] = select(second[1], second[2], has.z);
    second[0] = select(second[1], second[0], has.x);
    second[3] = select(second[2], second[3], has.w);
    let known = dot(vec4<f32>(1.0), select(vec4<f32>(0.0), vec4<f32>(1.0), has));
    let fourth = max(abs(second[0] - 2.0 * second[1] + second[2]), abs(second[1] - 2.0 * second[2] + second[3]));
    // Of one second difference, itself; of none, what light would have that falls by a constant share.
    let even = (c - d) * (c - d) / max(abs(c) + abs(d), vec4<f32>(1e-9));
    return 0.125 * select(2.0 * even, select(abs(second[1]), fourth, known > 1.5), known > 0.5);
}

// Of two sides that lie opposite; of both directions.
fn sky_doubts_more(a: SkyDoubt, b: SkyDoubt) -> SkyDoubt {
    return SkyDoubt(max(a.radiance, b.radiance), max(a.transmittance, b.transmittance));
}
fn sky_doubts(a: SkyDoubt, b: SkyDoubt) -> SkyDoubt {
    return SkyDoubt(a.radiance + b.radiance, a.transmittance + b.transmittance);
}

// Corners a, b in the upper row, c, d in the lower; sides a–b, c–d, a–c, b–d.
fn sky_cell(
    a: SkyTexel, b: SkyTexel, c: SkyTexel, d: SkyTexel, upper: SkySide, lower: SkySide, left: SkySide, right: SkySide,
) -> SkyCell {
    var cell: SkyCell;
    cell.r0 = a.radiance;
    cell.rx = b.radiance - a.radiance;
    cell.ry = c.radiance - a.radiance;
    cell.rxy = a.radiance - b.radiance - c.radiance + d.radiance;
    cell.bend_x = upper.radiance;
    cell.bend_xy = lower.radiance - upper.radiance;
    cell.bend_y = left.radiance;
    cell.bend_yx = right.radiance - left.radiance;
    let bend_x = 0.5 * (upper.transmittance + lower.transmittance);
    let bend_y = 0.5 * (left.transmittance + right.transmittance);
    cell.t0 = a.transmittance;
    cell.tx = b.transmittance - a.transmittance;
    cell.ty = c.transmittance - a.transmittance;
    cell.txy = a.transmittance - b.transmittance - c.transmittance + d.transmittance;
    cell.t_bend_x = vec4<f32>(bend_x, 0.0);
    cell.t_bend_y = vec4<f32>(bend_y, 0.0);
    return cell;
}

fn sky_cell_radiance(cell: SkyCell, at: vec2<f32>) -> vec4<f32> {
    let arc = at * (1.0 - at);
    return cell.r0 + at.x * cell.rx + at.y * (cell.ry + at.x * cell.rxy)
        - arc.x * (cell.bend_x + at.y * cell.bend_xy) - arc.y * (cell.bend_y + at.x * cell.bend_yx);
}
fn sky_cell_transmittance(cell: SkyCell, at: vec2<f32>) -> vec3<f32> {
    let arc = at * (1.0 - at);
    return (cell.t0 + at.x * cell.tx + at.y * (cell.ty + at.x * cell.txy) - arc.x * cell.t_bend_x - arc.y * cell.t_bend_y).rgb;
}
