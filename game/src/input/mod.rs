//! Input: devices become [`Commands`]. Read [`controls`] (what can be done), [`bindings`] (what does it), [`pads`], [`keys`].
//!
//! The throttle lever lives here, because a lever keeps its place between ticks; the World is told when it moves.
//! Not here: what a command does ([`crate::world`]), and clicks on panels ([`crate::hud`]), which are commands, too.

pub mod bindings;
pub mod controls;
pub mod keys;
pub mod pads;

use crate::command::{Action, Axes, Commands, Guidance, Hold, WARP_ONE, WARP_QUARTERS};
use crate::world::readout::Readout;
use bindings::{Bindings, Source};
use controls::{Analogue, Control, Group};
use pads::{PadButton, PadEvent, Pads};
use winit::keyboard::KeyCode;

/// Full throttle is this many steps of a lever that the keys move in one second.
const LEVER_PER_S: f64 = 0.6;
/// How fast a key's deflection comes and goes, per second: a tap is a nudge.
const KEY_SLEW_PER_S: f64 = 7.0;
/// Deflection while "fine control" is held.
const FINE: f64 = 0.2;

/// Who has the keyboard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Focus {
    /// The ship.
    #[default]
    Flight,
    /// The free camera: the ship hears nothing but the clock's controls.
    Camera,
    /// A menu: only Pause, Help and what photo mode needs get through.
    Menu,
    /// A text field, or the binding screen: nothing gets through.
    Text,
}

/// The devices and what is bound to them.
#[derive(Debug)]
pub struct Input {
    /// Bindings in force.
    pub bindings: Bindings,
    /// Gamepads.
    pub pads: Pads,
    focus: Focus,
    keys: Vec<KeyCode>,
    mouse: Vec<u8>,
    queued: Vec<Control>,
    eased: [f64; 6],
    lever: f64,
    lever_sent: u16,
    notices: Vec<String>,
    caught: Option<Source>,
    steps: Vec<Step>,
}

/// A pad's step through a menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Towards a neighbour.
    Up,
    /// Towards a neighbour.
    Down,
    /// Towards a neighbour, or less of something.
    Left,
    /// Towards a neighbour, or more of something.
    Right,
    /// Take it.
    Take,
}

impl Input {
    /// Opens the devices.
    pub fn new(bindings: Bindings) -> Self {
        let pads = Pads::open();
        Self::with_pads(bindings, pads)
    }

    /// With pads that are open already.
    pub fn with_pads(bindings: Bindings, pads: Pads) -> Self {
        let notices = pads.notice.clone().into_iter().collect();
        Self {
            bindings,
            pads,
            focus: Focus::Flight,
            keys: Vec::new(),
            mouse: Vec::new(),
            queued: Vec::new(),
            eased: [0.0; 6],
            lever: 0.0,
            lever_sent: 0,
            notices,
            caught: None,
            steps: Vec::new(),
        }
    }

    /// Who has the keyboard from now on. What is held is let go when the ship loses it.
    pub fn set_focus(&mut self, focus: Focus) {
        if focus != self.focus && !matches!(focus, Focus::Flight | Focus::Camera) {
            self.release_all();
        }
        self.focus = focus;
    }

    /// A key went down or up. Auto-repeat is to be left out by the caller.
    pub fn key(&mut self, code: KeyCode, down: bool) {
        if down {
            if !self.keys.contains(&code) {
                self.keys.push(code);
                self.press(Source::Key(code));
            }
        } else {
            self.keys.retain(|k| *k != code);
        }
    }

    /// A mouse button (2: middle, 3, 4: side) went down or up.
    pub fn mouse(&mut self, button: u8, down: bool) {
        if down && !self.mouse.contains(&button) {
            self.mouse.push(button);
            self.press(Source::Mouse(button));
        } else if !down {
            self.mouse.retain(|b| *b != button);
        }
    }

    /// Lets go of everything (the window lost the keyboard, a menu opened).
    pub fn release_all(&mut self) {
        self.keys.clear();
        self.mouse.clear();
        self.queued.clear();
    }

