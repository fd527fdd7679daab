//! The game: what is chosen. Ships, bodies, who eclipses whom, HUD, sound, saves, modes.
//!
//! Data flows one way: [`command::Commands`] → [`world::World`] → [`view`] snapshot → frame → target.
//! Live play, headless runs, replays and pictures share one loop ([`session::Session`]) and differ in who makes the
//! commands and what the target is.

// Tests quote published digits as they are printed, and may count in any type.
#![cfg_attr(
    test,
    allow(
        clippy::assertions_on_constants,
        clippy::cast_possible_truncation,
        clippy::disallowed_methods,
        clippy::excessive_precision,
        clippy::inconsistent_digit_grouping,
        clippy::type_complexity
    )
)]

pub mod assets;
pub mod cli;
pub mod command;
pub mod hud;
pub mod input;
pub mod mode;
pub mod picture;
pub mod replay;
pub mod save;
pub mod session;
pub mod settings;
pub mod sound;
pub mod view;
pub mod world;
