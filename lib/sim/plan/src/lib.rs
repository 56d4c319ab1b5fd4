//! Scene planning: which scenes, where, how long, in which weather.
//!
//! [`plan`] turns a dataset's settings and its maps into one row per scene and agent. Each scene depends on
//! the dataset's seed, its own number, its map and the settings alone, so [`plan_scene`] gives the same rows
//! as the whole plan does. [`enrol`] gives scenes their numbers, so that a dataset can grow. Every topic
//! (durations, weather, vehicles, ...) draws from its own named random stream.
//!
//! ```
//! use plan::SpawnPool;
//!
//! // Vehicles may start every 24 m on both lanes of a street of 200 m: at 0, 24, ... 192.
//! let pool = SpawnPool::new(&testkit::straight(200.0), 24.0);
//! assert_eq!((pool.lanes, pool.points.len()), (2, 18));
//! assert_eq!(pool.points[1].xyz_m.x, 24.0);
//! ```

mod agents;
mod error;
mod given_rsus;
mod given_ways;
mod hazards;
mod lights;
mod pool;
mod roster;
mod routes;
mod scene;
mod sources;
pub mod suspicions;
mod timing;
mod tracks;
mod weather;

pub use error::PlanError;
pub use pool::{SpawnPoint, SpawnPool};
pub use roster::{Roster, SceneSlot, enrol, scene_slots};
pub use scene::{Plan, PlanMap, PlannedScene, plan, plan_scene, plan_slots};
pub use sources::PlanSources;
pub use timing::{background_radius_m, draw_duration_s, frame_count};
pub use tracks::{Track, TrackFiles, TrackPose};
pub use weather::{PlannedWeather, draw_weather, plan_weather};
