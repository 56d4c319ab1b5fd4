//! Checks of links between roads and through junctions.

use super::lines::{Ids, JunctionLines, RoadLines, line_of, note};
use super::road::{has_lane, outside};
use crate::model::{
    Connection, ConnectionKind, ContactPoint, Junction, JunctionKind, LaneSection, Road, RoadLink,
};
use crate::read::context::Context;

/// The lane section at an end of a road.
fn section_at(road: &Road, contact: ContactPoint) -> Option<&LaneSection> {
    match contact {
        ContactPoint::Start => road.sections.first(),
        ContactPoint::End => road.sections.last(),
    }
}

/// What an end of a road is linked to.
fn link_at(road: &Road, contact: ContactPoint) -> Option<&RoadLink> {
    match contact {
        ContactPoint::Start => road.predecessor.as_ref(),
        ContactPoint::End => road.successor.as_ref(),
    }
}

pub(super) fn road(context: &mut Context, ids: &Ids<'_>, road: &Road, lines: &RoadLines) {
    let mut say = |s: f64, message: String| note(context, lines.road, Some(road), Some(s), message);
    if let Some(junction) = road.junction.as_deref().filter(|j| !ids.junctions.contains_key(j)) {
        say(0.0, format!("belongs to junction {junction}, which does not exist"));
    }
    for end in [ContactPoint::Start, ContactPoint::End] {
        let (name, s) = match end {
            ContactPoint::Start => ("predecessor", 0.0),
            ContactPoint::End => ("successor", road.length_m),
        };
        match link_at(road, end) {
            Some(RoadLink::Road { id, contact }) => match ids.roads.get(id.as_str()) {
                None => say(s, format!("its {name} is road {id}, which does not exist")),
                Some(other) => road_link(road, end, other, *contact, &mut |message| {
                    say(s, format!("its {name} {message}"))
                }),
            },
            Some(RoadLink::Junction { id }) if !ids.junctions.contains_key(id.as_str()) => {
                say(s, format!("its {name} is junction {id}, which does not exist"));
            }
            Some(RoadLink::Along { id, s: place, .. }) => match ids.roads.get(id.as_str()) {
                None => say(s, format!("its {name} is road {id}, which does not exist")),
                Some(other) if outside(*place, other) => {
                    say(s, format!("its {name} is road {id} at {place} m, where there is no road"));
                }
                Some(_) => {}
            },
            _ => {}
        }
    }
    for neighbour in road.neighbours.iter().filter(|n| !ids.roads.contains_key(n.id.as_str())) {
        say(0.0, format!("its neighbour is road {}, which does not exist", neighbour.id));
    }
}

/// A link from one road to another: the other must say the same, and lanes must lead to lanes.
fn road_link(
    road: &Road,
    end: ContactPoint,
    other: &Road,
    contact: ContactPoint,
    say: &mut dyn FnMut(String),
) {
    let back = link_at(other, contact);
    let agrees = matches!(back, Some(RoadLink::Road { id, contact }) if *id == road.id && *contact == end);
    // Roads that meet in a junction are linked to the junction instead of each connecting road.
    if !agrees && road.junction.is_none() && other.junction.is_none() {
        let what = match back {
            None => "nothing".to_owned(),
            Some(RoadLink::Road { id, contact }) => format!("the {contact} of road {id}"),
            Some(RoadLink::Junction { id }) => format!("junction {id}"),
            Some(RoadLink::Along { id, .. }) => format!("the middle of road {id}"),
        };
        say(format!("is the {contact} of road {}, which is linked to {what}", other.id));
    }
    let (Some(here), Some(there)) = (section_at(road, end), section_at(other, contact)) else { return };
    for lane in here.lanes() {
        let next = if end == ContactPoint::Start { &lane.predecessors } else { &lane.successors };
        for id in next.iter().filter(|id| !has_lane(there, **id)) {
            say(format!("is road {}, which has no lane {id} there to meet lane {}", other.id, lane.id));
        }
    }
}

pub(super) fn junction(context: &mut Context, ids: &Ids<'_>, junction: &Junction, lines: &JunctionLines) {
    for (i, connection) in junction.connections.iter().enumerate() {
        let line = line_of(&lines.connections, i);
        let mut say = |message: String| {
            note(context, line, None, None, format!("junction {}: {message}", junction.id));
        };
        // A connection into a virtual junction may come from nowhere in particular.
        let stated = |id: &str| !(id.is_empty() || (id == "-1" && junction.kind == JunctionKind::Virtual));
        let mut find = |id: &str| {
            let road = ids.roads.get(id).copied();
            if road.is_none() && stated(id) {
                say(format!("road {id} of a connection does not exist"));
            }
            road
        };
        let (incoming, connecting) = (find(&connection.incoming_road), find(&connection.connecting_road));
        if let (Some(incoming), Some(connecting)) = (incoming, connecting) {
            connection_roads(junction, connection, incoming, connecting, &mut say);
        }
    }
    let mut say = |message: String| {
        note(context, lines.junction, None, None, format!("junction {}: {message}", junction.id));
    };
    let priorities = junction.priorities.iter().flat_map(|p| p.high.iter().chain(&p.low));
    let paths = junction.cross_paths.iter().flat_map(|p| [&p.crossing_road, &p.start.road, &p.end.road]);
    let stretches =
        junction.crossing.iter().map(|s| &s.road).chain(junction.main_road.iter().map(|m| &m.road));
    for id in priorities.chain(paths).chain(stretches) {
        if !ids.roads.contains_key(id.as_str()) {
            say(format!("names road {id}, which does not exist"));
        }
    }
    if junction.kind == JunctionKind::Virtual && junction.main_road.is_none() {
        say("a virtual junction needs a main road".to_owned());
    }
}

/// A connection between two roads that exist.
fn connection_roads(
    junction: &Junction,
    connection: &Connection,
    incoming: &Road,
    connecting: &Road,
    say: &mut dyn FnMut(String),
) {
    let (from, to) = (&incoming.id, &connecting.id);
    if junction.kind == JunctionKind::Default
        && connection.kind == ConnectionKind::Default
        && connecting.junction.as_deref() != Some(&junction.id)
    {
        say(format!("the connecting road {to} does not belong to it"));
    }
    let back = link_at(connecting, connection.contact);
    let mut end = None;
    match back {
        Some(RoadLink::Road { id, contact }) if id == from => end = Some(*contact),
        Some(RoadLink::Along { id, .. }) if id == from => return,
        Some(RoadLink::Road { id, .. } | RoadLink::Along { id, .. }) => {
            say(format!("the {} of road {to} touches road {id}, not road {from}", connection.contact));
        }
        _ => {}
    }
    let here = end.and_then(|end| section_at(incoming, end));
    let there = section_at(connecting, connection.contact);
    for link in &connection.lane_links {
        if here.is_some_and(|section| !has_lane(section, link.from)) {
            say(format!("road {from} has no lane {} to come from", link.from));
        }
        if there.is_some_and(|section| !has_lane(section, link.to)) {
            say(format!("road {to} has no lane {} to lead to", link.to));
        }
    }
}
