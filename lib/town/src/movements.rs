//! Which lanes of an arm lead to which lanes of another.

use frames::wrap_pi;
use opendrive::ContactPoint;
use std::f64::consts::{PI, TAU};

use crate::path::Pose2;
use crate::section::{CrossSection, Side};

/// Two arms within this angle of a straight line go straight on, radians.
pub(crate) const STRAIGHT_RAD: f64 = 0.7;

/// The end of a street at a junction.
#[derive(Clone, Debug)]
pub(crate) struct Arm {
    /// Id of the street.
    pub(crate) road: String,
    /// Which end of it.
    pub(crate) contact: ContactPoint,
    /// Where its reference line ends, facing away from the junction.
    pub(crate) outward: Pose2,
    /// Its lanes.
    pub(crate) shape: CrossSection,
    /// Metres beyond the street's end that stay straight, with room for the crosswalk if there is one.
    pub(crate) lead_m: f64,
    /// Whether pedestrians may cross it.
    pub(crate) crosswalk: bool,
}

impl Arm {
    /// The side whose traffic enters the junction, and the sign of its lane ids.
    pub(crate) fn incoming(&self) -> (&Side, i16) {
        match self.contact {
            ContactPoint::End => (&self.shape.right, -1),
            ContactPoint::Start => (&self.shape.left, 1),
        }
    }

    /// The side whose traffic leaves the junction, and the sign of its lane ids.
    pub(crate) fn outgoing(&self) -> (&Side, i16) {
        match self.contact {
            ContactPoint::End => (&self.shape.left, 1),
            ContactPoint::Start => (&self.shape.right, -1),
        }
    }

    /// Turn from entering by this arm to leaving by another, radians, positive to the left.
    pub(crate) fn turn_to(&self, other: &Self) -> f64 {
        wrap_pi(other.outward.heading_rad - self.outward.heading_rad - PI)
    }
}

/// A way through a junction that needs a connecting road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Movement {
    /// Arm it enters by.
    pub(crate) from: usize,
    /// Arm it leaves by.
    pub(crate) to: usize,
    /// First driving lane it takes, counted from the inside.
    pub(crate) from_lane: u8,
    /// First driving lane it leads to.
    pub(crate) to_lane: u8,
    /// Number of driving lanes; 0 for a mere corner of gutter and sidewalk.
    pub(crate) lanes: u8,
    /// Whether it follows the kerb, and so carries the gutter and the sidewalk.
    pub(crate) corner: bool,
}

/// The arm that goes straight on from each arm.
pub(crate) fn opposite(arms: &[Arm], from: usize) -> Option<usize> {
    let turn = |to: &usize| arms[from].turn_to(&arms[*to]).abs();
    (0..arms.len())
        .filter(|to| *to != from)
        .min_by(|a, b| turn(a).total_cmp(&turn(b)))
        .filter(|to| turn(to) < STRAIGHT_RAD)
}

/// The arm that follows counter-clockwise: the one round the corner to the right.
pub(crate) fn next_to_the_right(arms: &[Arm], from: usize) -> Option<usize> {
    let angle = |to: &usize| counter_clockwise(arms[from].outward.heading_rad, arms[*to].outward.heading_rad);
    (0..arms.len()).filter(|to| *to != from).min_by(|a, b| angle(a).total_cmp(&angle(b)))
}

/// Angle from one heading counter-clockwise to another, in (0, 2 pi].
pub(crate) fn counter_clockwise(from_rad: f64, to_rad: f64) -> f64 {
    let angle = wrap_pi(to_rad - from_rad);
    if angle <= 0.0 { angle + TAU } else { angle }
}

