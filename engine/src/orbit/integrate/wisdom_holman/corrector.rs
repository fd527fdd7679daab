//! Symplectic correctors: a change of coordinates before and after the run that takes the leading errors out of it.
//!
//! To first order in the perturbation the map drift–kick–drift averages it with (x/2)/sinh(x/2) in place of 1, x = h·d/dt along the
//! Kepler orbits. A corrector is a product of Z(a, b) = drift(a) kick(b) drift(−2a) kick(−b) drift(a), to first order 2b·sinh(a·d/dt) of the
//! perturbation; its b make Σ 4bᵢ sinh(aᵢx) the series of (1 − (x/2)/sinh(x/2))/x up to a power [Wisdom, Holman & Touma 1996].
//! With aᵢ = iα, α² = 7/40, these are rational numbers over α, worked out here from that definition [Wisdom 2006, table 1 lists the same].

/// α.
const ALPHA: f64 = 0.418_330_013_267_037_8;

/// Order of the first error term, linear in the perturbation, that stays: steps to that power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corrector {
    /// No corrector: the error is of order 2.
    None,
    /// One stage each way.
    Third,
    /// Two stages.
    Fifth,
    /// Three stages.
    Seventh,
    /// Five stages.
    Eleventh,
    /// Eight stages.
    Seventeenth,
}

impl Corrector {
    /// Correctors, the weakest first.
    pub const ALL: [Self; 6] = [Self::None, Self::Third, Self::Fifth, Self::Seventh, Self::Eleventh, Self::Seventeenth];

    /// The number in the name: 0, 3, 5, 7, 11 or 17.
    pub fn order(self) -> u32 {
        [0, 3, 5, 7, 11, 17][self as usize]
    }

    /// Drifts a₁ … and kicks b₁ …, in steps.
    pub(super) fn stages(self) -> Vec<(f64, f64)> {
        let count = [0, 1, 2, 3, 5, 8][self as usize];
        weights(count).into_iter().zip(1..).map(|(b, i)| (f64::from(i) * ALPHA, b)).collect()
    }
}

/// b₁ … b_count: solves Σᵢ 4 bᵢ (iα)^{2m+1}/(2m+1)! = χ_m for m < count, where χ is the series of (1 − (x/2)/sinh(x/2))/x. As a
/// polynomial in i² that is Lagrange's: bᵢ = Σ_m (series)·(the basis polynomial of i), so each b is a sum over symmetric functions.
fn weights(count: usize) -> Vec<f64> {
    let alpha2 = 7.0 / 40.0;
    // y_m = χ_m (2m+1)!/(4 α^{2m+1}): what Σ bᵢ i^{2m+1} must be, times α^… kept apart.
    let mut target = Vec::new();
    let (mut factorial, mut power) = (1.0, ALPHA);
    for (m, chi) in series(count).into_iter().enumerate() {
        if m > 0 {
            let k = 2.0 * m as f64;
            factorial *= k * (k + 1.0);
            power *= alpha2;
        }
        target.push(chi * factorial / (4.0 * power));
    }
    (1..=count)
        .map(|i| {
            // The polynomial of degree count − 1 in s = i² that is 1 at i² and 0 at the others, as powers of s.
            let square = |k: usize| (k * k) as f64;
            let mut basis = vec![1.0];
            for k in (1..=count).filter(|k| *k != i) {
                let mut next = vec![0.0; basis.len() + 1];
                for (p, c) in basis.iter().enumerate() {
                    next[p + 1] += c;
                    next[p] -= c * square(k);
                }
                basis = next.into_iter().map(|c| c / (square(i) - square(k))).collect();
            }
            basis.iter().zip(&target).map(|(c, y)| c * y).sum::<f64>() / i as f64
        })
        .collect()
}

/// χ₀ … of (1 − (x/2)/sinh(x/2))/x: 1/24, −7/5760, … by division of series.
fn series(count: usize) -> Vec<f64> {
    // sinh(y)/y = Σ y^{2k}/(2k+1)!, y = x/2; its reciprocal r has Σ_{j≤k} s_j r_{k−j} = 0.
    let mut sinh = vec![1.0];
    let mut reciprocal = vec![1.0];
    for k in 1..=count {
        let n = 2.0 * k as f64;
        sinh.push(sinh[k - 1] / (4.0 * n * (n + 1.0)));
        let sum: f64 = (1..=k).map(|j| sinh[j] * reciprocal[k - j]).sum();
        reciprocal.push(-sum);
    }
    reciprocal[1..].iter().map(|r| -r).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fifth_and_seventh_are_known_fractions() {
        // Solved by hand: b = (5/288, −1/288)/α and (53521/2370816, −22651/2963520, 12361/11854080)/α.
        let known = [5.0 / 288.0, -1.0 / 288.0];
        for (b, k) in weights(2).iter().zip(known) {
            assert!((b * ALPHA - k).abs() < 1e-17);
        }
        let known = [53_521.0 / 2_370_816.0, -22_651.0 / 2_963_520.0, 12_361.0 / 11_854_080.0];
        for (b, k) in weights(3).iter().zip(known) {
            assert!((b * ALPHA - k).abs() < 1e-17);
        }
        assert!((ALPHA * ALPHA - 7.0 / 40.0).abs() < 1e-16);
    }

    #[test]
    fn each_corrects_to_its_order() {
        // What is left of x·Σ 4bᵢ sinh(aᵢx) = 1 − (x/2)/sinh(x/2) goes with x to the order plus one.
        for corrector in Corrector::ALL.into_iter().skip(1) {
            let left = |x: f64| {
                let sum: f64 = corrector.stages().iter().map(|(a, b)| 4.0 * b * libm::sinh(a * x)).sum();
                (x * sum - 1.0 + 0.5 * x / libm::sinh(0.5 * x)).abs()
            };
            let x = [0.0, 0.05, 0.1, 0.2, 0.4, 0.8][corrector as usize];
            let slope = libm::log2(left(2.0 * x) / left(x));
            let expected = f64::from(corrector.order() + 1).min(2.0 * corrector.stages().len() as f64 + 2.0);
            assert!((slope - expected).abs() < 0.5, "{corrector:?}: {slope} of {expected}");
        }
    }
}
