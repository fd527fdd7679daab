//! Light: the sun's disc, who hides it, and how the eye adapts.
//!
//! [`sun`] says how much light arrives and how large the disc is; [`occlusion`] which fraction of the disc is free
//! (twin of `shaders/lib/occlusion.wgsl`); [`reflected`] what a moon throws back; [`exposure`] turns luminances into an exposure;
//! [`spectrum`] turns spectra into colours.

pub mod exposure;
pub mod occlusion;
pub mod reflected;
pub mod shadow;
pub mod spectrum;
pub mod sun;