/// All movements, by entering arm, then counter-clockwise by leaving arm.
///
/// Straight on: every lane that has a partner. Turns to the left leave the innermost lane and turns
/// to the right the outermost one; where nothing goes straight on, they share the lanes out.
pub(crate) fn movements(arms: &[Arm]) -> Vec<Movement> {
    let mut all = Vec::new();
    for (from, arm) in arms.iter().enumerate() {
        let entering = arm.incoming().0.lanes;
        let straight = opposite(arms, from).filter(|to| arms[*to].outgoing().0.lanes > 0);
        let corner = next_to_the_right(arms, from);
        let mut exits: Vec<usize> = (0..arms.len()).filter(|to| *to != from).collect();
        let angle = |to: &usize| counter_clockwise(arm.outward.heading_rad, arms[*to].outward.heading_rad);
        exits.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        let turns = |left: bool| {
            exits.iter().any(|to| {
                Some(*to) != straight
                    && arms[*to].outgoing().0.lanes > 0
                    && (arm.turn_to(&arms[*to]) > 0.0) == left
            })
        };
        let (to_left, to_right) = match (straight, turns(true), turns(false)) {
            (Some(_), ..) => (1, 1),
            (None, true, true) => (entering.div_ceil(2), (entering / 2).max(1)),
            (None, ..) => (entering, entering),
        };
        for to in exits {
            let leaving = arms[to].outgoing().0.lanes;
            let common = entering.min(leaving);
            let left = arm.turn_to(&arms[to]) > 0.0;
            let lanes = common.min(if Some(to) == straight {
                common
            } else if left {
                to_left
            } else {
                to_right
            });
            let corner = Some(to) == corner;
            // What follows the kerb takes the outermost lanes; what crosses the junction the innermost ones.
            let outside = corner || !(left || Some(to) == straight);
            let (from_lane, to_lane) = if outside { (entering - lanes, leaving - lanes) } else { (0, 0) };
            if lanes > 0 || corner {
                all.push(Movement { from, to, from_lane, to_lane, lanes, corner });
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm(heading_rad: f64, lanes: u8) -> Arm {
        let side = Side { lanes, lane_m: 3.5, gutter_m: 0.5, parking_m: None, sidewalk_m: 3.0 };
        let outward = Pose2 { x_m: 0.0, y_m: 0.0, heading_rad };
        let shape = CrossSection { left: side, right: side, median_m: 0.0, speed_limit_kmh: 50.0 };
        Arm { road: String::new(), contact: ContactPoint::End, outward, shape, lead_m: 0.5, crosswalk: false }
    }

    /// `[from, to, from_lane, to_lane, lanes, corner]`.
    fn rows(arms: &[Arm]) -> Vec<[usize; 6]> {
        let row = |m: &Movement| {
            [m.from, m.to, m.from_lane.into(), m.to_lane.into(), m.lanes.into(), usize::from(m.corner)]
        };
        movements(arms).iter().map(row).collect()
    }

    #[test]
    fn a_crossing_of_a_street_and_an_avenue() {
        // East and west: two lanes each way; north and south: one.
        let arms = [arm(0.0, 2), arm(0.5 * PI, 1), arm(PI, 2), arm(-0.5 * PI, 1)];
        let found = rows(&arms);
        assert_eq!(found.len(), 12);
        // From the east: right to the north from the outer lane, straight on with both, left to the south from the inner one.
        assert_eq!(found[..3], [[0, 1, 1, 0, 1, 1], [0, 2, 0, 0, 2, 0], [0, 3, 0, 0, 1, 0]]);
        // From the north: right to the west into its outer lane, straight on, left to the east into its inner lane.
        assert_eq!(found[3..6], [[1, 2, 0, 1, 1, 1], [1, 3, 0, 0, 1, 0], [1, 0, 0, 0, 1, 0]]);
    }

    #[test]
    fn the_stem_of_a_t_shares_its_lanes_out() {
        let arms = [arm(0.0, 1), arm(PI, 1), arm(-0.5 * PI, 2)];
        let found = rows(&arms);
        // The straight side has the kerb: it carries gutter and sidewalk.
        assert!(found.contains(&[0, 1, 0, 0, 1, 1]));
        assert!(found.contains(&[1, 0, 0, 0, 1, 0]));
        // From the stem: right from the outer lane, left from the inner one.
        assert!(found.contains(&[2, 0, 1, 0, 1, 1]));
        assert!(found.contains(&[2, 1, 0, 0, 1, 0]));
        // Into the stem: from its left into the outer lane, round the corner.
        assert!(found.contains(&[1, 2, 0, 1, 1, 1]));
        assert!(found.contains(&[0, 2, 0, 0, 1, 0]));
        assert_eq!(found.len(), 6);
    }
}
