//! Orbits: how a state moves under gravity. Pure f64, cited, tested.
//!
//! Read [`state`], then [`kepler`] (two-body propagation), [`elements`], [`rotation`] (where a body's axes point),
//! [`ephemeris`] (position and velocity of body B at time t: the narrow interface), [`eclipse`] (whose shadow falls on whom, when
//! and where), [`field`] (which terms of gravity count for a ship), [`path`] (where a coasting ship goes under them, and what it
//! meets), [`predict`] (the path ahead with planned burns).

pub mod eclipse;
pub mod elements;
pub mod ephemeris;
pub mod field;
pub mod gravity;
pub mod integrate;
pub mod kepler;
pub mod path;
pub mod predict;
pub mod rotation;
pub mod state;

pub use state::{BodyId, State};
