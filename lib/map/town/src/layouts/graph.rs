//! Streets as lines through points: the common ground of styles that are no plain grid.
//!
//! A [`Graph`] is points and links between them; a link belongs to a line, which is a street with one name
//! and cross-section. Where two links of one line meet at a junction the street goes straight through it.
//! Points with two links are corners of a street, points with one are dead ends, and the rest are junctions.
//! [`Graph::into_layout`] makes nodes and edges of that.

use frames::math::{atan2, hypot, sin_cos};
use frames::wrap_pi;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use crate::assemble::build;
use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::section::{CrossSection, Ending, Pocket, RoadKind};
use crate::terrain::Terrain;

/// Names a point of a graph.
pub(super) type PointId = usize;
/// Names a line of a graph.
pub(super) type LineId = usize;

/// Radius of the turning circle at a dead end, metres.
const CIRCLE_M: f64 = 9.5;
/// Metres on which two cross-sections blend.
const SEAM_M: f64 = 24.0;
/// Smallest radius of a country road, metres.
const RURAL_RADIUS_M: f64 = 25.0;
/// Bends up to this may be seams, radians.
const STRAIGHT_RAD: f64 = 0.45;

/// A street.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) name: String,
    pub(super) shape: CrossSection,
    /// Radius and clothoids of its corners, metres.
    pub(super) bend_m: [f64; 2],
    /// Left pocket that it has at signals with four arms.
    pub(super) pocket: Option<Pocket>,
}

/// A piece of a line between two points.
#[derive(Clone, Copy, Debug)]
struct Link {
    line: LineId,
    ends: [PointId; 2],
}

/// Streets before they are a layout.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    points: Vec<[f64; 2]>,
    lines: Vec<Line>,
    links: Vec<Link>,
    kinds: BTreeMap<PointId, NodeKind>,
    unwalked: BTreeSet<PointId>,
}

/// One end of a link: its index, and 0 for its start or 1 for its end.
type Arm = (usize, usize);

impl Graph {
    /// Adds a point, metres east and north.
    pub(super) fn point(&mut self, at_m: [f64; 2]) -> PointId {
        self.points.push(at_m);
        self.points.len() - 1
    }

    /// Where a point is, metres.
    pub(super) fn at_m(&self, point: PointId) -> [f64; 2] {
        self.points[point]
    }

    /// Moves a point, metres.
    pub(super) fn move_to(&mut self, point: PointId, at_m: [f64; 2]) {
        self.points[point] = at_m;
    }

    /// Adds a street without links.
    pub(super) fn line(&mut self, name: impl Into<String>, shape: CrossSection, bend_m: [f64; 2]) -> LineId {
        self.lines.push(Line { name: name.into(), shape, bend_m, pocket: None });
        self.lines.len() - 1
    }

    /// Gives a street pockets for turns to the left.
    pub(super) fn pockets(&mut self, line: LineId, pocket: Pocket) {
        self.lines[line].pocket = Some(pocket);
    }

    /// Leads a street from point to point.
    pub(super) fn lead(&mut self, line: LineId, points: &[PointId]) {
        self.links.extend(points.windows(2).map(|p| Link { line, ends: [p[0], p[1]] }));
    }

    /// States what is at a point; junctions that nothing is said about have a yield sign where three streets
    /// meet and stop signs where more do.
    pub(super) fn kind(&mut self, point: PointId, kind: NodeKind) {
        self.kinds.insert(point, kind);
    }

    /// Leaves the crosswalks of a junction out: small streets are crossed anywhere.
    pub(super) fn without_crosswalks(&mut self, point: PointId) {
        self.unwalked.insert(point);
    }

    /// Puts a new point into the link between two points, at a share of the way.
    pub(super) fn split(&mut self, from: PointId, to: PointId, share: f64) -> Option<PointId> {
        let found = self.links.iter().position(|l| l.ends == [from, to] || l.ends == [to, from])?;
        let (a, b) = (self.points[from], self.points[to]);
        let middle = self.point([a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]);
        let Link { line, ends } = self.links[found];
        self.links[found].ends[1] = middle;
        self.links.push(Link { line, ends: [middle, ends[1]] });
        Some(middle)
    }

    /// A street that leaves the link between two points at a right angle and ends after `length_m`; negative
    /// lengths lead to the right, looking from the first point to the second.
    pub(super) fn close(&mut self, line: LineId, from: PointId, to: PointId, share: f64, length_m: f64) {
        let (a, b) = (self.points[from], self.points[to]);
        let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
        let span = hypot(dx, dy).max(1e-9);
        let Some(start) = self.split(from, to, share) else { return };
        let at = self.points[start];
        let end = self.point([at[0] - dy / span * length_m, at[1] + dx / span * length_m]);
        self.lead(line, &[start, end]);
    }

    /// Points that links join, with each point's links.
    fn arms(&self) -> Vec<Vec<Arm>> {
        let mut arms: Vec<Vec<Arm>> = self.points.iter().map(|_| Vec::new()).collect();
        for (i, link) in self.links.iter().enumerate() {
            arms[link.ends[0]].push((i, 0));
            arms[link.ends[1]].push((i, 1));
        }
        arms
    }

