//! Checks that need the whole network: links to nowhere, gaps, lengths that do not add up, ids that occur twice.

mod furniture;
mod links;
mod measure;
mod road;

use std::collections::BTreeMap;

pub(super) use measure::{absurdity, is_absurd};

use super::Warning;
use super::context::Context;
use crate::model::{Network, Road};

/// Lines of what warnings may be about, in the order of the network.
#[derive(Debug, Default)]
pub(super) struct Lines {
    pub(super) roads: Vec<RoadLines>,
    pub(super) junctions: Vec<JunctionLines>,
    pub(super) controllers: Vec<u32>,
}

/// Lines of a road and its parts, in the order of the model.
#[derive(Debug, Default)]
pub(super) struct RoadLines {
    pub(super) road: u32,
    pub(super) geometry: Vec<u32>,
    pub(super) sections: Vec<u32>,
    pub(super) objects: Vec<u32>,
    pub(super) signals: Vec<u32>,
}

/// Lines of a junction and its connections.
#[derive(Debug, Default)]
pub(super) struct JunctionLines {
    pub(super) junction: u32,
    pub(super) connections: Vec<u32>,
}

/// The line of a part; 0 where it is not known.
fn line_of(lines: &[u32], index: usize) -> u32 {
    lines.get(index).copied().unwrap_or(0)
}

/// What ids mean: the first road or junction that has them.
struct Ids<'a> {
    roads: BTreeMap<&'a str, &'a Road>,
    junctions: BTreeMap<&'a str, usize>,
}

pub(super) fn check(context: &mut Context, network: &Network, lines: &Lines) {
    let mut ids = Ids { roads: BTreeMap::new(), junctions: BTreeMap::new() };
    for (road, lines) in network.roads.iter().zip(&lines.roads) {
        let first = *ids.roads.entry(&road.id).or_insert(road);
        if !std::ptr::eq(first, road) {
            let message = format!("another road has the id {}, too: links go to the first", road.id);
            note(context, lines.road, Some(road), None, message);
        }
    }
    for (i, (junction, lines)) in network.junctions.iter().zip(&lines.junctions).enumerate() {
        if *ids.junctions.entry(&junction.id).or_insert(i) != i {
            let message = format!("another junction has the id {}, too: links go to the first", junction.id);
            note(context, lines.junction, None, None, message);
        }
    }
    for (road, lines) in network.roads.iter().zip(&lines.roads) {
        road::reference_line(context, road, lines);
        road::records(context, road, lines);
        road::sections(context, road, lines);
        links::road(context, &ids, road, lines);
    }
    for (junction, lines) in network.junctions.iter().zip(&lines.junctions) {
        links::junction(context, &ids, junction, lines);
    }
    furniture::check(context, network, lines);
}

fn note(context: &mut Context, line: u32, road: Option<&Road>, s: Option<f64>, message: String) {
    context.note(Warning { line, road: road.map(|r| r.id.clone()), s, message });
}
