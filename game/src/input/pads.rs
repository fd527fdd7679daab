//! Gamepads through gilrs: hot-plug, several devices at once, triggers as analogue sources.
//!
//! gilrs' own filters are off: a dead zone that is applied twice, or on one device only, cannot be tuned by the player
//! (`AxisBinding::shape` is the only one). Events put in by [`Pads::insert`] take the same way as a device's.
//! Not here: what a button means ([`super::bindings`]).

use gilrs::ev::Code;
use gilrs::{Axis, Button, Event, EventType, GamepadId, Gilrs, GilrsBuilder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Declares an enum of pad elements with name, label and gilrs' name.
macro_rules! elements {
    ($(#[$meta:meta])* $type:ident from $gilrs:ident { $($variant:ident = $theirs:ident, $label:literal;)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[allow(missing_docs)]
        pub enum $type { $($variant),* }
        impl $type {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];
            /// Name in files.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($variant)),* }
            }
            /// What the player reads.
            pub const fn label(self) -> &'static str {
                match self { $(Self::$variant => $label),* }
            }
            /// The element of a name.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|e| e.name() == name)
            }
            fn from_gilrs(theirs: $gilrs) -> Option<Self> {
                match theirs { $($gilrs::$theirs => Some(Self::$variant),)* _ => None }
            }
            /// As gilrs calls it.
            pub const fn to_gilrs(self) -> $gilrs {
                match self { $(Self::$variant => $gilrs::$theirs),* }
            }
        }
    };
}

elements! {
    /// A gamepad button, by place (South is A on an Xbox pad, × on a PlayStation one).
    PadButton from Button {
        South = South, "Pad A";
        East = East, "Pad B";
        North = North, "Pad Y";
        West = West, "Pad X";
        LeftTrigger = LeftTrigger, "Pad L1";
        RightTrigger = RightTrigger, "Pad R1";
        LeftTrigger2 = LeftTrigger2, "Pad L2";
        RightTrigger2 = RightTrigger2, "Pad R2";
        Select = Select, "Pad Select";
        Start = Start, "Pad Start";
        Mode = Mode, "Pad Mode";
        LeftThumb = LeftThumb, "Pad L3";
        RightThumb = RightThumb, "Pad R3";
        DPadUp = DPadUp, "Pad up";
        DPadDown = DPadDown, "Pad down";
        DPadLeft = DPadLeft, "Pad left";
        DPadRight = DPadRight, "Pad right";
    }
}

/// A stick's axis or a trigger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum PadAxis {
    LeftStickX,
    LeftStickY,
    RightStickX,
    RightStickY,
    LeftZ,
    RightZ,
    /// The analogue trigger L2, 0 … 1.
    LeftTrigger,
    /// The analogue trigger R2, 0 … 1.
    RightTrigger,
}

impl PadAxis {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::LeftStickX,
        Self::LeftStickY,
        Self::RightStickX,
        Self::RightStickY,
        Self::LeftZ,
        Self::RightZ,
        Self::LeftTrigger,
        Self::RightTrigger,
    ];
    /// What the player reads.
    pub const fn label(self) -> &'static str {
        match self {
            Self::LeftStickX => "Left stick X",
            Self::LeftStickY => "Left stick Y",
            Self::RightStickX => "Right stick X",
            Self::RightStickY => "Right stick Y",
            Self::LeftZ => "Left Z",
            Self::RightZ => "Right Z",
            Self::LeftTrigger => "Trigger L2",
            Self::RightTrigger => "Trigger R2",
        }
    }
    fn from_gilrs(axis: Axis) -> Option<Self> {
        Some(match axis {
            Axis::LeftStickX => Self::LeftStickX,
            Axis::LeftStickY => Self::LeftStickY,
            Axis::RightStickX => Self::RightStickX,
            Axis::RightStickY => Self::RightStickY,
            Axis::LeftZ => Self::LeftZ,
            Axis::RightZ => Self::RightZ,
            _ => return None,
        })
    }
}

/// What one device holds at present.
#[derive(Clone, Debug, Default)]
struct Device {
    name: String,
    axes: BTreeMap<PadAxis, f64>,
    pressed: Vec<PadButton>,
}

/// Something that happened on a pad.
#[derive(Clone, Debug, PartialEq)]
pub enum PadEvent {
    /// A button went down.
    Pressed(PadButton),
    /// A device came.
    Connected(String),
    /// A device went; all that it held is let go.
    Disconnected(String),
}

/// All gamepads.
#[derive(Debug)]
pub struct Pads {
    gilrs: Option<Gilrs>,
    devices: BTreeMap<usize, Device>,
    /// Why there are no gamepads, for a notice; the game goes on.
    pub notice: Option<String>,
}

/// Deflection beyond its resting place at which an axis is taken while binding.
const CAPTURE_BEYOND: f64 = 0.55;

