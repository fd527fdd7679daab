//! Directions and functions of a column's streams, and the few matrices that they need.

use crate::air::model::orders::gauss_legendre;
use core::f64::consts::PI;

/// Streams from above and from below the level, each.
pub const STREAMS: usize = 8;
/// Degrees of Legendre's functions that they tell apart.
pub const TERMS: usize = 2 * STREAMS;

/// A value per stream.
pub type Vector = [f64; STREAMS];
/// Columns of such: a matrix by a vector is a sum of columns, which a processor does several numbers at a time.
pub type Matrix = [Vector; STREAMS];

/// Legendre's associated functions of order m at a cosine, degree 0 to [`TERMS`], as `√((l−m)!/(l+m)!) P_l^m`: those of a degree add up to P_l of
/// the angle between two directions, `P_l(cos θ) = Σ_m (2 − δ₀ₘ) Y_l^m Y_l^m cos mφ`.
pub fn harmonics(m: usize, mu: f64) -> [f64; TERMS] {
    let sine = (1.0 - mu * mu).max(0.0).sqrt();
    let first = (1..=m).fold(1.0, |y, i| y * sine * ((2 * i - 1) as f64 / (2 * i) as f64).sqrt());
    let mut out = [0.0; TERMS];
    let (mut last, mut here) = (0.0, first);
    for (l, slot) in out.iter_mut().enumerate().skip(m) {
        *slot = here;
        let root = |l: usize| (((l - m) * (l + m)) as f64).sqrt();
        (last, here) = (here, ((2 * l + 1) as f64 * mu * here - root(l) * last) / root(l + 1));
    }
    out
}

/// The streams of one Fourier mode.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Number m of the mode.
    pub mode: usize,
    /// Zenith cosines of the upper half; the lower is its mirror image. [Sykes 1951, "Approximate Integration of the Equation of Transfer"]:
    /// Gauss points of each half by itself, as light jumps at the level.
    pub mu: Vector,
    /// Their weights, 1 in all.
    pub weight: Vector,
    /// Functions at the streams, by degree.
    y: [Vector; TERMS],
}

impl Basis {
    /// For a mode.
    pub fn new(mode: usize) -> Self {
        let nodes = gauss_legendre(STREAMS);
        let mu: Vector = core::array::from_fn(|i| nodes[i].0);
        let at = mu.map(|mu| harmonics(mode, mu));
        Self { mode, mu, weight: core::array::from_fn(|i| nodes[i].1), y: core::array::from_fn(|l| at.map(|y| y[l])) }
    }

    /// Degrees whose function has the same value in the mirrored stream; `odd`: those that change their sign.
    fn degrees(&self, odd: bool) -> impl Iterator<Item = usize> {
        (self.mode + usize::from(odd)..TERMS).step_by(2)
    }

    /// Scattering between streams, per unit of the scattering coefficient: of the half sum of light from above and below, `odd`: of the half difference.
    pub fn kernel(&self, chi: &[f64; TERMS], odd: bool) -> Matrix {
        let mut k = [[0.0; STREAMS]; STREAMS];
        for l in self.degrees(odd) {
            for ((column, y), w) in k.iter_mut().zip(self.y[l]).zip(self.weight) {
                let from = (2 * l + 1) as f64 * chi[l] * y * w;
                column.iter_mut().zip(self.y[l]).for_each(|(sum, to)| *sum += from * to);
            }
        }
        k
    }

    /// Scattering of a beam of zenith cosine `mu` into streams.
    pub fn of_beam(&self, chi: &[f64; TERMS], mu: f64, odd: bool) -> Vector {
        let from = harmonics(self.mode, mu);
        let twice = if self.mode > 0 { 2.0 } else { 1.0 };
        let mut q = [0.0; STREAMS];
        for l in self.degrees(odd) {
            let of_degree = twice / (4.0 * PI) * (2 * l + 1) as f64 * chi[l] * from[l];
            q.iter_mut().zip(self.y[l]).for_each(|(sum, y)| *sum += of_degree * y);
        }
        q
    }

