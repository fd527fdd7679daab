//! The loop of the window: events in, ticks, one frame out.

use super::canvas::{Canvas, Next};
use super::clock::{Clock, bounded};
use super::flight::{self, Flight};
use super::job::{Job, Outcome};
use super::{Opening, picture_path, refuse};
use crate::cli::{Backend, DEFAULT_START};
use crate::command::Action;
use crate::hud::{Hud, Lists, Reply, Request, Scene, Screen, loading, photo};
use crate::input::controls::{Analogue, Control};
use crate::input::{Focus, Input};
use crate::mode::open::{self, Start};
use crate::save::Slots;
use crate::save::slots::Kind;
use crate::settings::Settings;
use crate::sound::{Sound, Volumes};
use crate::view::{Picture, Rig, snapshot};
use crate::world::World;
use crate::world::readout::Situation;
use engine::gpu::BackendChoice;
use engine::render::{OffscreenImage, RenderError, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Force};
use engine::space::relative::narrow;
use engine::units::DEG;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::PhysicalKey;
use winit::window::{Window, WindowId};

/// Radians that the view turns for a pixel of the mouse, at a scale factor of 1.
const LOOK_RAD_PER_PX: f64 = 0.004;
/// Radians a second that a stick turns the view at full deflection.
const LOOK_RAD_PER_S: f64 = 1.6;
/// Seconds between a crash and its screen.
const CRASH_PAUSE_S: f64 = 1.8;

type Begun = Result<(World, Vec<String>), String>;

/// The application.
pub struct App {
    /// What the program ends with.
    pub exit: ExitCode,
    opening: Opening,
    settings: Settings,
    slots: Slots,
    lists: Lists,
    input: Input,
    hud: Hud,
    sound: Option<Sound>,
    canvas: Option<Canvas>,
    renderer: Option<Renderer>,
    pipelines: Option<Job<Result<Renderer, RenderError>>>,
    world: Option<Job<Begun>>,
    flight: Option<Flight>,
    clicked: Vec<Action>,
    clock: Clock,
    last: Instant,
    drag: Option<(f64, f64)>,
    crashed_s: f64,
    straight_in: bool,
    quitting: bool,
    /// A device was lost and made again; a second time in a row is an end.
    revived: bool,
}

impl App {
    /// Before the window is there.
    pub fn new(opening: Opening, settings: Settings, complaint: Option<String>) -> Self {
        let slots = Slots::new(&opening.data);
        let mut hud = Hud { message: complaint.clone(), ..Hud::default() };
        if let Some(text) = &complaint {
            eprintln!("warning: {text}");
        }
        let sound = match Sound::new(&volumes(&settings)) {
            Ok(sound) => Some(sound),
            Err(notice) => {
                hud.notice(notice.to_string());
                None
            }
        };
        Self {
            exit: ExitCode::SUCCESS,
            lists: flight::lists(&opening.assets, &slots),
            input: Input::new(settings.controls.clone()),
            straight_in: opening.args.start.is_some(),
            opening,
            settings,
            slots,
            hud,
            sound,
            canvas: None,
            renderer: None,
            pipelines: None,
            world: None,
            flight: None,
            clicked: Vec::new(),
            clock: Clock::default(),
            last: Instant::now(),
            drag: None,
            crashed_s: 0.0,
            quitting: false,
            revived: false,
        }
    }

    fn backend(&self) -> BackendChoice {
        self.opening.args.backend.map_or(BackendChoice::Auto, Backend::choice)
    }

    /// Starts building pipelines on a thread.
    fn build_pipelines(&mut self) {
        let Some(canvas) = &self.canvas else { return };
        let gpu = canvas.gpu.clone();
        let stars = self.opening.assets.overlay.find(std::path::Path::new("stars/stars.bin"));
        self.pipelines = Some(Job::spawn(move |progress| {
            progress(0.1, "Building pipelines");
            let mut renderer = Renderer::new(&gpu, RendererOptions::default())?;
            progress(0.8, "Stars");
            let catalogue = stars.and_then(|path| std::fs::read(path).ok());
            match catalogue.map(|bytes| engine::render::StarCatalogue::parse(&bytes)) {
                Some(Ok(catalogue)) => renderer.set_stars(&gpu, catalogue),
                Some(Err(e)) => tracing::warn!("stars/stars.bin: {e}"),
                None => tracing::warn!("stars/stars.bin is missing: the sky has no stars"),
            }
            Ok(renderer)
        }));
    }

