//! Phase functions: where scattered light goes. `p(cos θ)` in sr⁻¹, θ the angle by which light is turned.
//!
//! Each has its Legendre coefficients `χ_l = 2π ∫ p(μ) P_l(μ) dμ`, so that `p(μ) = (1/4π) Σ (2l+1) χ_l P_l(μ)`: χ₀ is the light kept by
//! one scattering (1 for all but Elek's), χ₁ the asymmetry. The GPU twin is in `shaders/lib/phase.wgsl`.
//!
//! Cornette & Shanks 1992, Applied Optics 31(16). Henyey & Greenstein 1941, ApJ 93. Elek 2008, "Rendering Planetary Atmosphere".

use super::super::RangeError;
use super::profile;
use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

/// Phase function of a layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Phase {
    /// 3/(16π)(1 + cos²θ).
    Rayleigh,
    /// Henyey–Greenstein with asymmetry g.
    HenyeyGreenstein {
        /// Asymmetry, −0.99 to 0.99.
        g: f32,
    },
    /// Cornette–Shanks with parameter g.
    CornetteShanks {
        /// Parameter, −0.99 to 0.99; the mean cosine is a little larger.
        g: f32,
    },
    /// Elek's empirical Rayleigh phase, meant for single scattering alone. As he gives it 2 % of the light is lost: its integral is 0.98.
    ElekRayleigh,
    /// 1/4π.
    Isotropic,
    /// Linear in the angle between points, held outside of them.
    Table {
        /// Scattering angles, degrees, rising within 0 … 180; two or more.
        angle_deg: Vec<f32>,
        /// Relative values; any scale in a file, sr⁻¹ once the medium is built.
        value: Vec<f32>,
    },
}

impl Phase {
    /// Largest |g|.
    pub const MAX_G: f64 = 0.99;

    /// Value at the cosine of the scattering angle, sr⁻¹.
    pub fn value(&self, cos_theta: f64) -> f64 {
        let c2 = cos_theta * cos_theta;
        match self {
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + c2),
            Self::HenyeyGreenstein { g } => henyey_greenstein(f64::from(*g), cos_theta),
            // [Cornette & Shanks 1992, eq. 8]
            Self::CornetteShanks { g } => {
                let g = f64::from(*g);
                henyey_greenstein(g, cos_theta) * 1.5 * (1.0 + c2) / (2.0 + g * g)
            }
            // [Elek 2008, eq. 3.2]; his F is 4π times a phase function.
            Self::ElekRayleigh => 0.7 * (1.4 + 0.5 * cos_theta) / (4.0 * PI),
            Self::Isotropic => 1.0 / (4.0 * PI),
            Self::Table { angle_deg, value } => tabulated(angle_deg, value, libm::acos(cos_theta.clamp(-1.0, 1.0)).to_degrees()),
        }
    }

    /// Integral over the sphere: the part of the light that one scattering keeps.
    pub fn integral(&self) -> f64 {
        match self {
            Self::ElekRayleigh => 0.98,
            Self::Table { .. } => self.pieces().iter().map(Piece::integral).sum(),
            _ => 1.0,
        }
    }

    /// The same with an integral of 1, where it is a table; others are as they are by definition.
    #[must_use]
    pub fn normalised(&self) -> Self {
        let Self::Table { angle_deg, value } = self else { return self.clone() };
        let scale = 1.0 / self.integral();
        let value = value.iter().map(|v| crate::space::relative::narrow(f64::from(*v) * scale)).collect();
        Self::Table { angle_deg: angle_deg.clone(), value }
    }

    /// Legendre coefficients χ₀ … χ_`l_max`; closed forms, and Gauss–Legendre quadrature on each piece of a table.
    pub fn legendre(&self, l_max: usize) -> Vec<f64> {
        let mut chi = vec![0.0; l_max + 1];
        let mut set = |l: usize, x: f64| {
            if let Some(slot) = chi.get_mut(l) {
                *slot = x;
            }
        };
        match self {
            Self::Rayleigh => [(0, 1.0), (2, 0.1)].into_iter().for_each(|(l, x)| set(l, x)),
            Self::ElekRayleigh => [(0, 0.98), (1, 0.35 / 3.0)].into_iter().for_each(|(l, x)| set(l, x)),
            Self::Isotropic => set(0, 1.0),
            Self::HenyeyGreenstein { g } => (0..=l_max).for_each(|l| set(l, power(f64::from(*g), l))),
            Self::CornetteShanks { g } => (0..=l_max).for_each(|l| set(l, cornette_shanks_chi(f64::from(*g), l))),
            Self::Table { .. } => self.pieces().iter().for_each(|p| p.add_legendre(&mut chi)),
        }
        chi
    }

    /// The pieces of a table, none for others: straight lines over [0, π], the held ends among them.
    pub fn pieces(&self) -> Vec<Piece> {
        let Self::Table { angle_deg, value } = self else { return Vec::new() };
        let mut knots: Vec<(f64, f64)> = angle_deg.iter().zip(value).map(|(a, v)| (f64::from(*a).to_radians(), f64::from(*v))).collect();
        let (Some(&(first, low)), Some(&(last, high))) = (knots.first(), knots.last()) else { return Vec::new() };
        if first > 0.0 {
            knots.insert(0, (0.0, low));
        }
        if last < PI {
            knots.push((PI, high));
        }
        let piece = |w: &[(f64, f64)]| Some(Piece { from: *w.first()?, to: *w.last()? });
        knots.windows(2).filter_map(piece).collect()
    }

    /// Adds what is out of range; `key` is the name of this phase function in the file.
    pub(super) fn check(&self, e: &mut Vec<RangeError>, key: &str) {
        match self {
            Self::HenyeyGreenstein { g } | Self::CornetteShanks { g } => {
                // What a file spells 0.99 is a little more in f32.
                RangeError::check(e, &format!("{key}.g"), (f64::from(*g) * 1e6).round() / 1e6, -Self::MAX_G, Self::MAX_G);
            }
            Self::Table { angle_deg, value } => {
                let before = e.len();
                profile::points(e, [(&format!("{key}.angle_deg"), angle_deg), (&format!("{key}.value"), value)], 2);
                let mut least = 0.0;
                for (i, a) in angle_deg.iter().enumerate() {
                    RangeError::check(e, &format!("{key}.angle_deg[{i}]"), f64::from(*a), least, 180.0);
                    least = f64::from(*a) + 1e-6;
                }
                for (i, v) in value.iter().enumerate() {
                    RangeError::check(e, &format!("{key}.value[{i}]"), f64::from(*v), 0.0, 1.0e9);
                }
                let integral = self.integral();
                if e.len() == before && !(1e-12..1e12).contains(&integral) {
                    e.push(RangeError { field: format!("{key}.value"), found: integral, expected: "some value above 0".into() });
                }
            }
            _ => {}
        }
    }
}

