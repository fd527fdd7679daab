// Tone mapping: smoothed edges, exposure, a filmic curve, sRGB, dithering. Rust side: engine/src/render/pass/tonemap.rs.

#include "lib/frame.wgsl"
#include "lib/color.wgsl"

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var lit: texture_2d<f32>;
@group(1) @binding(1) var<uniform> wanted: Exposure;
@group(1) @binding(2) var glare: texture_2d<f32>;
@group(1) @binding(3) var linear: sampler;
@group(1) @binding(4) var depth: texture_depth_2d;

// 1 where the target keeps what it is given (we encode), 0 where it encodes itself.
override encode: f32 = 1.0;
// Share of the light that the glare takes.
override glare_share: f32 = 0.0;

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varying {
    var out: Varying;
    out.uv = full_screen_uv(index);
    out.position = full_screen_position(out.uv);
    return out;
}

// AgX in its minimal form [Troy Sobotka; fit by Benjamin Wrensch 2023]: inset to a wider gamut, log2 over 16.5 stops, a sigmoid, outset.
fn agx(linear: vec3<f32>) -> vec3<f32> {
    let inset = mat3x3<f32>(
        vec3<f32>(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
        vec3<f32>(0.0784335999999992, 0.878468636469772, 0.0784336),
        vec3<f32>(0.0792237451477643, 0.0791661274605434, 0.879142973793104));
    let outset = mat3x3<f32>(
        vec3<f32>(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
        vec3<f32>(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
        vec3<f32>(-0.0990297440797205, -0.0989611768448433, 1.15107367264116));
    let lowest = -12.47393;
    let highest = 4.026069;
    let v = inset * linear;
    let x = (clamp(log2(max(v, vec3<f32>(1e-10))), vec3<f32>(lowest), vec3<f32>(highest)) - lowest) / (highest - lowest);
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    // A little more contrast and colour than the neutral look (its "punchy" half way).
    let y = luminance_of(curve);
    let graded = pow(max(vec3<f32>(y) + 1.2 * (curve - vec3<f32>(y)), vec3<f32>(0.0)), vec3<f32>(1.15));
    // The curve's output is display-encoded (power 2.2).
    return pow(max(outset * graded, vec3<f32>(0.0)), vec3<f32>(2.2));
}

// Interleaved gradient noise [Jimenez 2014], 0…1.
fn noise(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715))));
}

// Roughly how bright a pixel will look, 0…1.
fn shown(c: vec3<f32>, gain: f32) -> f32 {
    let y = luminance_of(c) * gain;
    return sqrt(y / (1.0 + y));
}

// Averages are taken of tone-mapped light, or a single bright pixel would win [Karis 2014].
fn tone_mix(a: vec3<f32>, b: vec3<f32>, share: f32, gain: f32) -> vec3<f32> {
    let wa = (1.0 - share) / (1.0 + luminance_of(a) * gain);
    let wb = share / (1.0 + luminance_of(b) * gain);
    return (a * wa + b * wb) / (wa + wb);
}

// How much a pixel takes of the one beside it, across an edge that is nearly level or upright and so goes in long steps: a horizon.
struct Stepped {
    beside: vec2<i32>,
    share: f32,
}
// Looks along the edge for both ends of the step [Lottes 2009, "FXAA", edge search]: at a step's end the line passes half-way between two rows.
fn stepped_edge(pixel: vec2<i32>, centre: f32, lumas: vec4<f32>, gain: f32) -> Stepped {
    let level = abs(lumas.x + lumas.y - 2.0 * centre) >= abs(lumas.z + lumas.w - 2.0 * centre);
    let two = select(lumas.zw, lumas.xy, level);
    let before = abs(two.x - centre) >= abs(two.y - centre);
    let other = select(two.y, two.x, before);
    let across = select(vec2<i32>(1, 0), vec2<i32>(0, 1), level) * select(1, -1, before);
    let along = select(vec2<i32>(0, 1), vec2<i32>(1, 0), level);
    let mean = 0.5 * (centre + other);
    let enough = 0.25 * abs(other - centre);
    var ends = vec2<f32>(0.0);
    var past = vec2<f32>(0.0);
    for (var side = 0; side < 2; side++) {
        var reach = 0;
        var off = 0.0;
        for (var k = 0; k < 16 && abs(off) < enough; k++) {
            reach += 1 << u32(max(k - 4, 0) / 4);
            let at = pixel + along * select(reach, -reach, side == 0);
            off = 0.5 * (seen(at, gain) + seen(at + across, gain)) - mean;
        }
        ends[side] = f32(reach);
        past[side] = off;
    }
    let nearest = select(past.y, past.x, ends.x < ends.y);
    let own = (nearest < 0.0) != (centre < mean);
    let share = 0.5 - min(ends.x, ends.y) / (ends.x + ends.y);
    return Stepped(pixel + across, select(0.0, share, own));
}
fn seen(pixel: vec2<i32>, gain: f32) -> f32 {
    return shown(textureLoad(lit, clamp(pixel, vec2<i32>(0), vec2<i32>(textureDimensions(lit)) - 1), 0).rgb, gain);
}

