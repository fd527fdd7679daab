//! One frame out: the World that is shown, the picture, the HUD over it, and pictures that are saved.

use super::App;
use crate::hud::{Reply, Scene, Screen, loading, photo};
use crate::mode::window::canvas::Next;
use crate::mode::window::clock::bounded;
use crate::mode::window::picture_path;
use crate::view::{Picture, Rig, snapshot};
use crate::world::World;
use engine::render::{OffscreenImage, RenderError, Target};
use engine::scene::{AutoOr, Force};
use engine::time::SimTime;
use engine::units::DEG;
use std::time::Instant;

/// How long a picture stands behind a menu where drawing is slow, s.
const STILL_S: f64 = 5.0;

/// The picture behind a menu: nothing moves there, so that a smaller image is drawn again only when something has changed, and
/// now and then for the exposure's sake. A processor that draws would else be too slow for its own menus.
#[derive(Default)]
pub(super) struct Still {
    taken: Option<(Instant, Rig, [u32; 2], SimTime)>,
}

impl Still {
    fn holds(&self, screen: Screen, rig: &Rig, size_px: [u32; 2], world: &World) -> bool {
        let menu = matches!(screen, Screen::Main | Screen::Starts | Screen::Calendar | Screen::Saves | Screen::Options | Screen::Pause);
        let Some((at, its_rig, its_size, time)) = &self.taken else { return false };
        menu && its_rig == rig && *its_size == size_px && *time == world.time && at.elapsed().as_secs_f64() < STILL_S
    }
}

impl App {
    /// The World that is drawn: the flight's own, or a copy: with the clock moved, with an edited air, at a pose before the crash.
    pub(super) fn shown(&self) -> Option<World> {
        let flight = self.flight.as_ref()?;
        let world = &flight.session.world;
        match self.hud.screen {
            Screen::Photo if self.hud.photo.hours != 0.0 => Some(photo::moved_clock(world, self.hud.photo.hours)),
            Screen::Air => {
                let mut copy = photo::moved_clock(world, self.hud.air.hours);
                if let Some(trial) = &self.trial {
                    copy.system = trial.clone();
                }
                Some(copy)
            }
            Screen::Crash if self.hud.crash.back_s > 0.0 => {
                world.ship.ground.recorder.at(self.hud.crash.back_s).map(|pose| photo::posed(world, &pose))
            }
            _ => None,
        }
    }

    pub(super) fn rig(&self) -> Rig {
        let mut rig = self.flight.as_ref().map(|f| f.rig.clone()).unwrap_or_default();
        let photo = self.hud.screen == Screen::Photo;
        let ev = self.settings.video.exposure_ev + if photo { self.hud.photo.ev } else { 0.0 };
        rig.exposure = AutoOr::Auto { compensation_ev: ev };
        rig.fov_y_rad = self.hud.photo.fov_deg.filter(|_| photo).unwrap_or(self.settings.video.fov_deg) * DEG;
        rig
    }