    /// Starts a flight on a thread: from a start, or from a save.
    fn begin(&mut self, what: Start) {
        let assets = self.opening.assets.clone();
        let at_hand = self.flight.as_ref().map(|f| f.session.world.clone());
        self.world = Some(Job::spawn(move |progress| match what {
            Start::Named(key) => flight::begin(&assets, &key, at_hand.as_ref(), progress).map(|w| (w, Vec::new())),
            Start::Save(loaded) => flight::restore(&assets, &loaded, at_hand.as_ref(), progress),
        }));
    }

    fn load(&mut self, path: Option<PathBuf>) {
        let read = match path {
            Some(path) => flight::read(&self.slots, &path),
            None => self.slots.load_newest(None, &crate::save::decode).map_err(|e| e.to_string()),
        };
        match read {
            Ok(loaded) => {
                self.straight_in = true;
                self.begin(Start::Save(Box::new(loaded)));
            }
            Err(e) => self.hud.message = Some(e),
        }
    }

    fn frame(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        let dt_s = now.duration_since(self.last).as_secs_f64();
        self.last = now;
        self.hear_jobs(event_loop);
        self.input.poll_pads();
        for notice in self.input.take_notices() {
            self.hud.notice(notice);
        }
        if self.renderer.is_none() || self.flight.is_none() {
            self.draw_loading();
            // The threads that load need the processor more than this screen does.
            std::thread::sleep(std::time::Duration::from_millis(40));
            return;
        }
        self.set_focus();
        for control in self.input.take_view_controls() {
            self.control(control);
        }
        self.tick(dt_s);
        self.look(dt_s);
        tracing::debug!("frame: {:.0} ms", dt_s * 1e3);
        if let Err(e) = self.draw(dt_s) {
            self.revive(event_loop, &e);
        }
        if self.quitting {
            event_loop.exit();
        }
    }

    fn hear_jobs(&mut self, event_loop: &ActiveEventLoop) {
        match self.pipelines.as_mut().map(Job::poll) {
            Some(Outcome::Done(Ok(renderer))) => (self.renderer, self.pipelines) = (Some(renderer), None),
            Some(Outcome::Done(Err(e))) => return self.end(event_loop, &e.to_string()),
            Some(Outcome::Died) => return self.end(event_loop, "building the pipelines failed; run with -v to see more"),
            _ => {}
        }
        let begun = match self.world.as_mut().map(Job::poll) {
            Some(Outcome::Done(begun)) => begun,
            Some(Outcome::Died) => Err("loading failed; run with -v to see more".to_owned()),
            _ => return,
        };
        self.world = None;
        match begun {
            Ok((world, notes)) => {
                let flight = Flight::new(world);
                self.input.adopt(&flight.readout);
                self.flight = Some(flight);
                self.clock.rest();
                self.crashed_s = 0.0;
                self.hud.screen = if std::mem::take(&mut self.straight_in) { Screen::Flight } else { Screen::Main };
                self.hud.hidden = false;
                if !notes.is_empty() {
                    self.hud.message = Some(notes.join("\n"));
                }
                self.apply();
            }
            // Without any flight there is nothing to fall back on.
            Err(e) if self.flight.is_none() => self.end(event_loop, &e),
            Err(e) => self.hud.message = Some(e),
        }
    }

    fn set_focus(&mut self) {
        let typing = self.canvas.as_ref().is_some_and(|c| c.ctx.egui_wants_keyboard_input());
        let focus = if self.hud.options.waiting.is_some() || typing {
            Focus::Text
        } else if self.hud.screen.runs() && !self.hud.help && self.hud.message.is_none() {
            Focus::Flight
        } else {
            Focus::Menu
        };
        self.input.set_focus(focus);
    }

    fn tick(&mut self, dt_s: f64) {
        let Some(flight) = &mut self.flight else { return };
        if !self.hud.screen.runs() {
            self.clock.rest();
            return;
        }
        let ticks = self.clock.advance(dt_s);
        let told = flight.run(ticks, &mut self.input, &mut self.clicked, &self.slots);
        for notice in told.notices {
            self.hud.notice(notice);
        }
        if flight.readout.situation == Situation::Crashed {
            self.crashed_s += dt_s;
            if self.crashed_s > CRASH_PAUSE_S {
                self.hud.crash = Default::default();
                self.hud.screen = Screen::Crash;
            }
        } else {
            self.crashed_s = 0.0;
        }
        if told.look_on_disk {
            self.quickload();
        }
    }

