//! Photo mode: the World stands still; exposure, field of view and time of day are the photographer's.
//!
//! The clock moves in a copy of the World that is drawn and never ticked ([`moved_clock`]): the ship keeps its place over
//! the ground, the sky turns. Leaving the mode leaves the flight as it was.

use super::panels::area;
use super::{Reply, Request, Scene, style};
use crate::world::World;
use crate::world::ship::{Motion, Resting, Rigid};
use egui::{Align2, Slider};
use engine::space::{Position, Rotation, Velocity};
use engine::units::HOUR;

/// The photographer's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photo {
    /// Exposure compensation on top of the settings', stops.
    pub ev: f32,
    /// Vertical field of view, degrees; the settings' where none is set.
    pub fov_deg: Option<f64>,
    /// The clock, moved by so many hours.
    pub hours: f64,
    /// The panel is shown.
    pub panel: bool,
}

impl Default for Photo {
    fn default() -> Self {
        Self { ev: 0.0, fov_deg: None, hours: 0.0, panel: true }
    }
}

impl Photo {
    /// Begins anew.
    pub fn enter(&mut self) {
        *self = Self::default();
    }
}

/// The panel of photo mode.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, photo: &mut Photo, reply: &mut Reply) {
    if !photo.panel {
        return;
    }
    area(ctx, "photo", Align2::CENTER_BOTTOM, [0.0, -14.0], |ui| {
        style::panel(0.8).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(style::heading("Photo"));
                ui.spacing_mut().slider_width = 130.0;
                ui.add(Slider::new(&mut photo.ev, -6.0..=6.0).text("EV").step_by(0.1));
                let mut fov = photo.fov_deg.unwrap_or(55.0);
                if ui.add(Slider::new(&mut fov, 2.0..=120.0).text("field of view").suffix("°").logarithmic(true)).changed() {
                    photo.fov_deg = Some(fov);
                }
                ui.add(Slider::new(&mut photo.hours, -12.0..=12.0).text("clock, h").step_by(0.02));
            });
            ui.horizontal(|ui| {
                if ui.button("Save the picture").clicked() {
                    reply.requests.push(Request::Picture);
                }
                if ui.button("As it was").clicked() {
                    photo.enter();
                }
                let time = scene.readout.time.utc();
                ui.label(style::note(format!("{time}   ·   drag: turn · wheel: nearer · F2: hide this panel")));
            });
        });
    });
}

/// A copy of the World with the clock moved by `hours`, the ship over the same ground; to be drawn, not flown.
#[allow(clippy::cast_possible_truncation)]
pub fn moved_clock(world: &World, hours: f64) -> World {
    let mut moved = world.clone();
    moved.time = world.time.plus((hours * HOUR * engine::time::TICKS_PER_SECOND as f64) as i64);
    let rigid = world.rigid();
    let spin = &world.system.body(rigid.body).spin;
    let turn = spin.icrf_from_fixed(moved.time) * spin.icrf_from_fixed(world.time).inverse();
    let kept = match &world.ship.motion {
        m @ (Motion::Landed(_) | Motion::Crashed(_)) => m.clone(),
        _ => {
            let mut state = rigid.state;
            state.position = Position::new(turn.0 * rigid.state.position.0);
            state.velocity = Velocity::new(turn.0 * rigid.state.velocity.0);
            Motion::Fly(Rigid { state, icrf_from_hull: Rotation::new(turn.0 * rigid.icrf_from_hull.0), ..rigid })
        }
    };
    moved.ship.motion = kept;
    moved
}

/// A copy of the World at a recorded pose, to be drawn.
pub fn posed(world: &World, pose: &crate::world::ship::recorder::Pose) -> World {
    let mut shown = world.clone();
    shown.time = pose.time;
    shown.ship.motion = Motion::Crashed(Resting { body: pose.body, position: pose.position, fixed_from_hull: pose.fixed_from_hull });
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::space::sphere;

    #[test]
    fn the_ship_keeps_its_place_over_the_ground() {
        for world in crate::save::fixture::worlds() {
            let moved = moved_clock(&world, 5.25);
            assert!((moved.time.since(world.time) - 5.25 * HOUR).abs() < 0.1);
            let place = |w: &World| {
                let rigid = w.rigid();
                let r = rigid.state.position.0;
                let fixed = w.system.body(rigid.body).spin.icrf_from_fixed(w.time).inverse().raw(r);
                (sphere::lat_lon_of(fixed), r.length())
            };
            let (((a, b), h), ((c, d), k)) = (place(&world), place(&moved));
            assert!((a - c).abs() < 1e-9 && libm::remainder(b - d, core::f64::consts::TAU).abs() < 1e-9 && (h - k).abs() < 1e-3);
        }
    }
}