/// Waits for an axis to be moved on purpose: where each axis rested at the start does not count.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisCapture {
    rest: BTreeMap<(usize, PadAxis), f64>,
}

impl Pads {
    /// Opens the gamepad subsystem; without one, `notice` says why.
    #[allow(clippy::result_large_err)]
    pub fn open() -> Self {
        let built = GilrsBuilder::new().with_default_filters(false).build();
        let (gilrs, notice) = match built {
            Ok(g) => (Some(g), None),
            Err(gilrs::Error::NotImplemented(g)) => (Some(g), Some("Gamepads are not supported on this system.".to_owned())),
            Err(e) => (None, Some(format!("No gamepads: {e}"))),
        };
        let mut pads = Self { gilrs, devices: BTreeMap::new(), notice };
        if let Some(gilrs) = &pads.gilrs {
            for (id, pad) in gilrs.gamepads() {
                pads.devices.insert(id.into(), Device { name: pad.name().to_owned(), ..Device::default() });
            }
        }
        pads
    }

    /// Puts an event in gilrs' queue, as if a device had sent it: for tests and recorded flights.
    /// False where no gamepad subsystem is there to take it.
    pub fn insert(&mut self, event: Event) -> bool {
        self.gilrs.as_mut().map(|g| g.insert_event(event)).is_some()
    }

    /// Takes what happened since the last call.
    pub fn poll(&mut self) -> Vec<PadEvent> {
        let mut out = Vec::new();
        while let Some(event) = self.gilrs.as_mut().and_then(Gilrs::next_event) {
            self.take(event, &mut out);
        }
        out
    }

    fn take(&mut self, event: Event, out: &mut Vec<PadEvent>) {
        let id = usize::from(event.id);
        let name = || self.gilrs.as_ref().and_then(|g| g.connected_gamepad(event.id).map(|p| p.name().to_owned()));
        let device = self.devices.entry(id).or_insert_with(|| Device { name: name().unwrap_or_default(), ..Device::default() });
        let mut press = |device: &mut Device, button: PadButton, down: bool| {
            let held = device.pressed.contains(&button);
            if down && !held {
                device.pressed.push(button);
                out.push(PadEvent::Pressed(button));
            } else if !down && held {
                device.pressed.retain(|b| *b != button);
            }
        };
        match event.event {
            EventType::ButtonPressed(b, _) => {
                if let Some(b) = PadButton::from_gilrs(b) {
                    press(device, b, true);
                }
            }
            EventType::ButtonReleased(b, _) => {
                if let Some(b) = PadButton::from_gilrs(b) {
                    press(device, b, false);
                }
            }
            EventType::ButtonChanged(b, value, _) => match b {
                Button::LeftTrigger2 => _ = device.axes.insert(PadAxis::LeftTrigger, f64::from(value)),
                Button::RightTrigger2 => _ = device.axes.insert(PadAxis::RightTrigger, f64::from(value)),
                _ => {}
            },
            // Some pads send their cross as two axes.
            EventType::AxisChanged(axis @ (Axis::DPadX | Axis::DPadY), value, _) => {
                let (minus, plus) = match axis {
                    Axis::DPadX => (PadButton::DPadLeft, PadButton::DPadRight),
                    _ => (PadButton::DPadDown, PadButton::DPadUp),
                };
                press(device, minus, value < -0.5);
                press(device, plus, value > 0.5);
            }
            EventType::AxisChanged(axis, value, _) => {
                if let Some(axis) = PadAxis::from_gilrs(axis) {
                    device.axes.insert(axis, f64::from(value));
                }
            }
            EventType::Connected => {
                *device = Device { name: name_of(self.gilrs.as_ref(), event.id), ..Device::default() };
                out.push(PadEvent::Connected(device.name.clone()));
            }
            EventType::Disconnected => {
                let gone = self.devices.remove(&id).map(|d| d.name).unwrap_or_default();
                out.push(PadEvent::Disconnected(gone));
            }
            _ => {}
        }
    }

    /// True while any device holds the button.
    pub fn pressed(&self, button: PadButton) -> bool {
        self.devices.values().any(|d| d.pressed.contains(&button))
    }

    /// The raw deflection of an axis on each device that has moved it: `(device name, −1 … 1)`.
    pub fn deflections(&self, axis: PadAxis) -> impl Iterator<Item = (&str, f64)> {
        self.devices.values().filter_map(move |d| d.axes.get(&axis).map(|v| (d.name.as_str(), *v)))
    }

    /// Names of the devices that are connected.
    pub fn names(&self) -> Vec<&str> {
        self.devices.values().map(|d| d.name.as_str()).filter(|n| !n.is_empty()).collect()
    }

    /// Begins to wait for an axis: what it rests at now, also far from the centre, does not count.
    pub fn begin_capture(&self) -> AxisCapture {
        let rest = self.devices.iter().flat_map(|(id, d)| d.axes.iter().map(|(a, v)| ((*id, *a), *v))).collect();
        AxisCapture { rest }
    }

