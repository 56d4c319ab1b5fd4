//! Where in the file everything is, and what ids mean there.

use std::collections::BTreeMap;

use crate::model::{Road, Warning};
use crate::read::context::Context;

/// Lines of what warnings may be about, in the order of the network.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    pub(crate) roads: Vec<RoadLines>,
    pub(crate) junctions: Vec<JunctionLines>,
    pub(crate) controllers: Vec<u32>,
}

/// Lines of a road and its parts, in the order of the model.
#[derive(Debug, Default)]
pub(crate) struct RoadLines {
    pub(crate) road: u32,
    pub(crate) geometry: Vec<u32>,
    pub(crate) sections: Vec<u32>,
    pub(crate) objects: Vec<u32>,
    pub(crate) signals: Vec<u32>,
}

/// Lines of a junction and its connections.
#[derive(Debug, Default)]
pub(crate) struct JunctionLines {
    pub(crate) junction: u32,
    pub(crate) connections: Vec<u32>,
}

/// The line of a part; 0 where it is not known.
pub(super) fn line_of(lines: &[u32], index: usize) -> u32 {
    lines.get(index).copied().unwrap_or(0)
}

/// What ids mean: the first road or junction that has them.
pub(super) struct Ids<'a> {
    pub(super) roads: BTreeMap<&'a str, &'a Road>,
    pub(super) junctions: BTreeMap<&'a str, usize>,
}

pub(super) fn note(context: &mut Context, line: u32, road: Option<&Road>, s: Option<f64>, message: String) {
    context.note(Warning { line, road: road.map(|r| r.id.clone()), s, message });
}
