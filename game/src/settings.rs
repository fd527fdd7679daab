//! The player's settings: kept as TOML in the data folder, written atomically, never silently reset.
//!
//! A file that cannot be read or holds a value out of range is kept beside as `settings.broken-N.toml`; the defaults are in
//! force and the player is told both. Not here: the screen that changes them ([`crate::hud`]).

use crate::input::bindings::Bindings;
use engine::render::pass::sky::STEPS;
use engine::render::pass::sky::physical::AGREE;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the file in the data folder.
pub const FILE: &str = "settings.toml";

/// Picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Video {
    /// Size of the 3-D picture relative to the window, 0.25 … 1.
    pub render_scale: f32,
    /// Vertical field of view, degrees, 20 … 110.
    pub fov_deg: f64,
    /// Size of text and panels, 0.6 … 2.5, times the display's own scale factor.
    pub ui_scale: f32,
    /// Exposure compensation, stops, −5 … 5.
    pub exposure_ev: f32,
    /// Points on a ray through air, 4 … 96: fewer are faster and err more.
    pub sky_points: u32,
    /// How much of its light a pixel of a sky may err that is drawn between rays, 0.0003 … 0.3.
    pub sky_error: f32,
    /// Wait for the display's refresh.
    pub vsync: bool,
    /// Whole screen.
    pub fullscreen: bool,
}

impl Default for Video {
    fn default() -> Self {
        Self {
            render_scale: 1.0,
            fov_deg: 55.0,
            ui_scale: 1.0,
            exposure_ev: 0.0,
            sky_points: STEPS,
            sky_error: AGREE,
            vsync: true,
            fullscreen: false,
        }
    }
}

/// Volumes, 0 … 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sound {
    /// Everything.
    pub master: f64,
    /// Engine and thrusters.
    pub engine: f64,
    /// Air.
    pub wind: f64,
    /// Warnings.
    pub warning: f64,
}

impl Default for Sound {
    fn default() -> Self {
        Self { master: 0.8, engine: 0.8, wind: 0.8, warning: 0.7 }
    }
}

/// What the HUD shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hud {
    /// Markers and names in the 3-D view.
    pub markers: bool,
    /// How much of what lies behind a panel is hidden, 0 … 1.
    pub panel_opacity: f32,
}

impl Default for Hud {
    fn default() -> Self {
        Self { markers: true, panel_opacity: 0.62 }
    }
}

/// All settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Picture.
    pub video: Video,
    /// Volumes.
    pub sound: Sound,
    /// HUD.
    pub hud: Hud,
    /// Keys, buttons, sticks.
    pub controls: Bindings,
}

/// What may go wrong when settings are kept.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// The file could not be written.
    #[error(
        "{path}: the settings could not be written: {source}. Check that the folder exists and may be written to, or choose another with --data-dir"
    )]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The settings cannot be put into TOML.
    #[error("the settings could not be put into TOML: {0}")]
    Encode(#[from] toml::ser::Error),
}

