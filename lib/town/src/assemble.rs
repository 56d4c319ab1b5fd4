//! From a layout of nodes and edges to a network.

use frames::math::{cos, sin, tan};
use opendrive::{ContactPoint, Header, Network, Road, RoadLink};
use std::f64::consts::PI;

use crate::TownError;
use crate::control::{Control, equip};
use crate::junction::{junction, lead_m, setbacks};
use crate::movements::Arm;
use crate::path::{Bend, Path, Pose2};
use crate::section::CrossSection;
use crate::street::street;

/// Least length of a street between two junctions, metres.
const SHORTEST_STREET_M: f64 = 12.0;

/// Hands out ids that are unique in the whole file.
#[derive(Debug, Default)]
pub(crate) struct Ids(u32);

impl Ids {
    pub(crate) fn next(&mut self) -> String {
        let id = self.0;
        self.0 += 1;
        id.to_string()
    }
}

/// Where streets meet.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Centre, metres east and north.
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// Height of its level surface, metres.
    pub(crate) z_m: f64,
    pub(crate) control: Control,
    pub(crate) name: String,
}

/// A street between two nodes; both ends point away from their node.
#[derive(Clone, Debug)]
pub(crate) struct Edge {
    /// Node and heading (radians) at the start.
    pub(crate) from: (usize, f64),
    /// Node and heading at the end.
    pub(crate) to: (usize, f64),
    pub(crate) shape: CrossSection,
    /// Radius of its bend, where it has one, and length of the clothoids, metres.
    pub(crate) bend_m: [f64; 2],
    pub(crate) name: String,
}

/// A whole town before its junctions are built.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(crate) name: String,
    pub(crate) nodes: Vec<Node>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) kerb_radius_m: f64,
    pub(crate) geo_reference: String,
}

/// An arm before its street is built.
struct End {
    edge: usize,
    contact: ContactPoint,
    heading_rad: f64,
}

/// Builds every street and junction.
pub(crate) fn assemble(layout: &Layout) -> Result<Network, TownError> {
    let mut ids = Ids::default();
    let arms_of = arms_by_node(layout);
    let outward = street_ends(layout, &arms_of);

    let mut network = Network { header: header(layout, &outward), ..Network::default() };
    for (edge, ends) in layout.edges.iter().zip(&outward) {
        network.roads.push(build_street(&mut ids, layout, edge, *ends)?);
    }
    for (node, ends) in layout.nodes.iter().zip(&arms_of) {
        let arms: Vec<Arm> = ends
            .iter()
            .map(|end| {
                let edge = &layout.edges[end.edge];
                let crosswalk = node.control.holds_back(is_faced(ends, end));
                Arm {
                    road: network.roads[end.edge].id.clone(),
                    contact: end.contact,
                    outward: outward[end.edge][usize::from(end.contact == ContactPoint::End)],
                    shape: edge.shape,
                    lead_m: lead_m(crosswalk),
                    crosswalk,
                }
            })
            .collect();
        let lengths: Vec<f64> = ends.iter().map(|end| network.roads[end.edge].length_m).collect();
        let mut built = junction(&mut ids, &node.name, &arms, node.z_m, layout.kerb_radius_m);
        let furniture = equip(&mut ids, &mut built, &arms, &lengths, node.control);
        for (end, (signal, object)) in ends.iter().zip(furniture.at_arms) {
            let street = &mut network.roads[end.edge];
            street.signals.extend(signal);
            street.objects.extend(object);
            let link = Some(RoadLink::Junction { id: built.junction.id.clone() });
            match end.contact {
                ContactPoint::Start => street.predecessor = link,
                ContactPoint::End => street.successor = link,
            }
        }
        network.roads.extend(built.roads);
        network.junctions.push(built.junction);
        network.controllers.extend(furniture.controllers);
    }
    Ok(network)
}

fn arms_by_node(layout: &Layout) -> Vec<Vec<End>> {
    let mut arms: Vec<Vec<End>> = layout.nodes.iter().map(|_| Vec::new()).collect();
    for (edge, e) in layout.edges.iter().enumerate() {
        for ((node, heading_rad), contact) in [(e.from, ContactPoint::Start), (e.to, ContactPoint::End)] {
            arms[node].push(End { edge, contact, heading_rad });
        }
    }
    arms
}

