//! Checks that need the whole network: links to nowhere, gaps, lengths that do not add up, ids that occur
//! twice.

mod furniture;
mod lines;
mod links;
mod measure;
mod road;

use std::collections::BTreeMap;

pub(super) use lines::{JunctionLines, Lines, RoadLines};
pub(super) use measure::{absurdity, is_absurd};

use super::context::Context;
use crate::model::Network;
use lines::{Ids, note};

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
