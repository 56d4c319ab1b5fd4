//! What renderers share: meshes with their search trees, built once for a scene, and the instances that a
//! camera may see, tile by tile.
//!
//! Trees, boxes and tiles only leave out what cannot be seen. What is seen is decided by the corners in the
//! blocks and the arithmetic of `outline`, the same for every renderer.

mod bvh;
mod meshes;
mod outline;
mod placed;
mod tiles;

pub use bvh::{Bvh, Node};
pub(crate) use bvh::{QUICK, Stack};
pub use meshes::{BLOCK, Block, MeshData, Meshes};
pub use outline::reciprocal;
pub(crate) use outline::{Outlines, Vectors, inside, near_reciprocal, reciprocal_f64};
pub use placed::Placed;
pub(crate) use tiles::is_within;
pub use tiles::{TILE_HEIGHT, TILE_WIDTH, TiledView, ViewedInstance};
