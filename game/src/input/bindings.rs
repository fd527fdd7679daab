//! Bindings: which key, button or stick does what. Plain data that is kept in the settings file; pure functions from a raw
//! deflection to a shaped one. Not here: reading devices ([`super::pads`], [`super::keys`]).

use super::controls::{Analogue, Control};
use super::keys;
use super::pads::{PadAxis, PadButton};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use winit::keyboard::KeyCode;

/// Something that is either pressed or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Source {
    /// A physical key.
    Key(KeyCode),
    /// A mouse button: 2 is the middle one, 3 and 4 the side buttons (0 and 1 belong to menus and the camera).
    Mouse(u8),
    /// A gamepad button.
    Pad(PadButton),
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(code) => write!(f, "key:{}", keys::name(*code)),
            Self::Mouse(button) => write!(f, "mouse:{button}"),
            Self::Pad(button) => write!(f, "pad:{}", button.name()),
        }
    }
}

impl Source {
    /// Reads `key:W`, `mouse:3`, `pad:South`. The error says what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (kind, name) = text.split_once(':').ok_or_else(|| format!("`{text}`: expected key:NAME, mouse:2…4 or pad:NAME"))?;
        match kind {
            "key" => keys::code(name).map(Self::Key).ok_or_else(|| match keys::nearest(name) {
                Some(near) => format!("`{name}` is not a key; the nearest name is `{near}`"),
                None => format!("`{name}` is not a key"),
            }),
            "mouse" => match name.parse::<u8>() {
                Ok(button @ 2..=4) => Ok(Self::Mouse(button)),
                _ => Err(format!("`{name}` is not a mouse button that can be bound: expected 2, 3 or 4")),
            },
            "pad" => PadButton::from_name(name).map(Self::Pad).ok_or_else(|| {
                let names: Vec<&str> = PadButton::ALL.iter().map(|b| b.name()).collect();
                format!("`{name}` is not a gamepad button: expected one of {}", names.join(", "))
            }),
            _ => Err(format!("`{text}`: expected key:NAME, mouse:2…4 or pad:NAME")),
        }
    }
    /// What the player reads.
    pub fn label(self) -> String {
        match self {
            Self::Key(code) => keys::label(code),
            Self::Mouse(button) => format!("Mouse {}", button + 1),
            Self::Pad(button) => button.label().to_owned(),
        }
    }
}

impl Serialize for Source {
    fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(&self.to_string())
    }
}

impl<'de> Deserialize<'de> for Source {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        Self::parse(&String::deserialize(d)?).map_err(serde::de::Error::custom)
    }
}

/// A stick or trigger bound to an analogue control, and how its deflection is shaped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisBinding {
    /// Which one.
    pub axis: PadAxis,
    /// Turned round.
    #[serde(default)]
    pub invert: bool,
    /// Deflection below which nothing happens, 0 … 0.9.
    #[serde(default = "default_dead_zone")]
    pub dead_zone: f64,
    /// 0: linear … 1: cubic (gentle in the middle).
    #[serde(default = "default_curve")]
    pub curve: f64,
}

fn default_dead_zone() -> f64 {
    0.12
}

fn default_curve() -> f64 {
    0.4
}

impl AxisBinding {
    /// With the default shape.
    pub fn new(axis: PadAxis, invert: bool) -> Self {
        Self { axis, invert, dead_zone: default_dead_zone(), curve: default_curve() }
    }

    /// Shapes a raw deflection in [−1, 1]: dead zone (continuous at its edge), curve `(1−c)x + c x³`, inversion.
    /// `device_dead_zone` is the device's own, for a worn stick; the larger one holds. Full deflection stays full.
    pub fn shape(&self, raw: f64, device_dead_zone: f64) -> f64 {
        if !raw.is_finite() {
            return 0.0;
        }
        let raw = raw.clamp(-1.0, 1.0);
        let dead = self.dead_zone.max(device_dead_zone).clamp(0.0, 0.9);
        let beyond = ((raw.abs() - dead) / (1.0 - dead)).max(0.0);
        let curve = self.curve.clamp(0.0, 1.0);
        let shaped = ((1.0 - curve) * beyond + curve * beyond * beyond * beyond) * raw.signum();
        if self.invert { -shaped } else { shaped }
    }
}

/// All bindings in force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Bindings {
    /// Digital controls; a control that is missing here has no source.
    pub buttons: BTreeMap<Control, Vec<Source>>,
    /// Analogue controls.
    pub axes: BTreeMap<Analogue, Vec<AxisBinding>>,
    /// Dead zone of a device, by its name, 0 … 0.9.
    pub device_dead_zone: BTreeMap<String, f64>,
}

impl Default for Bindings {
    fn default() -> Self {
        let buttons =
            Control::ALL.iter().map(|c| (*c, c.defaults().iter().filter_map(|s| Source::parse(s).ok()).collect::<Vec<_>>())).collect();
        // Signs: a stick pushed right is positive, pushed away from the player is positive.
        let axes = [
            (Analogue::Pitch, vec![AxisBinding::new(PadAxis::LeftStickY, true)]),
            (Analogue::Roll, vec![AxisBinding::new(PadAxis::LeftStickX, false)]),
            (Analogue::LookLeft, vec![AxisBinding::new(PadAxis::RightStickX, true)]),
            (Analogue::LookUp, vec![AxisBinding::new(PadAxis::RightStickY, false)]),
            (Analogue::Throttle, vec![AxisBinding::new(PadAxis::RightTrigger, false), AxisBinding::new(PadAxis::LeftTrigger, true)]),
        ];
        Self { buttons, axes: axes.into(), device_dead_zone: BTreeMap::new() }
    }
}