    /// The cross-section of a link, seen from one of its ends.
    fn shape_from(&self, (link, end): Arm) -> CrossSection {
        let shape = self.lines[self.links[link].line].shape;
        if end == 0 { shape } else { mirrored(shape) }
    }

    /// What is at a point, or nothing where a street just goes on.
    fn kind_at(&self, point: PointId, arms: &[Arm]) -> Option<NodeKind> {
        if let Some(kind) = self.kinds.get(&point)
            && (arms.len() > 2 || !matches!(kind, NodeKind::Crossing(_) | NodeKind::Roundabout { .. }))
        {
            return Some(*kind);
        }
        let rail = |arm: &Arm| self.lines[self.links[arm.0].line].shape.kind == RoadKind::Rail;
        match arms {
            [] => None,
            [only] if rail(only) => Some(NodeKind::MapEdge),
            [_] => Some(NodeKind::DeadEnd { radius_m: CIRCLE_M }),
            [a, b] => {
                // Walking in along the first and out along the second; round a corner the street stays as it
                // is.
                let same = mirrored(self.shape_from(*a)) == self.shape_from(*b);
                let turn = wrap_pi(self.heading(point, *a) - self.heading(point, *b) - PI);
                (!same && turn.abs() < STRAIGHT_RAD).then_some(NodeKind::Seam { length_m: SEAM_M })
            }
            [_, _, _] => Some(NodeKind::Crossing(Control::MinorYield)),
            _ if arms.iter().any(rail) => Some(NodeKind::RailCrossing),
            _ => Some(NodeKind::Crossing(Control::MinorStop)),
        }
    }

    /// Heading in which a street leaves a junction that it goes straight through.
    fn through(&self, point: PointId, arm: Arm, arms: &[Arm]) -> Option<f64> {
        let line = self.links[arm.0].line;
        let back = arms.iter().find(|other| **other != arm && self.links[other.0].line == line)?;
        let ahead = self.heading(point, arm);
        let behind = self.heading(point, *back);
        Some(wrap_pi(ahead + 0.5 * wrap_pi(behind + PI - ahead)))
    }

    /// Direction from a point along one of its links.
    fn heading(&self, point: PointId, (link, end): Arm) -> f64 {
        let (to, from) = (self.points[self.links[link].ends[1 - end]], self.points[point]);
        atan2(to[1] - from[1], to[0] - from[0])
    }

    /// Leaves out streets that do not hang together with most others: where links are left out by chance,
    /// some may be cut off. What reaches the nodes of the layout hangs together by them.
    fn leave_out_islands(&mut self, layout: &Layout) {
        let is_rail = |link: &Link| self.lines[link.line].shape.kind == RoadKind::Rail;
        // The first of all points that a point hangs together with.
        let mut first: Vec<PointId> = (0..self.points.len()).collect();
        let is_port = |point: &PointId| layout.nodes.iter().any(|n| n.at_m == self.points[*point]);
        let ports: Vec<PointId> = (0..self.points.len()).filter(is_port).collect();
        let joints = || ports.windows(2).map(|pair| [pair[0], pair[1]]);
        let mut changed = true;
        while std::mem::take(&mut changed) {
            let streets = self.links.iter().filter(|link| !is_rail(link)).map(|link| link.ends);
            for [a, b] in streets.chain(joints()) {
                let least = first[a].min(first[b]);
                changed |= first[a] != least || first[b] != least;
                (first[a], first[b]) = (least, least);
            }
        }
        let mut sizes: BTreeMap<PointId, usize> = BTreeMap::new();
        for link in self.links.iter().filter(|link| !is_rail(link)) {
            *sizes.entry(first[link.ends[0]]).or_default() += 1;
        }
        let largest = sizes.iter().max_by_key(|(_, size)| **size).map(|(first, _)| *first);
        let most = ports.first().map(|port| first[*port]).or(largest);
        let keep = |link: &Link| is_rail(link) || Some(first[link.ends[0]]) == most;
        self.links = self.links.iter().copied().filter(keep).collect();
    }

