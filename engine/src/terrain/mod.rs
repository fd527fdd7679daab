//! Terrain: how high the ground is, and which tiles of it to draw. No wgpu here.
//!
//! Reading order: [`spec`] (what a modder writes) → [`relief`] (the height function) with its parts [`noise`], [`crater`],
//! [`map`] → [`tile`] (a square of the quadtree, and what the GPU needs to repeat the function exactly) →
//! [`quadtree`] (which tiles a camera needs) → [`stream`] (which of them are resident) → [`scale`] (relief read from afar).

pub mod crater;
pub mod map;
pub mod noise;
pub mod quadtree;
pub mod relief;
pub mod scale;
pub mod spec;
pub mod stream;
pub mod tile;

pub use map::{ColourMap, CubeMap};
pub use quadtree::{View, select};
pub use relief::{Maps, Relief, ReliefError};
pub use scale::relief_scale;
pub use spec::{Ground, ReliefSpec};
pub use tile::{TileKey, TileSet};