impl Bindings {
    /// The sources of a control.
    pub fn sources(&self, control: Control) -> &[Source] {
        self.buttons.get(&control).map_or(&[], Vec::as_slice)
    }
    /// Adds a source to a control; what it did elsewhere stays, and is shown as a conflict.
    pub fn bind(&mut self, control: Control, source: Source) {
        let list = self.buttons.entry(control).or_default();
        if !list.contains(&source) {
            list.push(source);
        }
    }
    /// Takes a source from a control.
    pub fn unbind(&mut self, control: Control, source: Source) {
        if let Some(list) = self.buttons.get_mut(&control) {
            list.retain(|s| *s != source);
        }
    }
    /// Other controls that the same source works.
    pub fn conflicts(&self, control: Control, source: Source) -> Vec<Control> {
        self.buttons.iter().filter(|(c, list)| **c != control && list.contains(&source)).map(|(c, _)| *c).collect()
    }
    /// What the player reads for a control: `W, Left trigger`, or `—`.
    pub fn text(&self, control: Control) -> String {
        let names: Vec<String> = self.sources(control).iter().map(|s| s.label()).collect();
        if names.is_empty() { "—".to_owned() } else { names.join(", ") }
    }
    /// Checks the ranges of what was read from a file; all errors together.
    pub fn check(&self) -> Result<(), String> {
        let mut wrong = Vec::new();
        for (control, list) in &self.axes {
            for axis in list {
                if !(0.0..=0.9).contains(&axis.dead_zone) {
                    wrong.push(format!("{}: dead_zone = {} (expected 0 … 0.9)", control.label(), axis.dead_zone));
                }
                if !(0.0..=1.0).contains(&axis.curve) {
                    wrong.push(format!("{}: curve = {} (expected 0 … 1)", control.label(), axis.curve));
                }
            }
        }
        for (name, dead) in &self.device_dead_zone {
            if !(0.0..=0.9).contains(dead) {
                wrong.push(format!("device_dead_zone.\"{name}\" = {dead} (expected 0 … 0.9)"));
            }
        }
        if wrong.is_empty() { Ok(()) } else { Err(wrong.join("; ")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dead_zone_is_continuous_and_keeps_full_deflection() {
        let linear = AxisBinding { curve: 0.0, dead_zone: 0.2, ..AxisBinding::new(PadAxis::LeftStickX, false) };
        assert_eq!(linear.shape(0.2, 0.0), 0.0);
        assert_eq!(linear.shape(-0.19, 0.0), 0.0);
        assert!((linear.shape(0.201, 0.0) - 0.00125).abs() < 1e-12, "no jump at the edge");
        assert_eq!(linear.shape(1.0, 0.0), 1.0);
        assert_eq!(linear.shape(-1.0, 0.0), -1.0);
        assert!((linear.shape(0.6, 0.0) - 0.5).abs() < 1e-12);
        assert_eq!(linear.shape(0.3, 0.35), 0.0, "a worn device's own dead zone holds where it is larger");
        assert_eq!(linear.shape(f64::NAN, 0.0), 0.0);
    }

    #[test]
    fn the_curve_is_cubic_at_one_and_inversion_is_odd() {
        let cubic = AxisBinding { curve: 1.0, dead_zone: 0.0, axis: PadAxis::LeftStickY, invert: false };
        assert!((cubic.shape(0.5, 0.0) - 0.125).abs() < 1e-12);
        let inverted = AxisBinding { invert: true, ..cubic };
        assert!((inverted.shape(0.5, 0.0) + 0.125).abs() < 1e-12);
        assert_eq!(inverted.shape(1.0, 0.0), -1.0);
    }

    #[test]
    fn every_default_parses_and_none_conflicts() {
        let bindings = Bindings::default();
        for control in Control::ALL {
            assert_eq!(bindings.sources(*control).len(), control.defaults().len(), "{control:?}");
            for source in bindings.sources(*control) {
                assert_eq!(bindings.conflicts(*control, *source), [], "{control:?} {source}");
            }
        }
    }

    #[test]
    fn rebinding_shows_conflicts_and_survives_the_file() {
        let mut bindings = Bindings::default();
        let w = Source::parse("key:W").unwrap();
        bindings.bind(Control::Gear, w);
        assert_eq!(bindings.conflicts(Control::Gear, w), [Control::PitchDown]);
        bindings.unbind(Control::PitchDown, w);
        assert_eq!(bindings.conflicts(Control::Gear, w), []);
        assert_eq!(bindings.text(Control::PitchDown), "—");
        let text = toml::to_string(&bindings).unwrap();
        assert_eq!(toml::from_str::<Bindings>(&text).unwrap(), bindings);
    }

    #[test]
    fn a_wrong_source_names_the_nearest() {
        let e = Source::parse("key:Escpae").unwrap_err();
        assert!(e.contains("Escape"), "{e}");
        assert!(Source::parse("pad:Middle").unwrap_err().contains("South"));
        assert!(Source::parse("mouse:0").is_err());
        assert!(Source::parse("W").is_err());
    }
}
