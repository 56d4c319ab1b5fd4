//! What a style hands to the builder: nodes, edges and the ground under them.
//!
//! A layout says where things are and what they are; everything else follows.
//! [`build`](crate::assemble::build) works out where streets must end before their junctions, rounds their
//! bends, lays them over the ground, gives them lanes and markings, joins the lanes inside junctions, puts up
//! signals and signs, and writes bridges and tunnels where a road leaves the ground. What cannot be built is
//! an error that names the street.
//!
//! # A small example
//!
//! A signalled crossing with a turn pocket, a roundabout and a turning circle on rolling ground:
//!
//! ```ignore
//! let mut town = Layout::new("example", Terrain { waves: vec![wave], ..Terrain::flat() });
//! let cross = town.node(Node::new([0.0, 0.0], NodeKind::Crossing(Control::Signals)));
//! let round = town.node(Node::new([200.0, 20.0], NodeKind::Roundabout { island_m: 12.0, lanes: 1 }));
//! let close = town.node(Node::new([0.0, 150.0], NodeKind::DeadEnd { radius_m: 12.0 }));
//! let street = CrossSection::both_ways(Side::town(1, 3.5).with_sidewalk(2.5), 50.0);
//! // From the crossing to the roundabout round one bend, with a lane for turns to the left at the crossing.
//! town.edge(
//!     Edge::new("High Street", cross, round, street)
//!         .via([120.0, 0.0], 60.0, 15.0)
//!         .start(Ending { left: Some(Pocket::one(35.0, 20.0)), ..Ending::default() }),
//! );
//! town.edge(Edge::new("The Close", cross, close, street));
//! // ... two more arms; then `town::generate` calls `assemble::build(&town)`.
//! ```
//!
//! # Which node for what
//!
//! | place | node |
//! |---|---|
//! | streets that meet at any angles | [`NodeKind::Crossing`] with a [`Control`] |
//! | roundabout | [`NodeKind::Roundabout`]; its streets should have splitter islands (`Ending::splitter_m`) |
//! | a street changes its cross-section, a lane ends or begins, a motorway exit or entry, a carriageway splits | [`NodeKind::Seam`] |
//! | U-turn through a wide median (Michigan left) | [`NodeKind::Crossover`] |
//! | end of a street | [`NodeKind::DeadEnd`] (turning circle) or [`NodeKind::MapEdge`] (lanes just end) |
//! | railway across a street | [`NodeKind::RailCrossing`] |
//! | roads over one another | no node: lift one of them with [`Edge::lifted`]; the builder checks the clearance |
//!
//! Motorways: main carriageway into a seam with a right pocket (the deceleration lane), main carriageway out
//! of it, and the ramp attached with [`Edge::leaves_by_ramp`]; entries likewise with
//! [`Edge::enters_by_ramp`], where the road behind the seam has one lane more (the acceleration lane), which
//! ends at a later seam.

use opendrive::ContactPoint;

use crate::path::{Piece, Pose2, Via};
use crate::section::{CrossSection, Ending};
use crate::terrain::Terrain;
pub(crate) use crate::water::Water;

/// Names a node of a layout.
pub(crate) type NodeId = usize;

/// The right of way at a crossing. The major street is the pair of arms that face each other with the
/// higher speed limit, then with more lanes, then the one that was laid first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Control {
    /// Traffic lights on every arm.
    Signals,
    /// Stop signs on every arm.
    AllStop,
    /// Stop signs on the arms that are not of the major street.
    MinorStop,
    /// Yield signs on the arms that are not of the major street.
    MinorYield,
}

