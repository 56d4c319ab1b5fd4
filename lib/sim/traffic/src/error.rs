//! Why a scene cannot be simulated.

/// A fault of a scene's plan or map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrafficError {
    /// The map has no lanes to drive on.
    #[error("scene {scene}: map `{map}` has no driving lanes")]
    NoDrivingLanes {
        /// Scene number.
        scene: u32,
        /// Map name.
        map: String,
    },
    /// An agent's model is not in the catalogue.
    #[error("scene {scene}, {agent}: model `{model}` is no vehicle of the catalogue")]
    UnknownModel {
        /// Scene number.
        scene: u32,
        /// Whose it is.
        agent: schema::AgentId,
        /// Model name.
        model: String,
    },
    /// The model of an actor on a given trajectory is not in the catalogue.
    #[error("scene {scene}, {actor}: there is no model `{model}`")]
    UnknownGivenModel {
        /// Scene number.
        scene: u32,
        /// Whose it is.
        actor: String,
        /// Model name.
        model: String,
    },
    /// A number of the plan that cannot be followed.
    #[error("scene {scene}: {field} is {value}")]
    BadPlan {
        /// Scene number.
        scene: u32,
        /// Column of the plan.
        field: &'static str,
        /// Its value.
        value: String,
    },
    /// More objects than ids.
    #[error("scene {scene}: object ids run out at 65535 ({wanted} actors, the first would get {first})")]
    TooManyObjects {
        /// Scene number.
        scene: u32,
        /// Actors to number.
        wanted: usize,
        /// First free id.
        first: u16,
    },
    /// The caller asked to stop.
    #[error("scene {scene}: interrupted")]
    Interrupted {
        /// Scene number.
        scene: u32,
    },
}
