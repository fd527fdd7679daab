//! The path ahead as it is drawn: lines in the colour of what they are, flags with their values, and what the pointer is near.
//!
//! Not here: what the path is ([`super::course`]), the handles of planned burns ([`super::nodes`]).

use super::lines::{Flag, Lines};
use super::{Chart, format, style};
use egui::{Color32, Pos2, Rect, Shape, Stroke, Vec2};
use engine::orbit::predict::Kind;
use engine::space::sphere;
use engine::time::Moment;

/// The path as it is.
pub const FREE: Color32 = style::ACCENT;
/// The path with the planned burns.
pub const PLANNED: Color32 = Color32::from_rgb(92, 190, 255);
/// Another body's pull takes over.
const SPHERE: Color32 = Color32::from_rgb(206, 150, 255);
/// Crossings of the equator.
const NODE: Color32 = Color32::from_rgb(150, 214, 150);
/// Lines nearer to each other than this are one to the pointer, points.
const SAME: f32 = 4.0;
/// Size of an orbit that is drawn as a spot, points.
const SPOT: f32 = 20.0;
/// How near the pointer must be to a line, points.
const NEAR: f32 = 9.0;

/// A line on the screen, with the time at each point.
pub struct Track {
    /// With the planned burns.
    pub planned: bool,
    points: Vec<(Moment, Pos2, bool)>,
}

impl Track {
    /// The place nearest to `p` between two moments: how far off, points; when; and where.
    pub fn nearest(&self, p: Pos2, from: Moment, to: Moment) -> Option<(f32, Moment, Pos2)> {
        let parts = self.points.windows(2).filter_map(|w| {
            let ((ta, a, seen_a), (tb, b, seen_b)) = (w[0], w[1]);
            if !(seen_a && seen_b) || tb.since(from) < 0.0 || ta.since(to) > 0.0 {
                return None;
            }
            let ab = b - a;
            let f = if ab.length_sq() > 1e-6 { ((p - a).dot(ab) / ab.length_sq()).clamp(0.0, 1.0) } else { 0.0 };
            let at = a + ab * f;
            Some((at.distance(p), ta.plus_s(f64::from(f) * tb.since(ta)), at))
        });
        let parts: Vec<(f32, Moment, Pos2)> = parts.collect();
        let least = parts.iter().fold(f32::INFINITY, |least, part| least.min(part.0));
        // Of several revolutions that lie over each other the first.
        let mut i = parts.iter().position(|part| part.0 <= least + SAME)?;
        while parts.get(i + 1).is_some_and(|next| next.0 < parts[i].0) {
            i += 1;
        }
        parts.get(i).copied()
    }
}

/// Draws the lines; returns where they stand.
pub fn draw(chart: &Chart<'_, '_>, lines: &Lines) -> Vec<Track> {
    let now = Moment::from(chart.world.time);
    let two = lines.lines.iter().any(|l| l.planned);
    let mut tracks = Vec::new();
    for line in &lines.lines {
        let host = chart.world.system.body(line.host);
        let centre = chart.offset(line.anchor.body) + line.anchor.base;
        let first = line.points.partition_point(|p| p.at.since(now) <= 0.0);
        let mut points = Vec::with_capacity(line.points.len() - first + 1);
        let mut put = |at: Moment, p: glam::DVec3| {
            let place = chart.place(&line.anchor, p);
            let hidden = line.about_host && chart.projection.behind(place, centre, host.radius_m);
            points.push((at, chart.projection.at(place), !hidden));
        };
        // From where the ship is.
        if let (Some(before), Some(after)) = (first.checked_sub(1).and_then(|i| line.points.get(i)), line.points.get(first)) {
            let f = now.since(before.at) / after.at.since(before.at).max(1e-9);
            put(now, before.position.lerp(after.position, f));
        }
        for p in line.points.iter().skip(first) {
            put(p.at, p.position);
        }
        let colour = if line.planned { PLANNED } else { FREE };
        let stroke = Stroke::new(1.8, if two && !line.planned { colour.gamma_multiply(0.75) } else { colour });
        // What lies behind the body is seen through it.
        let mut run: Vec<Pos2> = Vec::new();
        let mut shown = true;
        let put = |run: &mut Vec<Pos2>, shown: bool| {
            let stroke = if shown { stroke } else { Stroke::new(1.2, stroke.color.gamma_multiply(0.22)) };
            if run.len() > 1 {
                chart.painter.add(Shape::line(std::mem::take(run), stroke));
            }
            run.clear();
        };
        for (_, at, seen) in &points {
            if *seen != shown {
                let last = run.last().copied();
                put(&mut run, shown);
                run.extend(last);
                shown = *seen;
            }
            run.push(*at);
        }
        put(&mut run, shown);
        tracks.push(Track { planned: line.planned, points });
    }
    tracks
}