    pub(super) fn draw(&mut self, dt_s: f64) -> Result<(), RenderError> {
        let (rig, copy) = (self.rig(), self.shown());
        let (Some(canvas), Some(renderer), Some(flight)) = (&mut self.canvas, &mut self.renderer, &mut self.flight) else {
            return Ok(());
        };
        let Next::Picture(texture) = canvas.acquire() else { return Ok(()) };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let world = copy.as_ref().unwrap_or(&flight.session.world);
        let time = world.time;
        let covered = matches!(self.hud.screen, Screen::Map | Screen::Surface);
        let scaled = canvas.scaled(self.settings.video.render_scale);
        let size_px = scaled.as_ref().map_or_else(|| canvas.size(), |(image, _)| image.size);
        renderer.set_sky(self.settings.video.sky_points, self.settings.video.sky_error);
        let alpha = if self.hud.screen.runs() { self.clock.alpha() } else { 0.0 };
        // The first picture of a flight is a whole one, its ground and its exposure: a sea would else stand for land that is still on its way.
        let adapt_s = self.still.taken.is_some().then(|| bounded(dt_s));
        let picture = Picture { size_px, alpha, adapt_s, force: Force::default() };
        let held = scaled.is_some() && !covered && self.still.holds(self.hud.screen, &rig, size_px, world);
        let scene = (!covered && !held).then(|| snapshot(world, &rig, &picture).0);

        let mut reply = Reply::default();
        let readout = copy.as_ref().map_or_else(|| flight.readout.clone(), World::readout);
        let (hud, lists, settings, input) = (&mut self.hud, &self.lists, &mut self.settings, &mut self.input);
        let behind = scaled.as_ref().filter(|_| !covered).map(|(_, id)| *id);
        canvas.paint(|ctx| {
            if let Some(id) = behind {
                let all = egui::Rect::from_min_max(egui::Pos2::ZERO, egui::Pos2::new(1.0, 1.0));
                ctx.layer_painter(egui::LayerId::background()).image(id, ctx.content_rect(), all, egui::Color32::WHITE);
            }
            let told = Scene { readout: &readout, world, snapshot: scene.as_ref() };
            let r = hud.show(ctx, Some(&told), lists, settings, input);
            reply.actions.extend(r.actions);
            reply.requests.extend(r.requests);
        });
        if let Some(sound) = &mut self.sound {
            sound.update(&flight.readout, !self.hud.screen.runs());
        }
        match (&scene, &scaled) {
            (Some(scene), Some((image, _))) => {
                renderer.render(&canvas.gpu, scene, Target::Image(image), None)?;
                canvas.draw_alone(&view);
            }
            (Some(scene), None) => {
                canvas.painter.alone = false;
                let target = Target::Surface { view: &view, format: canvas.format(), size: canvas.size() };
                renderer.render(&canvas.gpu, scene, target, Some(&mut canvas.painter))?;
            }
            (None, _) => canvas.draw_alone(&view),
        }
        canvas.window.pre_present_notify();
        canvas.gpu.queue.present(texture);
        self.revived = false;
        if scene.is_some() {
            self.still = Still { taken: Some((Instant::now(), rig, size_px, time)) };
            if self.drawn == 0 && canvas.gpu.wait().is_ok() {
                tracing::info!("first picture after {:.1} s", self.began.elapsed().as_secs_f64());
            }
            self.drawn += 1;
        }
        self.clicked.extend(reply.actions);
        for request in reply.requests {
            self.request(request);
        }
        Ok(())
    }

    pub(super) fn draw_loading(&mut self) {
        let Some(canvas) = &mut self.canvas else { return };
        let part = |done: bool, job: Option<(f32, &str)>| if done { 1.0 } else { job.map_or(0.0, |(f, _)| f) };
        let pipelines = self.pipelines.as_ref().map(|j| (j.fraction, j.what.as_str()));
        let world = self.world.as_ref().map(|j| (j.fraction, j.what.as_str()));
        let fraction = 0.5 * (part(self.renderer.is_some(), pipelines) + part(self.flight.is_some(), world));
        let what = world.or(pipelines).map_or("", |(_, what)| what).to_owned();
        let Next::Picture(texture) = canvas.acquire() else { return };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        canvas.paint(|ctx| loading::show(ctx, fraction, &what));
        canvas.draw_alone(&view);
        canvas.window.pre_present_notify();
        canvas.gpu.queue.present(texture);
    }

    pub(super) fn save_picture(&mut self) -> Result<String, String> {
        let (rig, copy) = (self.rig(), self.shown());
        let (Some(canvas), Some(renderer), Some(flight)) = (&self.canvas, &mut self.renderer, &self.flight) else {
            return Err("nothing is drawn yet".to_owned());
        };
        let world = copy.as_ref().unwrap_or(&flight.session.world);
        let image = OffscreenImage::new(&canvas.gpu, canvas.size());
        let picture = Picture { size_px: image.size, alpha: 0.0, adapt_s: None, force: Force::default() };
        let (scene, _) = snapshot(world, &rig, &picture);
        renderer.render(&canvas.gpu, &scene, Target::Image(&image), None).map_err(|e| e.to_string())?;
        let pixels = image.read_rgba8(&canvas.gpu).map_err(|e| e.to_string())?;
        let path = picture_path(&self.opening.data, world.time);
        if let Some(dir) = path.parent() {
            std::fs::create_dir_all(dir).map_err(|e| format!("{}: {e}", dir.display()))?;
        }
        crate::picture::write_png(&path, image.size[0], image.size[1], &pixels).map_err(|e| e.to_string())?;
        Ok(format!("Picture saved: {}", path.display()))
    }
}
