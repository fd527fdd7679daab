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
    @location(0) radiance: vec4<f32>,       // pre-exposed; a: depth of the surface seen, from where the air begins, times SKY_DEPTH_SCALE
    @location(1) transmittance: vec4<f32>,  // a: 1 where one ray stands for the pixel, else 0; 0 where no ray was asked for
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

fn surface_of(view: SkyView, own_depth: f32) -> vec2<f32> {
    let body = bodies.list[sky.ids.x];
    return sky_surface(body, airs.list[u32(body.ids.z)], view, own_depth);
}

const X: vec2<i32> = vec2<i32>(1, 0);
const Y: vec2<i32> = vec2<i32>(0, 1);

// First and last texel of a level of every `rate`-th pixel that the air asks for; the last stands at its last pixel or beyond.
fn level_bounds(rate: u32) -> vec4<i32> {
    let pixels = vec4<u32>(sky.settings[1]);
    return vec4<i32>(vec4<u32>(pixels.xy / rate, (pixels.zw - 1u) / rate + 1u));
}

// Depth at a pixel. Beyond the picture surfaces go on as planes do.
fn depth_at(pixel: vec2<u32>) -> f32 {
    let here = min(pixel, textureDimensions(depth) - 1u);
    let own = textureLoad(depth, here, 0);
    let back = textureLoad(depth, here - min(pixel - here, here), 0);
    let on = 2.0 * own - back;
    return select(own, on, back > 0.0 && on > 0.0);
}
fn pixel_view(pixel: vec2<u32>, own: f32) -> SkyView {
    return sky_view(frame, (vec2<f32>(pixel) + 0.5) * frame.size.zw, own);
}

@fragment
fn march_level(in: Varying) -> Level {
    let pixel = RATE * vec2<u32>(in.position.xy);
    let body = bodies.list[sky.ids.x];
    let own = depth_at(pixel);
    let view = pixel_view(pixel, own);
    // Where several rays would stand for a pixel, nobody asks for its light.
    let one = sky_rays(body, airs.list[u32(body.ids.z)], view) <= 1u;
    let light = sky_light(body, frame.star, view);
    return Level(
        vec4<f32>(to_hdr(light.radiance, exposure.pre), sky_surface(body, airs.list[u32(body.ids.z)], view, own).x),
        vec4<f32>(light.transmittance, select(0.0, 1.0, one)));
}

// A texel of this level, `like` one of them: with 1 for the transmittance's a where it can stand in one row with that.
fn texel_like(at: vec2<i32>, like: SkyTexel) -> SkyTexel {
    let bounds = level_bounds(RATE);
    var texel = texel_at(at);
    let fits = all(at >= bounds.xy) && all(at <= bounds.zw) && (texel.radiance.a > 0.0) == (like.radiance.a > 0.0);
    texel.transmittance.a *= select(0.0, 1.0, fits);
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
    return sky.settings[0].a * (behind * transmittance + radiance + SKY_UNSEEN);
}

// 1 where a cell is even, else 0: it is open.
@fragment
fn plan_level(in: Varying) -> @location(0) vec4<f32> {
    let at = vec2<i32>(in.position.xy);
    let a = texel_at(at);
    let b = texel_at(at + X);
    let c = texel_at(at + Y);
    let d = texel_at(at + X + Y);
    let grounds = vec4<bool>(a.radiance.a > 0.0, b.radiance.a > 0.0, c.radiance.a > 0.0, d.radiance.a > 0.0);
    let one = min(min(a.transmittance.a, b.transmittance.a), min(c.transmittance.a, d.transmittance.a)) > 0.999;
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
    let own = depth_at(pixel);
    let surface = surface_of(pixel_view(pixel, own), own);
    let deep = radiance.a < SKY_DEPTH_MOST && sky_near_enough(sky.settings[0].rgb, surface.y, doubt.radiance.a / max(radiance.a, 1e-6), through);
    return vec4<f32>(select(0.0, 1.0, one && lit && select(!any(grounds), deep, all(grounds))));
}

fn cell_of(cell: vec2<u32>) -> SkyCell {
    let at = vec2<i32>(cell);
    let a = texel_at(at);
    let b = texel_at(at + X);
    let c = texel_at(at + Y);
    let d = texel_at(at + X + Y);
    return sky_cell(a, b, c, d, side_from(at, X, a, b), side_from(at + Y, X, c, d), side_from(at, Y, a, c), side_from(at + X, Y, b, d));
}

struct Taken {
    colour: vec4<f32>,
    fits: bool,
}
// A pixel's colour by its cell, and whether it is such as those at the cell's corners.
fn taken(cell: SkyCell, pixel: vec2<u32>) -> Taken {
    let place = vec2<f32>(pixel % RATE) / f32(RATE);
    let radiance = sky_cell_radiance(cell, place);
    let through = clamp(sky_cell_transmittance(cell, place), vec3<f32>(0.0), vec3<f32>(1.0));
    let behind = textureLoad(opaque, pixel, 0).rgb;
    let own = textureLoad(depth, pixel, 0);
    let surface = surface_of(pixel_view(pixel, own), own);
    let alike = sky_near_enough(sky.settings[0].rgb, surface.y, abs(surface.x / max(radiance.a, 1e-6) - 1.0), through);
    let grounds = cell.r0.a > 0.0;
    return Taken(vec4<f32>(to_hdr(behind * through + radiance.rgb, 1.0), 1.0), grounds == (own > 0.0) && (alike || !grounds));
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
    return Corner(bounds.xy + vec2<u32>(place % wide, place / wide), (vec2<u32>(0x1au, 0x34u) >> vec2<u32>(index % 6u)) & vec2<u32>(1u));
}
fn is_open(cell: vec2<u32>) -> bool {
    return textureLoad(first_plan, cell, 0).x < 0.5;
}
// The even cells of the first level.
@vertex
fn cell_vertex(@builtin(vertex_index) index: u32) -> SkyCell {
    let corner = cell_corner(index);
    var out = cell_of(corner.cell);
    out.position = sky_texel_position(RATE * (corner.cell + corner.place), frame.size.xy);
    if is_open(corner.cell) {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    return out;
}

@fragment
fn cell(in: SkyCell) -> @location(0) vec4<f32> {
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
    let taken = taken(cell_of(pixel / RATE), pixel);
    if !taken.fits || textureLoad(plan, pixel / RATE, 0).x < 0.5 {
        discard;
    }
    return taken.colour;
}
