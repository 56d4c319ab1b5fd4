//! Which lane leads to which, as lists.

use super::types::LaneId;

/// Lane connections in the direction of travel, as lists packed one after the other.
#[derive(Debug, Default)]
pub(super) struct Graph {
    successors: Packed,
    predecessors: Packed,
}

#[derive(Debug, Default)]
struct Packed {
    ends: Vec<u32>,
    lanes: Vec<LaneId>,
}

impl Packed {
    fn push(&mut self, lanes: impl Iterator<Item = LaneId>) {
        self.lanes.extend(lanes);
        self.ends.push(self.lanes.len() as u32);
    }

    fn of(&self, lane: usize) -> &[LaneId] {
        let from = if lane == 0 { 0 } else { self.ends[lane - 1] };
        &self.lanes[from as usize..self.ends[lane] as usize]
    }
}

impl Graph {
    /// Adds the next lane: where travel comes from and goes on to.
    pub(super) fn push(&mut self, from: impl Iterator<Item = LaneId>, to: impl Iterator<Item = LaneId>) {
        self.predecessors.push(from);
        self.successors.push(to);
    }

    pub(super) fn predecessors(&self, lane: usize) -> &[LaneId] {
        self.predecessors.of(lane)
    }

    pub(super) fn successors(&self, lane: usize) -> &[LaneId] {
        self.successors.of(lane)
    }
}
