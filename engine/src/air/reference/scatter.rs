//! Scattering directions drawn from phase functions, each by the inverse of its cumulative distribution.
//!
//! With a uniform `u`, cos θ = C⁻¹(u), C(μ) = 2π ∫₋₁^μ p / ∫p. Closed forms where they exist; Newton's steps held in a bracket elsewhere.

use crate::air::medium::Phase;
use crate::air::medium::phase::Piece;
use core::f64::consts::PI;
use glam::DVec3;

/// A phase function made ready.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// The phase function.
    pub phase: Phase,
    integral: f64,
    pieces: Vec<Piece>,
    /// Light up to the end of each piece of a table, over all.
    ends: Vec<f64>,
}

impl Scatter {
    /// Prepares a phase function.
    pub fn new(phase: &Phase) -> Self {
        let pieces = phase.pieces();
        let integral = phase.integral();
        let mut sum = 0.0;
        let ends = pieces
            .iter()
            .map(|p| {
                sum += p.integral();
                sum / integral
            })
            .collect();
        Self { phase: phase.clone(), integral, pieces, ends }
    }

    /// Density of [`Scatter::draw`] at a cosine, sr⁻¹.
    pub fn density(&self, cos_theta: f64) -> f64 {
        if self.integral > 0.0 { self.phase.value(cos_theta) / self.integral } else { 0.0 }
    }

    /// Cosine of a scattering angle, from a uniform number.
    pub fn draw(&self, u: f64) -> f64 {
        let mu = match &self.phase {
            Phase::Isotropic => 2.0 * u - 1.0,
            Phase::Rayleigh => rayleigh(u),
            // C = (0.98 (1+μ) − 0.175 (1−μ²)) / 1.96, a quadratic in 1+μ: 0.175 x² + 0.63 x − 1.96 u = 0.
            Phase::ElekRayleigh => 2.0 * 1.96 * u / (0.63 + (0.63 * 0.63 + 4.0 * 0.175 * 1.96 * u).sqrt()) - 1.0,
            Phase::HenyeyGreenstein { g } => henyey_greenstein(f64::from(*g), u),
            Phase::CornetteShanks { g } => cornette_shanks(f64::from(*g), u),
            Phase::Table { .. } => self.tabulated(u),
        };
        mu.clamp(-1.0, 1.0)
    }

    fn tabulated(&self, u: f64) -> f64 {
        // Pieces run from θ = 0, where cos θ is largest.
        let u = 1.0 - u;
        let at = self.ends.partition_point(|end| *end <= u).min(self.pieces.len().saturating_sub(1));
        let Some(piece) = self.pieces.get(at) else { return 2.0 * u - 1.0 };
        let before = at.checked_sub(1).and_then(|i| self.ends.get(i)).copied().unwrap_or(0.0);
        let wanted = (u - before) * self.integral;
        let slope = |t: f64| 2.0 * PI * piece.value(t) * libm::sin(t);
        libm::cos(invert(|t| piece.integral_to(t) - wanted, slope, (piece.from.0, piece.to.0)))
    }
}

/// μ of (1+μ²)3/8 [Frisvad 2011, "Importance sampling the Rayleigh phase function", eq. 7].
fn rayleigh(u: f64) -> f64 {
    let a = 4.0 * u - 2.0;
    let b = libm::cbrt(a + (a * a + 1.0).sqrt());
    b - 1.0 / b
}

/// ((1+g²) − ((1−g²)/(1+gx))²)/2g with x = 2u − 1 [Witt 1977, eq. 19], with the division by g carried out.
fn henyey_greenstein(g: f64, u: f64) -> f64 {
    let x = 2.0 * u - 1.0;
    let t = 1.0 + g * x;
    (2.0 * x + g * (3.0 + x * x) + 2.0 * g * g * x + g * g * g * (x * x - 1.0)) / (2.0 * t * t)
}

