//! An orbit in units of its own, and the state on it after a time.
//!
//! Lengths, speeds and times are divided by powers of two, which is exact: the solver then sees numbers about 1 whatever the
//! units of the caller, and nothing over- or underflows on the way that does not in the result.

use super::super::State;
use super::guess::Pericentre;
use super::orbit::Orbit;
use super::pair::Pair;
use crate::space::{Frame, Position, Velocity};
use glam::DVec3;

/// An orbit with what does not depend on time worked out: cheaper than [`super::propagate`] when sampled often, and the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    scaled: Scaled,
    /// The period in scaled units.
    turn: Pair,
    pericentre: Pericentre,
}

/// A start, and the orbit from it in scaled units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scaled {
    gm: f64,
    start: (DVec3, DVec3),
    scale: Scale,
    pub(super) orbit: Orbit,
}

/// Powers of two that lengths and speeds are divided by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    length: i32,
    speed: i32,
    /// Whether there is a centre to bend towards.
    pub(super) bends: bool,
    /// Whether one factor does for each quantity.
    pub(super) tame: bool,
}

/// The factors of a tame [`Scale`], from the caller's units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    pub(super) gm: f64,
    pub(super) length: f64,
    pub(super) speed: f64,
    pub(super) time: f64,
}

/// Revolutions beyond which no digit of the phase is left.
pub(super) const MOST_TURNS: f64 = 2e15;

/// Scaled time beyond which an open path is taken as straight: its square of distance still fits an f64.
pub(super) const LONGEST: f64 = 1e140;

/// Scaled gravitational parameter below which it bends nothing that an f64 could tell.
pub(super) const LEAST: f64 = 1e-60;

/// The power of two at or below |x|, −1023 for what is smaller than a normal number.
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// 2ᵏ, −1022 ≤ k ≤ 1023.
fn power_of_two(k: i32) -> f64 {
    f64::from_bits(u64::from((k + 1023).cast_unsigned()) << 52)
}

/// x 2ᵏ for any k that two states can need.
fn times_power<T: core::ops::Mul<f64, Output = T>>(x: T, k: i32) -> T {
    let a = k.clamp(-1000, 1000);
    let b = (k - a).clamp(-1000, 1000);
    x * power_of_two(a) * power_of_two(b) * power_of_two((k - a - b).clamp(-1000, 1000))
}

impl Scale {
    #[inline(always)]
    pub(super) fn of(gm: f64, r0: DVec3, v0: DVec3) -> Self {
        let (largest, fastest) = (r0.abs().max_element(), v0.abs().max_element());
        let length = exponent(largest);
        let speed = exponent(fastest).max((exponent(gm) - length) >> 1);
        let tame = (length.abs() < 300) & (speed.abs() < 300);
        let bends = (gm > 0.0) & (gm < f64::INFINITY) & (largest > 0.0) & r0.is_finite() & v0.is_finite();
        Self { length, speed, bends, tame }
    }

    /// Without meaning where it is not tame.
    #[inline(always)]
    pub(super) fn factors(self) -> Factors {
        let (length, speed) = (power_of_two(-self.length), power_of_two(-self.speed));
        Factors { gm: length * speed * speed, length, speed, time: power_of_two(self.speed - self.length) }
    }

    /// Back to the caller's units.
    #[inline(always)]
    pub(super) fn undo(self, r: DVec3, v: DVec3) -> (DVec3, DVec3) {
        if self.tame {
            (r * power_of_two(self.length), v * power_of_two(self.speed))
        } else {
            (times_power(r, self.length), times_power(v, self.speed))
        }
    }
}

impl Scaled {
    #[inline(always)]
    pub(super) fn new(gm: f64, r0: DVec3, v0: DVec3) -> Self {
        let scale = Scale::of(gm, r0, v0);
        let Scale { length, speed, .. } = scale;
        let orbit = if scale.tame {
            let k = scale.factors();
            Orbit::new(gm * k.gm, (r0 * k.length).to_array(), (v0 * k.speed).to_array())
        } else {
            let (r, v) = (times_power(r0, -length), times_power(v0, -speed));
            Orbit::new(times_power(gm, -length - 2 * speed), r.to_array(), v.to_array())
        };
        Self { gm, start: (r0, v0), scale, orbit }
    }

    /// The state after `dt_s`; the scaled period and the pericentre are asked for where they are needed.
    #[inline(always)]
    pub(super) fn after(&self, dt_s: f64, turn: impl FnOnce() -> Pair, pericentre: impl FnOnce() -> Pericentre) -> (DVec3, DVec3) {
        if !(self.scale.bends && dt_s.is_finite()) || dt_s == 0.0 {
            return self.straight(dt_s);
        }
        let k = self.scale.speed - self.scale.length;
        let dt = if self.scale.tame { dt_s * power_of_two(k) } else { times_power(dt_s, k) };
        let dt = dt.clamp(-1e300, 1e300);
        let period = self.orbit.period;
        let dt = if dt.abs() > MOST_TURNS * period { libm::remainder(dt, period) } else { dt };
        if !(dt.abs() <= LONGEST && self.orbit.mu.hi > LEAST) {
            return self.beyond(dt, dt_s, pericentre());
        }
        let dt = self.orbit.reduced(dt, turn);
        let (r, v) = self.orbit.after(dt, pericentre);
        self.scale.undo(DVec3::from_array(r), DVec3::from_array(v))
    }

    /// After a time in which any path that bends no more has become straight, or without a centre worth the name.
    #[cold]
    fn beyond(&self, dt: f64, dt_s: f64, pericentre: Pericentre) -> (DVec3, DVec3) {
        if self.orbit.mu.hi <= LEAST {
            return self.straight(dt_s);
        }
        let bent = LONGEST.copysign(dt);
        let (r, v) = self.orbit.after((bent, 0.0), || pericentre);
        let (r, v) = (DVec3::from_array(r), DVec3::from_array(v));
        self.scale.undo(r + v * (dt - bent), v)
    }

    #[cold]
    fn straight(&self, dt_s: f64) -> (DVec3, DVec3) {
        let (r0, v0) = self.start;
        if dt_s == 0.0 { (r0, v0) } else { (r0 + v0 * dt_s, v0) }
    }
}

impl Conic {
    /// The orbit through `r0` (m) with velocity `v0` (m/s) about the origin.
    pub fn new(gm: f64, r0: DVec3, v0: DVec3) -> Self {
        let scaled = Scaled::new(gm, r0, v0);
        Self { scaled, turn: scaled.orbit.turn(), pericentre: scaled.orbit.pericentre() }
    }

    /// Period, s; infinite on open orbits.
    pub fn period_s(&self) -> f64 {
        let period = self.scaled.orbit.period;
        if period.is_finite() { times_power(self.turn.value(), self.scaled.scale.length - self.scaled.scale.speed) } else { f64::INFINITY }
    }

    /// Gravitational parameter, m³/s².
    pub fn gm(&self) -> f64 {
        self.scaled.gm
    }

    /// The state `dt_s` seconds later (or earlier).
    pub fn after<F: Frame>(&self, dt_s: f64) -> State<F> {
        let (r, v) = self.after_raw(dt_s);
        State { position: Position::new(r), velocity: Velocity::new(v) }
    }

    /// As [`Conic::after`], for callers that keep their own frame.
    pub fn after_raw(&self, dt_s: f64) -> (DVec3, DVec3) {
        self.scaled.after(dt_s, || self.turn, || self.pericentre)
    }
}
