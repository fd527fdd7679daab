// The sky by the model `physical`, for a picture and for given rays. Rust side: engine/src/render/pass/sky/physical.rs.
//
// `fragment` (of pass/sky.wgsl) marches at every pixel. Else there are two levels, of every eighth pixel of every eighth row and of every second: rays at
// texels, and between four of them a cell. `march_level` marches, `plan_level` tells which cells are even enough to be drawn by cubic interpolation;
// the second level has rays and cells only where a cell of the first is open: `open_vertex`. Then `cell` draws the even cells of the first, `take` those
// of the second, and `rest` marches at the pixels that are left, which the stencil tells: a processor that stands in for a GPU takes both sides of a
// branch, but shades no pixel that triangles or the stencil leave out.

#include "pass/sky.wgsl"
#include "lib/physical.wgsl"
#include "lib/second_light.wgsl"
#include "lib/sky_cell.wgsl"

@group(3) @binding(0) var level_radiance: texture_2d<f32>;
@group(3) @binding(1) var level_transmittance: texture_2d<f32>;
@group(3) @binding(2) var plan: texture_2d<f32>;
@group(3) @binding(3) var first_plan: texture_2d<f32>;

// Pixels from one texel of the level to the next, and of the first level.
override RATE: u32 = 2u;
override FIRST_RATE: u32 = 8u;
// Pixels from one texel of what is drawn into to the next; texels of it by which open cells reach over the next that is not open.
override INTO: u32 = 1u;
override MARGIN: u32 = 0u;

struct Level {
    @location(0) radiance: vec4<f32>,       // pre-exposed; a: depth of the surface seen, less the datum's
    @location(1) transmittance: vec4<f32>,  // a: where one ray stands for the pixel 1, or 2 if it meets a surface; else, and where no ray was asked for, 0
}

// By the air's own medium, or by its two band media; in the star's light and the second one.
fn sky_light(body: Body, star: vec4<f32>, view: SkyView) -> AirLight {
    let air = airs.list[u32(body.ids.z)];
    var luminance = vec3<f32>(0.0);
    var through = vec3<f32>(0.0);
    let first = u32(max(body.lights.w, 0));
    var l = first;
    // Loops ask at their ends: see lib/air_march.wgsl.
    loop {
        var by = in_light(body, l);
        var radiance = vec3<f32>(0.0);
        var k = 0u;
        loop {
            by.ids.z = i32(air.bands[3u * k].w);
            let light = physical_light(by, airs.list[u32(by.ids.z)], media, transmittance, orders, linear, star, sheets, sky, view);
            radiance += air_to_rgb(air, k) * light.radiance;
            through += air_to_rgb(air, k) * light.transmittance * select(0.0, 1.0, l == first);
            k++;
            if k >= u32(air.bands[1].w) {
                break;
            }
        }
        luminance += max(radiance, vec3<f32>(0.0)) * by.illuminance.rgb;
        l++;
        if l >= light_count(body) {
            break;
        }
    }
    return AirLight(luminance, clamp(through, vec3<f32>(0.0), vec3<f32>(1.0)));
}

const X: vec2<i32> = vec2<i32>(1, 0);
const Y: vec2<i32> = vec2<i32>(0, 1);

// First and last texel of a level of every `rate`-th pixel that the air asks for; the last stands at its last pixel or beyond.
fn level_bounds(rate: u32) -> vec4<i32> {
    let pixels = vec4<u32>(sky.settings[1]);
    return vec4<i32>(vec4<u32>(pixels.xy / rate, (pixels.zw - 1u) / rate + 1u));
}

fn uv_of(pixel: vec2<u32>) -> vec2<f32> {
    return (vec2<f32>(pixel) + 0.5) * frame.size.zw;
}
// Distance times depth of what stands at a pixel, m.
fn depth_scale(pixel: vec2<u32>) -> f32 {
    return axis_distance(frame, 1.0) * length(view_ray(frame, uv_of(pixel)));
}

fn datum_depth(pixel: vec2<u32>) -> f32 {
    return sky_datum_depth(frame, bodies.list[sky.ids.x], view_ray(frame, uv_of(pixel)));
}
// Depth of the surface at a pixel less the datum's there, and that itself: 0 where none is. Beyond the picture surfaces go on evenly.
fn relief_at(pixel: vec2<u32>) -> vec2<f32> {
    let here = min(pixel, textureDimensions(depth) - 1u);
    let back = here - min(pixel - here, here);
    let own = vec2<f32>(textureLoad(depth, here, 0), textureLoad(depth, back, 0));
    let relief = own - vec2<f32>(datum_depth(here), datum_depth(back));
    let datum = datum_depth(pixel);
    let on = select(relief.x, 2.0 * relief.x - relief.y, own.y > 0.0);
    return vec2<f32>(on, select(0.0, max(datum + on, 1e-30), own.x > 0.0));
}

