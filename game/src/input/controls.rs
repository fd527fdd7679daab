//! The logical inputs: what a player can do, whatever device does it. Not here: which key does it ([`super::bindings`]).

use serde::{Deserialize, Serialize};

/// The page of the help overlay and of the rebinding screen on which a control stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Turning the ship.
    Attitude,
    /// Sideways thrust.
    Translation,
    /// Throttle, gear, tanks.
    Engine,
    /// Attitude holds.
    Holds,
    /// Hover, descent, landing.
    Guidance,
    /// Warp.
    Time,
    /// Cameras and map.
    View,
    /// Saves, help, pause.
    Game,
}

impl Group {
    /// All groups in the order in which they are shown.
    pub const ALL: [Self; 8] =
        [Self::Attitude, Self::Translation, Self::Engine, Self::Holds, Self::Guidance, Self::Time, Self::View, Self::Game];
    /// Heading.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Attitude => "Attitude",
            Self::Translation => "Translation",
            Self::Engine => "Engine and gear",
            Self::Holds => "Attitude holds",
            Self::Guidance => "Guidance",
            Self::Time => "Time",
            Self::View => "View",
            Self::Game => "Game",
        }
    }
}

/// Declares the digital controls: variant, group, label, default keys and buttons.
macro_rules! controls {
    ($($variant:ident, $group:ident, $label:literal, [$($source:literal),*];)*) => {
        /// A digital control.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        #[allow(missing_docs)]
        pub enum Control { $($variant),* }

        impl Control {
            /// All, in the order in which they are shown.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];
            /// Whether it is heard while a panel has the keys too.
            pub const fn is_heard_in_panels(self) -> bool {
                matches!(self, Self::Pause | Self::Help | Self::Photo | Self::EditAir | Self::HideHud | Self::SavePicture)
            }
            /// What the player reads.
            pub const fn label(self) -> &'static str {
                match self { $(Self::$variant => $label),* }
            }
            /// Where it stands.
            pub const fn group(self) -> Group {
                match self { $(Self::$variant => Group::$group),* }
            }
            /// Default sources, as written in the settings file.
            pub const fn defaults(self) -> &'static [&'static str] {
                match self { $(Self::$variant => &[$($source),*]),* }
            }
        }
    };
}

controls! {
    PitchUp, Attitude, "Pitch up", ["key:S"];
    PitchDown, Attitude, "Pitch down", ["key:W"];
    YawLeft, Attitude, "Yaw left", ["key:A", "pad:LeftTrigger"];
    YawRight, Attitude, "Yaw right", ["key:D", "pad:RightTrigger"];
    RollLeft, Attitude, "Roll left", ["key:Q"];
    RollRight, Attitude, "Roll right", ["key:E"];
    Fine, Attitude, "Fine control (hold)", ["key:AltLeft"];
    TranslateForward, Translation, "Forward", ["key:H"];
    TranslateBack, Translation, "Back", ["key:N"];
    TranslateLeft, Translation, "Left", ["key:J"];
    TranslateRight, Translation, "Right", ["key:L"];
    TranslateUp, Translation, "Up", ["key:I"];
    TranslateDown, Translation, "Down", ["key:K"];
    ThrottleUp, Engine, "Throttle up", ["key:ShiftLeft"];
    ThrottleDown, Engine, "Throttle down", ["key:ControlLeft"];
    ThrottleFull, Engine, "Full throttle", ["key:Z"];
    ThrottleCut, Engine, "Cut the engine", ["key:X", "pad:East"];
    Gear, Engine, "Gear up / down", ["key:G", "pad:South"];
    Refuel, Engine, "Fill the tanks", ["key:F10"];
    KillRotation, Holds, "Kill rotation", ["key:T", "pad:West"];
    HoldPrograde, Holds, "Hold prograde", ["key:1", "pad:LeftThumb"];
    HoldRetrograde, Holds, "Hold retrograde", ["key:2"];
    HoldNormal, Holds, "Hold normal", ["key:3"];
    HoldAntiNormal, Holds, "Hold anti-normal", ["key:4"];
    HoldRadialOut, Holds, "Hold radial out", ["key:5"];
    HoldRadialIn, Holds, "Hold radial in", ["key:6"];
    HoldSurfaceRetrograde, Holds, "Hold against ground velocity", ["key:7"];
    HoldVertical, Holds, "Hold level (surface vertical)", ["key:8", "pad:RightThumb"];
    HoldTarget, Holds, "Hold target", ["key:9"];
    HoldFree, Holds, "No hold (free)", ["key:0"];
    Hover, Guidance, "Hover on / off", ["key:Y"];
    Land, Guidance, "Automatic landing on / off", ["key:U"];
    ClimbFaster, Guidance, "Vertical speed up", ["key:PageUp"];
    SinkFaster, Guidance, "Vertical speed down", ["key:PageDown"];
    ManualFlight, Guidance, "Guidance off", ["key:O"];
    WarpUp, Time, "Faster", ["key:.", "pad:DPadUp"];
    WarpDown, Time, "Slower", ["key:,", "pad:DPadDown"];
    WarpOne, Time, "Real time", ["key:/"];
    Map, View, "Orbit map", ["key:M", "pad:Select"];
    SurfaceMap, View, "Surface map", ["key:B"];
    Camera, View, "Next camera", ["key:C", "pad:North"];
    Photo, View, "Photo mode", ["key:V"];
    EditAir, View, "Edit the air", ["key:F7"];
    HideHud, View, "Hide or show the HUD", ["key:F2"];
    SavePicture, View, "Save a picture", ["key:F12"];
    CameraUp, View, "Free camera up", ["key:R"];
    CameraDown, View, "Free camera down", ["key:F"];
    ZoomIn, View, "Nearer", ["key:=", "pad:DPadRight"];
    ZoomOut, View, "Farther", ["key:-", "pad:DPadLeft"];
    Help, Game, "Help", ["key:F1"];
    Quicksave, Game, "Quick save", ["key:F5"];
    Quickload, Game, "Quick load", ["key:F9"];
    Pause, Game, "Pause menu", ["key:Escape", "pad:Start"];
}

/// An analogue control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Analogue {
    /// Nose up positive.
    Pitch,
    /// Nose left positive.
    Yaw,
    /// Right wing down positive.
    Roll,
    /// Translation right.
    Right,
    /// Translation up.
    Up,
    /// Translation forward.
    Forward,
    /// Throttle up (a rate: full deflection goes from nothing to full in one second).
    Throttle,
    /// Turn the view left.
    LookLeft,
    /// Turn the view up.
    LookUp,
}

impl Analogue {
    /// All, in the order in which they are shown.
    pub const ALL: [Self; 9] =
        [Self::Pitch, Self::Yaw, Self::Roll, Self::Right, Self::Up, Self::Forward, Self::Throttle, Self::LookLeft, Self::LookUp];
    /// What the player reads.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Pitch => "Pitch",
            Self::Yaw => "Yaw",
            Self::Roll => "Roll",
            Self::Right => "Translate right / left",
            Self::Up => "Translate up / down",
            Self::Forward => "Translate forward / back",
            Self::Throttle => "Throttle",
            Self::LookLeft => "Look left / right",
            Self::LookUp => "Look up / down",
        }
    }
}