    /// Takes over the lever's place from a World that was loaded or newly begun.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn adopt(&mut self, ship: &Readout) {
        self.lever = ship.throttle.clamp(0.0, 1.0);
        self.lever_sent = (self.lever * 65_535.0).round() as u16;
        self.eased = [0.0; 6];
        self.queued.clear();
    }

    /// Reads the gamepads. To be called once a frame, also in menus, so that hot-plug and binding work there.
    pub fn poll_pads(&mut self) {
        for event in self.pads.poll() {
            match event {
                PadEvent::Pressed(button) => self.press(Source::Pad(button)),
                PadEvent::Connected(name) => self.notices.push(format!("{name} connected")),
                PadEvent::Disconnected(name) => self.notices.push(format!("{name} disconnected")),
            }
        }
    }

    /// Small notices for the player since the last call.
    pub fn take_notices(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notices)
    }

    /// The last source pressed while [`Focus::Text`] held, for the binding screen.
    pub fn take_caught(&mut self) -> Option<Source> {
        self.caught.take()
    }

    /// What pads pressed in menus since the last call. Fixed: what is bound is heard in flight only.
    pub fn take_steps(&mut self) -> Vec<Step> {
        std::mem::take(&mut self.steps)
    }

    /// Controls of the view and the game (camera, map, pause, saves …) pressed since the last call.
    pub fn take_view_controls(&mut self) -> Vec<Control> {
        let is_view = |c: &Control| matches!(c.group(), Group::View | Group::Game);
        let taken = self.queued.iter().copied().filter(is_view).collect();
        self.queued.retain(|c| !is_view(c));
        taken
    }

    /// Deflection of an analogue control by all pads together, in [−1, 1].
    pub fn deflection(&self, control: Analogue) -> f64 {
        let Some(list) = self.bindings.axes.get(&control) else { return 0.0 };
        let mut sum = 0.0;
        for binding in list {
            for (device, raw) in self.pads.deflections(binding.axis) {
                let own = self.bindings.device_dead_zone.get(device).copied().unwrap_or(0.0);
                sum += binding.shape(raw, own);
            }
        }
        sum.clamp(-1.0, 1.0)
    }

    /// True while a control is held and the ship or the camera has the keyboard.
    pub fn held(&self, control: Control) -> bool {
        matches!(self.focus, Focus::Flight | Focus::Camera)
            && self.bindings.sources(control).iter().any(|s| match s {
                Source::Key(code) => self.keys.contains(code),
                Source::Mouse(button) => self.mouse.contains(button),
                Source::Pad(button) => self.pads.pressed(*button),
            })
    }

    /// The commands of the next tick. `dt_s` is the length of a tick; `ship` is what the World last told.
    pub fn sample(&mut self, dt_s: f64, ship: &Readout) -> Commands {
        let mut commands = Commands::default();
        if matches!(self.focus, Focus::Flight | Focus::Camera) {
            let flies = self.focus == Focus::Flight;
            if flies {
                commands.axes = self.axes(dt_s);
                self.move_lever(dt_s, ship, &mut commands.actions);
            } else {
                self.eased = [0.0; 6];
            }
            let pressed: Vec<Control> = self.queued.iter().copied().filter(|c| !matches!(c.group(), Group::View | Group::Game)).collect();
            self.queued.retain(|c| matches!(c.group(), Group::View | Group::Game));
            for control in pressed.into_iter().filter(|c| flies || c.group() == Group::Time) {
                self.act(control, ship, &mut commands.actions);
            }
        } else {
            self.eased = [0.0; 6];
        }
        self.tell_lever(ship, &mut commands.actions);
        commands
    }

    /// Where the free camera is pushed: right, up, back, each −1 … 1, by what turns and shifts the ship otherwise.
    pub fn camera_push(&self) -> [f64; 3] {
        use Control as C;
        let keys = |plus: [Control; 2], minus: [Control; 2]| {
            f64::from(i8::from(plus.iter().any(|c| self.held(*c))) - i8::from(minus.iter().any(|c| self.held(*c))))
        };
        let right = keys([C::YawRight, C::TranslateRight], [C::YawLeft, C::TranslateLeft]) + self.deflection(Analogue::Roll);
        let up = keys([C::CameraUp, C::TranslateUp], [C::CameraDown, C::TranslateDown]) + self.deflection(Analogue::Throttle);
        let back = keys([C::PitchUp, C::TranslateBack], [C::PitchDown, C::TranslateForward]) + self.deflection(Analogue::Pitch);
        let fine = if self.held(C::Fine) { FINE } else { 1.0 };
        [right, up, back].map(|v| v.clamp(-1.0, 1.0) * fine)
    }

    fn press(&mut self, source: Source) {
        if let (Focus::Menu | Focus::Text, Source::Pad(button)) = (self.focus, source) {
            match button {
                PadButton::DPadUp => self.steps.push(Step::Up),
                PadButton::DPadDown => self.steps.push(Step::Down),
                PadButton::DPadLeft => self.steps.push(Step::Left),
                PadButton::DPadRight => self.steps.push(Step::Right),
                PadButton::South => self.steps.push(Step::Take),
                PadButton::East if self.focus == Focus::Menu => return self.queued.push(Control::Pause),
                _ => {}
            }
        }
        if self.focus == Focus::Text {
            self.caught = Some(source);
            return;
        }
        for control in Control::ALL {
            let heard = matches!(self.focus, Focus::Flight | Focus::Camera) || control.is_heard_in_panels();
            if heard && self.bindings.sources(*control).contains(&source) {
                self.queued.push(*control);
            }
        }
    }

    fn axes(&mut self, dt_s: f64) -> Axes {
        use Control as C;
        const PAIRS: [(Control, Control, Analogue); 6] = [
            (C::PitchUp, C::PitchDown, Analogue::Pitch),
            (C::YawLeft, C::YawRight, Analogue::Yaw),
            (C::RollRight, C::RollLeft, Analogue::Roll),
            (C::TranslateRight, C::TranslateLeft, Analogue::Right),
            (C::TranslateUp, C::TranslateDown, Analogue::Up),
            (C::TranslateForward, C::TranslateBack, Analogue::Forward),
        ];
        let fine = if self.held(C::Fine) { FINE } else { 1.0 };
        let mut values = [0_i16; 6];
        for (i, (plus, minus, analogue)) in PAIRS.into_iter().enumerate() {
            let keys = f64::from(i8::from(self.held(plus)) - i8::from(self.held(minus)));
            let step = KEY_SLEW_PER_S * dt_s;
            self.eased[i] += (keys - self.eased[i]).clamp(-step, step);
            values[i] = Axes::quantise((self.eased[i] + self.deflection(analogue)) * fine);
        }
        let [pitch, yaw, roll, right, up, forward] = values;
        Axes { pitch, yaw, roll, right, up, forward }
    }

    fn move_lever(&mut self, dt_s: f64, ship: &Readout, actions: &mut Vec<Action>) {
        let keys = f64::from(i8::from(self.held(Control::ThrottleUp)) - i8::from(self.held(Control::ThrottleDown)));
        let rate = keys * LEVER_PER_S + self.deflection(Analogue::Throttle);
        if ship.guidance != Guidance::Manual {
            // The lever follows what flies it, so that taking over makes no jump.
            self.lever = ship.throttle.clamp(0.0, 1.0);
            if rate == 0.0 {
                return;
            }
            actions.push(Action::Guidance(Guidance::Manual));
        }
        self.lever = (self.lever + rate * dt_s).clamp(0.0, 1.0);
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn tell_lever(&mut self, ship: &Readout, actions: &mut Vec<Action>) {
        let taken_over = actions.iter().any(|a| matches!(a, Action::Guidance(Guidance::Manual)));
        let place = (self.lever * 65_535.0).round() as u16;
        if ship.guidance != Guidance::Manual && !taken_over {
            self.lever_sent = place;
        } else if place != self.lever_sent || (taken_over && ship.guidance != Guidance::Manual) {
            self.lever_sent = place;
            actions.push(Action::Throttle(place));
        }
    }

    fn act(&mut self, control: Control, ship: &Readout, actions: &mut Vec<Action>) {
        use Control as C;
        let manual = |actions: &mut Vec<Action>| {
            if ship.guidance != Guidance::Manual {
                actions.push(Action::Guidance(Guidance::Manual));
            }
        };
        let hold = |h: Hold| Action::Hold(if ship.hold == h { Hold::Rate } else { h });
        let top = u8::try_from(WARP_QUARTERS.len() - 1).unwrap_or(WARP_ONE);
        match control {
            C::ThrottleFull => {
                manual(actions);
                self.lever = 1.0;
            }
            C::ThrottleCut => {
                manual(actions);
                self.lever = 0.0;
            }
            C::Gear => actions.push(Action::Gear(!ship.gear_down)),
            C::Refuel => actions.push(Action::Refuel),
            C::KillRotation => actions.push(Action::Hold(Hold::KillRotation)),
            C::HoldPrograde => actions.push(hold(Hold::Prograde)),
            C::HoldRetrograde => actions.push(hold(Hold::Retrograde)),
            C::HoldNormal => actions.push(hold(Hold::Normal)),
            C::HoldAntiNormal => actions.push(hold(Hold::AntiNormal)),
            C::HoldRadialOut => actions.push(hold(Hold::RadialOut)),
            C::HoldRadialIn => actions.push(hold(Hold::RadialIn)),
            C::HoldSurfaceRetrograde => actions.push(hold(Hold::SurfaceRetrograde)),
            C::HoldVertical => actions.push(hold(Hold::SurfaceVertical)),
            C::HoldTarget => actions.push(hold(Hold::Target)),
            C::HoldFree => actions.push(hold(Hold::Free)),
            C::Hover => actions.push(toggle(ship, Guidance::Hover)),
            C::Land => actions.push(toggle(ship, Guidance::Land)),
            C::ClimbFaster => actions.push(Action::Guidance(climb(ship, 1))),
            C::SinkFaster => actions.push(Action::Guidance(climb(ship, -1))),
            C::ManualFlight => actions.push(Action::Guidance(Guidance::Manual)),
            C::WarpUp => actions.push(Action::Warp(ship.warp_asked.min(ship.warp).saturating_add(1).min(top))),
            C::WarpDown => actions.push(Action::Warp(ship.warp.saturating_sub(1))),
            C::WarpOne => actions.push(Action::Warp(WARP_ONE)),
            _ => {}
        }
    }
}