/// Newton's steps on the closed antiderivative of (1+μ²)(1+g²−2gμ)^(−3/2).
fn cornette_shanks(g: f64, u: f64) -> f64 {
    if g.abs() < 3e-3 {
        return rayleigh(u);
    }
    let (a, b) = (1.0 + g * g, 2.0 * g);
    let antiderivative = |mu: f64| {
        let t = (a - b * mu).max(0.0);
        let root = t.sqrt();
        (2.0 * (a * a + b * b) / root + 4.0 * a * root - 2.0 / 3.0 * t * root) / (b * b * b)
    };
    let scale = 0.75 * (1.0 - g * g) / (2.0 + g * g);
    let low = antiderivative(-1.0);
    let wanted = u / scale + low;
    let slope = |mu: f64| {
        let t = (a - b * mu).max(1e-12);
        (1.0 + mu * mu) / (t * t.sqrt())
    };
    invert(|mu| antiderivative(mu) - wanted, slope, (-1.0, 1.0))
}

/// Root of a rising function in a bracket: Newton where it stays inside, bisection elsewhere.
fn invert(f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, bracket: (f64, f64)) -> f64 {
    let (mut low, mut high) = bracket;
    let mut x = 0.5 * (low + high);
    for _ in 0..80 {
        let y = f(x);
        if y > 0.0 {
            high = x
        } else {
            low = x
        }
        let next = x - y / slope(x);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - x).abs() < 1e-13 {
            return next;
        }
        x = next;
    }
    x
}

/// A unit vector at the angle with this cosine from `axis`, turned around it by a fraction of a whole turn.
pub fn turn(axis: DVec3, cos_theta: f64, fraction: f64) -> DVec3 {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(2.0 * PI * fraction);
    let (u, v) = axis.any_orthonormal_pair();
    (axis * cos_theta + (u * cos + v * sin) * sin_theta).normalize_or(axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_has_the_density_that_is_stated() {
        let table = Phase::Table { angle_deg: vec![0.0, 5.0, 60.0, 180.0], value: vec![40.0, 3.0, 0.2, 0.7] }.normalised();
        let g = |g| Phase::HenyeyGreenstein { g };
        let cs = |g| Phase::CornetteShanks { g };
        let all = [Phase::Isotropic, Phase::Rayleigh, Phase::ElekRayleigh, g(0.8), g(-0.5), g(1e-6), cs(0.8), cs(-0.6), cs(0.01), table];
        for phase in all {
            let scatter = Scatter::new(&phase);
            // The cumulative distribution at what is drawn for u is u.
            for u in [0.001, 0.1, 0.37, 0.5, 0.8, 0.99] {
                let mu = scatter.draw(u);
                let n = 200_000;
                let h = (mu + 1.0) / f64::from(n);
                let below: f64 = (0..n).map(|i| scatter.density(-1.0 + (f64::from(i) + 0.5) * h)).sum::<f64>() * h * 2.0 * PI;
                assert!((below - u).abs() < 2e-5, "{phase:?}: {below} instead of {u}");
            }
        }
    }

    #[test]
    fn sharp_peaks_are_drawn_within_bounds() {
        for g in [0.99_f32, -0.99] {
            for phase in [Phase::HenyeyGreenstein { g }, Phase::CornetteShanks { g }] {
                let scatter = Scatter::new(&phase);
                let n = 20_000;
                let mean: f64 = (0..n).map(|i| scatter.draw((f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n);
                let asymmetry = phase.legendre(1)[1];
                assert!((mean - asymmetry).abs() < 1e-4, "{phase:?}: {mean} and {asymmetry}");
            }
        }
    }

    #[test]
    fn turning_keeps_the_angle() {
        let axis = DVec3::new(0.36, -0.48, 0.8);
        for c in [-1.0, -0.3, 0.0, 0.9, 1.0] {
            let d = turn(axis, c, 0.3);
            assert!((d.length() - 1.0).abs() < 1e-12 && (d.dot(axis) - c).abs() < 1e-12);
        }
    }
}
