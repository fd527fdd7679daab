//! Pictures of the air bench: relative error against time, both logarithmic, a line for each technique through its settings, and the front: the
//! stairs under which none of them comes.

use crate::mode::bench::orbit_plot::lend_font;
use crate::mode::bench::orbit_rows::RowsError;
use engine::render::sky_bench::front::{Row, Summary};
use engine::render::sky_bench::view::Light;
use plotters::prelude::*;
use std::path::Path;

/// What is drawn of a technique: its name, colour, whether it stands apart, and its places.
type Curve = (String, RGBColor, bool, Vec<(f64, f64)>);

const SIZE: (u32, u32) = (900, 600);
/// Where an error is less, or a picture takes less of the yardstick's time, it is drawn on the edge.
const LEAST: f64 = 1e-4;

/// Colour, and which curve of a technique's settings: those that march at every pixel are another one.
fn curve(row: &Row) -> (String, RGBColor, bool) {
    let apart = row.setting.contains("every pixel") || row.setting.contains("marched");
    let (r, g, b) = match row.model {
        "physical" => (200, 30, 30),
        "Hillaire 2020" => (30, 100, 190),
        "Bruneton 2008" => (20, 140, 60),
        "view_table" => (150, 90, 190),
        "limb_table" => (140, 100, 60),
        "thickness" => (230, 130, 20),
        _ => (110, 110, 110),
    };
    let name = match (row.model, apart) {
        ("physical", true) => "physical, every pixel".to_owned(),
        ("Hillaire 2020", true) => "Hillaire 2020, marched".to_owned(),
        ("Hillaire 2020", false) => "Hillaire 2020, his tables".to_owned(),
        ("Bruneton 2008", _) => "Bruneton & Neyret 2008".to_owned(),
        (name, _) => name.to_owned(),
    };
    (name, RGBColor(r, g, b), apart)
}

/// Draws `folder`/`air_<planet>.png` and one for each light.
///
/// # Errors
/// A folder that cannot be made, a picture that cannot be written.
pub fn draw(folder: &Path, planet: &str, rows: &[Row]) -> Result<(), RowsError> {
    std::fs::create_dir_all(folder).map_err(|source| RowsError::File { path: folder.to_owned(), doing: "cannot be made", source })?;
    let whole = ("all views".to_owned(), None);
    let parts = Light::ALL.iter().enumerate().map(|(i, l)| (l.name().to_owned(), Some(i)));
    for (title, part) in std::iter::once(whole).chain(parts) {
        let path = folder.join(part.map_or_else(|| format!("air_{planet}.png"), |_| format!("air_{planet}_{title}.png")));
        let of = |row: &Row| part.and_then(|i| row.by_light.get(i)).copied().unwrap_or(row.all);
        picture(&path, &format!("{planet}, {title}"), rows, &of)
            .map_err(|e| RowsError::Plot { path: path.clone(), message: e.to_string() })?;
    }
    Ok(())
}

fn picture(path: &Path, title: &str, rows: &[Row], of: &dyn Fn(&Row) -> Summary) -> Result<(), Box<dyn std::error::Error>> {
    lend_font()?;
    let place = |row: &Row| (of(row).time.max(LEAST), 100.0 * of(row).rms.max(LEAST));
    let places: Vec<(f64, f64)> = rows.iter().map(place).filter(|p| p.0.is_finite() && p.1.is_finite()).collect();
    let span = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        if low < high { (0.75 * low, 1.35 * high) } else { (1e-3, 1.0) }
    };
    let ((x0, x1), (y0, y1)) = (span(&mut places.iter().map(|p| p.0)), span(&mut places.iter().map(|p| p.1)));
    let root = BitMapBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(format!("Air: error against time, {title}"), ("sans-serif", 22))
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(66)
        .build_cartesian_2d((x0..x1).log_scale(), (y0..y1).log_scale())?;
    let number = |x: &f64| if *x >= 1.0 { format!("{x:.0}") } else { format!("{x}") };
    chart
        .configure_mesh()
        .light_line_style(RGBColor(235, 235, 235))
        .label_style(("sans-serif", 16))
        .axis_desc_style(("sans-serif", 17))
        .x_desc("time of the air\u{2019}s passes, \u{201c}physical\u{201d} as drawn = 1")
        .y_desc("radiance error, rms %")
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .draw()?;
    chart.draw_series(std::iter::once(PathElement::new(stairs(&places, (x1, y1)), RGBColor(160, 160, 160).stroke_width(2))))?;
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        let (name, colour, apart) = curve(row);
        match curves.iter_mut().find(|c| c.0 == name) {
            Some(c) => c.3.push(place(row)),
            None => curves.push((name, colour, apart, vec![place(row)])),
        }
    }
    for (name, colour, apart, mut line) in curves {
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        let dot = if apart { colour.stroke_width(2) } else { colour.filled() };
        // The line goes through the settings that no other of the technique betters.
        let mut best: Vec<(f64, f64)> = Vec::new();
        for p in &line {
            if best.last().is_none_or(|last| p.1 < last.1) {
                best.push(*p);
            }
        }
        chart.draw_series(LineSeries::new(best, colour.stroke_width(if apart { 1 } else { 2 })))?;
        chart.draw_series(line.iter().map(|p| Circle::new(*p, 5, dot)))?.label(name).legend(move |(x, y)| Circle::new((x + 8, y), 5, dot));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 16))
        .draw()?;
    root.present()?;
    Ok(())
}

/// Of all that is reached, the least error by the time that is spent, from the first place to the edge.
fn stairs(places: &[(f64, f64)], edge: (f64, f64)) -> Vec<(f64, f64)> {
    let mut sorted = places.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut line: Vec<(f64, f64)> = Vec::new();
    let mut least = edge.1;
    for (x, y) in sorted.into_iter().filter(|p| p.0 > 0.0) {
        if y < least {
            line.extend([(x, least), (x, y)]);
            least = y;
        }
    }
    line.push((edge.0, least));
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stairs_go_down_only() {
        let line = stairs(&[(1.0, 3.0), (2.0, 4.0), (0.5, 9.0), (4.0, 1.0)], (10.0, 20.0));
        assert_eq!(line, [(0.5, 20.0), (0.5, 9.0), (1.0, 9.0), (1.0, 3.0), (4.0, 3.0), (4.0, 1.0), (10.0, 1.0)]);
    }
}
