//! Pictures of the orbit bench: a case each, position error against CPU time and against evaluations, both logarithmic.
//!
//! Ours in colour, one a method; other programs of the same run in black; anchors measured elsewhere in grey (their CPU time was
//! another machine's). Runs that lost the orbit (an error of the orbit's own size) are left out.

use super::orbit_case::Case;
use super::orbit_rows::{Row, RowsError};
use egui::FontDefinitions;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontStyle;
use std::path::Path;
use std::sync::OnceLock;

const SIZE: (u32, u32) = (1500, 760);

/// A line of a picture.
struct Curve<'a> {
    name: String,
    rows: Vec<&'a Row>,
    colour: RGBColor,
    thick: u32,
    hollow: bool,
}

/// Draws `case` into `folder`/`orbit_<case>.png`.
///
/// # Errors
/// Where the folder cannot be made or the picture not be written.
pub fn draw(folder: &Path, case: &Case, own: &[Row], peers: &[Row], anchors: &[Row]) -> Result<(), RowsError> {
    std::fs::create_dir_all(folder).map_err(|source| RowsError::File { path: folder.to_owned(), doing: "cannot be made", source })?;
    let path = folder.join(format!("orbit_{}.png", case.name.replace(['@', '.'], "_")));
    let curves = curves(case, own, peers, anchors);
    picture(&path, case, &curves).map_err(|e| RowsError::Plot { path: path.clone(), message: e.to_string() })
}

fn curves<'a>(case: &Case, own: &'a [Row], peers: &'a [Row], anchors: &'a [Row]) -> Vec<Curve<'a>> {
    // An error of a tenth of the system's size is no error but another orbit.
    let size = case.end.iter().flatten().map(|r| r.iter().map(|x| x.0 * x.0).sum::<f64>().sqrt()).fold(0.0, f64::max);
    let mut all: Vec<Curve<'a>> = Vec::new();
    let groups =
        [(own, "", false, 2, None), (peers, "", true, 2, Some(BLACK)), (anchors, "anchor ", true, 1, Some(RGBColor(130, 130, 130)))];
    for (rows, before, hollow, thick, colour) in groups {
        for row in rows.iter().filter(|r| r.position_error.is_some_and(|e| e > 0.0 && e < 0.1 * size)) {
            // heyoka-taylor(order 19) and its like are one method.
            let method = row.method.split('(').next().unwrap_or_default();
            let name = format!("{before}{method}");
            match all.iter_mut().find(|c| c.name == name) {
                Some(curve) => curve.rows.push(row),
                None => {
                    let colour = colour.unwrap_or_else(|| tint(all.len()));
                    all.push(Curve { name, rows: vec![row], colour, thick, hollow });
                }
            }
        }
    }
    // Ours are in the order of their settings; others are joined by their time.
    for curve in all.iter_mut().filter(|c| c.hollow) {
        curve.rows.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    }
    all
}

/// Colours that neighbours do not share.
fn tint(k: usize) -> RGBColor {
    const WHEEL: [(u8, u8, u8); 20] = [
        (31, 119, 180),
        (255, 127, 14),
        (44, 160, 44),
        (214, 39, 40),
        (148, 103, 189),
        (140, 86, 75),
        (227, 119, 194),
        (188, 189, 34),
        (23, 190, 207),
        (0, 60, 140),
        (250, 190, 60),
        (0, 110, 60),
        (255, 80, 120),
        (90, 50, 160),
        (170, 140, 110),
        (120, 190, 255),
        (110, 120, 0),
        (0, 150, 150),
        (200, 0, 200),
        (255, 0, 0),
    ];
    let (r, g, b) = WHEEL[k % WHEEL.len()];
    RGBColor(r, g, b)
}

