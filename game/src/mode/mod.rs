//! mode
pub mod probe;
