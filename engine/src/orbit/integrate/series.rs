//! Series: arithmetic of power series in time, one coefficient at a time. The parts that a Taylor method is built from.
//!
//! A series is a slice whose element k is the k-th normalised derivative x⁽ᵏ⁾/k!. Every kernel returns coefficient `k` of its
//! result from coefficients 0 … k of its arguments (and 0 … k−1 of the result, where the rule is a recurrence), so that a method
//! builds the solution of y″ = f(y) order by order: put y_k in, take f_k out, y_{k+2} = f_k / ((k+1)(k+2)).
//! A slice that ends before the coefficient that is asked for counts as zero beyond its end.
//!
//! Not here: which forces there are (`taylor` for point masses), and how long a step may be.
//! - [Jorba & Zou 2005] "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
//!   Experimental Mathematics 14, prop. 2.1.
//! - [Neidinger 2010] "Introduction to automatic differentiation and MATLAB object-oriented programming", SIAM Review 52, §4.

use glam::DVec3;

/// Σ f(j) for j from `from` below `to`, in four interleaved partial sums: the same order of additions on every machine, and one that
/// vector units can follow.
#[inline(always)]
fn sum(from: usize, to: usize, f: impl Fn(usize) -> f64) -> f64 {
    let mut part = [0.0; 4];
    let mut j = from;
    while j + 4 <= to {
        for (lane, p) in part.iter_mut().enumerate() {
            *p += f(j + lane);
        }
        j += 4;
    }
    for (lane, p) in part.iter_mut().enumerate() {
        if j + lane < to {
            *p += f(j + lane);
        }
    }
    (part[0] + part[2]) + (part[1] + part[3])
}

/// Coefficient `k` of a·b: Σ a_j b_{k−j} [Jorba & Zou 2005, prop. 2.1 (2)].
#[inline]
#[must_use]
pub fn product(a: &[f64], b: &[f64], k: usize) -> f64 {
    // j < a.len() and k − j < b.len().
    let (from, to) = ((k + 1).saturating_sub(b.len()), a.len().min(k + 1));
    sum(from, to, |j| a[j] * b[k - j])
}

/// Coefficient `k` of a²: each mixed term once, doubled.
#[inline]
#[must_use]
pub fn square(a: &[f64], k: usize) -> f64 {
    let from = (k + 1).saturating_sub(a.len());
    let half = sum(from, k.div_ceil(2), |j| a[j] * a[k - j]);
    let middle = if k.is_multiple_of(2) && k / 2 < a.len() { a[k / 2] * a[k / 2] } else { 0.0 };
    2.0 * half + middle
}

/// Coefficient `k` of the scalar series a times the vector series b.
#[inline]
#[must_use]
pub fn scaled(a: &[f64], b: &[DVec3], k: usize) -> DVec3 {
    let (from, to) = ((k + 1).saturating_sub(b.len()), a.len().min(k + 1));
    (from..to).fold(DVec3::ZERO, |s, j| s + b[k - j] * a[j])
}

/// Coefficient `k` of the scalar product of two vector series.
#[inline]
#[must_use]
pub fn dot(a: &[DVec3], b: &[DVec3], k: usize) -> f64 {
    let (from, to) = ((k + 1).saturating_sub(b.len()), a.len().min(k + 1));
    sum(from, to, |j| a[j].dot(b[k - j]))
}

/// Coefficient `k` of |a|².
#[inline]
#[must_use]
pub fn norm_squared(a: &[DVec3], k: usize) -> f64 {
    let from = (k + 1).saturating_sub(a.len());
    let half = sum(from, k.div_ceil(2), |j| a[j].dot(a[k - j]));
    let middle = if k.is_multiple_of(2) && k / 2 < a.len() { a[k / 2].length_squared() } else { 0.0 };
    2.0 * half + middle
}

/// Coefficient `k` of the cross product of two vector series.
#[inline]
#[must_use]
pub fn cross(a: &[DVec3], b: &[DVec3], k: usize) -> DVec3 {
    let (from, to) = ((k + 1).saturating_sub(b.len()), a.len().min(k + 1));
    (from..to).fold(DVec3::ZERO, |s, j| s + a[j].cross(b[k - j]))
}

/// Coefficient `k` ≥ 1 of a/b, from coefficients 0 … k−1 of the quotient; b₀ ≠ 0 [Jorba & Zou 2005, prop. 2.1 (3)].
#[inline]
#[must_use]
pub fn quotient(a: &[f64], b: &[f64], quotient: &[f64], k: usize) -> f64 {
    let done = &quotient[..k.min(quotient.len())];
    (a.get(k).copied().unwrap_or(0.0) - product(done, b, k)) / b[0]
}

/// Coefficient `k` ≥ 1 of a^p for any real p, from coefficients 0 … k−1 of the power; a₀ > 0
/// [Jorba & Zou 2005, prop. 2.1 (4)]: `k a₀ y_k = Σ_{j<k} (k p − j (p + 1)) a_{k−j} y_j`. Coefficient 0 is a₀^p.
#[inline]
#[must_use]
pub fn power(a: &[f64], y: &[f64], p: f64, k: usize) -> f64 {
    let kp = k as f64 * p;
    let from = (k + 1).saturating_sub(a.len());
    sum(from, k, |j| (kp - j as f64 * (p + 1.0)) * (a[k - j] * y[j])) / (k as f64 * a[0])
}

