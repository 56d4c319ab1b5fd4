//! Checks of signals, objects, structures and controllers.

use std::collections::{BTreeMap, BTreeSet};

use super::lines::{Lines, line_of, note};
use super::road::outside;
use crate::model::{Network, Repeat, Road};
use crate::read::context::Context;

pub(super) fn check(context: &mut Context, network: &Network, lines: &Lines) {
    let mut signals: BTreeMap<&str, usize> = BTreeMap::new();
    for (road, lines) in network.roads.iter().zip(&lines.roads) {
        for (i, signal) in road.signals.iter().enumerate() {
            let line = line_of(&lines.signals, i);
            let seen = signals.entry(&signal.id).or_default();
            *seen += 1;
            if *seen > 1 {
                let message =
                    format!("another signal has the id {}, too: references go to the first", signal.id);
                note(context, line, Some(road), Some(signal.s), message);
            }
            beyond(context, road, "signal", &signal.id, signal.s, line);
        }
        for (i, object) in road.objects.iter().enumerate() {
            let line = line_of(&lines.objects, i);
            if object.repeats.is_empty() {
                beyond(context, road, "object", &object.id, object.s, line);
            }
            for repeat in &object.repeats {
                if repeat.room() > Repeat::MAX_COPIES as f64 {
                    let message = format!(
                        "a row of object {} has room for {:e} copies: only the first {} are placed",
                        object.id,
                        repeat.room(),
                        Repeat::MAX_COPIES
                    );
                    note(context, line, Some(road), Some(repeat.s), message);
                }
                beyond(context, road, "row of object", &object.id, repeat.s, line);
                beyond(context, road, "row of object", &object.id, repeat.s + repeat.length_m, line);
            }
        }
        let bridges = road.bridges.iter().map(|b| ("bridge", &b.id, b.s, b.length_m));
        let tunnels = road.tunnels.iter().map(|t| ("tunnel", &t.id, t.s, t.length_m));
        for (what, id, s, length_m) in bridges.chain(tunnels) {
            beyond(context, road, what, id, s, lines.road);
            beyond(context, road, what, id, s + length_m, lines.road);
        }
    }
    for (road, lines) in network.roads.iter().zip(&lines.roads) {
        for reference in road.signal_references.iter().filter(|r| !signals.contains_key(r.id.as_str())) {
            let message = format!("refers to signal {}, which does not exist", reference.id);
            note(context, lines.road, Some(road), Some(reference.s), message);
        }
        for (i, signal) in road.signals.iter().enumerate() {
            for other in signal.dependencies.iter().filter(|d| !signals.contains_key(d.id.as_str())) {
                let message =
                    format!("signal {} depends on signal {}, which does not exist", signal.id, other.id);
                note(context, line_of(&lines.signals, i), Some(road), Some(signal.s), message);
            }
        }
    }
    let mut controllers = BTreeSet::new();
    for (i, controller) in network.controllers.iter().enumerate() {
        let line = line_of(&lines.controllers, i);
        if !controllers.insert(controller.id.as_str()) {
            let message =
                format!("another controller has the id {}, too: the first one counts", controller.id);
            note(context, line, None, None, message);
        }
        for id in controller.signals.iter().filter(|id| !signals.contains_key(id.as_str())) {
            let message = format!("controller {} names signal {id}, which does not exist", controller.id);
            note(context, line, None, None, message);
        }
    }
    for (junction, lines) in network.junctions.iter().zip(&lines.junctions) {
        for entry in junction.controllers.iter().filter(|c| !controllers.contains(c.id.as_str())) {
            let message =
                format!("junction {} names controller {}, which does not exist", junction.id, entry.id);
            note(context, lines.junction, None, None, message);
        }
    }
}

fn beyond(context: &mut Context, road: &Road, what: &str, id: &str, s: f64, line: u32) {
    if outside(s, road) {
        note(context, line, Some(road), Some(s), format!("{what} {id} lies where there is no road"));
    }
}
