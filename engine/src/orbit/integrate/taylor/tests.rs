//! Taylor against closed forms.

use super::*;
use crate::orbit::{State, kepler};
use crate::space::{Centred, Position, Velocity};

#[test]
fn an_eccentric_orbit_is_kepler_s() {
    let (e, mu) = (0.9_f64, 1.0);
    let start =
        State::<Centred> { position: Position::xyz(1.0 + e, 0.0, 0.0), velocity: Velocity::xyz(0.0, ((1.0 - e) / (1.0 + e)).sqrt(), 0.0) };
    let mut points = Points { t: 0.0, q: vec![DVec3::ZERO, start.position.0], v: vec![DVec3::ZERO, start.velocity.0] };
    let mut taylor = Taylor::new(&[mu, 0.0], 1e-18);
    taylor.run(&mut points, 10.0).unwrap();
    let truth = kepler::propagate(mu, &start, 10.0).position.0;
    assert!((points.q[1] - truth).length() < 2e-14, "{}", points.q[1] - truth);
}
