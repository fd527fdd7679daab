// Tile heights: the height function at the samples of new tiles, at the tile's own level and at its parent's.
// Rust side: engine/src/render/pass/tile_heights.rs.

#include "lib/tile.wgsl"
#include "lib/height.wgsl"

const STORED: u32 = 67u;
const OCTAVES: u32 = 61u;

struct ReliefParams {
    counts: vec4<u32>,     // octaves of provinces, noise, craters; 1 where there is a coast
    noise: vec4<f32>,      // amplitude, plain amplitude, ridged, edge of a face, m
    province: vec4<f32>,   // depth, bias, 1 where there are any, radius of the datum, m
    height_map: MapShape,
    coast_map: MapShape,
    octaves: array<Octave, OCTAVES>,
}

struct Job {
    key: vec4<u32>,        // face, level, x, y
    place: vec4<u32>,      // slot, first lattice, 0, 0
    frame: TileFrame,
}

// Cell and fraction of the tile's centre in an octave's lattice; fades at the tile's level and at its parent's.
struct Lattice {
    cell: vec3<i32>,
    fade: f32,
    fraction: vec3<f32>,
    fade_coarse: f32,
}

@group(0) @binding(0) var<uniform> relief: ReliefParams;
@group(0) @binding(1) var<storage, read> jobs: array<Job>;
@group(0) @binding(2) var<storage, read> lattices: array<Lattice>;
@group(0) @binding(3) var height_map: texture_2d_array<i32>;
@group(0) @binding(4) var coast_map: texture_2d_array<i32>;
@group(0) @binding(5) var<storage, read_write> heights: array<vec2<f32>>;

// Map value, roughness and distance to the coast at a grid with 2^bits samples along a face.
fn mapped(face: u32, bits: u32, v: vec2<i32>) -> vec3<f32> {
    let value = cube_sample(height_map, relief.height_map, face, bits, v);
    let cell = relief.noise.w / f32(1u << min(bits, relief.height_map.bits));
    let rough = smooth_between(0.0, 1.0, value.y / cell / ROUGH_SLOPE + max(value.x, 0.0) / ROUGH_HEIGHT_M);
    var coast = 0.0;
    if relief.counts.w > 0u {
        coast = cube_sample(coast_map, relief.coast_map, face, bits, v).x;
    }
    return vec3<f32>(value.x, rough, coast);
}

fn at_lattice(lattice: Lattice, offset_m: vec3<f32>, cell_m: f32) -> LatticePoint {
    return lattice_point(lattice.cell, lattice.fraction + offset_m / cell_m);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= STORED * STORED {
        return;
    }
    let job = jobs[id.y];
    let sample = vec2<i32>(vec2<u32>(id.x % STORED, id.x / STORED)) - 1;
    let axes = face_axes(job.key.x);
    let point = tile_point(job.frame, axes, vec2<f32>(sample - 32) / 64.0);
    let radius = relief.province.w;
    let offset = point.offset * radius;
    var first = job.place.y;
    var octave = 0u;

    var high = vec2<f32>(1.0);
    if relief.province.z > 0.0 {
        var sum = vec2<f32>(relief.province.y);
        for (var k = 0u; k < relief.counts.x; k++) {
            let lattice = lattices[first + k];
            let o = relief.octaves[k];
            let p = at_lattice(lattice, offset, o.cell_m);
            sum += o.weight * vec2<f32>(lattice.fade, lattice.fade_coarse) * gradient_noise(p.cell, p.fraction, o.seed);
        }
        high = vec2<f32>(smooth_between(-0.1, 0.1, sum.x), smooth_between(-0.1, 0.1, sum.y));
    }
    first += relief.counts.x;
    octave += relief.counts.x;

    var base = -relief.province.x * (1.0 - high);
    var rough = high;
    var coast = vec2<f32>(0.0);
    if relief.height_map.bits > 0u {
        let v = vec2<i32>(job.key.zw * 64u) + sample;
        let bits = job.key.y + 6u;
        let fine = mapped(job.key.x, bits, v);
        var coarse = fine;
        // The parent samples a grid of half the density; where both read the map's finest level they agree.
        if job.key.y > 0u && bits <= max(relief.height_map.bits, relief.coast_map.bits) {
            coarse = mapped_coarse(job.key.x, bits - 1u, v);
        }
        base += vec2<f32>(fine.x, coarse.x);
        rough = vec2<f32>(fine.y, coarse.y);
        coast = vec2<f32>(fine.z, coarse.z);
    }

    var sum = vec2<f32>(0.0);
    for (var k = 0u; k < relief.counts.y; k++) {
        let lattice = lattices[first + k];
        if lattice.fade <= 0.0 {
            break;
        }
        let o = relief.octaves[octave + k];
        let p = at_lattice(lattice, offset, o.cell_m);
        let s = o.weight * shaped(gradient_noise(p.cell, p.fraction, o.seed), relief.noise.z);
        sum += s * vec2<f32>(lattice.fade * octave_weight(sum.x), lattice.fade_coarse * octave_weight(sum.y));
    }
    first += relief.counts.y;
    octave += relief.counts.y;
    var amplitude = relief.noise.y + (relief.noise.x - relief.noise.y) * rough;
    if relief.counts.w > 0u {
        amplitude = min(amplitude, relief.noise.y + VALLEY * max(base, vec2<f32>(0.0)));
    }
    var z = base + amplitude * sum;

    var pits = vec2<f32>(0.0);
    for (var k = 0u; k < relief.counts.z; k++) {
        let lattice = lattices[first + k];
        if lattice.fade <= 0.0 {
            break;
        }
        let o = relief.octaves[octave + k];
        let p = at_lattice(lattice, offset, o.cell_m);
        pits += crater_octave(o, radius, p, point.direction) * vec2<f32>(lattice.fade, lattice.fade_coarse);
    }
    z += (0.35 + 0.65 * high) * pits;

    if relief.counts.w > 0u {
        z = vec2<f32>(shore(z.x, coast.x + WOBBLE_M * sum.x), shore(z.y, coast.y + WOBBLE_M * sum.y));
    }
    heights[job.place.x * STORED * STORED + id.x] = z;
}

// The same place on the parent's grid, whose samples are every second one of ours: half-way points read between two of its nodes.
fn mapped_coarse(face: u32, bits: u32, v: vec2<i32>) -> vec3<f32> {
    let node = v >> vec2<u32>(1u);
    let odd = v - (node << vec2<u32>(1u));
    let a = mapped(face, bits, node);
    if odd.x == 0 && odd.y == 0 {
        return a;
    }
    let b = mapped(face, bits, node + odd);
    return 0.5 * (a + b);
}
