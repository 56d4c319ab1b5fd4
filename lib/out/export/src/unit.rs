//! The pieces in which an export is made.

use std::fmt;

use schema::AgentId;

/// A piece of an export that is made by itself and kept once it is finished: an agent of a scene, or a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct UnitName {
    /// The scene.
    pub scene: u32,
    /// The agent; none where a scene is one piece.
    pub agent: Option<AgentId>,
}

impl fmt::Display for UnitName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "scene_{:04}", self.scene)?;
        self.agent.map_or(Ok(()), |agent| write!(f, ".{agent}"))
    }
}

/// Watches an export, from any thread.
pub trait ProgressWatch: Sync {
    /// So many frames of agents are done; whether to stop.
    fn advance(&self, agent_frames: u64) -> bool;
}

/// Nobody watches.
#[cfg(test)]
pub(crate) struct Nobody;

#[cfg(test)]
impl ProgressWatch for Nobody {
    fn advance(&self, _: u64) -> bool {
        false
    }
}
