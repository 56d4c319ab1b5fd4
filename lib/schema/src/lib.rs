//! The words that every crate shares: ids, tags, classes, palettes, settings, table rows and meshes.
//!
//! Nothing here reads or writes files. Numbers that other tools know (tag ids, palettes, corner order, channel
//! order) are fixed here once and nowhere else.

pub mod agent;
pub mod arrays;
pub mod bev;
pub mod calibration;
pub mod class;
pub mod difficulty;
pub mod fleet;
pub mod footprint;
mod format;
pub mod geometry;
mod ids;
pub mod images;
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
pub use class::DetectionClass;
pub use difficulty::Difficulty;
pub use format::{FORMAT_VERSION, FRAME_PERIOD_S};
pub use ids::ObjectId;
pub use images::{ImageKind, ImageSet};
pub use tag::Tag;