    fn quickload(&mut self) {
        match self.slots.load_newest(Some(&Kind::Quick), &crate::save::decode) {
            Ok(loaded) => {
                self.straight_in = true;
                self.begin(Start::Save(Box::new(loaded)));
            }
            Err(_) => self.hud.notice("There is no quick save yet"),
        }
    }

    fn look(&mut self, dt_s: f64) {
        let Some(flight) = &mut self.flight else { return };
        let rate = LOOK_RAD_PER_S * dt_s.min(0.1);
        let (left, up) = (self.input.deflection(Analogue::LookLeft), self.input.deflection(Analogue::LookUp));
        if left != 0.0 || up != 0.0 {
            flight.rig.look(left * rate, up * rate);
        }
        let zoom = f64::from(i8::from(self.input.held(Control::ZoomOut)) - i8::from(self.input.held(Control::ZoomIn)));
        if zoom != 0.0 {
            flight.rig.zoom(libm::exp(zoom * 1.5 * dt_s.min(0.1)));
        }
    }

    /// A control of the view or the game.
    fn control(&mut self, control: Control) {
        use Control as C;
        let screen = self.hud.screen;
        let flip = |to: Screen| if screen == to { Screen::Flight } else { to };
        match control {
            C::Pause if self.hud.help => self.hud.help = false,
            C::Pause if self.hud.message.is_some() => self.hud.message = None,
            C::Pause => match screen {
                Screen::Flight => self.hud.screen = Screen::Pause,
                Screen::Main | Screen::Crash => {}
                Screen::Starts | Screen::Saves | Screen::Options => {
                    self.hud.screen = self.hud.back();
                    self.keep();
                }
                _ => self.hud.screen = Screen::Flight,
            },
            C::Help => self.hud.help = !self.hud.help,
            C::Map if screen.runs() => self.hud.screen = flip(Screen::Map),
            C::SurfaceMap if screen.runs() => self.hud.screen = flip(Screen::Surface),
            C::Photo if matches!(screen, Screen::Flight | Screen::Pause) => {
                self.hud.photo.enter();
                self.hud.screen = Screen::Photo;
            }
            C::Photo if screen == Screen::Photo => self.hud.screen = Screen::Flight,
            C::HideHud if screen == Screen::Photo => self.hud.photo.panel = !self.hud.photo.panel,
            C::HideHud => self.hud.hidden = !self.hud.hidden,
            C::Camera => self.request(Request::NextCamera),
            C::SavePicture => self.request(Request::Picture),
            C::Quicksave => self.request(Request::Quicksave),
            C::Quickload => self.request(Request::Quickload),
            _ => {}
        }
    }

    fn request(&mut self, request: Request) {
        match request {
            Request::NewFlight(key) => {
                self.straight_in = true;
                self.begin(Start::Named(key));
            }
            Request::Load(path) => self.load(Some(path)),
            Request::Continue => self.load(None),
            Request::SaveAs(name) => {
                if let Some(flight) = &self.flight {
                    let text = flight.save(&self.slots, &Kind::Named(name));
                    self.hud.notice(text);
                    self.lists = flight::lists(&self.opening.assets, &self.slots);
                }
            }
            Request::Leave => {
                self.auto_save();
                self.hud.screen = Screen::Main;
                self.lists = flight::lists(&self.opening.assets, &self.slots);
            }
            Request::Quit => {
                self.keep();
                self.quitting = true;
            }
            Request::Apply => self.apply(),
            Request::Keep => self.keep(),
            Request::Picture => {
                let text = self.save_picture().unwrap_or_else(|e| format!("No picture was saved: {e}"));
                self.hud.notice(text);
            }
            Request::NextCamera => {
                if let Some(flight) = &mut self.flight {
                    let name = flight.next_camera();
                    self.hud.notice(name);
                }
            }
            Request::Quicksave => self.clicked.push(Action::Quicksave),
            Request::Quickload if self.hud.screen.runs() => self.clicked.push(Action::Quickload),
            Request::Quickload => {
                // The World stands still: let one tick take the session's own slot back, as if it had been pressed in flight.
                self.hud.screen = Screen::Flight;
                self.clicked.push(Action::Quickload);
            }
        }
    }

    fn apply(&mut self) {
        if let Some(canvas) = &mut self.canvas {
            canvas.apply(&self.settings.video);
        }
        self.input.bindings = self.settings.controls.clone();
        if let Some(sound) = &mut self.sound {
            sound.set_volumes(&volumes(&self.settings));
        }
    }

    fn keep(&mut self) {
        if let Err(e) = self.settings.save(&self.opening.data) {
            self.hud.notice(e.to_string());
            eprintln!("warning: {e}");
        }
    }

