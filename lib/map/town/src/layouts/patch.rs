//! Towns of other styles as parts of a larger map.

use frames::math::sin_cos;
use frames::wrap_pi;
use opendrive::ContactPoint;
use std::f64::consts::FRAC_PI_8;
use std::ops::Range;

use super::plane::{Point, Segment, distance, heading, near};
use crate::layout::{Edge, Layout, Line, NodeId, NodeKind, Role};
use crate::path::Pose2;
use crate::terrain::{Channel, Hill, Pad};

/// Least angle between a gate's road and the streets that are there already, radians.
const GATE_RAD: f64 = 1.15;
/// A gate's road has to be clear of the town for so long, and by so much, metres.
const CLEAR_M: [f64; 2] = [420.0, 50.0];
/// Least angle between two gates, seen from the town's middle, radians.
const APART_RAD: f64 = 0.8;

/// A turn and a shift.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) at_m: Point,
    pub(super) turn_rad: f64,
}

/// A town in a larger layout.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    pub(super) nodes: Range<NodeId>,
    pub(super) edges: Range<usize>,
    pub(super) centre_m: Point,
    /// From the centre to the farthest corner of a street, metres.
    pub(super) radius_m: f64,
}

/// A junction at a town's edge from which a road may lead away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    pub(super) node: NodeId,
    /// Direction of the road, radians from east.
    pub(super) heading_rad: f64,
}

/// The points of an edge's line: its nodes, and the corners between them.
pub(super) fn points(layout: &Layout, edge: &Edge) -> Vec<Point> {
    let mut points = vec![layout.nodes[edge.from.node].at_m];
    points.extend(edge.vias().iter().map(|v| v.at_m));
    points.push(layout.nodes[edge.to.node].at_m);
    points
}

/// The straight parts of an edge's line.
pub(super) fn segments(layout: &Layout, edge: &Edge) -> Vec<Segment> {
    points(layout, edge).windows(2).map(|p| [p[0], p[1]]).collect()
}

/// Middle of the box round a layout's streets, and the distance of the farthest corner from it, metres.
pub(super) fn extent(layout: &Layout) -> (Point, f64) {
    let all: Vec<Point> = layout.edges.iter().flat_map(|e| points(layout, e)).collect();
    let span = |axis: usize| {
        let values = || all.iter().map(|p| p[axis]);
        0.5 * (values().fold(f64::INFINITY, f64::min) + values().fold(f64::NEG_INFINITY, f64::max))
    };
    let middle = [span(0), span(1)];
    (middle, all.iter().map(|p| distance(*p, middle)).fold(0.0, f64::max))
}

/// Puts a town into a larger layout, its middle at the spot. Its hills and channels come along; what else its
/// ground does is the larger map's.
pub(super) fn plant(into: &mut Layout, town: Layout, spot: Spot) -> Patch {
    let (middle, radius_m) = extent(&town);
    let (s, c) = sin_cos(spot.turn_rad);
    let at = |[x, y]: Point| {
        let (x, y) = (x - middle[0], y - middle[1]);
        [spot.at_m[0] + c * x - s * y, spot.at_m[1] + s * x + c * y]
    };
    let pose = |p: Pose2| {
        let [x_m, y_m] = at([p.x_m, p.y_m]);
        Pose2 { x_m, y_m, heading_rad: wrap_pi(p.heading_rad + spot.turn_rad) }
    };
    let (first_node, first_edge) = (into.nodes.len(), into.edges.len());
    for mut node in town.nodes {
        node.at_m = at(node.at_m);
        into.node(node);
    }
    for mut edge in town.edges {
        for end in [&mut edge.from, &mut edge.to] {
            end.node += first_node;
            end.heading_rad = end.heading_rad.map(|h| wrap_pi(h + spot.turn_rad));
            end.role = match end.role {
                Role::Fixed(p) => Role::Fixed(pose(p)),
                Role::Ring(p) => Role::Ring(pose(p)),
                other => other,
            };
        }
        match &mut edge.line {
            Line::Via(vias) => vias.iter_mut().for_each(|via| via.at_m = at(via.at_m)),
            Line::Chain(start, _) => *start = pose(*start),
        }
        edge.anchors.iter_mut().for_each(|anchor| anchor.at_m = at(anchor.at_m));
        edge.even.iter_mut().flatten().for_each(|p| *p = at(*p));
        into.edge(edge);
    }
    let ground = &mut into.terrain;
    ground.hills.extend(town.terrain.hills.into_iter().map(|h| Hill { at_m: at(h.at_m), ..h }));
    ground.pads.extend(town.terrain.pads.into_iter().map(|p| Pad { at_m: at(p.at_m), ..p }));
    ground.channels.extend(
        town.terrain
            .channels
            .into_iter()
            .map(|c| Channel { line_m: c.line_m.into_iter().map(at).collect(), ..c }),
    );
    Patch {
        nodes: first_node..into.nodes.len(),
        edges: first_edge..into.edges.len(),
        centre_m: spot.at_m,
        radius_m,
    }
}

