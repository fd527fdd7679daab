//! Forward peaks: the light that a class of layers turns by so little that the further orders of scattering count it as not turned at all.
//!
//! A phase function's peak is cut off level where it stands [`EDGE`] from its middle [Potter 1970, "The Delta Function Approximation in
//! Radiative Transfer Theory"]; what was above, the share f, goes straight on. What is left is smooth enough for few directions, and is exact outside of the peak. Sunlight with what peaks left going straight on is the *beam*; what part of it has
//! been turned is scattered by a phase function that both turnings have blurred: the *aureole's* [after Nakajima & Tanaka 1988, JQSRT 40].

use crate::air::Phase;
use crate::air::medium::Class;
use crate::space::relative::narrow;
use core::f64::consts::PI;

/// Half width of a peak that is cut off, rad.
pub(super) const EDGE: f64 = 0.15;
/// A smaller share is left where it is.
const LEAST: f64 = 0.01;
/// Degree at which the series of a blurred phase function ends: twice blurred, a peak 0.01 rad wide is below 1e-2 there.
const BLURRED_DEGREE: usize = 320;

/// A class of layers without its forward peak.
#[derive(Clone, Debug, PartialEq)]
pub struct Truncated {
    /// Share f that goes straight on.
    pub share: f64,
    /// Value at which the phase function is cut off, sr⁻¹.
    pub cap: f64,
    /// Mean cosine of the angle by which the peak turns light.
    pub cosine: f64,
    /// Integral of what is left.
    pub left: f64,
}

impl Truncated {
    /// Of a class.
    pub fn new(class: &Class) -> Self {
        let whole: f64 = class.phases.iter().map(|(share, phase)| share * phase.integral()).sum();
        let edge = class.value(libm::cos(EDGE));
        let (mut share, mut cosine) = (0.0, 0.0);
        // Midpoints, by cubes of even parts: the sharpest peak is 0.01 rad wide.
        let parts = 128;
        for i in 0..parts {
            let x = (f64::from(i) + 0.5) / f64::from(parts);
            let (sin, mu) = libm::sincos(EDGE * x * x * x);
            let light = (class.value(mu) - edge).max(0.0) * 2.0 * PI * sin * EDGE * 3.0 * x * x / f64::from(parts);
            share += light;
            cosine += light * mu;
        }
        if share < LEAST {
            return Self { share: 0.0, cap: 1e30, cosine: 1.0, left: whole };
        }
        Self { share: share.min(0.999 * whole), cap: edge, cosine: cosine / share, left: (whole - share).max(0.001 * whole) }
    }

    /// The aureole's phase function at angles (rad), sr⁻¹, of any class: blurred by the peak, `Σ (2l+1)/4π χ_l κ_l P_l` with χ the
    /// coefficients of the whole and κ those of the peak.
    pub fn blurred(&self, class: &Class, angles: &[f64]) -> Vec<f64> {
        let mu = || angles.iter().map(|a| libm::cos(*a));
        if self.share == 0.0 {
            return mu().map(|mu| class.value(mu)).collect();
        }
        let whole = class.legendre(BLURRED_DEGREE);
        let mut peak = vec![0.0; whole.len()];
        let parts = 512;
        for i in 0..parts {
            let x = (f64::from(i) + 0.5) / f64::from(parts);
            let (sin, mu) = libm::sincos(EDGE * x * x);
            let light = (class.value(mu) - self.cap).max(0.0) * sin * x;
            peak.iter_mut().zip(polynomials(mu)).for_each(|(sum, p)| *sum += light * p);
        }
        let factors: Vec<f64> = whole
            .iter()
            .zip(&peak)
            .zip(0_u32..)
            .map(|((chi, kappa), l)| f64::from(2 * l + 1) / (4.0 * PI) * chi * kappa / peak[0])
            .collect();
        mu().map(|mu| factors.iter().zip(polynomials(mu)).map(|(f, p)| f * p).sum::<f64>().max(0.0)).collect()
    }

