// Light of air between rays: cells of a level of the picture, with a ray at each corner, and what lies between by differences along their sides.
//
// Along a side, f(u) = (1 − u) f₀ + u f₁ − ½ u (1 − u) b, with b the mean of the second differences at its two ends: the cubic through four
// texels at the middle [Everett 1901, "On a New Interpolation Formula"; the terms of second order]. Where the next texel is no more of the same kind, the
// second difference of the other end stands for that of this one. Nothing is bound here: pass/sky_physical.wgsl.

#include "lib/sky_pixel.wgsl"

// By how much of its light a pixel may err because the surface around it is not its own.
const SKY_AGREE_DEPTH: f32 = 0.03;
// Relative error of an interpolated depth that is nothing but rounding.
const SKY_DEPTH_ROUNDING: f32 = 2e-6;

// How far a surface may lie from where it is thought to be, m: moved by ds it changes the light before it by T β ds of 1 − T, at most. `through`: T there.
fn sky_reach(extinction: vec3<f32>, through: vec3<f32>) -> f32 {
    let reach = SKY_AGREE_DEPTH * (1.0 - through) / max(through * extinction, vec3<f32>(1e-30));
    return max(min(min(reach.r, reach.g), reach.b), 0.0);
}

// Of a corner between texels of a target of this size. Nothing is cut off at its edge, which would be slow.
fn sky_texel_position(texel: vec2<u32>, size: vec2<f32>) -> vec4<f32> {
    return full_screen_position(min(vec2<f32>(texel) / size, vec2<f32>(1.0)));
}

// Depth of the datum where a pixel sees it, `through` (view_ray) its middle: with v·v = A, v·c = B and C = c² − R² = h (2R + h) for the centre c,
// 1/z = (B + √(B² − A C)) / C. Where no datum is, that of the horizon's nearest point, or 0.
fn sky_datum_depth(frame: Frame, body: Body, through: vec3<f32>) -> f32 {
    let near = -(body.centre.w + body.up.w) * dot(body.up.xyz, through);
    let apart = body.up.w * (2.0 * body.centre.w + body.up.w);
    let rest = near * near - dot(through, through) * apart;
    return select(0.0, min(frame.right.w * (near + sqrt(max(rest, 0.0))) / max(apart, 1e-3), 1.0), near > 0.0 && apart > 0.0);
}

// A ray: radiance, and the stored depth of its surface less the datum's; transmittance, and 1 where the texel can be used for sky, 2 for a surface.
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
    r0: vec4<f32>,
    rx: vec4<f32>,
    ry: vec4<f32>,
    rxy: vec4<f32>,
    bend_x: vec4<f32>,
    bend_xy: vec4<f32>,  // rise of that with y
    bend_y: vec4<f32>,
    bend_yx: vec4<f32>,
    t0: vec3<f32>,
    tx: vec3<f32>,
    ty: vec3<f32>,
    txy: vec3<f32>,
    t_bend_x: vec3<f32>,
    t_bend_y: vec3<f32>,
    reach: f32,          // how far a pixel's depth may lie from the cell's, over the square of it; negative: no surface
}

// Of a cell what is linear in x and y, so that it can be interpolated: value = base + y·rise − x (1 − x) bend_x − y (1 − y) bend_y. Nothing is flat:
// then a processor that stands in for a GPU fills rectangles and not triangles.
struct SkyPlane {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(linear) base: vec4<f32>,
    @location(1) @interpolate(linear) rise: vec4<f32>,
    @location(2) @interpolate(linear) bend_x: vec4<f32>,
    @location(3) @interpolate(linear) bend_y: vec4<f32>,
    @location(4) @interpolate(linear) t_base: vec4<f32>,    // a: the cell's reach
    @location(5) @interpolate(linear) t_rise: vec4<f32>,    // a: x
    @location(6) @interpolate(linear) t_bend_x: vec4<f32>,  // a: y
    @location(7) @interpolate(linear) t_bend_y: vec4<f32>,
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

// Corners a, b in the upper row, c, d in the lower; sides a–b, c–d, a–c, b–d. A surface at depth z is c/z away, for the `scale` c at the cell.
fn sky_cell(
    a: SkyTexel, b: SkyTexel, c: SkyTexel, d: SkyTexel, upper: SkySide, lower: SkySide, left: SkySide, right: SkySide,
    extinction: vec3<f32>, scale: f32,
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
    cell.t0 = a.transmittance.rgb;
    cell.tx = (b.transmittance - a.transmittance).rgb;
    cell.ty = (c.transmittance - a.transmittance).rgb;
    cell.txy = (a.transmittance - b.transmittance - c.transmittance + d.transmittance).rgb;
    cell.t_bend_x = 0.5 * (upper.transmittance + lower.transmittance);
    cell.t_bend_y = 0.5 * (left.transmittance + right.transmittance);
    let clearest = max(max(a.transmittance, b.transmittance), max(c.transmittance, d.transmittance)).rgb;
    cell.reach = select(-1.0, sky_reach(extinction, clearest) / scale, a.transmittance.a > 1.5);
    return cell;
}

fn sky_plane(cell: SkyCell, at: vec2<f32>) -> SkyPlane {
    return SkyPlane(
        vec4<f32>(0.0, 0.0, 0.0, 1.0),
        cell.r0 + at.x * cell.rx, cell.ry + at.x * cell.rxy, cell.bend_x + at.y * cell.bend_xy, cell.bend_y + at.x * cell.bend_yx,
        vec4<f32>(cell.t0 + at.x * cell.tx, cell.reach), vec4<f32>(cell.ty + at.x * cell.txy, at.x),
        vec4<f32>(cell.t_bend_x, at.y), vec4<f32>(cell.t_bend_y, 0.0));
}

// Light, and in a the depth of the surface less the datum's.
fn sky_plane_radiance(plane: SkyPlane) -> vec4<f32> {
    let at = vec2<f32>(plane.t_rise.a, plane.t_bend_x.a);
    return plane.base + at.y * plane.rise - (at.x - at.x * at.x) * plane.bend_x - (at.y - at.y * at.y) * plane.bend_y;
}
fn sky_plane_transmittance(plane: SkyPlane) -> vec3<f32> {
    let at = vec2<f32>(plane.t_rise.a, plane.t_bend_x.a);
    return (plane.t_base + at.y * plane.t_rise - (at.x - at.x * at.x) * plane.t_bend_x - (at.y - at.y * at.y) * plane.t_bend_y).rgb;
}
// Whether a pixel of this depth sees the surface that a cell has there, or none as the cell. `thought`: the cell's depth.
fn sky_plane_fits(plane: SkyPlane, thought: f32, depth: f32) -> bool {
    let alike = abs(thought - depth) <= depth * (plane.t_base.a * depth + SKY_DEPTH_ROUNDING);
    return (depth > 0.0) == (plane.t_base.a >= 0.0) && (alike || depth <= 0.0);
}