    fn auto_save(&mut self) {
        // The flight behind the main menu is a picture, not a flight.
        if let Some(flight) = self.flight.as_ref().filter(|_| self.hud.screen != Screen::Main) {
            let text = flight.save(&self.slots, &Kind::Auto);
            if text.starts_with("Not") {
                eprintln!("warning: {text}");
            }
            self.hud.notice(text);
        }
    }

    /// The World that is drawn: the flight's own, or a copy with the clock moved, or a pose before the crash.
    fn shown(&self) -> Option<World> {
        let flight = self.flight.as_ref()?;
        let world = &flight.session.world;
        match self.hud.screen {
            Screen::Photo if self.hud.photo.hours != 0.0 => Some(photo::moved_clock(world, self.hud.photo.hours)),
            Screen::Crash if self.hud.crash.back_s > 0.0 => {
                world.ship.ground.recorder.at(self.hud.crash.back_s).map(|pose| photo::posed(world, &pose))
            }
            _ => None,
        }
    }

    fn rig(&self) -> Rig {
        let mut rig = self.flight.as_ref().map(|f| f.rig.clone()).unwrap_or_default();
        let photo = self.hud.screen == Screen::Photo;
        let ev = self.settings.video.exposure_ev + if photo { self.hud.photo.ev } else { 0.0 };
        rig.exposure = AutoOr::Auto { compensation_ev: ev };
        rig.fov_y_rad = self.hud.photo.fov_deg.filter(|_| photo).unwrap_or(self.settings.video.fov_deg) * DEG;
        rig
    }

    fn draw(&mut self, dt_s: f64) -> Result<(), RenderError> {
        let (rig, copy) = (self.rig(), self.shown());
        let (Some(canvas), Some(renderer), Some(flight)) = (&mut self.canvas, &mut self.renderer, &mut self.flight) else {
            return Ok(());
        };
        let Next::Picture(texture) = canvas.next() else { return Ok(()) };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let world = copy.as_ref().unwrap_or(&flight.session.world);
        let covered = matches!(self.hud.screen, Screen::Map | Screen::Surface);
        let scaled = canvas.scaled(self.settings.video.render_scale);
        let size_px = scaled.as_ref().map_or_else(|| canvas.size(), |(image, _)| image.size);
        let alpha = if self.hud.screen.runs() { self.clock.alpha() } else { 0.0 };
        let picture = Picture { size_px, alpha, adapt_s: Some(bounded(dt_s)), force: Force::default() };
        let scene = (!covered).then(|| snapshot(world, &rig, &picture).0);

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
        self.clicked.extend(reply.actions);
        for request in reply.requests {
            self.request(request);
        }
        Ok(())
    }

    fn draw_loading(&mut self) {
        let Some(canvas) = &mut self.canvas else { return };
        let part = |done: bool, job: Option<(f32, &str)>| if done { 1.0 } else { job.map_or(0.0, |(f, _)| f) };
        let pipelines = self.pipelines.as_ref().map(|j| (j.fraction, j.what.as_str()));
        let world = self.world.as_ref().map(|j| (j.fraction, j.what.as_str()));
        let fraction = 0.5 * (part(self.renderer.is_some(), pipelines) + part(self.flight.is_some(), world));
        let what = world.or(pipelines).map_or("", |(_, what)| what).to_owned();
        let Next::Picture(texture) = canvas.next() else { return };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        canvas.paint(|ctx| loading::show(ctx, fraction, &what));
        canvas.draw_alone(&view);
        canvas.window.pre_present_notify();
        canvas.gpu.queue.present(texture);
    }

