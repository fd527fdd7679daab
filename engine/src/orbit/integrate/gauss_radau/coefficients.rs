//! Coefficients of the Gauss–Radau method of order 15, worked out at compile time from the one definition that they have.
//!
//! The eight nodes on [0, 1), the first at 0, make the quadrature exact for polynomials of degree 14. Not here: the loop (`gauss_radau`).
//! - [Everhart 1985] "An efficient integrator that uses Gauss–Radau spacings", IAU Coll. 83, 185.

/// Coefficients b₀…b₆ of the acceleration's polynomial a(h) = a₀ + b₀h + b₁h² + … + b₆h⁷ over a step.
pub(super) const TERMS: usize = 7;

/// Nodes h₀ = 0 < h₁ < … < h₇ < 1.
pub(super) const NODES: [f64; TERMS + 1] = nodes();

/// `FROM_NEWTON[j][k]`: weight of hᵏ⁺¹ in h(h − h₁)…(h − h_j): how a divided difference g_j enters b_k [Everhart 1985, c].
pub(super) const FROM_NEWTON: [[f64; TERMS]; TERMS] = from_newton();

/// `TO_NEWTON[j][k]`: weight of b_j in the divided difference g_k [Everhart 1985, d]: the inverse of [`FROM_NEWTON`].
pub(super) const TO_NEWTON: [[f64; TERMS]; TERMS] = to_newton();

/// `APART[n][m]` = 1/(h_n − h_m), m < n.
pub(super) const APART: [[f64; TERMS + 1]; TERMS + 1] = apart();

/// Binomials (k+1 over j+1): the polynomial about the end of a step from that about its start.
pub(super) const SHIFT: [[f64; TERMS]; TERMS] = shift();

/// Legendre's Pₙ and Pₙ₋₁ at x, by the three-term recurrence.
const fn legendre(n: u32, x: f64) -> (f64, f64) {
    let (mut before, mut here) = (1.0, x);
    let mut k = 1;
    while k < n {
        let kf = k as f64;
        let next = ((2.0 * kf + 1.0) * x * here - kf * before) / (kf + 1.0);
        before = here;
        here = next;
        k += 1;
    }
    (here, before)
}

/// Radau's polynomial (P₇ + P₈)(2h − 1)/h: its roots are h₁…h₇.
const fn radau(h: f64) -> f64 {
    let (p8, p7) = legendre(8, 2.0 * h - 1.0);
    (p7 + p8) / h
}

/// The roots by bisection between sign changes: 60 halvings settle every bit, and nothing can diverge.
const fn nodes() -> [f64; TERMS + 1] {
    let mut found = [0.0; TERMS + 1];
    let mut count = 1;
    let mut i = 1;
    while i < 256 {
        let (mut low, mut high) = (i as f64 / 256.0, (i as f64 + 1.0) / 256.0);
        let rising = radau(low) < 0.0;
        if rising != (radau(high) < 0.0) && count <= TERMS {
            let mut halving = 0;
            while halving < 60 {
                let middle = 0.5 * (low + high);
                if (radau(middle) < 0.0) == rising {
                    low = middle;
                } else {
                    high = middle;
                }
                halving += 1;
            }
            found[count] = 0.5 * (low + high);
            count += 1;
        }
        i += 1;
    }
    found
}

const fn from_newton() -> [[f64; TERMS]; TERMS] {
    let mut c = [[0.0; TERMS]; TERMS];
    c[0][0] = 1.0;
    let mut j = 1;
    while j < TERMS {
        let mut k = 0;
        while k <= j {
            let risen = if k > 0 { c[j - 1][k - 1] } else { 0.0 };
            c[j][k] = risen - NODES[j] * c[j - 1][k];
            k += 1;
        }
        j += 1;
    }
    c
}

const fn to_newton() -> [[f64; TERMS]; TERMS] {
    let mut d = [[0.0; TERMS]; TERMS];
    d[0][0] = 1.0;
    let mut j = 1;
    while j < TERMS {
        let mut k = 0;
        while k <= j {
            let risen = if k > 0 { d[j - 1][k - 1] } else { 0.0 };
            d[j][k] = risen + NODES[k + 1] * d[j - 1][k];
            k += 1;
        }
        j += 1;
    }
    d
}

const fn apart() -> [[f64; TERMS + 1]; TERMS + 1] {
    let mut r = [[0.0; TERMS + 1]; TERMS + 1];
    let mut n = 1;
    while n <= TERMS {
        let mut m = 0;
        while m < n {
            r[n][m] = 1.0 / (NODES[n] - NODES[m]);
            m += 1;
        }
        n += 1;
    }
    r
}

const fn shift() -> [[f64; TERMS]; TERMS] {
    // Pascal's triangle without its first column: row j, column k is (j+1 over k+1).
    let mut binomial = [[0.0; TERMS]; TERMS];
    let mut j = 0;
    while j < TERMS {
        binomial[j][0] = j as f64 + 1.0;
        let mut k = 1;
        while k <= j {
            binomial[j][k] = binomial[j - 1][k - 1] + binomial[j - 1][k];
            k += 1;
        }
        j += 1;
    }
    binomial
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_radau_s() {
        // The published first and last ones, and the sum of all: by Vieta (51480 − 3432)/12870 = 56/15.
        assert!((NODES[1] - 0.056_262_560_536_922_15).abs() < 3e-17 && (NODES[7] - 0.977_520_613_561_287_5).abs() < 3e-16);
        assert!((NODES.iter().sum::<f64>() - 56.0 / 15.0).abs() < 2e-15);
    }

    #[test]
    fn the_quadrature_is_exact_to_degree_14_and_not_beyond() {
        // Weights: the integral of Lagrange's polynomial of each node, through its monomials.
        let error = |degree: i32| {
            let mut sum = 0.0;
            for (i, x) in NODES.iter().enumerate() {
                let mut poly = vec![1.0];
                for (m, y) in NODES.iter().enumerate().filter(|(m, _)| *m != i) {
                    let _ = m;
                    let mut next = vec![0.0; poly.len() + 1];
                    for (k, c) in poly.iter().enumerate() {
                        next[k + 1] += c / (x - y);
                        next[k] -= c * y / (x - y);
                    }
                    poly = next;
                }
                let weight: f64 = poly.iter().zip(1..).map(|(c, k)| c / f64::from(k)).sum();
                sum += weight * libm::pow(*x, f64::from(degree));
            }
            (sum - 1.0 / f64::from(degree + 1)).abs()
        };
        for degree in 0..=14 {
            assert!(error(degree) < 3e-13, "degree {degree}: {}", error(degree));
        }
        // ∫₀¹ h(h−h₁)²…(h−h₇)² is what degree 15 misses: about 2e-9.
        assert!(error(15) > 1e-10 && error(15) < 1e-8, "{}", error(15));
    }

    #[test]
    #[allow(clippy::needless_range_loop, reason = "a product of matrices")]
    fn the_two_bases_are_each_other_s_inverse() {
        for j in 0..TERMS {
            for k in 0..TERMS {
                let product: f64 = (0..TERMS).map(|m| FROM_NEWTON[j][m] * TO_NEWTON[m][k]).sum();
                assert!((product - f64::from(u8::from(j == k))).abs() < 1e-14, "{j} {k}: {product}");
            }
        }
    }
}
