//! Explicit Runge–Kutta methods as tables of coefficients, and the one loop that runs them all.
//!
//! For powered flight at the fixed tick: no allocation, no adaptive step, so the same bits always. A coasting ship is not
//! integrated at all: see `path`.
//! - [Hairer, Nørsett & Wanner 1993] "Solving Ordinary Differential Equations I", tables II.1.2 (RK4) and II.5.2 (DOPRI5).

use crate::orbit::State;
use crate::space::{Frame, Position, Vector, Velocity};
use glam::DVec3;

/// Stages that a table may have.
const MAX_STAGES: usize = 7;

/// A Butcher tableau. Row i of `a` holds the weights of the stages before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// Name in reports.
    pub name: &'static str,
    /// Order of convergence.
    pub order: u32,
    /// Weights of earlier stages; as many rows as stages, at most seven.
    pub a: &'static [&'static [f64]],
    /// Weights of the stages in the result.
    pub b: &'static [f64],
    /// When each stage is taken, in steps.
    pub c: &'static [f64],
}

/// The classic fourth-order method of Kutta (1901).
pub const RK4: Table = Table {
    name: "rk4",
    order: 4,
    a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: &[0.0, 0.5, 0.5, 1.0],
};

/// Dormand & Prince (1980), the fifth-order solution; its seventh stage serves only error estimates and is left out.
pub const DOPRI5: Table = Table {
    name: "dopri5",
    order: 5,
    a: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    ],
    b: &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    c: &[0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0],
};

/// The state after one step of `dt_s`. `acceleration(t_s, state)` is in m/s²; `t_s` is the time at the start of the step.
pub fn step<F: Frame>(
    table: &Table,
    t_s: f64,
    state: &State<F>,
    dt_s: f64,
    mut acceleration: impl FnMut(f64, &State<F>) -> Vector<F>,
) -> State<F> {
    let mut rate = [(DVec3::ZERO, DVec3::ZERO); MAX_STAGES];
    let stages = table.b.len().min(MAX_STAGES);
    for i in 0..stages {
        let at = advance(state, dt_s, table.a[i], &rate);
        rate[i] = (at.velocity.0, acceleration(t_s + table.c[i] * dt_s, &at).0);
    }
    advance(state, dt_s, table.b, &rate)
}

fn advance<F: Frame>(state: &State<F>, dt_s: f64, weights: &[f64], rate: &[(DVec3, DVec3); MAX_STAGES]) -> State<F> {
    let (mut dr, mut dv) = (DVec3::ZERO, DVec3::ZERO);
    for (w, (v, a)) in weights.iter().zip(rate) {
        dr += *v * *w;
        dv += *a * *w;
    }
    State { position: Position::new(state.position.0 + dr * dt_s), velocity: Velocity::new(state.velocity.0 + dv * dt_s) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::{gravity, kepler};
    use crate::space::Centred;

    /// Error against Kepler after one revolution of e = 0.3 in `n` steps.
    fn error(table: &Table, n: u32) -> f64 {
        let start = State::<Centred> { position: Position::xyz(1.0, 0.0, 0.0), velocity: Velocity::xyz(0.0, 1.3_f64.sqrt(), 0.0) };
        let span = 8.0;
        let mut s = start;
        for i in 0..n {
            let dt = span / f64::from(n);
            s = step(table, f64::from(i) * dt, &s, dt, |_, s| gravity::point_mass(1.0, s.position));
        }
        (s.position - kepler::propagate(1.0, &start, span).position).length()
    }

    #[test]
    fn each_table_converges_at_its_order() {
        for table in [RK4, DOPRI5] {
            let order = libm::log2(error(&table, 200) / error(&table, 400));
            assert!((order - f64::from(table.order)).abs() < 0.35, "{}: measured order {order}", table.name);
        }
    }

    #[test]
    fn rows_of_a_table_add_up_to_its_times() {
        for t in [RK4, DOPRI5] {
            assert!((t.b.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for (row, c) in t.a.iter().zip(t.c) {
                assert!((row.iter().sum::<f64>() - c).abs() < 2e-14, "{}", t.name);
            }
        }
    }

    #[test]
    fn time_reaches_the_acceleration() {
        // a = t: exact for a method of order ≥ 3, r = t³/6.
        let s = step(&RK4, 0.0, &State::<Centred>::default(), 2.0, |t, _| Vector::xyz(t, 0.0, 0.0));
        assert!((s.position.0.x - 8.0 / 6.0).abs() < 1e-15 && (s.velocity.0.x - 2.0).abs() < 1e-15);
    }
}
