// Height of the ground: the terms of engine/src/terrain/relief.rs and crater.rs in f32, held together by tests/tests/height_twin.rs.
// The loops over octaves are in pass/tile_heights.wgsl, which owns the buffers.

#include "lib/noise.wgsl"

const ROUGH_SLOPE: f32 = 0.045;
const ROUGH_HEIGHT_M: f32 = 6000.0;
const RAMP_M: f32 = 8000.0;
const SOFT_M: f32 = 20.0;
const WOBBLE_M: f32 = 1500.0;
const VALLEY: f32 = 1.6;
const SLAB: f32 = 0.3;
const SLAB_FADE: f32 = 0.2;
const RADIUS_MIN: f32 = 0.11;
const RADIUS_MAX: f32 = 0.25;
const BLANKET: f32 = 1.6;

fn smooth_between(low: f32, high: f32, x: f32) -> f32 {
    let t = clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Gradient noise, or its ridge, or between.
fn shaped(n: f32, ridged: f32) -> f32 {
    return n + ridged * (0.5 - 2.0 * abs(n) - n);
}

// Weight of the next octave from the sum so far.
fn octave_weight(sum: f32) -> f32 {
    return clamp(0.5 + sum, 0.2, 1.2);
}

// Height on either side of the coast at signed distance s.
fn shore(z: f32, s: f32) -> f32 {
    let root = sqrt(z * z + SOFT_M * SOFT_M);
    let t = min(abs(s) / RAMP_M, 1.0);
    let ramp = t * (2.0 - t);
    let small = 0.5 * SOFT_M * SOFT_M / (root + abs(z));
    let large = 0.5 * (root + abs(z));
    if s > 0.0 {
        return ramp * select(small, large, z > 0.0);
    }
    return -ramp * select(large, small, z > 0.0);
}

fn crater_profile(t: f32, flat_floor: f32) -> f32 {
    if t >= BLANKET {
        return 0.0;
    }
    if t >= 1.0 {
        let s = (BLANKET - t) / (BLANKET - 1.0);
        return 0.22 * s * s * s;
    }
    let t2 = t * t;
    let bowl = t2 - 1.0;
    let base = smooth_between(0.45, 1.0, t) - 1.0;
    return bowl + flat_floor * (base - bowl) + 0.22 * t2 * t2;
}

// One octave of the catalogue of craters or of noise.
struct Octave {
    cell_m: f32,
    weight: f32,   // noise: gᵒ; craters: depth over diameter
    flat_floor: f32,
    density: f32,
    seed: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

fn crater_octave(o: Octave, radius_m: f32, at: LatticePoint, up: vec3<f32>) -> f32 {
    let inverse_radius = o.cell_m / radius_m;
    let first = select(vec3<i32>(0), vec3<i32>(-1), at.fraction < vec3<f32>(0.5));
    var height = 0.0;
    for (var k = 0; k < 8; k++) {
        let step = first + vec3<i32>(k & 1, (k >> 1u) & 1, k >> 2u);
        let h = hash_cell(at.cell + step, o.seed);
        if unit16(h) >= o.density {
            continue;
        }
        let h2 = mix32(h ^ 0x9e3779b9u);
        let h3 = mix32(h ^ 0x7f4a7c15u);
        let jitter = vec3<f32>(unit16(h >> 16u), unit16(h2), unit16(h2 >> 16u));
        let r = vec3<f32>(step) + jitter - at.fraction;
        let lift = (dot(r, up) + 0.5 * dot(r, r) * inverse_radius) * inverse_radius;
        let root = sqrt(max(1.0 + 2.0 * lift, 0.0));
        let e = 2.0 * lift / (inverse_radius * (1.0 + root));
        if abs(e) >= SLAB {
            continue;
        }
        let to_centre = r - (up + r * inverse_radius) * (e / max(root, 1e-6));
        let size = unit16(h3);
        let radius = RADIUS_MIN + (RADIUS_MAX - RADIUS_MIN) * size * size;
        let t = length(to_centre) / radius;
        if t >= BLANKET {
            continue;
        }
        let wear = unit16(h3 >> 16u);
        let depth = 2.0 * radius * o.cell_m * o.weight * (0.3 + 0.7 * wear * wear) * (1.0 - smooth_between(SLAB_FADE, SLAB, abs(e)));
        height += depth * crater_profile(t, o.flat_floor);
    }
    return height;
}

// Catmull–Rom: weights of nodes −1, 0, 1, 2 at t, and their derivatives.
fn cubic_weights(t: f32) -> vec4<f32> {
    let t2 = t * t;
    let t3 = t2 * t;
    return 0.5 * vec4<f32>(2.0 * t2 - t - t3, 3.0 * t3 - 5.0 * t2 + 2.0, 4.0 * t2 - 3.0 * t3 + t, t3 - t2);
}
fn cubic_slopes(t: f32) -> vec4<f32> {
    let t2 = t * t;
    return 0.5 * vec4<f32>(4.0 * t - 1.0 - 3.0 * t2, 9.0 * t2 - 10.0 * t, 8.0 * t - 9.0 * t2 + 1.0, 3.0 * t2 - 2.0 * t);
}

// A cube map on the GPU: a layer a face; the mips beside the first level, one above the other.
struct MapShape {
    bits: u32,     // log2 of the finest level's cells; 0: no map
    scale: f32,
    offset: f32,
    pad: u32,
}
const BORDER: i32 = 2;

// Value and its steepness per cell (on an edge of the cube the one along it stands for both) at a sample of a grid with 2^bits samples along a face; `v` counts them from the face's corner.
// Cell and fraction come from whole numbers: exact at every level.
fn cube_sample(map: texture_2d_array<i32>, shape: MapShape, face: u32, bits: u32, v: vec2<i32>) -> vec2<f32> {
    let level_bits = min(bits, shape.bits);
    let shift = bits - level_bits;
    let node = v >> vec2<u32>(shift);
    let t = vec2<f32>(v - (node << vec2<u32>(shift))) / f32(1u << shift);
    var origin = vec2<i32>(BORDER);
    var cells = 1 << shape.bits;
    for (var k = shape.bits; k > level_bits; k--) {
        origin.y += select(cells + 1 + 2 * BORDER, 0, k == shape.bits);
        cells = cells >> 1u;
    }
    if level_bits < shape.bits {
        origin.x += (1 << shape.bits) + 1 + 2 * BORDER;
    }
    let wx = cubic_weights(t.x);
    let dx = cubic_slopes(t.x);
    let wy = cubic_weights(t.y);
    let dy = cubic_slopes(t.y);
    var value = 0.0;
    var slope = vec2<f32>(0.0);
    for (var j = 0; j < 4; j++) {
        let at = origin + node + vec2<i32>(-1, j - 1);
        let s = vec4<f32>(
            f32(textureLoad(map, at, face, 0).r), f32(textureLoad(map, at + vec2<i32>(1, 0), face, 0).r),
            f32(textureLoad(map, at + vec2<i32>(2, 0), face, 0).r), f32(textureLoad(map, at + vec2<i32>(3, 0), face, 0).r));
        let along = dot(wx, s);
        value += wy[j] * along;
        slope += vec2<f32>(wy[j] * dot(dx, s), dy[j] * along);
    }
    let x = vec2<f32>(node) + t;
    let n = f32(1u << level_bits);
    let e = vec2<f32>(smooth_between(1.0, 3.0, min(x.x, n - x.x)), smooth_between(1.0, 3.0, min(x.y, n - x.y)));
    let steep = e.x * (2.0 - e.y) * slope.x * slope.x + e.y * (2.0 - e.x) * slope.y * slope.y;
    return vec2<f32>(shape.offset + shape.scale * value, abs(shape.scale) * sqrt(steep));
}
