//! Motorways: two carriageways from seam to seam, and the interchanges on them.

use super::motorway::{exit_lane, ramp_shape};
use crate::layout::{Control, Edge, Layout, Node, NodeId, NodeKind};
use crate::path::{Pose2, Via};
use crate::section::{CrossSection, Side};

/// Length of a seam, metres.
const SEAM_M: f64 = 60.0;
/// Height of an interchange's terminals (on embankments, no bridges) and of its overpass over the motorway,
/// metres.
const TERMINAL_LIFT_M: f64 = 2.4;
const OVERPASS_LIFT_M: f64 = 7.6;
/// Radius and clothoids of a ramp's bend, metres.
const RAMP_BEND_M: [f64; 2] = [65.0, 25.0];

/// What a motorway passes on its way.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stop {
    /// The first seam of an interchange.
    Behind(NodeId),
    /// Its second seam.
    Ahead(NodeId),
    /// A seam where acceleration lanes end; has to lie between two interchanges.
    Drop(NodeId),
    /// A bend.
    Corner(Via),
    /// A height over the ground near a place.
    Lift([f64; 2], f64),
    /// A stretch on which it runs evenly.
    Even([f64; 2], [f64; 2]),
}

impl Stop {
    fn node(self) -> Option<NodeId> {
        match self {
            Self::Behind(node) | Self::Ahead(node) | Self::Drop(node) => Some(node),
            _ => None,
        }
    }
}

/// Adds a motorway along its stops, the first and the last of which are nodes; for a closed one they are the
/// same. Before each interchange the lane on the right leads off, behind it the ramp's lane goes on until the
/// next drop.
pub(super) fn motorway(layout: &mut Layout, name: &str, shape: CrossSection, stops: &[Stop]) {
    let more = |side: Side| Side { lanes: side.lanes + 1, ..side };
    let nodes: Vec<usize> = (0..stops.len()).filter(|i| stops[*i].node().is_some()).collect();
    for pair in nodes.windows(2) {
        let (from, to) = (stops[pair[0]], stops[pair[1]]);
        let (Some(a), Some(b)) = (from.node(), to.node()) else { continue };
        let mut own = shape;
        if matches!(from, Stop::Ahead(_)) {
            own.right = more(own.right);
        }
        if matches!(to, Stop::Behind(_)) {
            own.left = more(own.left);
        }
        let mut edge = Edge::new(name, a, b, own);
        if matches!(from, Stop::Ahead(_)) {
            edge = edge.start(exit_lane());
        }
        if matches!(to, Stop::Behind(_)) {
            edge = edge.end(exit_lane());
        }
        for stop in &stops[pair[0] + 1..pair[1]] {
            edge = match *stop {
                Stop::Corner(via) => edge.via(via.at_m, via.radius_m, via.ease_m),
                Stop::Lift(at, lift_m) => edge.lifted(at, lift_m),
                Stop::Even(from, to) => edge.evenly(from, to),
                _ => edge,
            };
        }
        layout.edge(edge);
    }
}

/// A seam of a motorway.
pub(super) fn seam(layout: &mut Layout, at_m: [f64; 2], name: impl Into<String>) -> NodeId {
    layout.node(Node::new(at_m, NodeKind::Seam { length_m: SEAM_M }).named(name))
}

/// How large a diamond interchange is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// From its middle to the seams, metres along the motorway.
    pub(super) seam_m: f64,
    /// From the motorway's middle to the terminals, metres.
    pub(super) terminal_m: f64,
}

/// A diamond interchange: a street over the motorway, and four ramps between its ends and the seams.
#[derive(Clone, Copy, Debug)]
pub(super) struct Diamond {
    pub(super) behind: NodeId,
    pub(super) ahead: NodeId,
    /// Ends of the street over the motorway, to the right and to the left of it.
    pub(super) terminals: [NodeId; 2],
}

/// What streets do at the terminals of a diamond.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossroad {
    pub(super) shape: CrossSection,
    pub(super) kind: NodeKind,
    /// Speed limit on the ramps, km/h.
    pub(super) ramp_kmh: f64,
}

impl Crossroad {
    /// With traffic lights.
    pub(super) fn signals(shape: CrossSection) -> Self {
        Self { shape, kind: NodeKind::Crossing(Control::Signals), ramp_kmh: 50.0 }
    }
}

/// Adds a diamond interchange. `centre`: on the motorway, along its s.
pub(super) fn diamond(
    layout: &mut Layout,
    name: &str,
    centre: Pose2,
    size: Size,
    crossroad: &Crossroad,
) -> Diamond {
    let at = |along_m: f64, left_m: f64| {
        let p = centre.moved(along_m, left_m);
        [p.x_m, p.y_m]
    };
    let [behind, ahead] =
        [-size.seam_m, size.seam_m].map(|d| seam(layout, at(d, 0.0), format!("{name} seam")));
    let terminals = [-size.terminal_m, size.terminal_m].map(|d| {
        let node = Node::new(at(0.0, d), crossroad.kind).kerbs(9.0).lifted(TERMINAL_LIFT_M);
        layout.node(node.named(format!("{name} terminal")))
    });
    let ramp = ramp_shape(crossroad.ramp_kmh);
    let (dx, dy) = (0.43 * size.seam_m, size.terminal_m - 4.0);
    let [right, left] = terminals;
    let bend = |edge: Edge, x: f64, y: f64| edge.via(at(x, y), RAMP_BEND_M[0], RAMP_BEND_M[1]);
    let (exit, entry) = (format!("{name} exit"), format!("{name} entry"));
    layout.edge(bend(Edge::new(&exit, behind, right, ramp), -dx, -dy).leaves_by_ramp(true));
    layout.edge(bend(Edge::new(&entry, right, ahead, ramp), dx, -dy).enters_by_ramp(true));
    layout.edge(bend(Edge::new(&exit, ahead, left, ramp), dx, dy).leaves_by_ramp(false));
    layout.edge(bend(Edge::new(&entry, left, behind, ramp), -dx, dy).enters_by_ramp(false));
    let over = Edge::new(format!("{name} overpass"), right, left, crossroad.shape);
    layout.edge(over.lifted(at(0.0, 0.0), OVERPASS_LIFT_M));
    Diamond { behind, ahead, terminals }
}
