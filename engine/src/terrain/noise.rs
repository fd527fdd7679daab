//! Gradient noise on the 3-D integer lattice, with an integer hash: the same bits here and in `shaders/lib/noise.wgsl`.
//!
//! A sample point is given as a cell (i32 × 3) and a fraction in it, never as one float: so a metre-wide wave stays exact on a
//! planet, in f32 too. The gradients are the twelve edges of a cube, the fade is quintic [Perlin 2002, "Improving Noise"];
//! the hash is a multiply–xorshift finaliser [Wellons 2018, "Prospecting for Hash Functions", lowbias32].
//! Not here: how octaves are summed ([`super::relief`]).

use glam::{DVec3, IVec3};

/// Mixes 32 bits.
pub const fn mix32(mut h: u32) -> u32 {
    h ^= h >> 16;
    h = h.wrapping_mul(0x21f0_aaad);
    h ^= h >> 15;
    h = h.wrapping_mul(0xd35a_2d97);
    h ^ (h >> 15)
}

/// Hash of a lattice cell.
pub const fn hash(x: i32, y: i32, z: i32, seed: u32) -> u32 {
    let k = x
        .cast_unsigned()
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add(y.cast_unsigned().wrapping_mul(0x85eb_ca77))
        .wrapping_add(z.cast_unsigned().wrapping_mul(0xc2b2_ae3d))
        .wrapping_add(seed.wrapping_mul(0x27d4_eb2f));
    mix32(k)
}

/// The low 16 bits of a hash as a number in [0, 1): exact in f32.
pub fn unit16(h: u32) -> f64 {
    f64::from(h & 0xffff) / 65_536.0
}

fn gradient_dot(h: u32, f: DVec3) -> f64 {
    let h = h & 15;
    let a = if h < 8 { f.x } else { f.y };
    let b = if h < 4 {
        f.y
    } else if h == 12 || h == 14 {
        f.x
    } else {
        f.z
    };
    (if h & 1 == 0 { a } else { -a }) + (if h & 2 == 0 { b } else { -b })
}

/// Gradient noise in about [−1, 1], standard deviation near 0.27; zero at the lattice points.
pub fn gradient_noise(cell: IVec3, f: DVec3, seed: u32) -> f64 {
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32, z: i32| {
        let h = hash(cell.x.wrapping_add(x), cell.y.wrapping_add(y), cell.z.wrapping_add(z), seed);
        gradient_dot(h, f - DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
    };
    let lerp = |a: f64, b: f64, t: f64| a + t * (b - a);
    let x00 = lerp(corner(0, 0, 0), corner(1, 0, 0), w.x);
    let x10 = lerp(corner(0, 1, 0), corner(1, 1, 0), w.x);
    let x01 = lerp(corner(0, 0, 1), corner(1, 0, 1), w.x);
    let x11 = lerp(corner(0, 1, 1), corner(1, 1, 1), w.x);
    lerp(lerp(x00, x10, w.y), lerp(x01, x11, w.y), w.z)
}

/// Splits a lattice coordinate (|x| < 2³¹) into cell and fraction.
#[allow(clippy::cast_possible_truncation)]
pub fn split(q: DVec3) -> (IVec3, DVec3) {
    let floor = q.floor();
    (IVec3::new(floor.x as i32, floor.y as i32, floor.z as i32), q - floor)
}

/// A fixed shift of the lattice of octave `index`, so that the zeros of octaves do not line up.
pub fn lattice_offset(index: u32, seed: u32) -> DVec3 {
    let at = |axis: i32| unit16(hash(axis, 17, -5, seed ^ index.wrapping_mul(0x51ed_270b)));
    DVec3::new(at(0), at(1), at(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_continuous_across_cells_and_has_unit_like_range() {
        let (mut sum, mut square, mut worst, mut n) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for i in 0..4000 {
            let t = f64::from(i) * 0.377;
            let q = DVec3::new(t, 0.7 * t + 3.1, 91.3 - 0.31 * t);
            let (c, f) = split(q);
            let a = gradient_noise(c, f, 7);
            let (c2, f2) = split(q + DVec3::splat(1e-9));
            worst = worst.max((gradient_noise(c2, f2, 7) - a).abs());
            sum += a;
            square += a * a;
            n += 1.0;
        }
        assert!(worst < 1e-8, "a jump of {worst}");
        assert!((sum / n).abs() < 0.02, "mean {}", sum / n);
        let deviation = (square / n).sqrt();
        assert!((0.22..0.33).contains(&deviation), "standard deviation {deviation}");
    }
}
