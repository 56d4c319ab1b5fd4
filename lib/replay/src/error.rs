//! What can be wrong with a log or a map of a store.

use std::io;

/// A scene cannot be replayed from what the store holds.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// A table has not one row for each agent and frame.
    #[error("has {found} rows, expected {agents} agents times {frames} frames")]
    Rows {
        /// Rows found.
        found: usize,
        /// Agents of the scene.
        agents: usize,
        /// Frames of the scene.
        frames: u32,
    },
    /// The plan's tables lack a scene that its manifest names.
    #[error("has no such scene")]
    NoScene,
    /// A map could not be compressed.
    #[error("cannot compress the map")]
    Pack(#[source] io::Error),
    /// A map of the store cannot be unpacked.
    #[error("cannot decompress: {0} (run {planner} with --force)", planner = crate::PLANNER)]
    Unpack(#[source] io::Error),
    /// A map of the plan is not in the store.
    #[error("missing (run {planner} with --force)", planner = crate::PLANNER)]
    NoMap,
    /// A map of the store is another one than the plan was made with.
    #[error("is not the map of the plan (run {planner} with --force)", planner = crate::PLANNER)]
    OtherMap,
}
