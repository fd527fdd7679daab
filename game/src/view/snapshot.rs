//! The snapshot of a World: f64 to f32, once.