    /// Nodes and edges: chains of links without a junction between them become one edge. A point at exactly
    /// the place of a node that the layout has already is that node.
    pub(super) fn into_layout(mut self, mut layout: Layout, kerb_radius_m: f64) -> Layout {
        self.leave_out_islands(&layout);
        let arms = self.arms();
        let mut nodes: Vec<Option<(NodeId, NodeKind)>> = Vec::with_capacity(arms.len());
        for (point, here) in arms.iter().enumerate() {
            if let Some(port) = layout.nodes.iter().position(|n| n.at_m == self.points[point]) {
                nodes.push(Some((port, layout.nodes[port].kind)));
                continue;
            }
            let kind = self.kind_at(point, here);
            nodes.push(kind.map(|kind| {
                let node = Node::new(self.points[point], kind).kerbs(kerb_radius_m);
                let crosswalks = !self.unwalked.contains(&point);
                (layout.node(Node { crosswalks, ..node.named(format!("junction {point}")) }), kind)
            }));
        }
        let mut used = vec![false; self.links.len()];
        for (point, here) in arms.iter().enumerate() {
            let Some((start, start_kind)) = nodes[point] else { continue };
            for &arm in here {
                if used[arm.0] {
                    continue;
                }
                let (mut last, mut corners) = (arm, Vec::new());
                let (end_point, end) = loop {
                    used[last.0] = true;
                    let next = self.links[last.0].ends[1 - last.1];
                    if let Some((node, _)) = nodes[next] {
                        break (next, node);
                    }
                    let Some(on) = arms[next].iter().find(|a| a.0 != last.0) else { break (next, start) };
                    let bend_m = |arm: &Arm| self.lines[self.links[arm.0].line].bend_m;
                    let (before, after) = (bend_m(&last), bend_m(on));
                    // Where one street turns into another the tighter bend leaves room for its neighbours.
                    corners.push((self.points[next], if before[0] < after[0] { before } else { after }));
                    last = *on;
                };
                let line = &self.lines[self.links[arm.0].line];
                let mut edge = Edge::new(&line.name, start, end, self.shape_from(arm));
                if line.shape.kind == RoadKind::Rural {
                    edge = edge.min_radius(RURAL_RADIUS_M);
                }
                for (at, [radius_m, ease_m]) in corners {
                    edge = edge.via(at, radius_m, ease_m);
                }
                let back = (last.0, 1 - last.1);
                edge.from.heading_rad = self.through(point, arm, here);
                edge.to.heading_rad = self.through(end_point, back, &arms[end_point]);
                edge.from.ending = self.ending(start_kind, here.len(), arm);
                if let Some((_, kind)) = nodes[end_point] {
                    edge.to.ending = self.ending(kind, arms[end_point].len(), back);
                }
                layout.edge(edge);
            }
        }
        layout
    }

    fn ending(&self, kind: NodeKind, streets: usize, arm: Arm) -> Ending {
        let signals = kind == NodeKind::Crossing(Control::Signals) && streets > 3;
        let left = self.lines[self.links[arm.0].line].pocket.filter(|_| signals);
        Ending { left, ..Ending::default() }
    }
}

/// The same road, looked at along it from its other end.
fn mirrored(shape: CrossSection) -> CrossSection {
    CrossSection { left: shape.right, right: shape.left, ..shape }
}

/// The first layout of several that can be built; the last one where none can, so that its error is told.
pub(super) fn first_that_builds(attempts: u64, make: impl Fn(u64) -> Layout) -> Layout {
    let mut attempt = 0;
    loop {
        let layout = make(attempt);
        attempt += 1;
        if attempt >= attempts || build(&layout).is_ok() {
            return layout;
        }
    }
}

/// A point at an angle and a distance from another.
pub(super) fn polar(centre: [f64; 2], angle_rad: f64, radius_m: f64) -> [f64; 2] {
    let (sin, cos) = sin_cos(angle_rad);
    [centre[0] + radius_m * cos, centre[1] + radius_m * sin]
}

/// A layout without streets yet.
pub(super) fn empty(parameters: &crate::TownParameters, terrain: Terrain) -> Layout {
    let mut layout = Layout::new(&parameters.name, terrain);
    layout.geo_reference = parameters.geo_reference();
    layout
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::Side;

    #[test]
    fn streets_that_are_cut_off_are_left_out() {
        let mut graph = Graph::default();
        let shape = CrossSection::both_ways(Side::town(1, 3.5), 50.0);
        let line = graph.line("street", shape, [30.0, 0.0]);
        let lone = [graph.point([500.0, 0.0]), graph.point([500.0, 100.0])];
        let middle = graph.point([0.0, 0.0]);
        graph.lead(line, &lone);
        for at_m in [[100.0, 0.0], [0.0, 100.0], [-100.0, 0.0]] {
            let end = graph.point(at_m);
            graph.lead(line, &[middle, end]);
        }
        let layout = graph.into_layout(Layout::new("star", Terrain::flat()), 6.0);
        assert_eq!((layout.nodes.len(), layout.edges.len()), (4, 3));
        assert!(layout.nodes.iter().all(|node| node.at_m[0] < 400.0));

        // What reaches a node that is there already stays, however far from the others.
        let mut graph = Graph::default();
        let line = graph.line("street", shape, [30.0, 0.0]);
        let mut layout = Layout::new("ports", Terrain::flat());
        for x in [0.0, 500.0] {
            let kind = NodeKind::Crossing(Control::AllStop);
            layout.node(Node::new([x, 0.0], kind));
            let street = [[x, 0.0], [x, 100.0]].map(|at_m| graph.point(at_m));
            graph.lead(line, &street);
        }
        assert_eq!(graph.into_layout(layout, 6.0).edges.len(), 2);
    }
}
