//! Scenery, meshes and actor models; the instances at a time.
//!
//! [`place`] decides once per scene, by rule and seed, what stands beside the roads, as actor rows for the log. [`World`]
//! turns the log's actors and the map into triangles: [`World::snapshot`] gives everything near a place at one frame.
//! Whoever builds a world from the same map and rows gets the same triangles.
//!
//! * Surfaces (road, paint, sidewalks, terrain, bridges) come from the map, cut into tiles; each layer is one object.
//! * Actors come from their model name, size and variant ([`actor_mesh`]); wheels and limbs are pieces of the same object.
//!
//! ```
//! use schema::settings::WorldSettings;
//! use world::{World, place};
//!
//! # fn demo(map: &opendrive::Map) -> Result<(), world::WorldError> {
//! let actors = place(map, &WorldSettings::default(), 27, &[[0.0, 0.0, 0.0]], 1)?;
//! let world = World::new(map, &actors)?;
//! let z = world.ground_height(0.0, 0.0, 0.0);
//! # let _ = z;
//! # Ok(())
//! # }
//! ```

mod actors;
mod build;
mod error;
mod scenery;
mod surfaces;
mod world;

pub use actors::{ActorMesh, Joint, Piece, Posture, actor_mesh};
pub use error::WorldError;
pub use scenery::place;
pub use surfaces::lane_raise_m;
pub use world::{Moment, World, is_street_lamp, mark_failed};
