//! Search: the moments at which the axis of a shadow passes closest to a receiver near enough to matter. None is stepped over:
//! while the caster stands at an angle from the star, seen from the receiver, no step is longer than that angle, less what an
//! eclipse needs, divided by the greatest rate at which it can close (conservative advancement).
//!
//! Also here: roots of smooth functions of time.

use super::{Cast, Paths, Shadow};
use crate::orbit::field::Reach;
use crate::time::Moment;
use crate::units::SPEED_OF_LIGHT;

/// How fast things can change at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Of the angle between caster and star, seen from the receiver, rad/s.
    pub closing_rad_s: f64,
    /// Of the distances of caster and star from the receiver, m/s.
    pub closing_m_s: f64,
}

/// Half the interval over which a rate is taken, s: the distance of an axis moves by kilometres, known to a millimetre.
const HALF_S: f64 = 2.0;
/// Steps are never shorter, s: an eclipse lasts longer.
const SHORTEST_S: f64 = 20.0;
/// Rounds of a root finder; each gains a digit at least.
const ROUNDS: usize = 60;
/// A root is found when its bracket is this short, s.
const FINE_S: f64 = 1e-5;

impl Pace {
    /// From how far and how fast the caster can be from the receiver, and the star.
    pub fn of(caster: &Reach, star: &Reach) -> Self {
        let rate = |r: &Reach| r.fastest_m_s / r.nearest_m.max(1.0);
        // 3 % for light time and for what a body does beyond its conic.
        Self { closing_rad_s: 1.03 * (rate(caster) + rate(star)), closing_m_s: 1.03 * (caster.fastest_m_s + star.fastest_m_s) }
    }
}

