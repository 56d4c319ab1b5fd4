//! What can go wrong between the simulation and its log.

/// A scene was simulated and cannot be logged.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LogError {
    /// Ids are not 1, 2, 3, ...
    #[error("object number {number} has id {id}: a bug")]
    Ids { number: usize, id: u16 },
    /// The plan's tables lack a scene that its manifest names.
    #[error("has no such scene (run spawn-planner with --force)")]
    NotPlanned,
    /// An agent of the plan is not among the actors.
    #[error("{agent} was not simulated")]
    NotSimulated { agent: schema::AgentId },
    /// An agent is where no lane is.
    #[error("no driving lane")]
    NoLane,
}
