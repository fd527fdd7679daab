//! `syzygy play`: the window. Wall-clock time enters here ([`clock`]) and nowhere else.
//!
//! [`app`] is the loop, [`canvas`] the window with its device, [`flight`] the session with its camera and saves, [`job`]
//! the work beside it, [`ahead`] the paths of the bodies worked out beside it, [`follow`] the files that
//! change meanwhile. Not here: what panels look like ([`crate::hud`]), what keys mean ([`crate::input`]).

mod ahead;
mod app;
pub mod canvas;
pub mod clock;
mod flight;
pub mod follow;
pub mod job;

use super::places;
use crate::assets::Assets;
use crate::cli::PlayArgs;
use crate::settings::Settings;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use winit::event_loop::EventLoop;

/// What the window is opened with.
pub struct Opening {
    /// Arguments.
    pub args: PlayArgs,
    /// Assets with mods over them.
    pub assets: Assets,
    /// Folder of saves and settings.
    pub data: PathBuf,
    /// Folder of what can be made again.
    pub cache: Option<PathBuf>,
}

/// `syzygy play`.
///
/// # Errors
/// A folder that is missing. What goes wrong later is told where it happens, and is in the exit code.
pub fn play(args: &PlayArgs) -> Result<ExitCode, super::Error> {
    let assets = Assets::new(places::assets(&args.places)?, places::mods(&args.places)?);
    Ok(run(Opening { args: args.clone(), assets, data: places::data_dir(&args.places), cache: places::cache_dir(&args.places) }))
}

/// Opens the window and plays until it is closed. Exit code 0, or 2 where no window or no device can be had.
pub fn run(opening: Opening) -> ExitCode {
    let (settings, complaint) = if opening.args.places.safe_mode { Default::default() } else { Settings::load(&opening.data) };
    let event_loop = match EventLoop::new() {
        Ok(event_loop) => event_loop,
        Err(e) => {
            return refuse(&format!(
                "no window can be opened: {e}\nWithout a display, `syzygy headless` and `syzygy shot` do the same into files."
            ));
        }
    };
    let mut app = app::App::new(opening, settings, complaint);
    match event_loop.run_app(&mut app) {
        Ok(()) => app.exit,
        Err(e) => refuse(&format!("the window was closed by an error: {e}")),
    }
}

/// Says why the game cannot be played: on stderr always, and in a native message where there is a display.
fn refuse(why: &str) -> ExitCode {
    eprintln!("error: {why}");
    let display = cfg!(not(target_os = "linux")) || ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|v| std::env::var_os(v).is_some());
    if display {
        let text = why.to_owned();
        // A desktop without a portal may never answer: the message is given a minute, the exit code is not held back longer.
        let shown = std::thread::spawn(move || {
            rfd::MessageDialog::new().set_level(rfd::MessageLevel::Error).set_title("Syzygy").set_description(text).show()
        });
        for _ in 0..600 {
            if shown.is_finished() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
    }
    ExitCode::from(2)
}

/// Writes an RGBA picture beside the saves under a name that is free.
fn picture_path(data: &Path, time: engine::time::SimTime) -> PathBuf {
    let dir = data.join("pictures");
    let stem: String = time.utc().to_string().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    (1..10_000).map(|n| dir.join(format!("{stem}-{n}.png"))).find(|p| !p.exists()).unwrap_or_else(|| dir.join("picture.png"))
}