/// Whether another arm of the node goes straight on from this one.
fn is_faced(ends: &[End], end: &End) -> bool {
    ends.iter().any(|other| {
        let turn = frames::wrap_pi(other.heading_rad - end.heading_rad - PI);
        (other.edge, other.contact) != (end.edge, end.contact) && turn.abs() < crate::movements::STRAIGHT_RAD
    })
}

/// Start and end of each edge's reference line, both facing away from their node.
fn street_ends(layout: &Layout, arms_of: &[Vec<End>]) -> Vec<[Pose2; 2]> {
    let origin = Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
    let mut outward = vec![[origin; 2]; layout.edges.len()];
    for (node, ends) in layout.nodes.iter().zip(arms_of) {
        let arms: Vec<(f64, [f64; 2], f64)> = ends
            .iter()
            .map(|end| {
                let shape = &layout.edges[end.edge].shape;
                let kerbs = match end.contact {
                    // Seen from the node, a street that starts here has its left side on the left.
                    ContactPoint::Start => [shape.left.kerb_m(), shape.right.kerb_m()],
                    ContactPoint::End => [shape.right.kerb_m(), shape.left.kerb_m()],
                };
                (end.heading_rad, kerbs, lead_m(node.control.holds_back(is_faced(ends, end))))
            })
            .collect();
        for (end, setback) in ends.iter().zip(setbacks(&arms, layout.kerb_radius_m)) {
            let centre = Pose2 { x_m: node.x_m, y_m: node.y_m, heading_rad: end.heading_rad };
            outward[end.edge][usize::from(end.contact == ContactPoint::End)] = centre.moved(setback, 0.0);
        }
    }
    outward
}

fn build_street(
    ids: &mut Ids,
    layout: &Layout,
    edge: &Edge,
    [start, end]: [Pose2; 2],
) -> Result<Road, TownError> {
    let finish = end.turned(PI);
    // A street that starts behind its own end could only be reached by a loop.
    let ahead =
        cos(start.heading_rad) * (end.x_m - start.x_m) + sin(start.heading_rad) * (end.y_m - start.y_m);
    // A bend must leave room for its tangents; a quarter turn needs about its radius.
    let turn = frames::wrap_pi(finish.heading_rad - start.heading_rad).abs();
    let needed_m = if turn > 0.1 && turn < 3.0 {
        (edge.shape.reach_m() + 4.0) * tan(0.5 * turn)
    } else {
        SHORTEST_STREET_M
    };
    if ahead < needed_m {
        return Err(TownError::TooTight { street: edge.name.clone(), left_m: ahead, needed_m });
    }
    let [radius_m, ease_m] = edge.bend_m;
    let path = Path::between(start, finish, &Bend { radius_m, ease_m, lead_in_m: 0.0, lead_out_m: 0.0 });
    let z_m = [layout.nodes[edge.from.0].z_m, layout.nodes[edge.to.0].z_m];
    Ok(street(ids, &edge.name, path, z_m, &edge.shape))
}

fn header(layout: &Layout, outward: &[[Pose2; 2]]) -> Header {
    let reach = layout.edges.iter().map(|e| e.shape.reach_m()).fold(0.0, f64::max) + layout.kerb_radius_m;
    let bound = |pick: fn(f64, f64) -> f64, of: fn(&Pose2) -> f64, margin: f64| {
        outward.iter().flatten().map(of).reduce(pick).unwrap_or_default() + margin
    };
    // A bend stays inside the box of its ends and its corner; the nodes it joins span that box.
    let nodes = |pick: fn(f64, f64) -> f64, of: fn(&Node) -> f64, margin: f64| {
        layout.nodes.iter().map(of).reduce(pick).unwrap_or_default() + margin
    };
    Header {
        revision: (1, 7),
        name: layout.name.clone(),
        version: "1.00".into(),
        // No date: the same town has the same bytes on every day.
        vendor: "Convoy".into(),
        bounds_m: Some([
            bound(f64::max, |p| p.y_m, reach).max(nodes(f64::max, |n| n.y_m, reach)),
            bound(f64::min, |p| p.y_m, -reach).min(nodes(f64::min, |n| n.y_m, -reach)),
            bound(f64::max, |p| p.x_m, reach).max(nodes(f64::max, |n| n.x_m, reach)),
            bound(f64::min, |p| p.x_m, -reach).min(nodes(f64::min, |n| n.x_m, -reach)),
        ]),
        geo_reference: Some(layout.geo_reference.clone()),
        ..Header::default()
    }
}
