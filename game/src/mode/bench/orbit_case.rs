//! Cases of orbital motion: bodies at a start, and where they must be at given times, read from JSON and checked.
//!
//! The form is that of `tests/reference/orbit_cases.json`: one case, or an object of cases by name. Starts are read from hexadecimal floats
//! where those are given; references of 30 digits are kept as two f64, so that an error far below one ulp is still seen.
//! Not here: what integrates them (`orbit_method`).

use crate::assets::fault::did_you_mean;
use engine::orbit::integrate::Points;
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The ten cases of the reference data.
pub const CASES: &str = include_str!("../../../../tests/reference/orbit_cases.json");

/// Why there is no case.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is no JSON, or not of the form.
    #[error("{}:{line}:{column}: {message}", path.display())]
    #[diagnostic(help(
        "expected a case {{\"bodies\": [[\"name\", gm, x, y, z, vx, vy, vz], …], \"T\": time}}, or an object of such cases by name; numbers are finite"
    ))]
    Form {
        /// The file.
        path: PathBuf,
        /// Where, from 1.
        line: usize,
        /// Where, from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// What it says cannot be.
    #[error("{}: {place}: {message}", path.display())]
    #[diagnostic(help("{help}"))]
    Sense {
        /// The file.
        path: PathBuf,
        /// Which value, as a path in the JSON.
        place: String,
        /// What is wrong.
        message: String,
        /// What was expected.
        help: String,
    },
}

/// A case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name; `@` and a time where it ends before its last reference.
    pub name: String,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Their gravitational parameters, in the case's units.
    pub gm: Vec<f64>,
    /// Where they start.
    pub start: Points,
    /// The shortest period, where it is told.
    pub period: Option<f64>,
    /// When it ends.
    pub t_end: f64,
    /// Where they are then, where that is known: each coordinate as its f64 and the rest.
    pub end: Option<Vec<[(f64, f64); 3]>>,
}

#[derive(Deserialize)]
struct Raw {
    #[serde(rename = "G", default = "one")]
    g: f64,
    #[serde(default)]
    bodies: Vec<RawBody>,
    #[serde(default)]
    bodies_hex: Vec<[String; 8]>,
    orbit_period: Option<f64>,
    #[serde(rename = "T", alias = "t_end")]
    t_end: Option<f64>,
    #[serde(default)]
    reference: Vec<RawReference>,
}

/// Name, gm, position, velocity.
type RawBody = (String, f64, f64, f64, f64, f64, f64, f64);

#[derive(Deserialize)]
struct RawReference {
    t: f64,
    t_hex: Option<String>,
    state: Vec<Vec<String>>,
}

fn one() -> f64 {
    1.0
}

/// The case of that name (with or without `@t`) in a file; the name may be left out where there is one case only. `t_end` overrides
/// when it ends.
///
/// # Errors
/// Names the file, the place and what was expected.
pub fn read(path: &Path, name: Option<&str>, t_end: Option<f64>) -> Result<Case, CaseError> {
    let text = std::fs::read_to_string(path).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
    parse(path, &text, name, t_end)
}

/// The names in the reference data, in its order of difficulty.
pub fn known() -> [&'static str; 11] {
    [
        "LEO_1000orb",
        "KEP_e0.99_1000orb",
        "KEP_e0.999_1000orb",
        "EMS_1yr",
        "ARENSTORF_1T",
        "PYTHAG_70@10",
        "PYTHAG_70",
        "FIG8_100T",
        "OSS5_10000yr",
        "SS9_100yr",
        "SS11_100yr",
    ]
}

/// As [`read`], of the reference data itself.
///
/// # Errors
/// Where there is no such case.
pub fn reference(name: &str) -> Result<Case, CaseError> {
    parse(Path::new("tests/reference/orbit_cases.json"), CASES, Some(name), None)
}