    /// The aureole's phase function, where the class has a formula: turned twice, the lobe of g is that of g times the peak's mean cosine.
    pub fn aureole(&self, phase: &Phase) -> Phase {
        match phase {
            Phase::HenyeyGreenstein { g } => Phase::HenyeyGreenstein { g: narrow(f64::from(*g) * self.cosine) },
            Phase::CornetteShanks { g } => Phase::CornetteShanks { g: narrow(f64::from(*g) * self.cosine) },
            other => other.clone(),
        }
    }
}

/// Legendre polynomials P_0, P_1 … at a cosine.
fn polynomials(mu: f64) -> impl Iterator<Item = f64> {
    let (mut degree, mut last, mut here) = (0.0, 0.0, 1.0);
    core::iter::from_fn(move || {
        let value = here;
        (last, here) = (here, ((2.0 * degree + 1.0) * mu * here - degree * last) / (degree + 1.0));
        degree += 1.0;
        Some(value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn class(phase: Phase) -> Class {
        Class { phases: vec![(1.0, phase)], layers: vec![0] }
    }

    #[test]
    fn only_peaks_are_cut_and_no_light_is_lost() {
        for phase in [Phase::Rayleigh, Phase::Isotropic, Phase::HenyeyGreenstein { g: -0.9 }, Phase::HenyeyGreenstein { g: 0.2 }] {
            let all = Truncated::new(&class(phase.clone()));
            assert!(all.share == 0.0 && (all.left - 1.0).abs() < 1e-9, "{phase:?}");
        }
        let mut shares = Vec::new();
        for phase in [Phase::HenyeyGreenstein { g: 0.8 }, Phase::CornetteShanks { g: 0.9 }, Phase::HenyeyGreenstein { g: 0.99 }] {
            let cut = Truncated::new(&class(phase.clone()));
            // The integral of what is left, by brute force.
            let n = 100_000;
            let left: f64 = (0..n)
                .map(|i| {
                    let (sin, mu) = libm::sincos((f64::from(i) + 0.5) / f64::from(n) * PI);
                    phase.value(mu).min(cut.cap) * 2.0 * PI * sin * PI / f64::from(n)
                })
                .sum();
            assert!((left - cut.left).abs() < 2e-4, "{phase:?}: {left} {}", cut.left);
            shares.push(cut.share);
        }
        assert!(shares.windows(2).all(|w| w[0] < w[1]) && shares[0] > 0.015 && shares[2] < 1.0, "{shares:?}");
    }

    #[test]
    fn a_blurred_lobe_is_about_that_of_its_formula_and_keeps_the_light() {
        let phase = Phase::HenyeyGreenstein { g: 0.9 };
        let class = class(phase.clone());
        let cut = Truncated::new(&class);
        let n = 2000;
        let angles: Vec<f64> = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n) * PI).collect();
        let blurred = cut.blurred(&class, &angles);
        let sum: f64 = blurred.iter().zip(&angles).map(|(v, a)| v * 2.0 * PI * libm::sin(*a) * PI / f64::from(n)).sum();
        assert!((sum - 1.0).abs() < 2e-3, "{sum}");
        // In the middle by two fifths, far off hardly: light that the peak turned has gone on as before.
        let ratio = |i: usize| blurred[i] / phase.value(libm::cos(angles[i]));
        assert!(ratio(0) < 0.7 && ratio(0) > 0.5 && (ratio(600) - 1.0).abs() < 0.03, "{} {}", ratio(0), ratio(600));
        let isotropic = Class { phases: vec![(1.0, Phase::Isotropic)], layers: vec![0] };
        let same = Truncated::new(&isotropic).blurred(&isotropic, &angles);
        assert!(same.iter().all(|v| (v * 4.0 * PI - 1.0).abs() < 1e-6));
    }
}
