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
}