    /// The axis that was moved since [`Pads::begin_capture`]; an axis seen for the first time counts from where it is first seen.
    pub fn captured(&self, capture: &mut AxisCapture) -> Option<PadAxis> {
        for (id, device) in &self.devices {
            for (axis, value) in &device.axes {
                let rest = *capture.rest.entry((*id, *axis)).or_insert(if value.abs() > 0.9 { *value } else { 0.0 });
                if (value - rest).abs() > CAPTURE_BEYOND {
                    return Some(*axis);
                }
            }
        }
        None
    }
}

fn name_of(gilrs: Option<&Gilrs>, id: GamepadId) -> String {
    gilrs.and_then(|g| g.connected_gamepad(id)).map_or_else(|| format!("Gamepad {}", usize::from(id)), |p| p.name().to_owned())
}

/// An event of a device made by hand, for tests and recorded flights. `None` where the platform's event codes differ.
pub fn event(device: usize, kind: Hand) -> Option<Event> {
    // gilrs lets nobody build its ids and codes but serde.
    let id: GamepadId = serde_json::from_value(serde_json::json!(device)).ok()?;
    let code: Code = [serde_json::json!({"kind": 1, "code": 304}), serde_json::json!({"page": 9, "usage": 1}), serde_json::json!(1)]
        .into_iter()
        .find_map(|v| serde_json::from_value(v).ok())?;
    let event = match kind {
        Hand::Press(b) => EventType::ButtonPressed(b.to_gilrs(), code),
        Hand::Release(b) => EventType::ButtonReleased(b.to_gilrs(), code),
        Hand::Trigger(b, v) => EventType::ButtonChanged(b.to_gilrs(), v, code),
        Hand::Axis(a, v) => EventType::AxisChanged(a, v, code),
        Hand::Connect => EventType::Connected,
        Hand::Disconnect => EventType::Disconnected,
    };
    Some(Event::new(id, event))
}

/// What [`event`] is to say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// Button down.
    Press(PadButton),
    /// Button up.
    Release(PadButton),
    /// Analogue value of a trigger, 0 … 1.
    Trigger(PadButton, f32),
    /// Deflection of an axis, −1 … 1.
    Axis(Axis, f32),
    /// Device came.
    Connect,
    /// Device went.
    Disconnect,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pads(events: &[(usize, Hand)]) -> Option<(Pads, Vec<PadEvent>)> {
        let mut pads = Pads::open();
        for (device, kind) in events {
            if !pads.insert(event(*device, *kind)?) {
                return None;
            }
        }
        let out = pads.poll();
        Some((pads, out))
    }

    #[test]
    fn events_through_gilrs_reach_the_state_of_several_devices() {
        let Some((mut pads, out)) = pads(&[
            (70, Hand::Press(PadButton::South)),
            (71, Hand::Axis(Axis::LeftStickX, 0.5)),
            (70, Hand::Axis(Axis::LeftStickX, -0.25)),
            (71, Hand::Trigger(PadButton::RightTrigger2, 0.75)),
            (71, Hand::Axis(Axis::DPadY, 1.0)),
        ]) else {
            return;
        };
        assert_eq!(out, [PadEvent::Pressed(PadButton::South), PadEvent::Pressed(PadButton::DPadUp)]);
        assert!(pads.pressed(PadButton::South));
        let sticks: Vec<f64> = pads.deflections(PadAxis::LeftStickX).map(|(_, v)| v).collect();
        assert_eq!(sticks, [-0.25, 0.5]);
        assert_eq!(pads.deflections(PadAxis::RightTrigger).map(|(_, v)| v).sum::<f64>(), 0.75);
        assert!(pads.insert(event(70, Hand::Disconnect).unwrap()));
        pads.poll();
        assert!(!pads.pressed(PadButton::South), "what a device held is let go when it is pulled out");
    }

    #[test]
    fn a_resting_axis_is_not_captured() {
        // A trigger of some pads rests at −1, a worn stick at 0.2.
        let Some((mut pads, _)) = pads(&[(70, Hand::Axis(Axis::LeftZ, -1.0)), (70, Hand::Axis(Axis::LeftStickX, 0.2))]) else {
            return;
        };
        let mut capture = pads.begin_capture();
        assert_eq!(pads.captured(&mut capture), None);
        for (value, expected) in [(0.5, None), (0.9, Some(PadAxis::LeftStickX))] {
            pads.insert(event(70, Hand::Axis(Axis::LeftStickX, value)).unwrap());
            pads.poll();
            assert_eq!(pads.captured(&mut capture), expected);
        }
        // A device that reports only once the player touches something else: its first value is its rest.
        let mut capture = pads.begin_capture();
        pads.insert(event(71, Hand::Axis(Axis::RightZ, -1.0)).unwrap());
        pads.poll();
        assert_eq!(pads.captured(&mut capture), None);
    }
}
