//! The loop of the window: events in, ticks, one frame out. [`asked`] is what menus and view controls ask for,
//! [`drawing`] the frame, [`watch`] the hot reload, [`air`] the editor of airs.

mod air;
mod asked;
mod drawing;
mod watch;

use super::ahead::Ahead;
use super::canvas::Canvas;
use super::clock::Clock;
use super::flight::{self, Flight};
use super::follow::Follow;
use super::job::{Job, Outcome};
use super::{Opening, refuse};
use crate::cli::{Backend, DEFAULT_START};
use crate::command::Action;
use crate::hud::{Hud, Lists, Screen};
use crate::input::controls::{Analogue, Control};
use crate::input::{Focus, Input, Step};
use crate::mode::open::{self, Start};
use crate::save::Slots;
use crate::settings::Settings;
use crate::sound::{Sound, Volumes};
use crate::view::CameraMode;
use crate::world::World;
use crate::world::eclipse::almanac::Event;
use crate::world::readout::Situation;
use crate::world::system::System;
use engine::gpu::BackendChoice;
use engine::render::{RenderError, Renderer, RendererOptions};
use engine::space::relative::narrow;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize, Size};
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
    entered: Screen,
    input: Input,
    hud: Hud,
    sound: Option<Sound>,
    canvas: Option<Canvas>,
    renderer: Option<Renderer>,
    pipelines: Option<Job<Result<Renderer, RenderError>>>,
    world: Option<Job<Begun>>,
    eclipses: Option<Job<Vec<Event>>>,
    flight: Option<Flight>,
    /// The paths of the flight's bodies, being worked out.
    ahead: Option<Ahead>,
    watch: Follow,
    /// The flight's system with the edited air: drawn, never flown.
    trial: Option<Arc<System>>,
    clicked: Vec<Action>,
    clock: Clock,
    last: Instant,
    drag: Option<(f64, f64)>,
    crashed_s: f64,
    straight_in: bool,
    quitting: bool,
    still: drawing::Still,
    began: Instant,
    /// Frames of the 3-D picture so far.
    drawn: u64,
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
            entered: Screen::Main,
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
            eclipses: None,
            flight: None,
            ahead: None,
            watch: Follow::default(),
            trial: None,
            clicked: Vec::new(),
            clock: Clock::default(),
            last: Instant::now(),
            drag: None,
            crashed_s: 0.0,
            quitting: false,
            still: drawing::Still::default(),
            began: Instant::now(),
            drawn: 0,
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
        let at_hand = self.flight.as_ref().filter(|_| !self.watch.stale).map(|f| f.session.world.clone());
        self.world = Some(Job::spawn(move |progress| match what {
            Start::Named(key) => flight::begin(&assets, &key, at_hand.as_ref(), progress).map(|w| (w, Vec::new())),
            Start::Save(loaded) => flight::restore(&assets, &loaded, at_hand.as_ref(), progress),
        }));
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
        self.hear_watch();
        self.hear_air();
        self.hear_eclipses();
        self.hud.paths_ahead = self.ahead.as_mut().and_then(Ahead::poll);
        self.set_focus();
        self.step_through_menus();
        // Quick and automatic saves were written since.
        if self.hud.screen != std::mem::replace(&mut self.entered, self.hud.screen)
            && matches!(self.hud.screen, Screen::Saves | Screen::Main)
        {
            self.lists = flight::lists(&self.opening.assets, &self.slots);
        }
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
                self.hud.warn(&flight.session.world.system.warnings);
                self.input.adopt(&flight.readout);
                self.flight = Some(flight);
                self.still = drawing::Still::default();
                self.watch_system();
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
        let typing = self.canvas.as_ref().is_some_and(|c| c.ctx.text_edit_focused());
        let focus = if self.hud.options.waiting.is_some() || typing {
            Focus::Text
        } else if self.hud.screen.runs() && !self.hud.help && self.hud.message.is_none() {
            let free = self.hud.screen == Screen::Flight && self.flight.as_ref().is_some_and(|f| f.rig.mode == CameraMode::Free);
            // Shift is finer there, and no throttle.
            let editing = self.hud.screen == Screen::Map && self.hud.map.editing();
            if free || editing { Focus::Camera } else { Focus::Flight }
        } else {
            Focus::Menu
        };
        if let (Focus::Flight | Focus::Camera, Some(canvas)) = (focus, &self.canvas) {
            // Tab or an arrow must not wander through the panels in flight: Enter would press what it stands on.
            canvas.ctx.memory_mut(|m| m.focused().map(|id| m.surrender_focus(id)));
        }
        self.input.set_focus(focus);
    }

    /// A pad's way through menus: what the arrows and Enter do on a keyboard.
    fn step_through_menus(&mut self) {
        for step in self.input.take_steps() {
            let key = match step {
                Step::Up => egui::Key::ArrowUp,
                Step::Down => egui::Key::ArrowDown,
                Step::Left => egui::Key::ArrowLeft,
                Step::Right => egui::Key::ArrowRight,
                Step::Take => egui::Key::Enter,
            };
            // While a control is bound, the press is the binding's.
            if let (Some(canvas), None) = (&mut self.canvas, &self.hud.options.waiting) {
                canvas.press(key);
            }
        }
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

    fn look(&mut self, dt_s: f64) {
        let Some(flight) = &mut self.flight else { return };
        let rate = LOOK_RAD_PER_S * dt_s.min(0.1);
        let (left, up) = (self.input.deflection(Analogue::LookLeft), self.input.deflection(Analogue::LookUp));
        if left != 0.0 || up != 0.0 {
            flight.rig.look(left * rate, up * rate);
        }
        let zoom = f64::from(i8::from(self.input.held(Control::ZoomOut)) - i8::from(self.input.held(Control::ZoomIn)));
        if zoom != 0.0 && self.hud.screen == Screen::Map {
            if !self.hud.map.editing() {
                self.hud.map.zoom(libm::exp(zoom * 1.5 * dt_s.min(0.1)));
            }
        } else if zoom != 0.0 {
            zoomed(flight, zoom * 1.5 * dt_s.min(0.1));
        }
        if self.hud.screen == Screen::Flight {
            flight.fly(self.input.camera_push().into(), dt_s.min(0.25));
        }
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
        let view = matches!(self.hud.screen, Screen::Flight | Screen::Photo | Screen::Air | Screen::Crash);
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
                    zoomed(flight, -0.12 * steps.clamp(-20.0, 20.0));
                }
            }
            _ => {}
        }
    }
}

