//! The meshes of a scene, and which of them are where at a time.
//!
//! [`SceneWorld`] turns the log's actors and the map into triangles: [`SceneWorld::snapshot`] gives everything near a place at
//! one frame. Whoever builds a world from the same map and rows gets the same triangles.
//!
//! * Surfaces (road, paint, sidewalks, terrain, bridges) come from the map, cut into tiles; each layer is one object
//!   (crate `surfaces`).
//! * Actors come from their model name, size and variant (crate `actors`); wheels and limbs are pieces of the same object.
//!
//! ```
//! use schema::settings::WorldSettings;
//! use schema::tables::FrameRow;
//! use world::{Moment, SceneWorld};
//!
//! let map = testkit::straight(200.0);
//! let middle = [100.0, 0.0, 0.0];
//! let actors = scenery::place(&map, &WorldSettings::default(), 27, &[middle], 1).unwrap();
//! let world = SceneWorld::new(&map, &actors)?;
//! let moment = Moment { states: &[], previous: &[], signals: &[], frame: &FrameRow::default() };
//! let near = world.snapshot(&moment, middle, 50.0);
//! assert!(near.instances.len() < world.snapshot(&moment, middle, 500.0).instances.len());
//! # Ok::<(), world::WorldError>(())
//! ```

mod error;
mod world;

pub use error::WorldError;
pub use world::{Moment, SceneWorld};
