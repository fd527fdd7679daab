// Gradient noise on the 3-D integer lattice, same bits as engine/src/terrain/noise.rs. A point is a cell and a fraction in it.

fn mix32(x: u32) -> u32 {
    var h = x;
    h ^= h >> 16u;
    h *= 0x21f0aaadu;
    h ^= h >> 15u;
    h *= 0xd35a2d97u;
    return h ^ (h >> 15u);
}

fn hash_cell(c: vec3<i32>, seed: u32) -> u32 {
    let u = bitcast<vec3<u32>>(c);
    return mix32(u.x * 0x9e3779b1u + u.y * 0x85ebca77u + u.z * 0xc2b2ae3du + seed * 0x27d4eb2fu);
}

// The low 16 bits as a number in [0, 1).
fn unit16(h: u32) -> f32 {
    return f32(h & 0xffffu) / 65536.0;
}

fn gradient_dot(hash: u32, f: vec3<f32>) -> f32 {
    let h = hash & 15u;
    let a = select(f.y, f.x, h < 8u);
    let b = select(select(f.z, f.x, h == 12u || h == 14u), f.y, h < 4u);
    return select(-a, a, (h & 1u) == 0u) + select(-b, b, (h & 2u) == 0u);
}

// In about −1 … 1, zero at the lattice points.
fn gradient_noise(cell: vec3<i32>, f: vec3<f32>, seed: u32) -> f32 {
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let x00 = mix(corner(cell, vec3<i32>(0, 0, 0), f, seed), corner(cell, vec3<i32>(1, 0, 0), f, seed), w.x);
    let x10 = mix(corner(cell, vec3<i32>(0, 1, 0), f, seed), corner(cell, vec3<i32>(1, 1, 0), f, seed), w.x);
    let x01 = mix(corner(cell, vec3<i32>(0, 0, 1), f, seed), corner(cell, vec3<i32>(1, 0, 1), f, seed), w.x);
    let x11 = mix(corner(cell, vec3<i32>(0, 1, 1), f, seed), corner(cell, vec3<i32>(1, 1, 1), f, seed), w.x);
    return mix(mix(x00, x10, w.y), mix(x01, x11, w.y), w.z);
}
fn corner(cell: vec3<i32>, step: vec3<i32>, f: vec3<f32>, seed: u32) -> f32 {
    return gradient_dot(hash_cell(cell + step, seed), f - vec3<f32>(step));
}

// A lattice point: cell and fraction, the fraction brought back into [0, 1).
struct LatticePoint {
    cell: vec3<i32>,
    fraction: vec3<f32>,
}
fn lattice_point(cell: vec3<i32>, fraction: vec3<f32>) -> LatticePoint {
    let whole = floor(fraction);
    return LatticePoint(cell + vec3<i32>(whole), fraction - whole);
}