    fn save_picture(&mut self) -> Result<String, String> {
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

    /// After a frame that was not drawn: a lost device is opened anew once; anything else ends the game, the flight kept.
    fn revive(&mut self, event_loop: &ActiveEventLoop, error: &RenderError) {
        tracing::error!("{error}");
        if self.revived || !matches!(error, RenderError::DeviceLost(_)) {
            return self.end(event_loop, &error.to_string());
        }
        self.revived = true;
        let Some(window) = self.canvas.take().map(|c| c.window) else { return };
        self.renderer = None;
        match Canvas::open(window, self.backend(), &self.settings.video) {
            Ok(canvas) => {
                self.canvas = Some(canvas);
                self.hud.notice("The graphics device was lost and opened anew");
                self.build_pipelines();
            }
            Err(e) => self.end(event_loop, &e.to_string()),
        }
    }

    /// Ends the game with a reason; a flight is kept first.
    fn end(&mut self, event_loop: &ActiveEventLoop, why: &str) {
        self.auto_save();
        self.exit = refuse(why);
        event_loop.exit();
    }

    fn pointer(&mut self, event: &WindowEvent, kept: bool) {
        let over_panel = self.canvas.as_ref().is_some_and(|c| c.ctx.egui_wants_pointer_input());
        let view = matches!(self.hud.screen, Screen::Flight | Screen::Photo | Screen::Crash);
        match event {
            WindowEvent::MouseInput { state, button, .. } => {
                let down = *state == ElementState::Pressed;
                match button {
                    MouseButton::Left | MouseButton::Right => {
                        self.drag = (down && !kept && !over_panel && view).then_some(self.drag.unwrap_or((f64::NAN, f64::NAN)));
                    }
                    MouseButton::Middle => self.input.mouse(2, down),
                    MouseButton::Back => self.input.mouse(3, down),
                    MouseButton::Forward => self.input.mouse(4, down),
                    MouseButton::Other(_) => {}
                }
            }
            WindowEvent::CursorMoved { position, .. } => {
                let Some((x, y)) = self.drag else { return };
                if let (Some(flight), true) = (&mut self.flight, x.is_finite()) {
                    let scale = self.canvas.as_ref().map_or(1.0, |c| c.window.scale_factor().max(0.5));
                    let k = LOOK_RAD_PER_PX / scale * (flight.rig.fov_y_rad / 0.96).min(1.0);
                    flight.rig.look((position.x - x) * k, (position.y - y) * k);
                }
                self.drag = Some((position.x, position.y));
            }
            WindowEvent::MouseWheel { delta, .. } if view && !over_panel => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(_, y) => f64::from(*y),
                    MouseScrollDelta::PixelDelta(p) => p.y / 50.0,
                };
                if let Some(flight) = &mut self.flight {
                    flight.rig.zoom(libm::exp(-0.12 * steps.clamp(-20.0, 20.0)));
                }
            }
            _ => {}
        }
    }
}

fn volumes(settings: &Settings) -> Volumes {
    let s = &settings.sound;
    Volumes { master: narrow(s.master), engine: narrow(s.engine), wind: narrow(s.wind), warning: narrow(s.warning) }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.canvas.is_some() {
            return;
        }
        let (width, height) = self.opening.args.size.unwrap_or((1280, 720));
        let attributes = Window::default_attributes().with_title("Syzygy").with_inner_size(PhysicalSize::new(width, height));
        let window = match event_loop.create_window(attributes) {
            Ok(window) => Arc::new(window),
            Err(e) => return self.end(event_loop, &format!("no window can be opened: {e}")),
        };
        match Canvas::open(window, self.backend(), &self.settings.video) {
            Ok(canvas) => {
                // A processor that draws takes a quarter of the time for a picture of half the width; the player may raise it.
                if canvas.gpu.info.device_type == wgpu::DeviceType::Cpu && !self.opening.data.join(crate::settings::FILE).exists() {
                    self.settings.video.render_scale = 0.5;
                    self.hud.notice("No graphics card was found: the picture is drawn at half resolution (Settings > Picture)");
                }
                self.canvas = Some(canvas);
            }
            Err(e) => return self.end(event_loop, &e.to_string()),
        }
        let start = self.opening.args.start.clone().unwrap_or_else(|| DEFAULT_START.to_owned());
        match open::start(&start) {
            Ok(start) => self.begin(start),
            Err(e) => return self.end(event_loop, &e.to_string()),
        }
        self.draw_loading();
        self.build_pipelines();
        event_loop.set_control_flow(ControlFlow::Poll);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let kept = self.canvas.as_mut().is_some_and(|c| c.event(&event));
        match &event {
            WindowEvent::CloseRequested => {
                self.auto_save();
                self.keep();
                event_loop.exit();
            }
            WindowEvent::Resized(size) => {
                if let Some(canvas) = &mut self.canvas {
                    canvas.resize(size.width, size.height);
                }
            }
            WindowEvent::Focused(false) => {
                self.input.release_all();
                self.drag = None;
            }
            WindowEvent::KeyboardInput { event: key, .. } if !key.repeat => {
                if let PhysicalKey::Code(code) = key.physical_key {
                    self.input.key(code, key.state == ElementState::Pressed);
                }
            }
            WindowEvent::RedrawRequested => self.frame(event_loop),
            other => self.pointer(other, kept),
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some(canvas) = &self.canvas {
            canvas.window.request_redraw();
        }
    }
}
