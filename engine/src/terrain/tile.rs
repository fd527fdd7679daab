//! Tiles: squares of the cube-sphere quadtree.

/// The tiles of one body chosen for one camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileSet {}
