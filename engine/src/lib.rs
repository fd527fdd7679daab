//! The engine: what would be true in any game. It knows no ship's name, no key and no save.
//!
//! # Conventions
//! - Scalars are SI in `f64`; a name ends in its unit where the type does not say it (`altitude_m`).
//! - Positions are typed by frame ([`space::frame`]); transforms read `a_from_b`.
//! - `f64 → f32` happens in [`space::relative`] and [`scene::gpu_data`] only.
//! - Depth is infinite reversed-Z: clear 0, compare Greater. Views look along −Z, +Y up.
//! - Light is photometric: sun illuminance in lx, radiance-like quantities in cd/m², one set of linear sRGB channels.
//! - Determinism: `libm` for transcendental functions, no hash-map iteration, no wall-clock.
//!
//! # Levels (a module uses only lower ones; `tests/tidy.rs` holds this)
//! - L0 [`units`] [`time`] [`space`]: arithmetic and frames
//! - L1 [`orbit`] [`terrain`] [`air`] [`light`] [`rigid`]: simulation, no wgpu
//! - L2 [`scene`]: plain f32 data for a frame · [`gpu`]: wgpu helpers
//! - L3 [`render`]: scene + gpu → pixels; read [`render::frame`] first

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

pub mod space;
pub mod time;
pub mod units;

pub mod air;
pub mod light;
pub mod orbit;
pub mod rigid;
pub mod terrain;

pub mod gpu;
pub mod scene;

pub mod render;
