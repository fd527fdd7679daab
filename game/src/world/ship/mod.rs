//! The ship: how it answers a stick.

/// A ship.
#[derive(Clone, Debug)]
pub struct Ship {}
