// Terrain: tiles of 32 × 32 quads, displaced from heights computed once, morphing into their parents; materials and light.
// Rust side: engine/src/render/pass/terrain.rs. Air between eye and ground is laid over by pass/sky.wgsl.

#include "lib/lamps.wgsl"
#include "lib/frame.wgsl"
#include "lib/tile.wgsl"
#include "lib/ground.wgsl"
#include "lib/lambert.wgsl"
#include "lib/daylight.wgsl"
#include "lib/second_light.wgsl"
#include "lib/shadow.wgsl"
#include "lib/view_table.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> bodies: Bodies;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var<uniform> airs: Airs;
@group(1) @binding(1) var transmittance: texture_2d_array<f32>;
@group(1) @binding(3) var irradiance: texture_2d_array<f32>;
@group(1) @binding(4) var linear: sampler;
@group(1) @binding(5) var shadow_map: texture_depth_2d;
@group(1) @binding(6) var shadow_compare: sampler_comparison;
@group(1) @binding(7) var<uniform> shadow: Shadow;
@group(1) @binding(8) var media: texture_2d_array<f32>;
@group(1) @binding(9) var refracted: texture_2d_array<f32>;
@group(1) @binding(10) var sheets: texture_2d_array<f32>;
@group(1) @binding(12) var mirror_scatter: texture_3d<f32>;
@group(1) @binding(13) var<uniform> mirror: ViewTable;
@group(2) @binding(0) var albedo_map: texture_2d<f32>;
@group(2) @binding(1) var night_map: texture_2d<f32>;
@group(3) @binding(0) var<uniform> paint: Paint;
@group(3) @binding(1) var<storage, read> tiles: array<Tile>;
@group(3) @binding(2) var<storage, read> heights: array<vec2<f32>>;

const STORED: u32 = 67u;
const SIDE: u32 = 33u;
const NEAR_M: f32 = 16.0;        // PAINT_M[0]
const SEA_SLOPES: f32 = 0.034;  // mean square slope of the sea at 6 m/s [Cox & Munk 1954]: 0.003 + 0.00512 · 6

struct Tile {
    frame: TileFrame,
    centre: vec4<f32>,        // xyz: of the tile on the datum, m from the camera, body-fixed axes; w: drop of the skirt, m
    key: vec4<u32>,           // face, level, slot, 0
    morph: vec4<f32>,         // from, to, m; scale of relief; distance of samples, m
    near_cell: vec4<i32>,     // lattices of paint: cell of the tile's centre; fraction in it and edge, m
    near_fraction: vec4<f32>,
    far_cell: vec4<i32>,
    far_fraction: vec4<f32>,
}

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) point: vec3<f32>,      // m from the camera, body-fixed axes
    @location(1) offset: vec3<f32>,     // m from the tile's centre, on the datum
    @location(2) at: vec3<f32>,         // sample coordinates, morph
    @location(3) @interpolate(flat) tile: u32,
    // What derivatives are taken of comes by varyings: helper invocations may read zeros from buffers.
    @location(4) up: vec3<f32>,
    @location(5) near: vec3<f32>,       // place in the near lattice of paint, cells from its cell
    @location(6) @interpolate(flat) near_cell: vec3<i32>,
}

fn height_at(slot: u32, sample: vec2<i32>) -> vec2<f32> {
    let s = vec2<u32>(clamp(sample, vec2<i32>(-1), vec2<i32>(65)) + 1);
    return heights[slot * STORED * STORED + s.y * STORED + s.x];
}

