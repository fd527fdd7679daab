//! Syzygy.
fn main() {}