fn parse(path: &Path, text: &str, name: Option<&str>, t_end: Option<f64>) -> Result<Case, CaseError> {
    let form = |e: serde_json::Error| {
        // The place is in the message a second time.
        let message = e.to_string();
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(m, _)| m).to_owned();
        CaseError::Form { path: path.to_owned(), line: e.line(), column: e.column(), message }
    };
    let sense =
        |place: String, message: String, help: &str| CaseError::Sense { path: path.to_owned(), place, message, help: help.to_owned() };
    let value: serde_json::Value = serde_json::from_str(text).map_err(form)?;
    let single = value.get("bodies").is_some() || value.get("bodies_hex").is_some();
    let (asked, at) = match name.map(|n| n.split_once('@').map_or((n, None), |(n, at)| (n, Some(at)))) {
        Some((asked, at)) => (Some(asked), at),
        None => (None, None),
    };
    let (name, raw) = if single {
        let stem = path.file_stem().map_or("case".to_owned(), |s| s.to_string_lossy().into_owned());
        (asked.map_or(stem, str::to_owned), serde_json::from_str::<Raw>(text).map_err(form)?)
    } else {
        let mut all = serde_json::from_str::<BTreeMap<String, Raw>>(text).map_err(form)?;
        let names = all.keys().cloned().collect::<Vec<_>>();
        let key = match asked {
            Some(asked) => asked.to_owned(),
            None if names.len() == 1 => names[0].clone(),
            None => {
                let known = format!("name one with --name: {}", names.join(", "));
                return Err(sense("the file".into(), format!("holds {} cases", names.len()), &known));
            }
        };
        let Some(raw) = all.remove(&key) else {
            let near = did_you_mean(&key, names.iter().map(String::as_str)).map(|n| format!("did you mean `{n}`? "));
            let help = format!("{}cases are {}", near.unwrap_or_default(), names.join(", "));
            return Err(sense("the file".into(), format!("has no case `{key}`"), &help));
        };
        (key, raw)
    };
    let (bodies, gm, start) = start(&raw).map_err(|(place, message)| {
        sense(place, message, "a body is a name, gm ≥ 0, a position and a velocity, all finite; no two are at one place")
    })?;
    let at = match at {
        Some(at) => Some(
            at.parse::<f64>()
                .map_err(|_| sense(format!("@{at}"), "is no time".into(), "expected a number after @, for example PYTHAG_70@10"))?,
        ),
        None => t_end.or(raw.t_end),
    };
    let exact = |r: &RawReference| r.t_hex.as_deref().and_then(hex).unwrap_or(r.t);
    let last = match at {
        Some(at) => raw.reference.iter().find(|r| r.t == at || exact(r) == at),
        None => raw.reference.last(),
    };
    let t_end = match (at, last) {
        (_, Some(r)) => exact(r),
        (Some(at), None) => at,
        (None, None) => {
            return Err(sense("T".into(), "is not told".into(), "expected the time at which the case ends: \"T\" in the file, or --t"));
        }
    };
    if !t_end.is_finite() {
        return Err(sense("T".into(), format!("{t_end} is no time"), "expected a finite number"));
    }
    let end = last
        .map(|r| digits(r, bodies.len()))
        .transpose()
        .map_err(|(place, message)| sense(place, message, "a reference is a state of each body, coordinates as strings of digits"))?;
    let name = at.filter(|_| !single).map_or(name.clone(), |at| format!("{name}@{at}"));
    Ok(Case { name, bodies, gm, start, period: raw.orbit_period, t_end, end })
}

type Start = (Vec<String>, Vec<f64>, Points);
/// A coordinate as its f64 and the rest.
type Digits = (f64, f64);
/// Which value, and what is wrong with it.
type Fault = (String, String);

/// Bodies, checked. An error is a place and what is wrong there.
fn start(raw: &Raw) -> Result<Start, Fault> {
    let (mut names, mut gm, mut points) = (Vec::new(), Vec::new(), Points::default());
    let hexadecimal = !raw.bodies_hex.is_empty();
    let list = if hexadecimal { "bodies_hex" } else { "bodies" };
    let rows: Vec<(String, [f64; 7])> = if hexadecimal {
        let mut rows = Vec::new();
        for (i, row) in raw.bodies_hex.iter().enumerate() {
            let mut numbers = [0.0; 7];
            for (k, number) in numbers.iter_mut().enumerate() {
                *number = hex(&row[k + 1])
                    .ok_or_else(|| (format!("{list}[{i}][{}]", k + 1), format!("`{}` is no hexadecimal number", row[k + 1])))?;
            }
            rows.push((row[0].clone(), numbers));
        }
        rows
    } else {
        raw.bodies.iter().map(|(name, m, x, y, z, vx, vy, vz)| (name.clone(), [*m, *x, *y, *z, *vx, *vy, *vz])).collect()
    };
    if rows.is_empty() {
        return Err((list.to_owned(), "is empty".to_owned()));
    }
    for (i, (name, n)) in rows.into_iter().enumerate() {
        let place = || format!("{list}[{i}] `{name}`");
        let mass = n[0] * raw.g;
        if !mass.is_finite() || mass < 0.0 {
            return Err((place(), format!("gm is {mass}")));
        }
        if let Some(bad) = n.iter().find(|x| !x.is_finite()) {
            return Err((place(), format!("{bad} is no number to start from")));
        }
        let (q, v) = (DVec3::new(n[1], n[2], n[3]), DVec3::new(n[4], n[5], n[6]));
        if let Some(other) = points.q.iter().position(|p| *p == q) {
            return Err((place(), format!("is at the same place as [{other}] `{}`", names[other])));
        }
        points.q.push(q);
        points.v.push(v);
        gm.push(mass);
        names.push(name);
    }
    Ok((names, gm, points))
}

fn digits(reference: &RawReference, bodies: usize) -> Result<Vec<[Digits; 3]>, Fault> {
    let place = format!("reference at t = {}", reference.t);
    if reference.state.len() != bodies {
        return Err((place, format!("has {} states for {bodies} bodies", reference.state.len())));
    }
    let mut all = Vec::new();
    for (i, state) in reference.state.iter().enumerate() {
        let mut position = [(0.0, 0.0); 3];
        for (k, x) in position.iter_mut().enumerate() {
            let text = state.get(k).map_or("", String::as_str);
            *x = split(text).ok_or_else(|| (format!("{place}: state[{i}][{k}]"), format!("`{text}` is no number")))?;
        }
        all.push(position);
    }
    Ok(all)
}