/// A straight stretch of a tabulated phase function: (angle in rad, value) at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Where it begins.
    pub from: (f64, f64),
    /// Where it ends.
    pub to: (f64, f64),
}

impl Piece {
    /// Value at an angle, rad.
    pub fn value(&self, theta: f64) -> f64 {
        self.from.1 + (self.to.1 - self.from.1) * (theta - self.from.0) / (self.to.0 - self.from.0)
    }

    /// `2π ∫ p sin θ dθ` from its beginning to an angle: with p = a + bθ the antiderivative is `−p cos θ + b sin θ`.
    pub fn integral_to(&self, theta: f64) -> f64 {
        let slope = (self.to.1 - self.from.1) / (self.to.0 - self.from.0);
        let at = |t: f64| slope * libm::sin(t) - self.value(t) * libm::cos(t);
        2.0 * PI * (at(theta) - at(self.from.0))
    }

    /// The same to its end.
    pub fn integral(&self) -> f64 {
        self.integral_to(self.to.0)
    }

    /// Adds its share of each coefficient: enough short stretches of five Gauss points that P_l turns slowly within one.
    fn add_legendre(&self, chi: &mut [f64]) {
        const NODE: [f64; 5] = [-0.906_179_845_938_664, -0.538_469_310_105_683_1, 0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        const WEIGHT: [f64; 5] = [
            0.236_926_885_056_189_08,
            0.478_628_670_499_366_47,
            0.568_888_888_888_888_9,
            0.478_628_670_499_366_47,
            0.236_926_885_056_189_08,
        ];
        let width = self.to.0 - self.from.0;
        let stretches = (width * chi.len() as f64).ceil().max(1.0);
        let h = width / stretches;
        let mut k = 0.0;
        while k < stretches {
            for (node, weight) in NODE.iter().zip(WEIGHT) {
                let theta = self.from.0 + (k + 0.5 + 0.5 * node) * h;
                let (sin, mu) = libm::sincos(theta);
                let w = PI * h * weight * sin * self.value(theta);
                // P_{l+1} = ((2l+1) μ P_l − l P_{l−1}) / (l+1)
                let (mut last, mut p, mut l) = (0.0, 1.0, 0.0);
                for slot in chi.iter_mut() {
                    *slot += w * p;
                    (last, p) = (p, ((2.0 * l + 1.0) * mu * p - l * last) / (l + 1.0));
                    l += 1.0;
                }
            }
            k += 1.0;
        }
    }
}

/// [Henyey & Greenstein 1941, eq. 2] as a phase function, sr⁻¹.
fn henyey_greenstein(g: f64, cos_theta: f64) -> f64 {
    // (1 − g)² + 2g(1 − cos θ): nothing cancels near the forward peak.
    let d =
        if g >= 0.0 { (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos_theta) } else { (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cos_theta) };
    (1.0 - g * g) / (4.0 * PI * d * d.sqrt())
}

/// `g^l`, 0⁰ being 1.
fn power(g: f64, l: usize) -> f64 {
    (0..l).fold(1.0, |x, _| x * g)
}

/// χ_l of Cornette–Shanks: that of Henyey–Greenstein (g^l) times `1.5 (1 + μ²)/(2 + g²)`, by `μ P_l = ((l+1) P_{l+1} + l P_{l−1})/(2l+1)` twice.
fn cornette_shanks_chi(g: f64, l: usize) -> f64 {
    let x = l as f64;
    let up = (x + 1.0) * (x + 2.0) / ((2.0 * x + 1.0) * (2.0 * x + 3.0));
    let same = (x + 1.0) * (x + 1.0) / ((2.0 * x + 1.0) * (2.0 * x + 3.0)) + x * x / (4.0 * x * x - 1.0);
    let down = x * (x - 1.0) / (4.0 * x * x - 1.0);
    let below = if l >= 2 { down * power(g, l - 2) } else { 0.0 };
    1.5 / (2.0 + g * g) * (power(g, l) * (1.0 + same) + up * power(g, l + 2) + below)
}

/// Linear interpolation in a table of angles, held at the ends.
fn tabulated(angle_deg: &[f32], value: &[f32], at_deg: f64) -> f64 {
    let knot = |i: usize| Some((f64::from(*angle_deg.get(i)?), f64::from(*value.get(i)?)));
    let next = angle_deg.partition_point(|a| f64::from(*a) <= at_deg);
    match (next.checked_sub(1).and_then(knot), knot(next)) {
        (Some((a, from)), Some((b, to))) => from + (to - from) * ((at_deg - a) / (b - a)),
        (Some((_, end)), None) | (None, Some((_, end))) => end,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of Cornette–Shanks at another scale, every half degree.
    fn copy_of_cornette_shanks(g: f32) -> Phase {
        let angle_deg: Vec<f32> = (0_i16..=360).map(|i| 0.5 * f32::from(i)).collect();
        let value = angle_deg.iter().map(|a| 7.0 * Phase::CornetteShanks { g }.value(f64::from(*a).to_radians().cos()) as f32).collect();
        Phase::Table { angle_deg, value }.normalised()
    }

    fn all() -> Vec<Phase> {
        vec![
            Phase::Rayleigh,
            Phase::HenyeyGreenstein { g: 0.8 },
            Phase::HenyeyGreenstein { g: -0.99 },
            Phase::HenyeyGreenstein { g: 0.0 },
            Phase::CornetteShanks { g: 0.8 },
            Phase::CornetteShanks { g: -0.4 },
            Phase::CornetteShanks { g: 0.99 },
            Phase::ElekRayleigh,
            Phase::Isotropic,
            Phase::Table { angle_deg: vec![10.0, 30.0, 170.0], value: vec![5.0, 1.0, 2.0] }.normalised(),
        ]
    }

    /// χ_l by brute force: midpoints in θ.
    fn brute(phase: &Phase, l: usize) -> f64 {
        let n = 400_000;
        let at = |i: i32| {
            let theta = (f64::from(i) + 0.5) / f64::from(n) * PI;
            let mu = theta.cos();
            let (mut last, mut p) = (0.0, 1.0);
            for k in 0..l {
                let k = k as f64;
                (last, p) = (p, ((2.0 * k + 1.0) * mu * p - k * last) / (k + 1.0));
            }
            phase.value(mu) * p * theta.sin()
        };
        (0..n).map(at).sum::<f64>() * 2.0 * PI * PI / f64::from(n)
    }

    #[test]
    fn phase_functions_hold_the_light_that_they_say() {
        for phase in all() {
            let integral = brute(&phase, 0);
            assert!((integral - phase.integral()).abs() < 1e-6, "{phase:?}: {integral}");
            let kept = if phase == Phase::ElekRayleigh { 0.98 } else { 1.0 };
            assert!((integral - kept).abs() < 1e-6, "{phase:?}: {integral}");
        }
    }

    #[test]
    fn legendre_coefficients_are_the_integrals() {
        for phase in all() {
            let chi = phase.legendre(12);
            assert_eq!(chi.len(), 13);
            for l in [0, 1, 2, 3, 5, 12] {
                let truth = brute(&phase, l);
                assert!((chi[l] - truth).abs() < 1e-6, "{phase:?}: χ_{l} = {} not {truth}", chi[l]);
            }
        }
    }

    #[test]
    fn a_table_of_a_known_function_is_that_function() {
        let (table, truth) = (copy_of_cornette_shanks(0.7), Phase::CornetteShanks { g: 0.7 });
        for (mu, allowed) in [(1.0, 2e-4), (0.9, 2e-4), (0.3, 2e-4), (-1.0, 2e-4)] {
            assert!((table.value(mu) / truth.value(mu) - 1.0).abs() < allowed, "{mu}");
        }
        for (l, (a, b)) in table.legendre(40).into_iter().zip(truth.legendre(40)).enumerate() {
            assert!((a - b).abs() < 2e-4, "χ_{l}: {a} and {b}");
        }
    }

    #[test]
    fn the_forward_peak_keeps_its_digits() {
        let sharp = Phase::HenyeyGreenstein { g: 0.99 };
        let g = f64::from(0.99_f32);
        let peak = (1.0 + g) / ((1.0 - g) * (1.0 - g)) / (4.0 * PI);
        assert!((sharp.value(1.0) / peak - 1.0).abs() < 1e-12);
        assert!((Phase::HenyeyGreenstein { g: -0.99 }.value(-1.0) / peak - 1.0).abs() < 1e-12);
    }
}
