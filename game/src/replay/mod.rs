//! Replays: a flight as its start, its commands and what it looked like every second, bit by bit.
//!
//! - [`log`]: what a log holds and how it lies in a file
//! - [`recorder`]: makes a log while any mode flies
//! - [`player`]: gives the commands back, compares, and names what differs
//! - [`dump`]: a log as text
//!
//! A log begins with a save, so that it needs no start file. Not here: the mode that plays logs ([`crate::mode::replay`]).

pub mod dump;
pub mod log;
pub mod player;
pub mod recorder;

pub use log::{Log, LogError};
pub use player::{Divergence, Player};
pub use recorder::Recorder;
