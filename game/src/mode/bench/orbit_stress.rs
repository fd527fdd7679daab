//! `syzygy bench orbit --stress`: what breaks integrators, as lines of one number each, held against a bound.
//!
//! Long spans (energy may wander as √t and no faster), steps that must shrink by 1e5, systems of odd scale, passes close to a centre,
//! eccentricities next to 1. Truth is Kepler's closed form, or a symmetry. Not here: work against precision (`orbit`).

use super::orbit_case::{self, Case};
use super::orbit_method::{Masses, Method, Setting};
use engine::orbit::integrate::gauss_radau::GaussRadau;
use engine::orbit::integrate::{Points, Step};
use engine::orbit::kepler::Conic;
use glam::DVec3;
use serde::Serialize;

/// One line.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// What was done.
    pub name: String,
    /// By which method.
    pub method: String,
    /// What was measured.
    pub measured: &'static str,
    /// How much it is.
    pub value: f64,
    /// How much it may be.
    pub bound: f64,
    /// True where it is no more.
    pub holds: bool,
}

fn line(name: impl Into<String>, method: &str, measured: &'static str, value: f64, bound: f64) -> Line {
    Line { name: name.into(), method: method.to_owned(), measured, value, bound, holds: value <= bound }
}

/// All lines. Some seconds each.
pub fn run() -> Vec<Line> {
    let mut lines = Vec::new();
    lines.extend(millennium());
    lines.push(spikes());
    lines.extend(scales());
    lines.push(head_on());
    lines.extend([1e-3, 1e-6, 1e-9, 1e-12].map(eccentric));
    lines
}

/// Sun, Mercury, Venus, the Earth and Moon as one, Mars: the first five of a case of the reference data.
fn inner_system() -> Option<Case> {
    let mut case = orbit_case::reference("SS9_100yr").ok()?;
    case.gm.truncate(5);
    case.bodies.truncate(5);
    case.start.q.truncate(5);
    case.start.v.truncate(5);
    case.end = None;
    Some(case)
}

/// A thousand years of the inner system, from four starts that differ by a turn of the axes (other roundings, the same motion): the slope
/// of log|ΔE| against log t over the last two decades, and |ΔE| itself. A drift has slope 1, a walk ½.
fn millennium() -> Vec<Line> {
    let Some(case) = inner_system() else { return Vec::new() };
    let marks: Vec<f64> = (0..=12).map(|k| 10.0 * libm::exp10(f64::from(k) / 6.0)).collect();
    let mut squares = vec![0.0; marks.len()];
    let turns = [0.0, 0.7, 1.9, 2.6];
    for turn in turns {
        let (sin, cos) = libm::sincos(turn);
        let turned = |p: &DVec3| DVec3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
        let mut points = Points { t: 0.0, q: case.start.q.iter().map(turned).collect(), v: case.start.v.iter().map(turned).collect() };
        let before = case.energy(&points);
        let mut method = GaussRadau::new(case.gm.len(), GaussRadau::TOLERANCE);
        let force = Masses { gm: &case.gm };
        for (mark, square) in marks.iter().zip(&mut squares) {
            // The largest error since the last mark: energy at one moment may be right by chance.
            let mut worst = 0.0_f64;
            let mut steps = 0_u32;
            while method.step(&force, &mut points, mark * 365.25) == Step::Made {
                steps += 1;
                if steps.is_multiple_of(16) {
                    worst = worst.max((case.energy(&points) / before - 1.0).abs());
                }
            }
            *square += worst * worst / turns.len() as f64;
        }
    }
    let logs: Vec<(f64, f64)> = marks.iter().zip(&squares).map(|(t, s)| (libm::log(*t), 0.5 * libm::log(s.max(1e-40)))).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let slope = logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / logs.iter().map(|p| (p.0 - mx) * (p.0 - mx)).sum::<f64>();
    let last = squares.last().map_or(f64::NAN, |s| s.sqrt());
    vec![
        line("inner system, 1000 years", "gauss_radau", "slope of log energy error by log time", slope, 0.6),
        line("inner system, 1000 years", "gauss_radau", "relative energy error", last, 1e-14),
    ]
}

fn pair(e_less: f64) -> (Vec<f64>, Points) {
    // From the apocentre of an orbit of semi-major axis 1, where 1 − e can be told exactly.
    let e = 1.0 - e_less;
    let points = Points {
        t: 0.0,
        q: vec![DVec3::ZERO, DVec3::new(-1.0 - e, 0.0, 0.0)],
        v: vec![DVec3::ZERO, DVec3::new(0.0, -(e_less / (1.0 + e)).sqrt(), 0.0)],
    };
    (vec![1.0, 0.0], points)
}