    /// Moments `∫ Y_l L dμ` of light, given by half sums and half differences; those of the source function are χ_l of these.
    pub fn moments(&self, sum: &Vector, difference: &Vector) -> [f64; TERMS] {
        let mut out = [0.0; TERMS];
        for (l, slot) in out.iter_mut().enumerate().skip(self.mode) {
            let light = if (l - self.mode).is_multiple_of(2) { sum } else { difference };
            *slot = (0..STREAMS).map(|i| 2.0 * self.weight[i] * self.y[l][i] * light[i]).sum();
        }
        out
    }
}

/// A matrix by a vector.
pub fn times(a: &Matrix, x: &Vector) -> Vector {
    let mut out = [0.0; STREAMS];
    for (column, x) in a.iter().zip(x) {
        out.iter_mut().zip(column).for_each(|(sum, a)| *sum += a * x);
    }
    out
}

/// A matrix by another.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| times(a, &column))
}

/// Sum of two vectors, the second by a factor.
pub fn plus(a: &Vector, b: &Vector, factor: f64) -> Vector {
    core::array::from_fn(|i| a[i] + factor * b[i])
}

/// 1 plus a matrix.
pub fn one_plus(mut a: Matrix) -> Matrix {
    a.iter_mut().enumerate().for_each(|(i, row)| row[i] += 1.0);
    a
}

/// The inverse, by elimination with pivots; alike for rows and for columns.
pub fn inverse(mut a: Matrix) -> Matrix {
    let mut b = one_plus([[0.0; STREAMS]; STREAMS]);
    for i in 0..STREAMS {
        let pivot = (i..STREAMS).max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs())).unwrap_or(i);
        a.swap(i, pivot);
        b.swap(i, pivot);
        let by = 1.0 / if a[i][i].abs() < 1e-280 { 1e-280 } else { a[i][i] };
        a[i].iter_mut().chain(&mut b[i]).for_each(|x| *x *= by);
        let (of_a, of_b) = (a[i], b[i]);
        for r in (0..STREAMS).filter(|r| *r != i) {
            let f = a[r][i];
            a[r].iter_mut().zip(of_a).for_each(|(x, y)| *x -= f * y);
            b[r].iter_mut().zip(of_b).for_each(|(x, y)| *x -= f * y);
        }
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_add_up_to_legendre_s_of_the_angle_between() {
        for (a, b, phi) in [(0.3, -0.8, 1.0), (0.99, 0.2, 2.5), (-0.5, -0.5, 0.1)] {
            let across = ((1.0_f64 - a * a) * (1.0 - b * b)).sqrt();
            let c = a * b + across * libm::cos(phi);
            // P₃ of it; modes beyond the degree are none.
            let found: f64 =
                (0..=3).map(|m| if m > 0 { 2.0 } else { 1.0 } * harmonics(m, a)[3] * harmonics(m, b)[3] * libm::cos(m as f64 * phi)).sum();
            assert!((found - 0.5 * (5.0 * c * c * c - 3.0 * c)).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn scattering_keeps_the_light() {
        let basis = Basis::new(0);
        let chi: [f64; TERMS] = core::array::from_fn(|l| libm::pow(0.7, l as f64));
        for sum in times(&basis.kernel(&chi, false), &[1.0; STREAMS]) {
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        }
        // Of a beam, over all directions.
        let q = basis.of_beam(&chi, -0.3, false);
        let all: f64 = q.iter().zip(basis.weight).map(|(q, w)| 4.0 * PI * q * w).sum();
        assert!((all - 1.0).abs() < 1e-12, "{all}");
    }

    #[test]
    fn an_inverse_undoes_its_matrix() {
        let a: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| libm::sin((3 * i * i + 7 * j + i * j) as f64)));
        let unit = product(&a, &inverse(a));
        for (i, row) in unit.iter().enumerate() {
            for (j, x) in row.iter().enumerate() {
                assert!((x - f64::from(u8::from(i == j))).abs() < 1e-9, "{i} {j}: {x}");
            }
        }
    }
}