/// What is at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NodeKind {
    /// A level junction of two or more arms at any angles.
    Crossing(Control),
    /// A one-way ring, counter-clockwise; entering traffic yields.
    Roundabout {
        /// Radius of the central island up to the circulating lanes, metres; larger where the streets need
        /// it.
        island_m: f64,
        /// Circulating lanes (1 or 2).
        lanes: u8,
    },
    /// Roads in line: lanes go on where they lie; where there are more of them on one side, those without a
    /// partner end in (or begin from) their neighbour. Slopes go through. Two arms of the same lanes are
    /// joined without a junction.
    Seam {
        /// Metres on which widths change and lanes end, ramps fork off or join.
        length_m: f64,
    },
    /// A road with a wide median goes straight on, and the left pockets before it lead back on the other
    /// side.
    Crossover,
    /// A street ends in a turning circle.
    DeadEnd {
        /// Radius of the circle's carriageway, metres (8 or more; buses need 12).
        radius_m: f64,
    },
    /// A street (two arms) and a railway (two arms) cross.
    RailCrossing,
    /// The map ends here, and lanes lead nowhere. Keep maps closed and use it for railways only.
    MapEdge,
    /// A part of a roundabout; made by the builder.
    Ring,
}

/// Where streets meet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    /// Centre, metres east and north.
    pub(crate) at_m: [f64; 2],
    pub(crate) kind: NodeKind,
    /// Height over the ground, metres.
    pub(crate) lift_m: f64,
    /// Least radius of the kerb (or pavement) at a corner, metres.
    pub(crate) kerb_radius_m: f64,
    pub(crate) name: String,
    /// Whether pedestrians may cross here, where the streets have sidewalks and the control permits it.
    pub(crate) crosswalks: bool,
    /// Whether turns to the left are allowed at a crossing; those from an arm that has no other way are.
    pub(crate) lefts: bool,
}

impl Node {
    /// A node on the ground.
    pub(crate) fn new(at_m: [f64; 2], kind: NodeKind) -> Self {
        Self {
            at_m,
            kind,
            lift_m: 0.0,
            kerb_radius_m: 6.0,
            name: String::new(),
            crosswalks: true,
            lefts: true,
        }
    }

    /// The same over the ground.
    pub(crate) fn lifted(self, lift_m: f64) -> Self {
        Self { lift_m, ..self }
    }

    /// The same with other corners.
    pub(crate) fn kerbs(self, kerb_radius_m: f64) -> Self {
        Self { kerb_radius_m, ..self }
    }

    /// The same without turns to the left: for crossings whose traffic turns back further on instead.
    pub(crate) fn without_lefts(self) -> Self {
        Self { lefts: false, ..self }
    }

    /// The same with a name.
    pub(crate) fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }
}

/// How an edge meets its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Role {
    /// As its heading says.
    Arm,
    /// At a seam: a one-way ramp beside the main road, on the right of the traffic that runs along the seam's
    /// axis (`forward`), or of the opposite traffic. The axis is the heading of the seam's first arm that is
    /// no ramp, looked at along that road's s.
    Ramp { forward: bool },
    /// Exactly here, facing away from the node.
    Fixed(Pose2),
    /// A piece of a roundabout's ring; made by the builder.
    Ring(Pose2),
}

/// One end of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct End {
    pub(crate) node: NodeId,
    pub(crate) role: Role,
    /// Heading away from the node, radians; taken from the next point of the line where it is not given.
    pub(crate) heading_rad: Option<f64>,
    pub(crate) ending: Ending,
}

/// Where an edge runs in plan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Line {
    /// From node to node round these corners.
    Via(Vec<Via>),
    /// Exactly these pieces; the nodes at its ends take their arms' poses from it.
    Chain(Pose2, Vec<Piece>),
}

/// A height that an edge keeps somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Anchor {
    /// The place of the edge nearest to this point, metres east and north.
    pub(crate) at_m: [f64; 2],
    /// Height over the ground there, metres.
    pub(crate) lift_m: f64,
}

/// A street between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edge {
    pub(crate) name: String,
    pub(crate) from: End,
    pub(crate) to: End,
    pub(crate) line: Line,
    pub(crate) shape: CrossSection,
    /// Heights over the ground between the nodes, in order; from one to the next the lift changes smoothly.
    pub(crate) anchors: Vec<Anchor>,
    /// Stretches, by the points nearest to their ends, on which it runs evenly whatever the ground does.
    pub(crate) even: Vec<[[f64; 2]; 2]>,
    /// Smallest radius of its bends, metres.
    pub(crate) min_radius_m: f64,
}