/// A decimal as the f64 nearest to it and, as an f64, what that leaves.
fn split(text: &str) -> Option<(f64, f64)> {
    let high: f64 = text.parse().ok().filter(|x: &f64| x.is_finite())?;
    if text.contains(['e', 'E']) {
        return Some((high, 0.0));
    }
    // An f64 has a finite decimal expansion; to 50 places both are integers, and their difference is exact.
    let (a, b) = (fixed(text), fixed(&format!("{high:.50}")));
    let (larger, sign) = if a >= b { ((&a, &b), 1.0) } else { ((&b, &a), -1.0) };
    let (mut difference, mut borrow) = (vec![0_i16; a.len()], 0);
    for k in (0..a.len()).rev() {
        let d = i16::from(larger.0[k]) - i16::from(larger.1[k]) - borrow;
        borrow = i16::from(d < 0);
        difference[k] = d + 10 * borrow;
    }
    let figures: String = difference.iter().map(|d| char::from(b'0' + u8::try_from(*d).unwrap_or(0))).collect();
    let low: f64 = format!("{figures}e-50").parse().ok()?;
    let negative = text.starts_with('-');
    Some((high, if negative { -sign * low } else { sign * low }))
}

/// The digits of |text|: 40 before the point, 50 after it.
fn fixed(text: &str) -> Vec<u8> {
    let (whole, part) = text.trim_start_matches(['-', '+']).split_once('.').unwrap_or((text.trim_start_matches(['-', '+']), ""));
    format!("{whole:0>40}{part:0<50}").bytes().map(|b| b - b'0').take(90).collect()
}

/// `-0x1.8p+3`: C's hexadecimal floats.
fn hex(text: &str) -> Option<f64> {
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |t| (-1.0, t));
    let (mantissa, exponent) = text.strip_prefix("0x")?.split_once('p')?;
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let bits = u64::from_str_radix(&format!("{whole}{part}"), 16).ok().filter(|b| *b < 1 << 53)?;
    let places = i32::try_from(4 * part.len()).ok()?;
    Some(sign * libm::ldexp(bits as f64, exponent.parse::<i32>().ok()?.checked_sub(places)?)).filter(|x| x.is_finite())
}

impl Case {
    /// The largest distance of any body from where it must be, at the end; NaN where that is not known.
    pub fn position_error(&self, points: &Points) -> f64 {
        let Some(end) = &self.end else { return f64::NAN };
        let miss =
            |q: &DVec3, r: &[(f64, f64); 3]| DVec3::from_array(std::array::from_fn(|k| (q.to_array()[k] - r[k].0) - r[k].1)).length();
        points.q.iter().zip(end).map(|(q, r)| miss(q, r)).fold(0.0, f64::max)
    }

    /// Energy at `points` (massless bodies left out; beside one massive body that of the first massless for unit mass).
    pub fn energy(&self, points: &Points) -> f64 {
        let massive: Vec<usize> = (0..self.gm.len()).filter(|i| self.gm[*i] > 0.0).collect();
        if let ([sun], true) = (massive.as_slice(), self.gm.len() > 1) {
            let i = usize::from(*sun == 0);
            let (r, v) = (points.q[i] - points.q[*sun], points.v[i] - points.v[*sun]);
            return 0.5 * v.length_squared() - self.gm[*sun] / r.length();
        }
        let mut sum = 0.0;
        for (k, i) in massive.iter().enumerate() {
            sum += 0.5 * self.gm[*i] * points.v[*i].length_squared();
            for j in &massive[..k] {
                sum -= self.gm[*i] * self.gm[*j] / (points.q[*i] - points.q[*j]).length();
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_beyond_an_f64_are_kept() {
        // 0.1 as an f64 is 0.1000000000000000055511151231257827…
        let (high, low) = split("0.1").unwrap();
        assert!(high == 0.1 && (low + 5.551_115_123_125_783e-18).abs() < 1e-33, "{low:e}");
        let (high, low) = split("-2107465.698380959157658372").unwrap();
        assert!((high + 2_107_465.698_380_959).abs() < 1e-9 && low.abs() < 3e-10 && low != 0.0);
        assert_eq!(split("0.0"), Some((0.0, 0.0)));
        assert_eq!(split("12a"), None);
        assert_eq!((hex("-0x1.8p+3"), hex("0x0.0p+0"), hex("0x1.zp1")), (Some(-12.0), Some(0.0), None));
    }

    #[test]
    fn every_case_of_the_reference_is_read() {
        for name in known() {
            let case = reference(name).unwrap();
            assert!(case.end.is_some() && case.t_end > 0.0 && case.period.is_some(), "{name}");
        }
        assert_eq!(reference("PYTHAG_70@10").unwrap().t_end, 10.0);
        assert!(format!("{:?}", miette::Report::new(reference("PYTHAG").unwrap_err())).contains("PYTHAG_70"));
        let leo = reference("LEO_1000orb").unwrap();
        assert!((leo.position_error(&leo.start) - 1.15e7).abs() < 1e6);
    }
}
