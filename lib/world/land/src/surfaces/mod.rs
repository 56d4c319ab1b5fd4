//! The ground of the world, made from the map: roads, paint, sidewalks, islands, land, bridges, rails, water.
//!
//! An [`Atlas`] is a map made ready; it gives the [`AreaGround`] of one area after another. That says what
//! lies where and how high, which scenery is placed by, and makes the triangles. What an area has follows
//! from the map alone: of what else was asked for, and from where, nothing depends.
//!
//! ```
//! use land::surfaces::{Atlas, Region};
//!
//! let map = testkit::straight(100.0);
//! let atlas = Atlas::new(&map);
//! let here = atlas.ground(&Region { min: [0.0, -32.0], max: [112.0, 32.0] });
//! // The sidewalk begins 3.5 m beside the middle and has a kerb.
//! assert_eq!(here.levels.height(50.0, -2.0, 0.0), 0.0);
//! assert!((here.levels.height(50.0, -5.0, 0.0) - 0.12).abs() < 1e-9);
//! assert!(here.surfaces().iter().any(|piece| piece.layer == schema::Layer::Sidewalk));
//! ```

mod atlas;
mod blocks;
mod bridges;
mod cover;
mod field;
mod ground;
mod holes;
mod lanes;
mod marks;
mod materials;
mod raster;
mod region;
mod sections;
mod terrain;
mod tracks;
mod water;

pub use atlas::{AreaGround, Atlas, HALO_M, LEVELS_M};
pub use cover::{Cover, Facet};
pub(crate) use field::Field;
pub use ground::GroundLevels;
pub use lanes::beside_edge;
pub(crate) use materials::GRASS;
pub use raster::Raster;
pub use region::Region;
pub use sections::{Edge, Ground, Section, Strip};
pub use water::Water;
pub(crate) use water::waters;