/// Coefficient `k` of r⁻³ from the series r² (0 … k) and r⁻³ itself (0 … k−1): the one nonlinear function of point-mass gravity.
#[inline]
#[must_use]
pub fn inverse_cube(r2: &[f64], y: &[f64], k: usize) -> f64 {
    if k == 0 { 1.0 / (r2[0] * r2[0].sqrt()) } else { power(r2, y, -1.5, k) }
}

/// Coefficients of the derivative: element k is (k+1) a_{k+1}.
#[inline]
#[must_use]
pub fn derivative(a: &[DVec3], k: usize) -> DVec3 {
    a.get(k + 1).copied().unwrap_or(DVec3::ZERO) * (k + 1) as f64
}

/// Value of the series at `h` by Horner's rule.
#[inline]
#[must_use]
pub fn value(a: &[DVec3], h: f64) -> DVec3 {
    a.iter().rev().fold(DVec3::ZERO, |s, c| s * h + *c)
}

/// Value and rate of the series at `h`.
#[inline]
#[must_use]
pub fn value_and_rate(a: &[DVec3], h: f64) -> (DVec3, DVec3) {
    a.iter().rev().fold((DVec3::ZERO, DVec3::ZERO), |(s, r), c| (s * h + *c, r * h + s))
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 24;

    /// (1 + c t)^p by its binomial series.
    fn binomial(c: f64, p: f64) -> Vec<f64> {
        let mut y = vec![1.0];
        for k in 1..N {
            let last = y[k - 1];
            y.push(last * c * (p - (k as f64 - 1.0)) / k as f64);
        }
        y
    }

    /// Exp(c t).
    fn exponential(c: f64) -> Vec<f64> {
        let mut y = vec![1.0];
        for k in 1..N {
            let last = y[k - 1];
            y.push(last * c / k as f64);
        }
        y
    }

    fn close(k: usize, a: f64, b: f64) {
        assert!((a - b).abs() <= 4e-15 * b.abs().max(1.0), "coefficient {k}: {a} for {b}");
    }

    #[test]
    fn a_product_of_exponentials_is_the_exponential_of_the_sum() {
        let (a, b, ab, aa) = (exponential(0.7), exponential(-1.9), exponential(0.7 - 1.9), exponential(1.4));
        for k in 0..N {
            close(k, product(&a, &b, k), ab[k]);
            close(k, square(&a, k), aa[k]);
        }
        let mut q = vec![1.0];
        for k in 1..N {
            let next = quotient(&ab, &b, &q, k);
            q.push(next);
            close(k, q[k], a[k]);
        }
    }

    #[test]
    fn powers_of_a_binomial_are_binomials() {
        for p in [-1.5, -1.0, -2.5, 0.5, 3.0] {
            let (base, truth) = (binomial(0.8, 2.0), binomial(0.8, 2.0 * p));
            // The base is a polynomial of degree 2: a short slice must do as well as a long one with zeros.
            for a in [&base[..], &base[..3]] {
                let mut y = vec![1.0];
                for k in 1..N {
                    let next = power(a, &y, p, k);
                    y.push(next);
                    assert!((y[k] - truth[k]).abs() <= 2e-14 * truth[k].abs().max(1.0), "{p}, {k}: {} for {}", y[k], truth[k]);
                }
            }
        }
    }

    #[test]
    fn the_inverse_cube_of_a_straight_flight_s_distance_is_right() {
        // r = (1, t, 0): r⁻³ = (1 + t²)^{−3/2}, whose series is binomial in t².
        let r = [DVec3::X, DVec3::Y];
        let r2: Vec<f64> = (0..N).map(|k| norm_squared(&r, k)).collect();
        assert_eq!(&r2[..4], &[1.0, 0.0, 1.0, 0.0]);
        let (mut y, truth) = (Vec::new(), binomial(1.0, -1.5));
        for k in 0..N {
            let next = inverse_cube(&r2, &y, k);
            y.push(next);
            close(k, y[k], if k % 2 == 0 { truth[k / 2] } else { 0.0 });
        }
        // r·r⁻³ by vectors is the same by components; a series is its own square's dot.
        for k in 1..N {
            let a = scaled(&y, &r, k);
            close(k, a.x, y[k]);
            close(k, a.y, y[k - 1]);
            close(k, dot(&r, &r, k), r2[k]);
        }
    }

    #[test]
    fn a_cross_product_of_turning_vectors_is_constant() {
        // r = (cos t, sin t, 0), r × r′ = z.
        let (c, s): (Vec<f64>, Vec<f64>) = exponential(1.0)
            .iter()
            .enumerate()
            .map(|(k, e)| match k % 4 {
                0 => (*e, 0.0),
                1 => (0.0, *e),
                2 => (-*e, 0.0),
                _ => (0.0, -*e),
            })
            .unzip();
        let r: Vec<DVec3> = c.iter().zip(&s).map(|(c, s)| DVec3::new(*c, *s, 0.0)).collect();
        let v: Vec<DVec3> = (0..N).map(|k| derivative(&r, k)).collect();
        for k in 0..N - 1 {
            assert!((cross(&r, &v, k) - if k == 0 { DVec3::Z } else { DVec3::ZERO }).length() < 1e-15, "{k}");
        }
        let (at, rate) = value_and_rate(&r, 0.9);
        assert!((at - DVec3::new(libm::cos(0.9), libm::sin(0.9), 0.0)).length() < 3e-16);
        assert!((rate - DVec3::new(-libm::sin(0.9), libm::cos(0.9), 0.0)).length() < 3e-16);
        assert_eq!(at, value(&r, 0.9));
    }
}
