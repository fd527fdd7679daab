//! Dense output of any one-step method for y″ = f, by bootstrapping: no coefficients of the method enter.
//!
//! A quintic through positions, velocities and accelerations at both ends is of order 5; accelerations taken on it at three places
//! inside are two orders better than its own second derivative. A polynomial of degree 8 through these and both ends is of order 7
//! [Hairer, Nørsett & Wanner 1993, §II.6]. With h = θ·dt: a(θ) = L(θ) + 2688·(R₂ − R₁θ)·w(θ), where L interpolates the five accelerations at
//! θ = 0, ¼, ½, ¾, 1, w(θ) = θ(θ−¼)(θ−½)(θ−¾)(θ−1), and R₁, R₂ are what ∫L and ∬L miss of the step's velocity and position.

use crate::orbit::integrate::{Force, Points};
use glam::DVec3;

/// Powers of θ in the acceleration's polynomial.
const TERMS: usize = 7;
/// The places inside a step.
const INSIDE: [f64; 3] = [0.25, 0.5, 0.75];
/// w(θ) from θ¹ to θ⁵.
const W: [f64; 5] = [3.0 / 32.0, -25.0 / 32.0, 35.0 / 16.0, -5.0 / 2.0, 1.0];

/// The last step as a polynomial.
#[derive(Clone, Debug, Default)]
pub(super) struct Dense {
    t0: f64,
    dt: f64,
    q0: Vec<DVec3>,
    v0: Vec<DVec3>,
    a0: Vec<DVec3>,
    /// c₀ … c₆ of each point.
    terms: Vec<[DVec3; TERMS]>,
    q: Vec<DVec3>,
    v: Vec<DVec3>,
    inside: [Vec<DVec3>; 3],
}

impl Dense {
    /// Notes where a step of `dt` begins; `a` is flat.
    pub(super) fn start(&mut self, points: &Points, dt: f64, a: &[f64]) {
        (self.t0, self.dt) = (points.t, dt);
        self.q0.clone_from(&points.q);
        self.v0.clone_from(&points.v);
        self.a0.clear();
        self.a0.extend(a.chunks_exact(3).map(DVec3::from_slice));
    }

    /// Fits the polynomial to the end of the step; returns evaluations made.
    #[allow(clippy::needless_range_loop, reason = "i is a point of eight lists")]
    pub(super) fn finish<F: Force>(&mut self, force: &F, points: &Points, a: &[f64]) -> u64 {
        let (n, dt) = (points.q.len(), self.dt);
        self.q.resize(n, DVec3::ZERO);
        self.v.resize(n, DVec3::ZERO);
        self.terms.resize(n, [DVec3::ZERO; TERMS]);
        let end = |i: usize| DVec3::from_slice(&a[3 * i..3 * i + 3]);
        // What velocity and position gain beyond a₀ held fast, as accelerations.
        let gains: Vec<[DVec3; 2]> = (0..n)
            .map(|i| {
                let straight = self.q0[i] + self.v0[i] * dt;
                [(points.v[i] - self.v0[i]) / dt, ((points.q[i] - straight) / dt) / dt]
            })
            .collect();
        for i in 0..n {
            // The quintic: a = a₀ + c₁θ + c₂θ² + c₃θ³ with the ends' velocity, position and acceleration.
            let [v, q] = gains[i].map(|g| g);
            let (v, q, a) = (v - self.a0[i], q - self.a0[i] * 0.5, end(i) - self.a0[i]);
            self.terms[i] = [DVec3::ZERO; TERMS];
            self.terms[i][0] = self.a0[i];
            self.terms[i][1] = q * 60.0 - v * 24.0 + a * 3.0;
            self.terms[i][2] = v * 84.0 - q * 180.0 - a * 12.0;
            self.terms[i][3] = q * 120.0 - v * 60.0 + a * 10.0;
        }
        for (k, theta) in INSIDE.into_iter().enumerate() {
            let (mut q, mut v) = (std::mem::take(&mut self.q), std::mem::take(&mut self.v));
            self.on(theta, &mut q, &mut v);
            self.inside[k].resize(n, DVec3::ZERO);
            force.accelerations(self.t0 + theta * dt, &q, &v, &mut self.inside[k]);
            (self.q, self.v) = (q, v);
        }
        for i in 0..n {
            let [a0, a1, a2, a3, a4] = [self.a0[i], self.inside[0][i], self.inside[1][i], self.inside[2][i], end(i)];
            let mut c = [
                a0,
                (a1 * 16.0 - a0 * (25.0 / 3.0) - a2 * 12.0) + (a3 * (16.0 / 3.0) - a4),
                (a0 * (70.0 / 3.0) - a1 * (208.0 / 3.0)) + (a2 * 76.0 - a3 * (112.0 / 3.0) + a4 * (22.0 / 3.0)),
                (a1 * 96.0 - a0 * (80.0 / 3.0) - a2 * 128.0) + (a3 * (224.0 / 3.0) - a4 * 16.0),
                ((a0 + a4) * (32.0 / 3.0) - (a1 + a3) * (128.0 / 3.0)) + a2 * 64.0,
                DVec3::ZERO,
                DVec3::ZERO,
            ];
            let [v, q] = gains[i];
            // ∫L and ∬L over the step.
            let (mut once, mut twice) = (DVec3::ZERO, DVec3::ZERO);
            let mut k = 5.0;
            for term in c[..5].iter().rev() {
                once += *term / k;
                twice += *term / (k * (k + 1.0));
                k -= 1.0;
            }
            let (r1, r2) = (v - once, q - twice);
            for (k, w) in W.into_iter().enumerate() {
                c[k + 1] += r2 * (2688.0 * w);
                c[k + 2] -= r1 * (2688.0 * w);
            }
            self.terms[i] = c;
        }
        INSIDE.len() as u64
    }

    /// The polynomial at time `t`; false where there is none, or one of another number of points.
    pub(super) fn at(&self, t: f64, q: &mut [DVec3], v: &mut [DVec3]) -> bool {
        if self.dt == 0.0 || self.terms.len() != q.len() || self.terms.len() != v.len() {
            return false;
        }
        self.on((t - self.t0) / self.dt, q, v);
        true
    }

    fn on(&self, theta: f64, q: &mut [DVec3], v: &mut [DVec3]) {
        let time = theta * self.dt;
        for (i, c) in self.terms.iter().enumerate() {
            let (mut once, mut twice) = (DVec3::ZERO, DVec3::ZERO);
            let mut k = 7.0;
            for term in c.iter().rev() {
                once = once * theta + *term / k;
                twice = twice * theta + *term / (k * (k + 1.0));
                k -= 1.0;
            }
            q[i] = self.q0[i] + (self.v0[i] * time + twice * (time * time));
            v[i] = self.v0[i] + once * time;
        }
    }
}
