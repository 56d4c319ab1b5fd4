//! Motorways: interchanges, and the carriageways between them.

use frames::math::sin_cos;
use std::f64::consts::PI;

use crate::layout::{Edge, Layout, Node, NodeId, NodeKind};
use crate::section::{CrossSection, Ending, Pocket, Side};

/// Width of a lane, a shoulder and the median of a motorway, metres.
pub(super) const LANE_M: f64 = 3.6;
const SHOULDER_M: f64 = 2.5;
const MEDIAN_M: f64 = 4.0;
/// Length on which ramps fork off and join, metres.
const SEAM_M: f64 = 70.0;
/// Deceleration lanes: full length and taper, metres.
const EXIT_M: [f64; 2] = [130.0, 50.0];
/// Lanes for turns to the left at the end of an exit: full length and taper, metres.
const RAMP_POCKET_M: [f64; 2] = [45.0, 25.0];
/// Straight stretch of a ramp beside its street, from the street's axis, and radius and clothoid of the bend
/// before it, metres.
const RAMP_STRAIGHT_M: f64 = 80.0;
const RAMP_BEND_M: [f64; 2] = [140.0, 25.0];
const RAMP_LANE_M: f64 = 4.0;
const RAMP_KMH: f64 = 50.0;

/// A right-handed frame in the plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Metres east and north.
    pub(super) origin_m: [f64; 2],
    /// Direction of its x axis, radians from east.
    pub(super) heading_rad: f64,
}

impl Frame {
    /// A point of it in the plan.
    pub(super) fn at(self, x: f64, y: f64) -> [f64; 2] {
        let (s, c) = sin_cos(self.heading_rad);
        [self.origin_m[0] + c * x - s * y, self.origin_m[1] + s * x + c * y]
    }

    /// A frame inside it.
    pub(super) fn then(self, x: f64, y: f64, turn_rad: f64) -> Self {
        Self { origin_m: self.at(x, y), heading_rad: self.heading_rad + turn_rad }
    }
}

/// A motorway's cross-section.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motorway<'a> {
    pub(super) name: &'a str,
    pub(super) limit_kmh: f64,
    /// Driving lanes of each direction away from the interchanges.
    pub(super) lanes: u8,
}

impl Motorway<'_> {
    /// Its cross-section with this many lanes more for the traffic against its s (`left`) and along it
    /// (`right`).
    pub(super) fn shape(&self, [left, right]: [u8; 2]) -> CrossSection {
        let side = |more: u8| Side::open(self.lanes + more, LANE_M, SHOULDER_M);
        CrossSection {
            left: side(left),
            right: side(right),
            ..CrossSection::motorway(side(0), MEDIAN_M, self.limit_kmh)
        }
    }

    /// A carriageway pair from seam to seam.
    pub(super) fn edge(&self, from: NodeId, to: NodeId, more: [u8; 2]) -> Edge {
        Edge::new(self.name, from, to, self.shape(more)).min_radius(100.0)
    }

    /// Where lanes begin and end.
    pub(super) fn seam(&self, layout: &mut Layout, at_m: [f64; 2], lift_m: f64) -> NodeId {
        let node = Node::new(at_m, NodeKind::Seam { length_m: SEAM_M }).lifted(lift_m);
        layout.node(node.named(self.name))
    }
}

/// A ramp of one lane.
pub(super) fn ramp_shape(limit_kmh: f64) -> CrossSection {
    CrossSection::ramp(1, RAMP_LANE_M, limit_kmh)
}

/// The deceleration lane before an exit.
pub(super) fn exit_lane() -> Ending {
    let [length_m, taper_m] = EXIT_M;
    Ending { right: Some(Pocket::one(length_m, taper_m)), ..Ending::default() }
}

/// The nodes of a diamond interchange. Its frame: the motorway's s runs along x, the crossing street along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Diamond {
    /// Seams before and behind the crossing street, along the motorway's s.
    pub(super) seams: [NodeId; 2],
    /// Where the ramps meet the street, right and left of the motorway.
    pub(super) ends: [NodeId; 2],
}

/// What a diamond interchange is like.
#[derive(Clone, Copy, Debug)]
pub(super) struct DiamondPlan<'a> {
    pub(super) name: &'a str,
    pub(super) frame: Frame,
    /// From the street to either seam, metres.
    pub(super) reach_m: f64,
    /// From the motorway's axis to the ends of the ramps, metres.
    pub(super) beside_m: f64,
    /// Height of the motorway over the ground there, metres.
    pub(super) lift_m: f64,
    /// What is at the ends of the ramps.
    pub(super) kind: NodeKind,
    pub(super) kerb_radius_m: f64,
}

/// Adds a diamond interchange's nodes and ramps; the motorway and the street are the caller's.
pub(super) fn diamond(layout: &mut Layout, motorway: &Motorway<'_>, plan: &DiamondPlan<'_>) -> Diamond {
    let DiamondPlan { name, frame, reach_m, beside_m, .. } = *plan;
    let seams = [-reach_m, reach_m].map(|x| motorway.seam(layout, frame.at(x, 0.0), plan.lift_m));
    let ends = [(-beside_m, "right"), (beside_m, "left")].map(|(y, side)| {
        let node = Node::new(frame.at(0.0, y), plan.kind).kerbs(plan.kerb_radius_m);
        layout.node(node.named(format!("{name} {side}")))
    });
    let shape = ramp_shape(RAMP_KMH);
    let [length_m, taper_m] = RAMP_POCKET_M;
    let turns = Ending { left: Some(Pocket::one(length_m, taper_m)), ..Ending::default() };
    for (side, forward) in [true, false].into_iter().enumerate() {
        // Along the traffic that the ramps serve.
        let along = if forward { frame.heading_rad } else { frame.heading_rad + PI };
        let [before, behind] = if forward { seams } else { [seams[1], seams[0]] };
        // Ramps come to the street on a straight.
        let (ahead_m, y_m) = (RAMP_STRAIGHT_M, if forward { -beside_m } else { beside_m });
        let corner = |x: f64| frame.at(if forward { x } else { -x }, y_m);
        let exit = Edge::new(format!("{name} exit"), before, ends[side], shape)
            .via(corner(-ahead_m), RAMP_BEND_M[0], RAMP_BEND_M[1])
            .end(turns);
        let mut exit = exit.leaves_by_ramp(forward).min_radius(60.0);
        exit.to.heading_rad = Some(along + PI);
        let entry = Edge::new(format!("{name} entry"), ends[side], behind, shape).via(
            corner(ahead_m),
            RAMP_BEND_M[0],
            RAMP_BEND_M[1],
        );
        let mut entry = entry.enters_by_ramp(forward).min_radius(60.0);
        entry.from.heading_rad = Some(along);
        layout.edge(exit);
        layout.edge(entry);
    }
    Diamond { seams, ends }
}