impl Settings {
    /// Reads the settings of a data folder. Where there is no file yet, the defaults; where it is broken, the defaults and a
    /// message for the player that says what is wrong and where the file was kept.
    pub fn load(dir: &Path) -> (Self, Option<String>) {
        let path = dir.join(FILE);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return (Self::default(), None),
            Err(e) => return (Self::default(), Some(kept(&path, &e.to_string()))),
        };
        match Self::parse(&text) {
            Ok(settings) => (settings, None),
            Err(why) => (Self::default(), Some(kept(&path, &why))),
        }
    }

    /// Reads and checks the text of a settings file. All range errors are told together.
    pub fn parse(text: &str) -> Result<Self, String> {
        let settings: Self = toml::from_str(text).map_err(|e| e.to_string().trim_end().to_owned())?;
        let mut wrong = Vec::new();
        let v = &settings.video;
        let mut range = |name: &str, value: f64, low: f64, high: f64| {
            if !(low..=high).contains(&value) {
                wrong.push(format!("{name} = {value} (expected {low} … {high})"));
            }
        };
        range("video.render_scale", f64::from(v.render_scale), 0.25, 1.0);
        range("video.fov_deg", v.fov_deg, 20.0, 110.0);
        range("video.ui_scale", f64::from(v.ui_scale), 0.5, 2.5);
        range("video.exposure_ev", f64::from(v.exposure_ev), -5.0, 5.0);
        range("video.sky_points", f64::from(v.sky_points), 4.0, 96.0);
        range("video.sky_error", f64::from(v.sky_error), 0.0003, 0.3);
        range("hud.panel_opacity", f64::from(settings.hud.panel_opacity), 0.0, 1.0);
        let s = &settings.sound;
        for (name, volume) in [("master", s.master), ("engine", s.engine), ("wind", s.wind), ("warning", s.warning)] {
            range(&format!("sound.{name}"), volume, 0.0, 1.0);
        }
        if let Err(more) = settings.controls.check() {
            wrong.push(more);
        }
        if wrong.is_empty() { Ok(settings) } else { Err(wrong.join("; ")) }
    }

    /// Writes the settings: to a temporary file in the same folder, synced, then renamed over the old one.
    pub fn save(&self, dir: &Path) -> Result<(), SettingsError> {
        let path = dir.join(FILE);
        let text = toml::to_string_pretty(self)?;
        let write = || -> std::io::Result<()> {
            std::fs::create_dir_all(dir)?;
            let mut file = tempfile::NamedTempFile::new_in(dir)?;
            file.write_all(text.as_bytes())?;
            file.as_file().sync_all()?;
            file.persist(&path).map_err(|e| e.error)?;
            Ok(())
        };
        write().map_err(|source| SettingsError::Write { path: path.clone(), source })
    }
}

/// Keeps a broken file beside and says so.
fn kept(path: &Path, why: &str) -> String {
    let aside = (1..1000).map(|n| path.with_file_name(format!("settings.broken-{n}.toml"))).find(|p| !p.exists());
    let where_to = match aside.map(|to| std::fs::rename(path, &to).map(|()| to)) {
        Some(Ok(to)) => format!("It is kept as {}", to.display()),
        _ => "It could not be moved aside and will be left as it is until you change a setting".to_owned(),
    };
    format!("{}: the settings cannot be used: {why}\n{where_to}; the defaults are in force.", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive_the_file() {
        let dir = tempfile::tempdir().unwrap();
        let mut settings = Settings::default();
        settings.video.fov_deg = 71.5;
        settings.controls.device_dead_zone.insert("Worn \"pad\"".to_owned(), 0.3);
        settings.save(dir.path()).unwrap();
        settings.save(dir.path()).unwrap();
        assert_eq!(Settings::load(dir.path()), (settings, None));
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1, "no temporary file is left behind");
    }

    #[test]
    fn a_broken_file_is_kept_and_told() {
        let dir = tempfile::tempdir().unwrap();
        for (text, expected) in [
            ("video = 3", "video"),
            ("[video]\nfov_deg = 500.0\nrender_scale = 9.0", "video.fov_deg = 500 (expected 20 … 110)"),
            ("[video]\nfov_deg = nan", "fov_deg"),
            ("[video]\nsky_points = 1", "video.sky_points = 1 (expected 4 … 96)"),
            ("[video]\nsky_error = 2.0", "video.sky_error = 2 (expected 0.0003 … 0.3)"),
            ("[vdeo]\n", "vdeo"),
            ("[controls.buttons]\ngear = [\"key:Gg\"]", "`Gg` is not a key"),
            ("[[controls.axes.pitch]]\naxis = \"LeftStickY\"\ncurve = 4.0", "curve = 4"),
        ] {
            std::fs::write(dir.path().join(FILE), text).unwrap();
            let (settings, message) = Settings::load(dir.path());
            assert_eq!(settings, Settings::default());
            let message = message.unwrap();
            assert!(message.contains(expected), "{message}");
            assert!(message.contains("broken-"), "{message}");
        }
        assert!(!dir.path().join(FILE).exists());
        assert_eq!(std::fs::read_to_string(dir.path().join("settings.broken-1.toml")).unwrap(), "video = 3");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 8);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a-file");
        std::fs::write(&file, "").unwrap();
        let e = Settings::default().save(&file.join("sub")).unwrap_err().to_string();
        assert!(e.contains("a-file") && e.contains("--data-dir"), "{e}");
    }
}
