//! Rigid bodies near the ground: how a ship falls, touches, slides, rests and breaks. Nothing here exists high above ground.
//!
//! The truth is one [`BodyState`] in the body-fixed frame, in f64. Each substep is integrated in f64 ([`bubble`]); the ground is
//! a mesh ([`ground`]) of `f32` metres from an anchor near the ship, and rapier ([`hull`]) is asked for what a contact adds to
//! the motion. rapier keeps nothing from one substep to the next, so the state that a save must hold is [`Contact`] alone, and
//! moving the anchor cannot move the ship. Fast ships are swept against the height function itself ([`sweep`]).
//!
//! Not here: thrust and drag (the caller's [`Loads`]), orbits ([`crate::orbit`]), what a crash means to the game.
//! Read [`body`], [`bubble`], [`gear`], [`hull`], [`ground`], [`sweep`].

pub mod body;
pub mod bubble;
pub mod gear;
pub mod ground;
pub mod hull;
pub mod sweep;

pub use body::{BodyState, Loads, MassProps, RotatingFrame};
pub use bubble::{Bubble, Contact, Nearness, Report};
pub use gear::{Chassis, Leg, LegState};
pub use ground::{Patch, PatchKey, Surface};

/// An error of this module.
#[derive(Debug, thiserror::Error)]
pub enum RigidError {
    /// The ground could not be made into a collider.
    #[error("ground collider at {key:?}: {why}; the relief must give finite heights there")]
    Ground {
        /// Where.
        key: PatchKey,
        /// What the mesh builder said.
        why: String,
    },
}