/// Farther by a factor of e to the `by`; the free camera, which hangs at nothing, becomes slower.
fn zoomed(flight: &mut Flight, by: f64) {
    if flight.rig.mode == CameraMode::Free {
        flight.change_pace(libm::exp(-2.0 * by));
    } else {
        flight.rig.zoom(libm::exp(by));
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
        // A size that is asked for is in pixels, as pictures are; otherwise the window is as large on every display.
        let size = self.opening.args.size.map_or(Size::from(LogicalSize::new(1280, 720)), |(w, h)| PhysicalSize::new(w, h).into());
        let attributes = Window::default_attributes().with_title("Syzygy").with_inner_size(size);
        let window = match event_loop.create_window(attributes) {
            Ok(window) => Arc::new(window),
            Err(e) => return self.end(event_loop, &format!("no window can be opened: {e}")),
        };
        match Canvas::open(window, self.backend(), &self.settings.video) {
            Ok(canvas) => {
                // A processor that draws takes an eighth of the time for a picture of a third of the width; the player may raise it.
                if canvas.gpu.info.device_type == wgpu::DeviceType::Cpu && !self.opening.data.join(crate::settings::FILE).exists() {
                    self.settings.video.render_scale = 0.35;
                    (self.settings.video.sky_points, self.settings.video.sky_error) = (4, 0.03);
                    self.hud.notice("No graphics card was found: the picture is drawn at a third of the resolution (Settings > Picture)");
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
            WindowEvent::ScaleFactorChanged { .. } => {
                if let Some(canvas) = &mut self.canvas {
                    let size = canvas.window.inner_size();
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