/// Distances of caster and star and the angle between them, from the receiver, geometric (light time moves them by under 1e-4 rad).
fn sight(cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> (f64, f64, f64) {
    let here = paths(cast.receiver.id, t).position;
    let star = (paths(cast.star.id, t).position - here).0;
    let caster = (paths(cast.caster.id, t).position - here).0;
    (caster.length(), star.length(), libm::atan2(caster.cross(star).length(), caster.dot(star)))
}

/// Rate at which the axis and the receiver's centre part, squared: of their distance in solar eclipses, of the angle between them
/// seen from the caster in lunar ones (the canons differ so; by 5 s where the caster goes away and the axis passes far out).
fn approach(cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> f64 {
    let solar = cast.is_solar();
    let aside = |s: f64| {
        let shadow = Shadow::at(cast, paths, t.plus_s(s));
        if solar { shadow.offset } else { shadow.offset / shadow.behind_m.abs().max(1.0) }
    };
    let (before, after) = (aside(-HALF_S), aside(HALF_S));
    (after - before).dot(after + before) / (2.0 * HALF_S)
}

/// Speed of the axis across the receiver, m/s.
pub fn crossing_m_s(cast: &Cast<'_>, paths: &Paths<'_>, t: Moment) -> f64 {
    let before = Shadow::at(cast, paths, t.plus_s(-HALF_S)).offset;
    let after = Shadow::at(cast, paths, t.plus_s(HALF_S)).offset;
    ((after - before).length() / (2.0 * HALF_S)).max(1e-3)
}

/// The first moment in `from ..= to` at which the axis passes closest to the receiver, with the penumbra near; and where to go on.
pub fn closest(cast: &Cast<'_>, paths: &Paths<'_>, pace: Pace, from: Moment, to: Moment) -> Option<(Moment, Moment)> {
    let mut t = from;
    let closing = pace.closing_rad_s.max(1e-12);
    while to.since(t) >= 0.0 {
        let (caster_m, star_m, angle) = sight(cast, paths, t);
        // Behind the star, or beside it: nothing before it comes nearer than the star.
        let beyond_s = (caster_m - star_m) / pace.closing_m_s.max(1.0);
        let reach_m = reach_m(cast, caster_m, star_m);
        let apart = (star_m - caster_m).abs().max(1.0);
        // Light time turns the sight by the caster's speed over that of light.
        let sine = reach_m * apart / (caster_m * star_m).max(1.0);
        let needed = libm::asin(sine.min(1.0)) + 1.1 * pace.closing_m_s / SPEED_OF_LIGHT;
        let wait_s = ((angle - needed) / closing).max(beyond_s);
        if wait_s > 0.0 {
            t = t.plus_s(wait_s.max(SHORTEST_S));
            continue;
        }
        let step = (0.15 * reach_m / crossing_m_s(cast, paths, t)).max(SHORTEST_S);
        if approach(cast, paths, t) >= 0.0 {
            t = t.plus_s(step);
            continue;
        }
        // Coming nearer: on to where it goes away, then between the two.
        let ahead = t.plus_s(step);
        if approach(cast, paths, ahead) >= 0.0 {
            let at = t.plus_s(root(&|s| approach(cast, paths, t.plus_s(s)), 0.0, step));
            if to.since(at) < 0.0 {
                return None;
            }
            return Some((at, ahead));
        }
        t = ahead;
    }
    None
}

/// How far from the receiver's centre an axis can pass and its penumbra still touch, m, with some to spare.
fn reach_m(cast: &Cast<'_>, caster_m: f64, star_m: f64) -> f64 {
    let limb = cast.caster.shape.limb_m[0].max(cast.caster.shape.equatorial_m * cast.caster.shape.shadow);
    let spread = (cast.star.shape.limb_m[0] + limb) / (star_m - caster_m).max(star_m * 0.01).max(1.0);
    1.02 * (limb + caster_m * spread + cast.receiver.shape.equatorial_m.max(cast.receiver.shape.limb_m[0]))
}

/// A root of `f` between `a` and `b`, where its signs differ: regula falsi that halves a stale end's value [Dowell & Jarratt 1971].
/// Where they do not differ, the end with the smaller value.
pub fn root(f: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let (mut fa, mut fb) = (f(a), f(b));
    if fa * fb > 0.0 || fa.is_nan() || fb.is_nan() {
        return if fa.abs() < fb.abs() { a } else { b };
    }
    let mut stale = 0;
    for _ in 0..ROUNDS {
        if (b - a).abs() < FINE_S || fa == fb {
            break;
        }
        let c = (a * fb - b * fa) / (fb - fa);
        let fc = f(c);
        if fc == 0.0 {
            return c;
        }
        if (fc > 0.0) == (fb > 0.0) {
            (b, fb) = (c, fc);
            if stale == 1 {
                fa *= 0.5;
            }
            stale = 1;
        } else {
            (a, fa) = (c, fc);
            if stale == -1 {
                fb *= 0.5;
            }
            stale = -1;
        }
    }
    0.5 * (a + b)
}

/// When `gap`, negative at `centre`, becomes zero before it and after it; looked for in steps of `step_s`, at most 100 each way.
pub fn span(gap: &dyn Fn(Moment) -> f64, centre: Moment, step_s: f64) -> Option<super::Span> {
    if gap(centre) >= 0.0 {
        return None;
    }
    let edge = |direction: f64| {
        let mut s = 0.0;
        for _ in 0..100 {
            let next = s + direction * step_s;
            if gap(centre.plus_s(next)) >= 0.0 {
                return Some(centre.plus_s(root(&|s| gap(centre.plus_s(s)), s, next)));
            }
            s = next;
        }
        None
    };
    Some([edge(-1.0)?, edge(1.0)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::SimTime;

    #[test]
    fn roots() {
        let x = root(&|x| x * x * x - 2.0, 0.0, 5.0);
        assert!((x - 1.259_921_049_894_873).abs() < 1e-5, "{x}");
        assert!((root(&|x| libm::exp(x) - 1e6, -3.0, 20.0) - libm::log(1e6)).abs() < 1e-5);
        assert_eq!(root(&|x| x + 1.0, 0.0, 1.0), 0.0);
        assert!((root(&|x| x - 3.0, 10.0, -10.0) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn a_span_has_two_edges() {
        let t0 = Moment::from(SimTime::from_ticks(1_000_000));
        let [a, b] = span(&|m| libm::fabs(m.since(t0) - 3.0) - 40.0, t0, 7.0).unwrap();
        assert!((a.since(t0) + 37.0).abs() < 1e-4 && (b.since(t0) - 43.0).abs() < 1e-4);
        assert!(span(&|_| 1.0, t0, 1.0).is_none() && span(&|_| -1.0, t0, 1.0).is_none());
    }
}
