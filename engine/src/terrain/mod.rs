//! Terrain: how high the ground is, and which tiles of it to draw.

pub mod relief;
pub mod tile;

pub use relief::Relief;
pub use tile::TileSet;
