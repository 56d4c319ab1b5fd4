//! What can go wrong.

use schema::ObjectId;

/// Why a world can't be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WorldError {
    /// An actor has a model that no mesh is known for.
    #[error("actor {id}: unknown model `{model}`")]
    UnknownModel {
        /// The actor.
        id: ObjectId,
        /// Its model.
        model: String,
    },
    /// An actor's pose or dimensions are not usable.
    #[error("actor {id} ({model}): {problem}")]
    BadActor {
        /// The actor.
        id: ObjectId,
        /// Its model.
        model: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// Two actors have one id.
    #[error("actor id {id} is used twice")]
    DuplicateId {
        /// The id.
        id: ObjectId,
    },
    /// The scenery does not fit into the ids from `first_id` to 65535.
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
