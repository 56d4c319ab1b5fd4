//! What can go wrong.

use schema::ObjectId;

/// Why scenery can't be placed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneryError {
    /// It does not fit into the ids from `first_id` to 65535.
    #[error("{wanted} scenery objects do not fit into the ids from {first_id} to 65535")]
    OutOfIds {
        /// First id that was free.
        first_id: ObjectId,
        /// How many objects must be numbered at least.
        wanted: usize,
    },
    /// Scenery is built around places; there was none, or one that is not finite.
    #[error("scenery needs at least one place to be built around, with finite coordinates")]
    NoCentre,
    /// The map has no lanes near the places that scenery was asked for.
    #[error("no lane within {radius_m} m of any place that scenery was asked for")]
    NoRoads {
        /// The radius around each place, metres.
        radius_m: f64,
    },
}
