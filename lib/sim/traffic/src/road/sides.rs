//! Which lanes lie beside which, and where the marks between them may be crossed.

use std::collections::BTreeMap;

use opendrive::{LaneId, Map};

use crate::road::centreline::{Centreline, Sample};

/// Lanes narrower than this are not changed to, metres.
pub(crate) const CHANGE_WIDTH_M: f64 = 2.6;

/// Left and right of the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

impl Side {
    pub(crate) const BOTH: [Self; 2] = [Self::Right, Self::Left];
}

/// The lane beside a lane that runs the same way.
#[derive(Clone, Debug)]
pub(crate) struct Beside {
    pub(crate) lane: usize,
    /// Per sample of the lane: whether the marks there allow to cross over.
    pub(crate) allowed: Vec<bool>,
}

/// The neighbour of a way on one side; none in junctions, where nobody changes lanes.
pub(crate) fn beside(
    map: &Map,
    way: &Centreline,
    index: &BTreeMap<LaneId, usize>,
    side: Side,
) -> Option<Beside> {
    let own = map.lane(way.lane)?;
    let id = match side {
        Side::Left => map.left_of(way.lane)?,
        Side::Right => map.right_of(way.lane)?,
    };
    let lane =
        index.get(&id).copied().filter(|_| own.junction.is_none() && map.same_direction(way.lane, id))?;
    let allows = |sample: &Sample| {
        let share = sample.along_m / way.length_m;
        let marks = map.lane_change(way.lane, own.s_of_along(own.s_length() * share));
        match side {
            Side::Left => marks.to_left(),
            Side::Right => marks.to_right(),
        }
    };
    let allowed: Vec<bool> = way.samples.iter().map(allows).collect();
    allowed.contains(&true).then_some(Beside { lane, allowed })
}