fn toggle(ship: &Readout, guidance: Guidance) -> Action {
    Action::Guidance(if ship.guidance == guidance { Guidance::Manual } else { guidance })
}

/// One step up or down of the held vertical speed: 1 m/s below 10 m/s, 10 m/s above; begins at the present one.
#[allow(clippy::cast_possible_truncation)]
pub fn climb(ship: &Readout, sign: i32) -> Guidance {
    let now = match ship.guidance {
        Guidance::VerticalSpeed { cm_s } => cm_s,
        Guidance::Hover => 0,
        _ => (ship.vertical_speed_m_s.clamp(-200.0, 200.0).round() as i32) * 100,
    };
    let outward = now.signum() == sign || now == 0;
    let step = if now.abs() > 1_000 || (now.abs() == 1_000 && outward) { 1_000 } else { 100 };
    Guidance::VerticalSpeed { cm_s: (now + sign * step).clamp(-20_000, 20_000) }
}

#[cfg(test)]
mod tests {
    use super::pads::{Hand, PadButton, event};
    use super::*;
    use crate::hud::testing::readout;
    use engine::time::TICK_S;
    use gilrs::Axis;

    fn input() -> Input {
        Input::new(Bindings::default())
    }

    #[test]
    fn the_lever_is_told_only_when_it_moves() {
        let (mut input, ship) = (input(), readout());
        assert_eq!(input.sample(TICK_S, &ship).actions, []);
        input.key(KeyCode::KeyZ, true);
        assert_eq!(input.sample(TICK_S, &ship).actions, [Action::Throttle(65_535)]);
        assert_eq!(input.sample(TICK_S, &ship).actions, []);
        input.key(KeyCode::ControlLeft, true);
        let mut told = 0;
        for _ in 0..120 {
            told += input.sample(TICK_S, &ship).actions.len();
        }
        assert_eq!(told, 100, "0.6 of the lever a second at 60 Hz, then it stands still at nothing");
    }

