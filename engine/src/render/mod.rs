//! Rendering: a snapshot becomes pixels. Read [`frame`] first.

pub mod frame;
