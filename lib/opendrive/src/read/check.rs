//! Checks that need the whole network: links to nowhere, gaps, lengths that do not add up.

use std::collections::BTreeMap;

use super::Warning;
use super::context::Context;
use crate::geometry::Plan;
use crate::model::{Network, Road, RoadLink};

/// Seams of the reference line wider than this are worth a warning, metres.
const GAP_M: f64 = 0.01;
/// Kinks of the reference line sharper than this are worth a warning, radians.
const KINK_RAD: f64 = 0.01;

pub(super) fn check(context: &mut Context, network: &Network) {
    let mut roads: BTreeMap<&str, &Road> = BTreeMap::new();
    for road in &network.roads {
        if roads.insert(&road.id, road).is_some() {
            note(context, None, None, format!("two roads have the id {}: links go to the first", road.id));
        }
    }
    let junctions: BTreeMap<&str, ()> = network.junctions.iter().map(|j| (j.id.as_str(), ())).collect();
    for road in &network.roads {
        if let Some(junction) = road.junction.as_deref().filter(|j| !junctions.contains_key(j)) {
            note(context, Some(road), None, format!("belongs to junction {junction}, which does not exist"));
        }
        for (end, link) in [("predecessor", &road.predecessor), ("successor", &road.successor)] {
            match link {
                Some(RoadLink::Road { id, .. }) if !roads.contains_key(id.as_str()) => {
                    note(context, Some(road), None, format!("its {end} is road {id}, which does not exist"));
                }
                Some(RoadLink::Junction { id }) if !junctions.contains_key(id.as_str()) => {
                    note(
                        context,
                        Some(road),
                        None,
                        format!("its {end} is junction {id}, which does not exist"),
                    );
                }
                _ => {}
            }
        }
        reference_line(context, road);
        sections(context, road);
    }
    for junction in &network.junctions {
        for connection in &junction.connections {
            for id in [&connection.incoming_road, &connection.connecting_road] {
                if !roads.contains_key(id.as_str()) {
                    let message =
                        format!("junction {}: road {id} of a connection does not exist", junction.id);
                    note(context, None, None, message);
                }
            }
        }
    }
}

fn reference_line(context: &mut Context, road: &Road) {
    for (s, gap, kink) in Plan::new(&road.plan_view, |x, y, h| (x, y, h)).seams() {
        if gap > GAP_M {
            note(context, Some(road), Some(s), format!("the reference line has a gap of {gap:.3} m"));
        } else if kink > KINK_RAD {
            note(context, Some(road), Some(s), format!("the reference line has a kink of {kink:.4} rad"));
        }
    }
    let sum: f64 = road.plan_view.iter().map(|g| g.length_m).sum();
    if (sum - road.length_m).abs() > GAP_M {
        let message =
            format!("geometry adds up to {sum:.3} m, but the road's length is {:.3} m", road.length_m);
        note(context, Some(road), None, message);
    }
}

/// Lane links inside the road that lead to lanes that are not there.
fn sections(context: &mut Context, road: &Road) {
    if let Some(first) = road.sections.first().filter(|s| s.s > GAP_M) {
        note(context, Some(road), Some(first.s), "the first lane section begins late".to_owned());
    }
    if let Some(last) = road.sections.last().filter(|s| s.s > road.length_m) {
        note(context, Some(road), Some(last.s), "a lane section begins after the road's end".to_owned());
    }
    for pair in road.sections.windows(2) {
        for lane in pair[0].lanes() {
            for id in lane.successors.iter().filter(|id| **id == 0 || pair[1].lane(**id).is_none()) {
                let message = format!("lane {} leads to lane {id}, which does not exist", lane.id);
                note(context, Some(road), Some(pair[1].s), message);
            }
        }
        for lane in pair[1].lanes() {
            for id in lane.predecessors.iter().filter(|id| **id == 0 || pair[0].lane(**id).is_none()) {
                let message = format!("lane {} follows lane {id}, which does not exist", lane.id);
                note(context, Some(road), Some(pair[1].s), message);
            }
        }
    }
}

fn note(context: &mut Context, road: Option<&Road>, s: Option<f64>, message: String) {
    context.note(Warning { line: 0, road: road.map(|r| r.id.clone()), s, message });
}