    #[test]
    fn keys_ease_in_and_quantise_to_full_deflection() {
        let (mut input, ship) = (input(), readout());
        input.key(KeyCode::KeyS, true);
        let first = input.sample(TICK_S, &ship).axes.pitch;
        assert!(first > 0 && first < i16::MAX / 4);
        for _ in 0..20 {
            input.sample(TICK_S, &ship);
        }
        assert_eq!(input.sample(TICK_S, &ship).axes.pitch, i16::MAX);
        input.key(KeyCode::KeyW, true);
        for _ in 0..20 {
            input.sample(TICK_S, &ship);
        }
        assert_eq!(input.sample(TICK_S, &ship).axes.pitch, 0, "both keys cancel");
    }

    #[test]
    fn bindings_do_not_fire_in_menus_and_text_fields() {
        let (mut input, ship) = (input(), readout());
        input.key(KeyCode::KeyS, true);
        for focus in [Focus::Menu, Focus::Text] {
            input.set_focus(focus);
            input.key(KeyCode::KeyG, true);
            input.key(KeyCode::KeyG, false);
            let commands = input.sample(TICK_S, &ship);
            assert_eq!(commands, Commands::default(), "{focus:?}");
        }
        input.key(KeyCode::Escape, true);
        assert_eq!(input.take_caught(), Source::parse("key:Escape").ok());
        assert_eq!(input.take_view_controls(), []);
        input.key(KeyCode::Escape, false);
        input.set_focus(Focus::Menu);
        input.key(KeyCode::Escape, true);
        assert_eq!(input.take_view_controls(), [Control::Pause]);
    }

