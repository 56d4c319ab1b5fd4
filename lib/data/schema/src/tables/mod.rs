//! The row types of every table in a store. Tables that other stages read are files of their own, so that a
//! change makes just those stale that know the table.

mod agents;
mod boxes;
mod boxes_valid;
mod catalogue;
mod hd_map;
mod log;
mod map;
mod plan;
mod plan_models;
mod plan_routes;
mod plan_trajectories;
mod plan_weather;
mod sensor;
mod stats;
mod tile;
mod tracks;
mod weather;

pub use agents::AgentRow;
pub use boxes::BoxRow;
pub use boxes_valid::ValidBoxRow;
pub use catalogue::{TableDoc, every_table};
pub use hd_map::HdMapRow;
pub use log::{ActorRow, FrameRow, LampRow, SignalRow, StateRow};
pub use map::{VectorKind, VectorMapRow};
pub use plan::{PlanAgentRow, PlanHazardRow, PlanSceneRow};
pub use plan_models::PlanModelRow;
pub use plan_routes::PlanRouteRow;
pub use plan_trajectories::PlanTrajectoryRow;
pub use plan_weather::PlanWeatherRow;
pub use sensor::*;
pub use stats::PartialRow;
pub use tile::{SceneTileRow, SurfaceRow, TILE_STAGE, TileObjectRow};
pub use tracks::{SightingRow, TrackFrameRow, TrackRow, WindowRow};
pub use weather::Weather;
