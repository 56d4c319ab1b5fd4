//! What pictures are drawn from.

use pictures::{BoxShape, ColourBy};

use crate::feed::{AgentFrame, Rig};
use crate::session::Session;

/// What pictures are drawn from.
pub(crate) struct Desk<'a> {
    pub(crate) session: &'a Session,
    pub(crate) frame: u32,
    /// All agents that were read, and their rigs.
    pub(crate) agents: &'a [AgentFrame],
    pub(crate) rigs: &'a [Rig],
    /// What the colours of points tell, where it was said.
    pub(crate) colour: Option<ColourBy>,
}

/// The boxes of all agents, each object once: as easy as it is to whom it is easiest.
pub(crate) fn boxes_of_all(agents: &[AgentFrame]) -> Vec<BoxShape> {
    let mut boxes: Vec<BoxShape> = agents.iter().flat_map(|a| a.boxes.iter().map(|(b, _)| *b)).collect();
    boxes.sort_by_key(|shape| (shape.id, shape.difficulty));
    boxes.dedup_by_key(|shape| shape.id);
    boxes
}
