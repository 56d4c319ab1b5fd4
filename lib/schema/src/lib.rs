//! The words that every crate shares: ids, tags, classes, palettes, settings, table rows and meshes.
//!
//! Nothing here reads or writes files. Numbers that other tools know (tag ids, palettes, corner order, channel
//! order) are fixed here once and nowhere else.

pub mod agent;
pub mod bev;
pub mod class;
pub mod fleet;
pub mod footprint;
pub mod geometry;
pub mod lights;
pub mod measures;
pub mod models;
pub mod scene_info;
pub mod settings;
pub mod table;
pub mod tables;
mod tag;
pub mod works;

pub use agent::{AgentId, AgentKind, ParseAgentError};
pub use bev::BevClass;
pub use class::{DetectionClass, Difficulty};
pub use tag::Tag;

/// Number of one object in a scene: 1..=65535, never reused, static things too. 0 is "no object".
pub type ObjectId = u16;

/// Version of the store's layout. A reader refuses a store with another number.
pub const FORMAT_VERSION: u32 = 1;

/// Seconds between frames: frame `k` is at `k * FRAME_PERIOD_S` after warm-up, for every agent.
pub const FRAME_PERIOD_S: f64 = 0.05;
