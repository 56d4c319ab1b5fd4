//! The static world of a map (`surfaces` and `scenery`), in squares of 256 m on a grid of the world. A tile
//! follows from the map, the rules of scenery and its index, from nothing else: not from a scene, nor from
//! which tiles were made before. Scenes share tiles; `number` gives the objects in those that a scene needs
//! its object ids. `cargo run --release -p convoy-land --example static-boxes` counts the lights, signs and
//! parked vehicles that a frame has in each town.
//!
//! ```
//! use settings::SceneryRules;
//! use schema::tile::TileIndex;
//! use land::tiles::TileMaker;
//!
//! let map = testkit::straight(600.0);
//! let rules = SceneryRules::default();
//! let maker = TileMaker::new(&map, &rules, catalogue::Catalogue::built_in());
//! let tile = maker.make(TileIndex { x: 1, y: 0 });
//! assert!(!tile.objects.is_empty() && tile.objects.iter().all(|o| (256.0..512.0).contains(&o.xyz_m[0])));
//! ```

mod make;
mod number;

pub use make::{Surroundings, Tile, TileMaker};
pub use number::{Numbered, TooManyObjects, number, reached};