/// What a flag is called, and its colour.
fn name(chart: &Chart<'_, '_>, flag: &Flag) -> Option<(String, Color32)> {
    let own = if flag.planned { PLANNED } else { FREE };
    let radius = chart.world.system.body(flag.mark.host).radius_m;
    let height = || format::length(flag.mark.state.position.length() - radius);
    Some(match flag.mark.kind {
        Kind::Periapsis => (format!("Pe {}", height()), own),
        Kind::Apoapsis => (format!("Ap {}", height()), own),
        Kind::AscendingNode => ("AN".to_owned(), NODE),
        Kind::DescendingNode => ("DN".to_owned(), NODE),
        Kind::Closest { distance_m } => (format!("Closest {}", format::length(distance_m)), style::DANGER),
        Kind::AirEntry => ("Into the air".to_owned(), style::DANGER),
        Kind::AirExit => ("Out of the air".to_owned(), own),
        Kind::Impact => ("Impact".to_owned(), style::DANGER),
        Kind::Leave => (format!("Leaves {}", chart.scene.name(flag.mark.host)), SPHERE),
        Kind::Enter(body) => (format!("Meets {}", chart.scene.name(body)), SPHERE),
        Kind::BurnBegins(_) | Kind::BurnEnds(_) => return None,
    })
}

/// All that is known of a flag, for the pointer.
fn story(chart: &Chart<'_, '_>, flag: &Flag) -> String {
    let mark = &flag.mark;
    let body = chart.world.system.body(mark.host);
    let title = match mark.kind {
        Kind::Periapsis => "Periapsis: nearest".to_owned(),
        Kind::Apoapsis => "Apoapsis: farthest".to_owned(),
        Kind::AscendingNode => "Ascending node: northwards over the equator".to_owned(),
        Kind::DescendingNode => "Descending node: southwards over the equator".to_owned(),
        _ => name(chart, flag).map_or_else(String::new, |n| n.0),
    };
    let fixed = body.spin.icrf_from_fixed(mark.at.tick).inverse().raw(mark.state.position.0.normalize_or(glam::DVec3::Z));
    let (lat, lon) = sphere::lat_lon_of(fixed);
    format!(
        "{title}\nin {}   {}\n{} above {}, {}\nover {}",
        format::duration(mark.at.since(chart.world.time.into())),
        mark.at.tick.utc(),
        format::length(mark.state.position.length() - body.radius_m),
        body.name,
        format::speed(mark.state.velocity.length()),
        format::place(lat, lon),
    )
}

/// Draws the flags: the first of each kind with its value, the others as dots; the one near the pointer tells all.
pub fn flags(chart: &Chart<'_, '_>, lines: &Lines, pointer: Option<Pos2>, taken: &mut Vec<Rect>) -> bool {
    let now = Moment::from(chart.world.time);
    let mut told: Vec<(std::mem::Discriminant<Kind>, bool)> = Vec::new();
    let nearest = lines.flags.iter().filter_map(|f| match f.mark.kind {
        Kind::Closest { distance_m } if f.mark.at.since(now) > 0.0 => Some(distance_m),
        _ => None,
    });
    let nearest = nearest.fold(f64::INFINITY, f64::min);
    let mut hovered: Option<(f32, &Flag, Pos2)> = None;
    for flag in lines.flags.iter().filter(|f| f.mark.at.since(now) > 0.0) {
        let Some((text, colour)) = name(chart, flag) else { continue };
        let place = chart.place(&flag.anchor, flag.position);
        let centre = chart.offset(flag.anchor.body) + flag.anchor.base;
        if !place.is_finite() {
            continue;
        }
        let hidden = chart.projection.behind(place, centre, chart.world.system.body(flag.mark.host).radius_m);
        let colour = if hidden { colour.gamma_multiply(0.5) } else { colour };
        let at = chart.projection.at(place);
        if !chart.rect.contains(at) {
            continue;
        }
        if let Some(off) = pointer.map(|p| p.distance(at)).filter(|d| *d < NEAR)
            && hovered.is_none_or(|h| off < h.0)
        {
            hovered = Some((off, flag, at));
        }
        // The equator is crossed at much the same place with and without the burns.
        let both = matches!(flag.mark.kind, Kind::AscendingNode | Kind::DescendingNode);
        let kind = (std::mem::discriminant(&flag.mark.kind), flag.planned && !both);
        // Of an orbit that is but a spot nothing can be told apart.
        let orbit = chart.projection.points(flag.mark.state.position.length());
        let first = match flag.mark.kind {
            Kind::Periapsis | Kind::Apoapsis | Kind::AscendingNode | Kind::DescendingNode if orbit < SPOT => continue,
            Kind::Closest { distance_m } => distance_m <= nearest,
            _ => !told.contains(&kind),
        };
        told.push(kind);
        sign(chart, flag.mark.kind, at, if first { colour } else { colour.gamma_multiply(0.5) }, first);
        if first {
            let when = format::duration(flag.mark.at.since(now));
            label(chart, at, &format!("{text}\nin {when}"), colour, taken);
        }
    }
    if let Some((_, flag, at)) = hovered {
        chart.painter.circle_stroke(at, 7.0, Stroke::new(1.4, style::TEXT));
        tip(chart, at, &story(chart, flag));
    }
    hovered.is_some()
}