/// Junctions at a town's edge from which roads may lead away, the outermost first, at most so many.
pub(super) fn gates(layout: &Layout, patch: &Patch, most: usize) -> Vec<Gate> {
    let mut found: Vec<(f64, Gate)> = Vec::new();
    for node in patch.nodes.clone() {
        let place = &layout.nodes[node];
        if !matches!(place.kind, NodeKind::Crossing(_)) || place.lift_m != 0.0 {
            continue;
        }
        let out = heading(patch.centre_m, place.at_m);
        let arms = arms(layout, patch, node);
        let free = |h: f64| arms.iter().map(|a| wrap_pi(a - h).abs()).fold(f64::INFINITY, f64::min);
        let tries = [0.0, 1.0, -1.0, 2.0, -2.0].map(|k| wrap_pi(out + k * FRAC_PI_8));
        let Some(best) = tries.into_iter().max_by(|a, b| free(*a).min(1.5).total_cmp(&free(*b).min(1.5)))
        else {
            continue;
        };
        if arms.len() < 4 && free(best) >= GATE_RAD && is_clear(layout, patch, node, best) {
            found.push((distance(place.at_m, patch.centre_m), Gate { node, heading_rad: best }));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut gates: Vec<Gate> = Vec::new();
    for (_, gate) in found {
        let bearing = |g: &Gate| heading(patch.centre_m, layout.nodes[g.node].at_m);
        if gates.len() < most
            && gates.iter().all(|other| wrap_pi(bearing(other) - bearing(&gate)).abs() > APART_RAD)
        {
            gates.push(gate);
        }
    }
    gates
}

/// Headings of the streets at a node of a patch.
fn arms(layout: &Layout, patch: &Patch, node: NodeId) -> Vec<f64> {
    let mut headings = Vec::new();
    for edge in &layout.edges[patch.edges.clone()] {
        let line = points(layout, edge);
        for contact in [ContactPoint::Start, ContactPoint::End] {
            if edge.at(contact).node == node {
                let next = if contact == ContactPoint::Start { line[1] } else { line[line.len() - 2] };
                headings.push(edge.at(contact).heading_rad.unwrap_or(heading(layout.nodes[node].at_m, next)));
            }
        }
    }
    headings
}

fn is_clear(layout: &Layout, patch: &Patch, node: NodeId, heading_rad: f64) -> bool {
    let from = layout.nodes[node].at_m;
    let (s, c) = sin_cos(heading_rad);
    let at = |d: f64| [from[0] + d * c, from[1] + d * s];
    layout.edges[patch.edges.clone()].iter().all(|edge| {
        let own = edge.from.node == node || edge.to.node == node;
        // The streets that meet there are only to be left behind.
        let ray = [at(if own { 2.0 * CLEAR_M[1] } else { 0.0 }), at(CLEAR_M[0])];
        segments(layout, edge).iter().all(|part| !near(ray, *part, CLEAR_M[1]))
    })
}
