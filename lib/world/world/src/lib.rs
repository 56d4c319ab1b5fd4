//! The meshes of a scene, and which of them are where at a time.
//!
//! [`SceneWorld`] turns the log's actors and the ground of its tiles into triangles: [`SceneWorld::snapshot`]
//! gives everything near a place at one frame. Equal rows and ground always give the
//! same triangles.
//!
//! * The ground (road, paint, sidewalks, terrain, bridges) comes in pieces; each layer is one object (crate
//!   `tiles`).
//! * Actors come from their model name, size and variant (crate `actors`); wheels and limbs are pieces of the
//!   same object.
//!
//! ```
//! use schema::tables::{ActorRow, FrameRow, StateRow};
//! use world::{Moment, SceneWorld};
//!
//! let car = ActorRow {
//!     id: 7,
//!     model: "car.sedan".into(),
//!     length_m: 4.7,
//!     width_m: 1.84,
//!     height_m: 1.44,
//!     quaternion: [1.0, 0.0, 0.0, 0.0],
//!     ..ActorRow::default()
//! };
//! let world = SceneWorld::new(&[car], Vec::new())?;
//! let states = [StateRow { id: 7, quaternion: [1.0, 0.0, 0.0, 0.0], ..StateRow::default() }];
//! let moment = Moment { states: &states, previous: &[], signals: &[], frame: &FrameRow::default() };
//! // A body and four wheels, and from far away nothing.
//! assert_eq!(world.snapshot(&moment, [30.0, 0.0, 0.0], 50.0).instances.len(), 5);
//! assert!(world.snapshot(&moment, [300.0, 0.0, 0.0], 50.0).instances.is_empty());
//! # Ok::<(), world::WorldError>(())
//! ```

mod error;
mod state;
mod world;

pub use error::WorldError;
pub use world::{Light, Moment, OwnModels, SceneWorld};
