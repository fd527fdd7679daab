//! What the reference says of the rays that a bench judges: computed, written as a file, read back.

use super::Planet;
use super::view::{VIEWS, View};
use crate::air::reference::{Estimate, Options, radiance_noting};
use glam::DVec3;
use std::fmt::Write as _;

/// Columns of a file: name of the planet and of the view, pixel of the grid, radiance of all orders per unit of the sun's irradiance (sr⁻¹) in
/// red, green and blue, its standard errors.
pub const HEADER: &str = "planet,view,column,row,L_r,L_g,L_b,e_r,e_g,e_b";

/// One ray's truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Name of the planet.
    pub planet: String,
    /// Name of the view.
    pub view: String,
    /// Pixel of the grid.
    pub pixel: [u32; 2],
    /// Radiance, sr⁻¹.
    pub radiance: DVec3,
    /// Its standard error.
    pub std_error: DVec3,
}

/// Asks the reference for `count` rays of every view; `done` is called as each is finished.
pub fn compute(planet: &Planet, count: usize, options: &Options, done: &(dyn Fn() + Sync)) -> Vec<Truth> {
    let Planet { name, medium, sun_rad } = planet;
    let asked: Vec<(&View, [u32; 2])> = VIEWS.iter().flat_map(|v| v.judged(medium, count).into_iter().map(move |p| (v, p))).collect();
    let rays: Vec<_> = asked.iter().map(|(view, pixel)| view.ray(medium, *sun_rad, *pixel)).collect();
    let found = radiance_noting(medium, &rays, options, done);
    let truth = |((view, pixel), e): ((&View, [u32; 2]), Estimate)| Truth {
        planet: name.clone(),
        view: view.name.to_owned(),
        pixel,
        radiance: e.total,
        std_error: e.std_error,
    };
    asked.into_iter().zip(found).map(truth).collect()
}

/// Lines of a file, without its head.
pub fn lines(truths: &[Truth]) -> String {
    let mut out = String::new();
    for t in truths {
        let [c, r] = t.pixel;
        let (l, e) = (t.radiance, t.std_error);
        let numbers = format!("{:.6e},{:.6e},{:.6e},{:.2e},{:.2e},{:.2e}", l.x, l.y, l.z, e.x, e.y, e.z);
        let _ = writeln!(out, "{},{},{c},{r},{numbers}", t.planet, t.view);
    }
    out
}

/// Reads a file; an error names the line.
///
/// # Errors
/// A line that does not have the columns of [`HEADER`].
pub fn read(text: &str) -> Result<Vec<Truth>, String> {
    let rows = text.lines().enumerate().filter(|(_, l)| !l.starts_with('#') && !l.is_empty() && *l != HEADER);
    rows.map(|(i, line)| one(line).ok_or_else(|| format!("line {}: `{line}`: expected {HEADER}", i + 1))).collect()
}

fn one(line: &str) -> Option<Truth> {
    let cells: Vec<&str> = line.split(',').collect();
    let [planet, view, column, row, numbers @ ..] = cells.as_slice() else { return None };
    let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().ok()).collect::<Option<_>>()?;
    let [lr, lg, lb, er, eg, eb] = numbers.as_slice() else { return None };
    Some(Truth {
        planet: (*planet).to_owned(),
        view: (*view).to_owned(),
        pixel: [column.parse().ok()?, row.parse().ok()?],
        radiance: DVec3::new(*lr, *lg, *lb),
        std_error: DVec3::new(*er, *eg, *eb),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let truth = Truth {
            planet: "earth".to_owned(),
            view: "day".to_owned(),
            pixel: [3, 4],
            radiance: DVec3::new(1e-2, 2e-2, 3e-7),
            std_error: DVec3::new(1e-5, 2e-5, 3e-9),
        };
        let text = format!("# a comment\n{HEADER}\n{}", lines(std::slice::from_ref(&truth)));
        assert_eq!(read(&text), Ok(vec![truth]));
        assert!(read("earth,day,1,2,3,4,5,6,7").unwrap_err().contains("line 1"));
    }
}
