//! The integrators by name: what the bench measures and `probe propagate` runs.
//!
//! Not here: the methods themselves (`engine::orbit::integrate`), which cases they are run on (`orbit`).

use crate::assets::fault::did_you_mean;
use engine::orbit::integrate::composition::{Composition, SCHEMES, Scheme};
use engine::orbit::integrate::dormand_prince::{DORMAND_PRINCE_5, DORMAND_PRINCE_8, Embedded, Pair};
use engine::orbit::integrate::gauss_radau::GaussRadau;
use engine::orbit::integrate::taylor::Taylor;
use engine::orbit::integrate::wisdom_holman::{Corrector, Hierarchy, WisdomHolman};
use engine::orbit::integrate::{Force, Points, Work};
use glam::DVec3;
use thiserror::Error;

/// A method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// A symplectic composition of fixed step, with compensated sums.
    Composition(Scheme),
    /// Wisdom–Holman in the hierarchy of osculating periods.
    WisdomHolman(Corrector),
    /// An embedded pair.
    DormandPrince(Pair),
    /// Gauss–Radau of order 15.
    GaussRadau,
    /// Taylor series for point masses, of the order that its tolerance asks for.
    Taylor,
}

/// What a method is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// A tolerance, for methods that choose their steps.
    Tolerance(f64),
    /// A step, for those that do not.
    Step(f64),
}

/// Why a method cannot be run.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum MethodError {
    /// There is none of that name.
    #[error("there is no method `{name}`")]
    #[diagnostic(help("{help}"))]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        help: String,
    },
    /// It needs the other setting.
    #[error("{method} takes {takes}")]
    #[diagnostic(help("{help}"))]
    Setting {
        /// The method.
        method: String,
        /// What it takes.
        takes: &'static str,
        /// An example.
        help: &'static str,
    },
}

/// All methods of all cases' plots, in the order of their families.
pub fn all() -> Vec<Method> {
    let compositions = SCHEMES.into_iter().map(Method::Composition);
    let wisdom = Corrector::ALL.into_iter().map(Method::WisdomHolman);
    let pairs = [DORMAND_PRINCE_5, DORMAND_PRINCE_8].into_iter().map(Method::DormandPrince);
    compositions.chain(wisdom).chain(pairs).chain([Method::GaussRadau, Method::Taylor]).collect()
}

impl Method {
    /// By name; case, `-` and `_` do not matter.
    ///
    /// # Errors
    /// Says which name is the nearest.
    pub fn find(name: &str) -> Result<Self, MethodError> {
        let plain = |s: &str| s.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect::<String>();
        let wanted = match plain(name).as_str() {
            "ias15" => "gaussradau".to_owned(),
            "whfast" => "wisdomholman".to_owned(),
            other => other.to_owned(),
        };
        all().into_iter().find(|m| plain(&m.name()) == wanted).ok_or_else(|| {
            let names: Vec<String> = all().iter().map(Self::name).collect();
            let near = did_you_mean(name, names.iter().map(String::as_str)).map(|n| format!("did you mean `{n}`? "));
            let help = format!("{}methods are {}", near.unwrap_or_default(), names.join(", "));
            MethodError::Unknown { name: name.to_owned(), help }
        })
    }

    /// Its name in reports and on the command line.
    pub fn name(&self) -> String {
        match self {
            Self::Composition(scheme) => scheme.name.to_owned(),
            Self::WisdomHolman(Corrector::None) => "wisdom_holman".to_owned(),
            Self::WisdomHolman(corrector) => format!("wisdom_holman_c{}", corrector.order()),
            Self::DormandPrince(pair) => pair.table.name.to_owned(),
            Self::GaussRadau => "gauss_radau".to_owned(),
            Self::Taylor => "taylor".to_owned(),
        }
    }

    /// True where it chooses its own steps.
    pub fn adaptive(&self) -> bool {
        matches!(self, Self::DormandPrince(_) | Self::GaussRadau | Self::Taylor)
    }

    /// Evaluations of the force in a step of a method of fixed step.
    pub fn stages(&self) -> usize {
        if let Self::Composition(scheme) = self { scheme.drifts.len() } else { 1 }
    }

