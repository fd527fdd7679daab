//! `#[repr(C)]` mirrors of the structs in `shaders/`, and the second of the two places that may narrow f64 to f32.
//!
//! glam's `scalar-math` (asked for by rapier's determinism) makes `align_of::<Vec4>()` 4, so GPU structs use plain arrays
//! and explicit padding; `tests/` compares every one of them, field by field, with naga's reflection of the WGSL.