// Edges of solid things, smoothed along their direction [after Lottes 2009, "FXAA"]; stars and sky gradients are left alone.
fn smoothed(pixel: vec2<i32>, gain: f32) -> vec3<f32> {
    let middle = textureLoad(lit, pixel, 0).rgb;
    let last = vec2<i32>(textureDimensions(lit)) - 1;
    let n = clamp(pixel - vec2<i32>(0, 1), vec2<i32>(0), last);
    let s = clamp(pixel + vec2<i32>(0, 1), vec2<i32>(0), last);
    let w = clamp(pixel - vec2<i32>(1, 0), vec2<i32>(0), last);
    let e = clamp(pixel + vec2<i32>(1, 0), vec2<i32>(0), last);
    let solid = max(max(textureLoad(depth, n, 0), textureLoad(depth, s, 0)), max(textureLoad(depth, w, 0), textureLoad(depth, e, 0)));
    if solid <= 0.0 {
        return middle;
    }
    let north = shown(textureLoad(lit, n, 0).rgb, gain);
    let south = shown(textureLoad(lit, s, 0).rgb, gain);
    let west = shown(textureLoad(lit, w, 0).rgb, gain);
    let east = shown(textureLoad(lit, e, 0).rgb, gain);
    let centre = shown(middle, gain);
    let lowest = min(centre, min(min(north, south), min(west, east)));
    let highest = max(centre, max(max(north, south), max(west, east)));
    let contrast = highest - lowest;
    if contrast < max(0.06, 0.15 * highest) {
        return middle;
    }
    let lumas = vec4<f32>(north, south, west, east);
    let stepped = stepped_edge(pixel, centre, lumas, gain);
    if stepped.share > 0.0 {
        return tone_mix(middle, textureLoad(lit, clamp(stepped.beside, vec2<i32>(0), last), 0).rgb, stepped.share, gain);
    }
    // Along the edge: across the gradient.
    let gradient = vec2<f32>(east - west, south - north);
    let along = vec2<f32>(-gradient.y, gradient.x) / max(abs(gradient.x) + abs(gradient.y), 1e-4);
    // Blend towards the mean of the four by how far the centre stands out, and along the edge by how clear it is.
    let texel = 1.0 / vec2<f32>(textureDimensions(lit));
    let uv = (vec2<f32>(pixel) + 0.5) * texel;
    let a = textureSampleLevel(lit, linear, uv + along * texel * 0.75, 0.0).rgb;
    let b = textureSampleLevel(lit, linear, uv - along * texel * 0.75, 0.0).rgb;
    return tone_mix(middle, tone_mix(a, b, 0.5, gain), 2.0 / 3.0, gain);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    // The meter puts the mean at 1 / 9.6, the curve has its middle grey at 0.18.
    let gain = wanted.final_ / exposure.pre * 9.6 * 0.18;
    let sharp = smoothed(vec2<i32>(in.position.xy), gain);
    let spread = textureSampleLevel(glare, linear, in.uv, 0.0).rgb;
    let hdr = mix(sharp, spread, glare_share) * gain;
    let shift = f32(frame.counts.y % 64u) * 5.588238;
    let dither = noise(in.position.xy + shift) - 0.5;
    let encoded = srgb_encode(agx(hdr)) + dither / 255.0;
    if encode > 0.5 {
        return vec4<f32>(encoded, 1.0);
    }
    return vec4<f32>(srgb_decode(max(encoded, vec3<f32>(0.0))), 1.0);
}