    #[test]
    fn the_free_camera_moves_and_the_ship_stays_inert_but_for_the_clock() {
        let (mut input, ship) = (input(), readout());
        input.set_focus(Focus::Camera);
        for key in [KeyCode::KeyW, KeyCode::KeyA, KeyCode::KeyF, KeyCode::KeyZ, KeyCode::KeyT, KeyCode::ShiftLeft] {
            input.key(key, true);
        }
        for _ in 0..30 {
            assert_eq!(input.sample(TICK_S, &ship), Commands::default());
        }
        assert_eq!(input.camera_push(), [-1.0, -1.0, -1.0], "left, down, ahead");
        input.key(KeyCode::Period, true);
        assert!(matches!(input.sample(TICK_S, &ship).actions[..], [Action::Warp(_)]));
        input.set_focus(Focus::Menu);
        assert_eq!(input.camera_push(), [0.0; 3]);
    }

    #[test]
    fn a_pad_flies_through_gilrs() {
        let (mut input, mut ship) = (input(), readout());
        let Some(stick) = event(7, Hand::Axis(Axis::LeftStickY, -1.0)) else { return };
        if !input.pads.insert(stick) {
            return;
        }
        input.pads.insert(event(7, Hand::Trigger(PadButton::RightTrigger2, 1.0)).unwrap());
        input.pads.insert(event(8, Hand::Press(PadButton::South)).unwrap());
        input.poll_pads();
        ship.gear_down = false;
        let commands = input.sample(0.5, &ship);
        assert_eq!(commands.axes.pitch, i16::MAX, "stick pulled: nose up");
        assert_eq!(commands.actions, [Action::Gear(true), Action::Throttle(32_768)]);
        input.pads.insert(event(7, Hand::Disconnect).unwrap());
        input.poll_pads();
        assert_eq!(input.sample(0.5, &ship).axes.pitch, 0);
        assert_eq!(input.take_notices().len(), 1 + usize::from(input.pads.notice.is_some()));
        input.set_focus(Focus::Menu);
        input.pads.insert(event(8, Hand::Press(PadButton::DPadDown)).unwrap());
        input.poll_pads();
        assert_eq!(input.take_steps(), [Step::Down]);
    }

    #[test]
    fn touching_the_lever_takes_over_from_guidance_without_a_jump() {
        let (mut input, mut ship) = (input(), readout());
        ship.guidance = Guidance::Hover;
        ship.throttle = 0.4;
        assert_eq!(input.sample(TICK_S, &ship).actions, []);
        input.key(KeyCode::ShiftLeft, true);
        let actions = input.sample(TICK_S, &ship).actions;
        assert_eq!(actions[0], Action::Guidance(Guidance::Manual));
        let Action::Throttle(place) = actions[1] else { panic!("{actions:?}") };
        assert!((f64::from(place) / 65_535.0 - 0.41).abs() < 1e-4);
    }

    #[test]
    fn vertical_speed_steps() {
        let mut ship = readout();
        ship.guidance = Guidance::Hover;
        assert_eq!(climb(&ship, -1), Guidance::VerticalSpeed { cm_s: -100 });
        ship.guidance = Guidance::VerticalSpeed { cm_s: 1_000 };
        assert_eq!(climb(&ship, 1), Guidance::VerticalSpeed { cm_s: 2_000 });
        assert_eq!(climb(&ship, -1), Guidance::VerticalSpeed { cm_s: 900 });
    }
}