@fragment
fn march_level(in: Varying) -> Level {
    let pixel = RATE * vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let surface = relief_at(pixel);
    let view = sky_view(frame, uv_of(pixel), surface.y);
    // Where several rays would stand for a pixel, nobody asks for its light.
    let one = sky_alone(sky_spread(frame, body, airs.list[u32(body.ids.z)], view));
    let light = sky_light(body, frame.star, view);
    return Level(
        vec4<f32>(to_hdr(light.radiance, exposure.pre), surface.x),
        vec4<f32>(light.transmittance, select(0.0, select(1.0, 2.0, surface.y > 0.0), one)));
}

// A texel of this level, `like` one of them: with 1 for the transmittance's a where it can stand in one row with that.
fn texel_like(at: vec2<i32>, like: SkyTexel) -> SkyTexel {
    let bounds = level_bounds(RATE);
    var texel = texel_at(at);
    let fits = all(at >= bounds.xy) && all(at <= bounds.zw) && texel.transmittance.a == like.transmittance.a;
    texel.transmittance.a = select(0.0, 1.0, fits);
    return texel;
}
fn texel_at(at: vec2<i32>) -> SkyTexel {
    return SkyTexel(textureLoad(level_radiance, at, 0), textureLoad(level_transmittance, at, 0));
}

// The way from one corner of a cell to the next.
fn side_from(at: vec2<i32>, along: vec2<i32>, a: SkyTexel, b: SkyTexel) -> SkySide {
    return sky_side(texel_like(at - along, a), a, b, texel_like(at + 2 * along, a));
}
fn doubt_from(at: vec2<i32>, along: vec2<i32>, a: SkyTexel, b: SkyTexel) -> SkyDoubt {
    return sky_doubt(
        texel_like(at - 2 * along, a), texel_like(at - along, a), a, b, texel_like(at + 2 * along, a), texel_like(at + 3 * along, a));
}

fn behind_at(pixel: vec2<u32>) -> vec3<f32> {
    return textureLoad(opaque, min(pixel, textureDimensions(opaque) - 1u), 0).rgb;
}

fn bearable(behind: vec3<f32>, radiance: vec3<f32>, transmittance: vec3<f32>) -> vec3<f32> {
    return sky.settings[0].a * (behind * transmittance + radiance + sky.settings[2].x);
}

// 1 where a cell is even, else 0: it is open.
@fragment
fn plan_level(in: Varying) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let a = texel_at(at);
    let b = texel_at(at + X);
    let c = texel_at(at + Y);
    let d = texel_at(at + X + Y);
    let kinds = vec4<f32>(a.transmittance.a, b.transmittance.a, c.transmittance.a, d.transmittance.a);
    let alike = a.transmittance.a > 0.5 && all(kinds == kinds.xxxx);
    let doubt = sky_doubts(
        sky_doubts_more(doubt_from(at, X, a, b), doubt_from(at + Y, X, c, d)),
        sky_doubts_more(doubt_from(at, Y, a, c), doubt_from(at + X, Y, b, d)));
    let radiance = 0.25 * (a.radiance + b.radiance + c.radiance + d.radiance);
    let through = 0.25 * (a.transmittance + b.transmittance + c.transmittance + d.transmittance).rgb;
    let pixel = RATE * vec2<u32>(at);
    let behind = max(
        max(max(behind_at(pixel), behind_at(pixel + vec2<u32>(RATE, 0u))), max(behind_at(pixel + vec2<u32>(0u, RATE)), behind_at(pixel + RATE))),
        behind_at(pixel + RATE / 2u));
    // Stars and the sun's disc stand between the pixels that are asked for what is behind: all transmittances are right to some degree.
    let lit = all(doubt.transmittance <= 4.0 * sky.settings[0].a * (through + 0.05))
        && all(doubt.radiance.rgb <= bearable(vec3<f32>(0.0), radiance.rgb, through))
        && all(doubt.radiance.rgb + behind * doubt.transmittance <= bearable(behind, radiance.rgb, through));
    let own = radiance.a + datum_depth(pixel + RATE / 2u);
    let deep = 0.2 * doubt.radiance.a * depth_scale(pixel) <= own * own * sky_reach(sky.settings[0].rgb, through);
    return vec4<f32>(select(0.0, 1.0, alike && lit && (deep || kinds.x < 1.5)));
}

