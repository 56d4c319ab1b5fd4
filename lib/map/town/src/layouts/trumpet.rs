//! A trumpet: where a road ends at a motorway without a level crossing.

use super::motorway::{Frame, LANE_M, Motorway, exit_lane, ramp_shape};
use crate::layout::{Edge, Layout, Node, NodeId, NodeKind};
use crate::section::{CrossSection, Side};

/// Where the motorway's seams lie, along its axis, metres: ramps of the near side's exit and the far side's
/// entry; the loop; the near side's entry.
const SEAMS_M: [f64; 3] = [-410.0, 110.0, 390.0];
/// Where the road's seams lie: near side's ramps, and the end behind the motorway.
const ROAD_M: [f64; 2] = [-235.0, 62.0];
/// Lengths of the road's seams, metres.
const ROAD_SEAM_M: [f64; 2] = [60.0, 36.0];
/// Heights of the road over the ground at its seams and over the motorway, metres.
const LIFTS_M: [f64; 3] = [1.0, 6.6, 7.3];
/// The loop's square: its right side, half its side, its lower side; and radius and clothoid, metres.
const LOOP_M: [f64; 3] = [-0.5 * ROAD_MEDIAN_M, 56.0, 31.0];
const LOOP_BEND_M: [f64; 2] = [46.0, 16.0];
/// Corners of the far ramp, and their radii and clothoids, metres.
const FAR_M: [[f64; 2]; 2] = [[0.5 * ROAD_MEDIAN_M, 195.0], [-205.0, 195.0]];
const FAR_BEND_M: [[f64; 2]; 2] = [[85.0, 25.0], [130.0, 30.0]];
/// Corner of the near ramps, its radius and clothoid, metres.
const NEAR_M: [f64; 2] = [20.0, -48.0];
const NEAR_BEND_M: [f64; 2] = [105.0, 30.0];
const RAMP_KMH: f64 = 50.0;
/// Lanes of each direction of the road that ends here, from its first seam on; its shoulder, median and speed
/// limit.
pub(super) const LANES: u8 = 2;
const ROAD_SHOULDER_M: f64 = 2.0;
const ROAD_MEDIAN_M: f64 = 4.0;
const ROAD_KMH: f64 = 80.0;

/// The nodes of a trumpet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trumpet {
    /// Seams of the motorway, along the frame's x axis.
    pub(super) seams: [NodeId; 3],
    /// The road's first seam: what is between it and the rest of the world is the caller's.
    pub(super) road: NodeId,
}

/// The cross-section of the road that ends here, with so many lanes each way.
pub(super) fn road_shape(lanes: u8) -> CrossSection {
    CrossSection::motorway(Side::open(lanes, LANE_M, ROAD_SHOULDER_M), ROAD_MEDIAN_M, ROAD_KMH)
}

/// Adds a trumpet's nodes and ramps; the motorway and the road's other end are the caller's.
///
/// Its frame: the motorway runs along x, the road comes from the right of it (from negative y). The
/// motorway's s runs against x.
pub(super) fn trumpet(layout: &mut Layout, motorway: &Motorway<'_>, name: &str, frame: Frame) -> Trumpet {
    let seams = SEAMS_M.map(|x| motorway.seam(layout, frame.at(x, 0.0), 0.0));
    let mut seam = |k: usize| {
        let node = Node::new(frame.at(0.0, ROAD_M[k]), NodeKind::Seam { length_m: ROAD_SEAM_M[k] });
        layout.node(node.lifted(LIFTS_M[k]).named(name))
    };
    let [road, end] = [seam(0), seam(1)];
    let over =
        Edge::new(format!("{name} bridge"), road, end, road_shape(1)).lifted(frame.at(0.0, 0.0), LIFTS_M[2]);
    layout.edge(over);

    let ramp = |what: &str, from: NodeId, to: NodeId, corners: &[([f64; 2], [f64; 2])]| {
        let edge = Edge::new(format!("{name} {what}"), from, to, ramp_shape(RAMP_KMH));
        corners.iter().fold(edge, |edge, ([x, y], bend)| edge.via(frame.at(*x, *y), bend[0], bend[1]))
    };
    // Traffic along x runs against the motorway's s.
    let exit = ramp("exit", seams[0], road, &[([-NEAR_M[0], NEAR_M[1]], NEAR_BEND_M)]);
    layout.edge(exit.leaves_by_ramp(false).enters_by_ramp(false));
    let entry = ramp("entry", road, seams[2], &[(NEAR_M, NEAR_BEND_M)]);
    layout.edge(entry.leaves_by_ramp(true).enters_by_ramp(false));
    let far = ramp("far entry", end, seams[0], &[(FAR_M[0], FAR_BEND_M[0]), (FAR_M[1], FAR_BEND_M[1])]);
    layout.edge(far.enters_by_ramp(true));
    let [right, half, low] = LOOP_M;
    let (left, high) = (right - 2.0 * half, low + 2.0 * half);
    let corners = [[left, low], [left, high], [right, high]].map(|at| (at, LOOP_BEND_M));
    layout.edge(ramp("loop", seams[1], end, &corners).leaves_by_ramp(true));
    Trumpet { seams, road }
}

impl Trumpet {
    /// The motorway between its seams, in the direction of its s.
    pub(super) fn carriageways(&self, layout: &mut Layout, motorway: &Motorway<'_>) {
        let [a, b, c] = self.seams;
        layout.edge(motorway.edge(c, b, [0, 0]).end(exit_lane()));
        layout.edge(motorway.edge(b, a, [0, 0]));
    }
}