/// The sign of a kind.
fn sign(chart: &Chart<'_, '_>, kind: Kind, at: Pos2, colour: Color32, large: bool) {
    let r = if large { 4.0 } else { 2.2 };
    let line = Stroke::new(1.6, colour);
    let triangle = |up: f32| [Vec2::new(0.0, -up), Vec2::new(0.9, 0.8 * up), Vec2::new(-0.9, 0.8 * up)].map(|v| at + v * r).to_vec();
    match kind {
        Kind::AscendingNode => _ = chart.painter.add(Shape::convex_polygon(triangle(1.0), colour, Stroke::NONE)),
        Kind::DescendingNode => _ = chart.painter.add(Shape::convex_polygon(triangle(-1.0), colour, Stroke::NONE)),
        Kind::Closest { .. } | Kind::Impact => {
            chart.painter.line_segment([at + Vec2::splat(-r), at + Vec2::splat(r)], line);
            chart.painter.line_segment([at + Vec2::new(-r, r), at + Vec2::new(r, -r)], line);
        }
        Kind::Leave | Kind::Enter(_) | Kind::AirEntry | Kind::AirExit => _ = chart.painter.circle_stroke(at, r, line),
        _ => _ = chart.painter.circle_filled(at, 0.8 * r, colour),
    }
}

/// A text beside a place, where there is room for it; none where there is not.
pub fn label(chart: &Chart<'_, '_>, at: Pos2, text: &str, colour: Color32, taken: &mut Vec<Rect>) {
    let galley = chart.painter.layout_no_wrap(text.to_owned(), style::mono(11.0), colour);
    let size = galley.size();
    let corners =
        [Vec2::new(9.0, 5.0), Vec2::new(9.0, -5.0 - size.y), Vec2::new(-9.0 - size.x, 5.0), Vec2::new(-9.0 - size.x, -5.0 - size.y)];
    let room = corners
        .into_iter()
        .map(|c| Rect::from_min_size(at + c, size))
        .find(|r| chart.rect.contains_rect(*r) && taken.iter().all(|t| !t.intersects(*r)));
    if let Some(rect) = room {
        chart.painter.galley(rect.min, galley, colour);
        taken.push(rect);
    }
}

/// A panel of text beside a place, kept within the map.
pub fn tip(chart: &Chart<'_, '_>, at: Pos2, text: &str) {
    let galley = chart.painter.layout_no_wrap(text.to_owned(), style::mono(12.0), style::TEXT);
    let size = galley.size() + Vec2::splat(14.0);
    let x = if at.x + size.x + 16.0 < chart.rect.right() { at.x + 16.0 } else { at.x - 16.0 - size.x };
    let y = (at.y - 0.5 * size.y).clamp(chart.rect.top() + 4.0, (chart.rect.bottom() - size.y - 4.0).max(chart.rect.top() + 4.0));
    let rect = Rect::from_min_size(Pos2::new(x, y), size);
    chart.painter.rect(rect, 5, style::ground(0.94), Stroke::new(1.0, style::LINE), egui::StrokeKind::Inside);
    chart.painter.galley(rect.min + Vec2::splat(7.0), galley, style::TEXT);
}

/// The place on the path with all burns that the pointer is near, if it is: when, and where.
pub fn near(tracks: &[Track], pointer: Pos2, now: Moment, parts_at: Option<Moment>) -> Option<(Moment, Pos2)> {
    let end = now.plus_s(1e12);
    let found = tracks.iter().filter_map(|t| t.nearest(pointer, now, if t.planned { end } else { parts_at.unwrap_or(end) }));
    found.filter(|f| f.0 < NEAR).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at, p)| (at, p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::time::SimTime;

    #[test]
    fn the_nearest_place_on_a_line_has_its_time() {
        let at = |s: f64| Moment::after(SimTime::from_ticks(1_000), s);
        let p = |x: f32, y: f32| Pos2::new(x, y);
        let points = vec![(at(0.0), p(0.0, 0.0), true), (at(10.0), p(100.0, 0.0), true), (at(20.0), p(100.0, 100.0), true)];
        let track = Track { planned: false, points };
        let (off, t, _) = track.nearest(p(50.0, 3.0), at(0.0), at(99.0)).unwrap();
        assert!((off - 3.0).abs() < 1e-5 && (t.since(at(5.0))).abs() < 1e-5);
        let (_, t, _) = track.nearest(p(102.0, 25.0), at(0.0), at(99.0)).unwrap();
        assert!(t.since(at(12.5)).abs() < 1e-5);
        assert!(near(&[track], p(50.0, 40.0), at(0.0), None).is_none());
    }
}