// A vertex at a sample, from the camera in body-fixed axes, with the height of the tile's or of its parent's level.
struct Place {
    point: vec3<f32>,
    offset: vec3<f32>,
    up: vec3<f32>,
}
fn place(tile: Tile, axes: mat3x3<f32>, sample: vec2<i32>, coarse: bool) -> Place {
    let p = tile_point(tile.frame, axes, vec2<f32>(sample - 32) / 64.0);
    let h2 = height_at(tile.key.z, sample);
    var h = select(h2.x, h2.y, coarse);
    if paint.kind.y > 0u {
        h = max(h, 0.0);
    }
    let offset = p.offset * tile.frame.tangent.w;
    return Place(tile.centre.xyz + offset + p.direction * (h * tile.morph.z), offset, p.direction);
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Varying {
    let tile = tiles[instance];
    let axes = face_axes(tile.key.x);
    var grid = vec2<i32>(vec2<u32>(index % SIDE, index / SIDE));
    var drop = 0.0;
    if index >= SIDE * SIDE {
        let along = i32((index - SIDE * SIDE) % SIDE);
        let side = (index - SIDE * SIDE) / SIDE;
        let ends = array<vec2<i32>, 4>(vec2<i32>(along, 0), vec2<i32>(32, along), vec2<i32>(along, 32), vec2<i32>(0, along));
        grid = ends[side];
        drop = tile.centre.w;
    }
    let fine = place(tile, axes, grid * 2, false);
    let morph = smoothstep(tile.morph.x, tile.morph.y, length(fine.point));
    var point = fine.point;
    if morph > 0.0 {
        // The parent's mesh has every second vertex; the others lie on its edges, or on its diagonals from lower left to upper right.
        let odd = grid & vec2<i32>(1);
        let a = place(tile, axes, (grid - odd) * 2, true);
        let b = place(tile, axes, (grid + odd) * 2, true);
        point = mix(fine.point, 0.5 * (a.point + b.point), morph);
    }
    let body = bodies.list[paint.kind.z];
    var out: Varying;
    out.point = point - fine.up * drop;
    out.offset = fine.offset;
    out.at = vec3<f32>(vec2<f32>(grid * 2), morph);
    out.tile = instance;
    out.up = fine.up;
    out.near = tile.near_fraction.xyz + fine.offset / tile.near_fraction.w;
    out.near_cell = tile.near_cell.xyz;
    let icrf = body.fixed_x.xyz * out.point.x + body.fixed_y.xyz * out.point.y + body.fixed_z.xyz * out.point.z;
    out.position = frame.clip_from_icrf * vec4<f32>(icrf, 1.0);
    return out;
}

// Height and its slope by `at` (samples), bilinear between samples of height and of central differences.
fn height_and_slope(slot: u32, at: vec2<f32>, morph: f32) -> vec3<f32> {
    let cell = clamp(vec2<i32>(floor(at)), vec2<i32>(0), vec2<i32>(63));
    let t = at - vec2<f32>(cell);
    let weights = vec4<f32>((1.0 - t.x) * (1.0 - t.y), t.x * (1.0 - t.y), (1.0 - t.x) * t.y, t.x * t.y);
    var out = vec3<f32>(0.0);
    for (var k = 0; k < 4; k++) {
        let s = cell + vec2<i32>(k & 1, k >> 1u);
        let h = height_at(slot, s);
        let dx = height_at(slot, s + vec2<i32>(1, 0)) - height_at(slot, s - vec2<i32>(1, 0));
        let dy = height_at(slot, s + vec2<i32>(0, 1)) - height_at(slot, s - vec2<i32>(0, 1));
        out += weights[k] * vec3<f32>(mix(h.x, h.y, morph), 0.5 * mix(dx.x, dx.y, morph), 0.5 * mix(dy.x, dy.y, morph));
    }
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let tile = tiles[in.tile];
    let body = bodies.list[paint.kind.z];
    let axes = face_axes(tile.key.x);
    let distance = max(length(in.point), 0.01);
    let view = -in.point / distance;
    let up = normalize(in.up);
    let field = height_and_slope(tile.key.z, in.at.xy, in.at.z);
    let height = field.x;
    let wet = paint.kind.y > 0u && height < 0.0;

    // Normal from the heights: the gradient g with g·t_u = h_u, g·t_v = h_v in the tangent plane.
    let tangents = tile_tangents(tile.frame, axes, up);
    let tu = tangents[0] * (tile.frame.tangent.w / 64.0);
    let tv = tangents[1] * (tile.frame.tangent.w / 64.0);
    let gradient = (field.y * cross(tv, up) + field.z * cross(up, tu)) / max(dot(up, cross(tu, tv)), 1e-20);
    var normal = up;
    if !wet {
        normal = normalize(up - gradient * tile.morph.z);
    }

    // Paint: waves from 4 km down to 6 cm, as far as a pixel shows them; the short ones also tilt the normal.
    let footprint = distance * frame.up.w / max(dot(view, up), 0.15);
    let qf = tile.far_fraction.xyz + in.offset / tile.far_fraction.w;
    let coarse = paint_wave(tile.far_cell.xyz, qf, 0u, tile.far_fraction.w, footprint)
        + 0.7 * paint_wave(tile.far_cell.xyz, qf, 2u, tile.far_fraction.w, footprint)
        + 0.5 * paint_wave(tile.far_cell.xyz, qf, 4u, tile.far_fraction.w, footprint);
    let w0 = paint_wave(in.near_cell, in.near, 0u, NEAR_M, footprint);
    let w2 = paint_wave(in.near_cell, in.near, 2u, NEAR_M, footprint);
    let w4 = paint_wave(in.near_cell, in.near, 4u, NEAR_M, footprint);
    let w6 = paint_wave(in.near_cell, in.near, 6u, NEAR_M, footprint);
    let w8 = paint_wave(in.near_cell, in.near, 8u, NEAR_M, footprint);
    let fine = w0 + 0.7 * w2 + 0.6 * w4 + 0.5 * w6 + 0.4 * w8;
    let bumps = 0.16 * w2 + 0.055 * w4 + 0.018 * w6 + 0.0045 * w8;
    let dpx = dpdx(in.point);
    let dpy = dpdy(in.point);
    let r1 = cross(dpy, normal);
    let r2 = cross(normal, dpx);
    let det = dot(dpx, r1);
    let tilt = sign(det) * (dpdx(bumps) * r1 + dpdy(bumps) * r2) / max(abs(det), 1e-12);
    if !wet && footprint < 2.0 {
        normal = normalize(normal - clamp(tilt, vec3<f32>(-0.6), vec3<f32>(0.6)));
    }

    let latitude = atan2(up.z, length(up.xy));
    let uv = vec2<f32>(atan2(up.y, up.x) / 6.28318530718 + 0.5, 0.5 - latitude / 3.14159265359);
    let texel = 6.28318530718 * tile.frame.tangent.w / f32(textureDimensions(albedo_map).x);
    let lod = log2(max(distance * frame.up.w / max(dot(view, up), 0.3) / texel, 1e-6));
    // Not the anisotropic sampler of the maps: with an explicit level, software drivers take hundreds of taps for it.
    let mapped = textureSampleLevel(albedo_map, linear, uv, max(lod, 0.0)).rgb;
    let night = lamps(textureSampleLevel(night_map, linear, uv, max(lod, 0.0)).rgb);
    let tint = select(ground_albedo(body, airs.list[u32(max(body.ids.z, 0))]), mapped, paint.kind.w > 0u);
    let slope = length(gradient);
    let near = 1.0 - smoothstep(2.0e4, 4.0e5, distance);

    let icrf = body.fixed_x.xyz * in.point.x + body.fixed_y.xyz * in.point.y + body.fixed_z.xyz * in.point.z;
    var m = Material(tint * (1.0 + 0.16 * coarse + 0.20 * fine), 1.0);
    if paint.kind.x == 2u {
        m = living_ground(tint, height, slope, latitude, coarse, fine, near);
    } else if paint.kind.x == 1u {
        m.albedo *= mix(paint.province.z, 1.0, paint_province(paint, up));
    }
    var luminance = vec3<f32>(0.0);
    for (var k = 0u; k < light_count(body); k++) {
        let by = in_light(body, k);
        let sun = fixed_from_icrf(body, by.sun.xyz);
        let mu_s = dot(sun, up);
        let light = daylight(by, frame.star, icrf, airs.list[u32(max(body.ids.z, 0))], transmittance, irradiance, refracted, sheets, linear);
        var direct = by.illuminance.rgb * light.sun;
        var sky = by.illuminance.rgb * light.sky;
        if k == 0u {
            direct *= ship_shadow(shadow, shadow_map, shadow_compare, icrf, body.sun.w);
            sky += STARLIGHT_LX;
        }
        if wet {
            // The sea: light from below by depth, the sky's mirror image, the glint.
            let shallow = exp(min(height, 0.0) / 9.0) * near;
            let below = mix(vec3<f32>(0.0035, 0.012, 0.026), vec3<f32>(0.05, 0.12, 0.11), shallow * 0.7);
            let foam = shallow * near * smoothstep(0.25, 0.6, w0 + 0.6 * w2 + 0.4) * smoothstep(-0.6, 0.0, height) * near;
            let fresnel = water_fresnel(max(dot(up, view), 0.0) * 0.9 + 0.08);
            var mirrored = sky / PI;
            var share = fresnel;
            if mirror.ids.x == body.ids.x {
                let air = airs.list[u32(max(body.ids.z, 0))];
                mirrored = by.illuminance.rgb * eclipse_visible(by, frame.star, icrf)
                    * view_mirrored(air, media, body.ids.z, mirror, mirror_scatter, linear, up, view, sun);
                share = 1.0 - max(dot(up, view), 0.0);  // [Elek 2008, eq. 3.8]
            }
            luminance += mix(below, vec3<f32>(0.6), foam) / PI * (direct * max(mu_s, 0.0) + sky) * (1.0 - share)
                + mirrored * share
                + direct * water_glint(up, view, sun, SEA_SLOPES) * (1.0 - foam);
        } else {
            var lit = sun_cosine(dot(normal, sun), by.sun.w);
            if paint.kind.x == 1u {
                lit = regolith_response(lit, max(dot(normal, view), 0.0), dot(sun, view)) * step(1e-6, lit);
            }
            // Hollows see less of the sky: half-way between open ground and the slope's own share.
            luminance += max(m.albedo, vec3<f32>(0.0)) / PI * (direct * lit + sky * (0.5 + 0.5 * dot(normal, up)));
        }
    }
    if !wet {
        luminance += night * (1.0 - smoothstep(-0.1, 0.05, dot(fixed_from_icrf(body, body.sun.xyz), up)));
    }
    return vec4<f32>(to_hdr(luminance, exposure.pre), 1.0);
}
