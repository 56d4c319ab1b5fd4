//! A scene's log as a replayable world: what the stages after `simulate-and-log` look at.
//!
//! [`SceneLog`] is the log's tables, indexed by frame. [`Replay`] adds the map and the meshes and gives the
//! [`schema::geometry::Snapshot`] of any frame. [`in_frame_order`] computes frames in parallel and hands them over
//! in order, [`archive_frames`] writes one array of each.

mod error;
mod log;
mod map;
mod order;
mod pool;
mod replay;

pub use error::ReplayError;
pub use log::{SIMULATE, SceneLog};
pub use map::{PLANNER, compress_map, read_hazards, read_map, read_map_text, read_plan};
pub use order::{archive_frames, in_frame_order};
pub use pool::BufferPool;
pub use replay::Replay;