fn picture(path: &Path, case: &Case, curves: &[Curve]) -> Result<(), Box<dyn std::error::Error>> {
    lend_font()?;
    let root = BitMapBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(SIZE.0 / 2 - 90);
    panel(&left, &format!("{}: position error by CPU time, s", case.name), curves, false, |r| Some(r.cpu_s))?;
    panel(&right, "and by evaluations of the force", curves, true, |r| r.force_evals)?;
    root.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<BitMapBackend, Shift>,
    title: &str,
    curves: &[Curve],
    legend: bool,
    across: impl Fn(&Row) -> Option<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    let place = |row: &Row| Some((across(row).filter(|x| *x > 0.0)?, row.position_error?));
    let all: Vec<(f64, f64)> = curves.iter().flat_map(|c| c.rows.iter().filter_map(|r| place(r))).collect();
    let span = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        if low < high { (0.6 * low, 1.7 * high) } else { (1e-3, 1.0) }
    };
    let (x0, x1) = span(&mut all.iter().map(|p| p.0));
    let (y0, y1) = span(&mut all.iter().map(|p| p.1));
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 19))
        .margin(10)
        .margin_right(if legend { 210 } else { 10 })
        .x_label_area_size(34)
        .y_label_area_size(62)
        .build_cartesian_2d((x0..x1).log_scale(), (y0..y1).log_scale())?;
    chart
        .configure_mesh()
        .x_labels(8)
        .y_labels(10)
        .label_style(("sans-serif", 14))
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    let (_, height) = area.dim_in_pixel();
    for (k, curve) in curves.iter().enumerate() {
        let line: Vec<(f64, f64)> = curve.rows.iter().filter_map(|r| place(r)).collect();
        let style = curve.colour.stroke_width(curve.thick);
        chart.draw_series(LineSeries::new(line.iter().copied(), style))?;
        let dot = if curve.hollow { curve.colour.stroke_width(1) } else { curve.colour.filled() };
        chart.draw_series(line.iter().map(|p| Circle::new(*p, 4, dot)))?;
        if legend {
            let (width, _) = area.dim_in_pixel();
            #[allow(clippy::cast_possible_wrap, clippy::cast_possible_truncation, reason = "pixels of a picture")]
            let (x, y) = (width as i32 - 205, 40 + (k as i32) * ((height as i32 - 60) / (curves.len() as i32).max(1)).min(22));
            area.draw(&PathElement::new(vec![(x, y + 7), (x + 22, y + 7)], style))?;
            area.draw(&Circle::new((x + 11, y + 7), 4, dot))?;
            area.draw(&Text::new(curve.name.clone(), (x + 28, y), ("sans-serif", 14)))?;
        }
    }
    Ok(())
}

/// The game's own font, for pictures too: no system font is asked for.
pub fn lend_font() -> Result<(), Box<dyn std::error::Error>> {
    static FONT: OnceLock<Vec<u8>> = OnceLock::new();
    let bytes = FONT
        .get_or_init(|| FontDefinitions::default().font_data.get("Ubuntu-Light").map_or_else(Vec::new, |f| (*f.font).as_ref().to_vec()));
    if bytes.is_empty() {
        return Err("the font is missing".into());
    }
    // A second call finds it there already.
    let _ = plotters::style::register_font("sans-serif", FontStyle::Normal, bytes);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mode::bench::{orbit_case, orbit_rows};

    #[test]
    fn a_picture_is_drawn_and_shows_more_than_its_ground() {
        let dir = tempfile::tempdir().unwrap();
        let case = orbit_case::reference("FIG8_100T").unwrap();
        let own = vec![Row { method: "gauss_radau".to_owned(), ..orbit_rows::anchors("FIG8_100T")[0].clone() }];
        draw(dir.path(), &case, &own, &own, &orbit_rows::anchors("FIG8_100T")).unwrap();
        let bytes = std::fs::read(dir.path().join("orbit_FIG8_100T.png")).unwrap();
        assert!(bytes.len() > 20_000, "{} bytes", bytes.len());
        // Nothing to draw is a picture too.
        draw(dir.path(), &case, &[], &[], &[]).unwrap();
    }
}