impl Edge {
    /// A straight street.
    pub(crate) fn new(name: impl Into<String>, from: NodeId, to: NodeId, shape: CrossSection) -> Self {
        let end = |node| End { node, role: Role::Arm, heading_rad: None, ending: Ending::default() };
        Self {
            name: name.into(),
            from: end(from),
            to: end(to),
            line: Line::Via(Vec::new()),
            shape,
            anchors: Vec::new(),
            even: Vec::new(),
            min_radius_m: shape.reach_m() + 2.0,
        }
    }

    /// One more corner on the way: its place, radius and clothoids in metres.
    pub(crate) fn via(mut self, at_m: [f64; 2], radius_m: f64, ease_m: f64) -> Self {
        match &mut self.line {
            Line::Via(vias) => vias.push(Via { at_m, radius_m, ease_m }),
            line @ Line::Chain(..) => *line = Line::Via(vec![Via { at_m, radius_m, ease_m }]),
        }
        self
    }

    /// Headings away from its nodes, radians.
    pub(crate) fn headings(mut self, from_rad: f64, to_rad: f64) -> Self {
        (self.from.heading_rad, self.to.heading_rad) = (Some(from_rad), Some(to_rad));
        self
    }

    /// What is special about its start.
    pub(crate) fn start(mut self, ending: Ending) -> Self {
        self.from.ending = ending;
        self
    }

    /// What is special about its end.
    pub(crate) fn end(mut self, ending: Ending) -> Self {
        self.to.ending = ending;
        self
    }

    /// It begins as a ramp that leaves the seam at its start; see [`Role::Ramp`].
    pub(crate) fn leaves_by_ramp(mut self, forward: bool) -> Self {
        self.from.role = Role::Ramp { forward };
        self
    }

    /// It ends as a ramp that enters the seam at its end; see [`Role::Ramp`].
    pub(crate) fn enters_by_ramp(mut self, forward: bool) -> Self {
        self.to.role = Role::Ramp { forward };
        self
    }

    /// It keeps a height over (or, negative, under) the ground near a point.
    pub(crate) fn lifted(mut self, at_m: [f64; 2], lift_m: f64) -> Self {
        self.anchors.push(Anchor { at_m, lift_m });
        self
    }

    /// Between the places nearest to two points it runs evenly from one height to the other: through a hill
    /// in a tunnel, over a valley on a bridge.
    pub(crate) fn evenly(mut self, from_m: [f64; 2], to_m: [f64; 2]) -> Self {
        self.even.push([from_m, to_m]);
        self
    }

    /// No bend of it may be tighter, metres.
    pub(crate) fn min_radius(mut self, min_radius_m: f64) -> Self {
        self.min_radius_m = self.min_radius_m.max(min_radius_m);
        self
    }

    /// One of its ends.
    pub(crate) fn at(&self, contact: ContactPoint) -> &End {
        match contact {
            ContactPoint::Start => &self.from,
            ContactPoint::End => &self.to,
        }
    }

    /// The corners on its way.
    pub(crate) fn vias(&self) -> &[Via] {
        match &self.line {
            Line::Via(vias) => vias,
            Line::Chain(..) => &[],
        }
    }
}

/// A whole town before it is built.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) name: String,
    pub(crate) geo_reference: String,
    pub(crate) terrain: Terrain,
    pub(crate) nodes: Vec<Node>,
    pub(crate) edges: Vec<Edge>,
    /// Rivers and lakes.
    pub(crate) waters: Vec<Water>,
}

impl Layout {
    /// A layout without nodes.
    pub(crate) fn new(name: impl Into<String>, terrain: Terrain) -> Self {
        Self {
            name: name.into(),
            geo_reference: String::new(),
            terrain,
            nodes: Vec::new(),
            edges: Vec::new(),
            waters: Vec::new(),
        }
    }

    /// Adds a node.
    pub(crate) fn node(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds an edge.
    pub(crate) fn edge(&mut self, edge: Edge) {
        self.edges.push(edge);
    }
}