/// Steps that shrink and grow by 1e5 and more within a revolution, ten times over: what that does to the energy.
fn spikes() -> Line {
    let (gm, mut points) = pair(2e-4);
    let energy = |p: &Points| 0.5 * p.v[1].length_squared() - 1.0 / p.q[1].length();
    let before = energy(&points);
    let mut method = GaussRadau::new(2, GaussRadau::TOLERANCE);
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
    let end = 10.0 * core::f64::consts::TAU;
    loop {
        let from = points.t;
        if method.step(&Masses { gm: &gm }, &mut points, end) != Step::Made {
            break;
        }
        let dt = points.t - from;
        // The last is cut to fit.
        if points.t < end {
            (shortest, longest) = (shortest.min(dt), longest.max(dt));
        }
    }
    let name = format!("steps from 1 to {:.0e} and back, ten times", longest / shortest);
    line(name, "gauss_radau", "relative energy error", (energy(&points) / before - 1.0).abs(), 1e-10)
}

/// The reference system at a millionth and at a million times its size, in steps of powers of ten that are no powers of two: the same
/// path, but for rounding.
fn scales() -> Vec<Line> {
    let Ok(case) = orbit_case::reference("SS9_100yr") else { return Vec::new() };
    let end = 3652.5;
    let mut lines = Vec::new();
    let wisdom = Method::find("wisdom_holman_c7").ok().map(|m| (m, Setting::Step(2.0)));
    let pair = Method::find("dormand_prince8").ok().map(|m| (m, Setting::Tolerance(1e-13)));
    for (method, setting) in [Some((Method::GaussRadau, Setting::Tolerance(1e-9))), wisdom, pair].into_iter().flatten() {
        let reach = |scale: f64| {
            let gm: Vec<f64> = case.gm.iter().map(|gm| gm * scale * scale * scale).collect();
            let all = |list: &[DVec3]| list.iter().map(|x| *x * scale).collect();
            let mut points = Points { t: 0.0, q: all(&case.start.q), v: all(&case.start.v) };
            method.run(&gm, &mut points, setting, end);
            points.q.iter().map(|q| *q / scale).collect::<Vec<_>>()
        };
        let plain = reach(1.0);
        for scale in [1e-6, 1e6] {
            let miss = reach(scale).iter().zip(&plain).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
            lines.push(line(
                format!("nine bodies, ten years, lengths × {scale:e}"),
                &method.name(),
                "difference of places, AU",
                miss,
                1e-10,
            ));
        }
    }
    lines
}

/// A comet straight at the Earth's centre but for an impact parameter that lets it pass 1 km above the ground, from the Moon's distance
/// and out again.
fn head_on() -> Line {
    let (gm, r0, speed) = (3.986_004_355_07e14, 3.844e8, 11_000.0_f64);
    let pericentre: f64 = 6_371_000.0 + 1000.0;
    // Angular momentum from energy: v_p² = v₀² + 2μ(1/r_p − 1/r₀), h = r_p v_p.
    let across = pericentre * (speed * speed + 2.0 * gm * (1.0 / pericentre - 1.0 / r0)).sqrt() / r0;
    let along = -(speed * speed - across * across).sqrt();
    let start = Points { t: 0.0, q: vec![DVec3::ZERO, DVec3::X * r0], v: vec![DVec3::ZERO, DVec3::new(along, across, 0.0)] };
    let (mut points, span) = (start.clone(), 60_000.0);
    let mut method = GaussRadau::new(2, GaussRadau::TOLERANCE);
    method.run(&Masses { gm: &[gm, 0.0] }, &mut points, span);
    let truth = Conic::new(gm, start.q[1], start.v[1]).after_raw(span).0;
    line("head-on at the Earth, passing 1 km above the ground", "gauss_radau", "error of place, m", (points.q[1] - truth).length(), 1e-3)
}

/// Once around from the apocentre. What an ulp of the start's speed is worth grows as 1/(1 − e): no method can be better than that.
fn eccentric(e_less: f64) -> Line {
    let (gm, start) = pair(e_less);
    let mut points = start.clone();
    // Three quarters of the way: past the pericentre and half out again.
    let span = 0.75 * core::f64::consts::TAU;
    GaussRadau::new(2, GaussRadau::TOLERANCE).run(&Masses { gm: &gm }, &mut points, span);
    let truth = Conic::new(1.0, start.q[1], start.v[1]).after_raw(span).0;
    let miss = if points.t == span { (points.q[1] - truth).length() } else { f64::INFINITY };
    line(format!("once past the pericentre at 1 − e = {e_less:e}"), "gauss_radau", "error of place, semi-major axes", miss, 1e-14 / e_less)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_lines_hold() {
        for line in [spikes(), head_on(), eccentric(1e-3), eccentric(1e-6)].into_iter().chain(scales()) {
            assert!(line.holds, "{line:?}");
        }
    }
}