fn cell_of(cell: vec2<u32>) -> SkyCell {
    let at = vec2<i32>(cell);
    let a = texel_at(at);
    let b = texel_at(at + X);
    let c = texel_at(at + Y);
    let d = texel_at(at + X + Y);
    return sky_cell(a, b, c, d, side_from(at, X, a, b), side_from(at + Y, X, c, d), side_from(at, Y, a, c), side_from(at + X, Y, b, d),
        sky.settings[0].rgb, depth_scale(RATE * cell));
}

struct Taken {
    colour: vec4<f32>,
    fits: bool,
}
// A pixel's colour by its cell, and whether it is such as those at the cell's corners.
fn taken(plane: SkyPlane, pixel: vec2<u32>) -> Taken {
    let radiance = sky_plane_radiance(plane);
    let through = clamp(sky_plane_transmittance(plane), vec3<f32>(0.0), vec3<f32>(1.0));
    let behind = textureLoad(opaque, pixel, 0).rgb;
    let own = textureLoad(depth, pixel, 0);
    return Taken(vec4<f32>(to_hdr(behind * through + radiance.rgb, 1.0), 1.0), sky_plane_fits(plane, radiance.a + datum_depth(pixel), own));
}

struct Corner {
    cell: vec2<u32>,   // of the first level
    place: vec2<u32>,  // 0 or 1 each way
}
// Six corners of two triangles for each cell of the first level.
fn cell_corner(index: u32) -> Corner {
    let bounds = vec4<u32>(level_bounds(FIRST_RATE));
    let place = index / 6u;
    let wide = bounds.z - bounds.x;
    return Corner(bounds.xy + vec2<u32>(place % wide, place / wide), (vec2<u32>(0x34u, 0x16u) >> vec2<u32>(index % 6u)) & vec2<u32>(1u));
}
fn is_open(cell: vec2<u32>) -> bool {
    return textureLoad(first_plan, cell, 0).x < 0.5;
}
// The even cells of the first level.
@vertex
fn cell_vertex(@builtin(vertex_index) index: u32) -> SkyPlane {
    let corner = cell_corner(index);
    let end = min(vec2<f32>(RATE * (corner.cell + corner.place)), frame.size.xy);
    // Pixels are asked in their middle.
    var out = sky_plane(cell_of(corner.cell), (end - 0.5) / f32(RATE) - vec2<f32>(corner.cell));
    out.position = select(full_screen_position(end / frame.size.xy), vec4<f32>(0.0, 0.0, 0.0, 1.0), is_open(corner.cell));
    return out;
}

@fragment
fn cell(in: SkyPlane) -> @location(0) vec4<f32> {
    let taken = taken(in, vec2<u32>(in.position.xy));
    if !taken.fits {
        discard;
    }
    return taken.colour;
}

// Its open cells, in a level or in the picture.
@vertex
fn open_vertex(@builtin(vertex_index) index: u32) -> Varying {
    let corner = cell_corner(index);
    let last = vec2<u32>(level_bounds(FIRST_RATE).zw) - 1u;
    let more = vec2<u32>(
        select(MARGIN, 0u, corner.cell.x < last.x && is_open(corner.cell + vec2<u32>(1u, 0u))),
        select(MARGIN, 0u, corner.cell.y < last.y && is_open(corner.cell + vec2<u32>(0u, 1u))));
    let texel = (corner.cell + corner.place) * (FIRST_RATE / INTO) + more * corner.place;
    let size = select(ceil(frame.size.xy / f32(INTO)) + 1.0, frame.size.xy, INTO == 1u);
    let open = is_open(corner.cell);
    return Varying(select(vec4<f32>(0.0, 0.0, 0.0, 1.0), sky_texel_position(texel, size), open), vec2<f32>(0.0));
}

// What lies in the even cells of the second level.
@fragment
fn take(in: Varying) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(in.position.xy);
    let taken = taken(sky_plane(cell_of(pixel / RATE), vec2<f32>(pixel % RATE) / f32(RATE)), pixel);
    if !taken.fits || textureLoad(plan, pixel / RATE, 0).x < 0.5 {
        discard;
    }
    return taken.colour;
}