    /// The setting that was asked for, or the method's usual one where none was.
    ///
    /// # Errors
    /// Where it takes the other kind, or a number that is not positive and finite.
    pub fn setting(&self, tolerance: Option<f64>, step: Option<f64>) -> Result<Setting, MethodError> {
        let sound = |x: f64| x.is_finite() && x > 0.0;
        let fault = |takes, help| Err(MethodError::Setting { method: self.name(), takes, help });
        match (self.adaptive(), tolerance, step) {
            (true, Some(tolerance), None) if sound(tolerance) => Ok(Setting::Tolerance(tolerance)),
            (true, None, None) if *self == Self::GaussRadau => Ok(Setting::Tolerance(GaussRadau::TOLERANCE)),
            (true, None, None) => Ok(Setting::Tolerance(if *self == Self::Taylor { 1e-18 } else { 1e-13 })),
            (true, ..) => fault("a tolerance, a positive number, and no step", "for example --tol 1e-9"),
            (false, None, Some(step)) if sound(step) => Ok(Setting::Step(step)),
            (false, ..) => fault("a step, a positive number in the case's unit of time, and no tolerance", "for example --dt 0.5"),
        }
    }

    /// False where its evaluations are whole power series and do not compare with those of a force.
    pub fn counts_forces(&self) -> bool {
        *self != Self::Taylor
    }

    /// From `points` to `t_end`, in place. A run that cannot reach the end (a collision) stops before it: compare `points.t`.
    pub fn run(&self, gm: &[f64], points: &mut Points, setting: Setting, t_end: f64) -> Work {
        let (n, masses) = (gm.len(), Masses { gm });
        let number = match setting {
            Setting::Tolerance(x) | Setting::Step(x) => x,
        };
        match self {
            Self::Composition(scheme) => Composition::new(*scheme, n, number, true).run(&masses, points, t_end),
            Self::WisdomHolman(corrector) => {
                let hierarchy = Hierarchy::by_period(gm, &points.q, &points.v);
                WisdomHolman::new(gm, &hierarchy, number, *corrector).run(points, t_end)
            }
            Self::DormandPrince(pair) => Embedded::new(*pair, n, number, false).run(&masses, points, t_end),
            Self::GaussRadau => GaussRadau::new(n, number).run(&masses, points, t_end),
            // Where it stops short the points say so by their time.
            Self::Taylor => Taylor::new(gm, number).run(points, t_end).unwrap_or_default(),
        }
    }
}

/// Every mass attracts every other body.
pub struct Masses<'a> {
    /// Gravitational parameters.
    pub gm: &'a [f64],
}

impl Force for Masses<'_> {
    const USES_VELOCITY: bool = false;

    fn accelerations(&self, _: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        a.fill(DVec3::ZERO);
        for (i, (at, gm)) in q.iter().zip(self.gm).enumerate() {
            let mut own = a[i];
            for ((other, other_gm), pull) in q[i + 1..].iter().zip(&self.gm[i + 1..]).zip(&mut a[i + 1..]) {
                if *gm == 0.0 && *other_gm == 0.0 {
                    continue;
                }
                let d = *other - *at;
                let r2 = d.length_squared();
                let cube = 1.0 / (r2 * r2.sqrt());
                own += d * (other_gm * cube);
                *pull -= d * (gm * cube);
            }
            a[i] = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_however_they_are_written() {
        for method in all() {
            assert_eq!(Method::find(&method.name()).unwrap(), method);
        }
        assert_eq!(Method::find("Gauss-Radau").unwrap(), Method::GaussRadau);
        let help = format!("{:?}", miette::Report::new(Method::find("gaus_radau").unwrap_err()));
        assert!(help.contains("did you mean `gauss_radau`"), "{help}");
    }

    #[test]
    fn settings_are_of_the_method_s_kind_and_positive() {
        let (leapfrog, radau) = (Method::find("leapfrog").unwrap(), Method::GaussRadau);
        assert_eq!(radau.setting(None, None).unwrap(), Setting::Tolerance(1e-9));
        assert_eq!(leapfrog.setting(None, Some(0.5)).unwrap(), Setting::Step(0.5));
        for (method, tolerance, step) in [
            (radau, Some(-1e-9), None),
            (radau, None, Some(1.0)),
            (radau, Some(f64::NAN), None),
            (leapfrog, None, None),
            (leapfrog, Some(1e-9), None),
        ] {
            assert!(method.setting(tolerance, step).is_err(), "{method:?} {tolerance:?} {step:?}");
        }
    }
}
