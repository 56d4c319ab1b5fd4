//! Arrows on the lanes before a junction, which say where each leads.

use opendrive::{Corner, Object, Outline};
use std::f64::consts::PI;

use crate::arm::{Arm, STRAIGHT_RAD, runs};
use crate::ids::Ids;
use crate::movements::Movement;
use crate::section::EndStrip;

/// Length of an arrow, metres, and its middle before the end of its street: 5 m before the stop line.
const LENGTH_M: f64 = 5.0;
const MIDDLE_M: f64 = 8.0;
/// Streets shorter than this have none, metres.
const SHORTEST_M: f64 = 30.0;

/// Corners of a ring: metres ahead of the arrow's middle, and to its left.
type Ring = &'static [[f64; 2]];

/// An arrow is longer than it is wide: drivers see it at a flat angle. Rings are counter-clockwise.
const STRAIGHT: Ring =
    &[[-2.5, -0.08], [0.9, -0.08], [0.85, -0.38], [2.5, 0.0], [0.85, 0.38], [0.9, 0.08], [-2.5, 0.08]];
/// One that turns to the left at its end.
const LEFT: Ring = &[
    [-2.5, -0.08],
    [0.75, -0.08],
    [1.42, 0.4],
    [2.1, 0.36],
    [1.3, 1.0],
    [0.5, 0.36],
    [1.12, 0.4],
    [0.65, 0.08],
    [-2.5, 0.08],
];
/// What one that goes straight on has besides, to turn to the left.
const LEFT_BRANCH: Ring =
    &[[-0.7, 0.08], [-0.32, 0.08], [0.22, 0.4], [0.9, 0.36], [0.1, 1.0], [-0.7, 0.36], [-0.08, 0.4]];

/// Ways that a lane leads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Ways {
    left: bool,
    straight: bool,
    right: bool,
}

impl Ways {
    /// Where a driving lane of an arm leads, counted from the inside.
    fn of(arms: &[Arm], from: usize, lane: u8, movements: &[Movement]) -> Self {
        let mut ways = Self::default();
        let uses = |m: &&Movement| m.from == from && (m.from_lane..m.from_lane + m.lanes).contains(&lane);
        for movement in movements.iter().filter(uses) {
            let turn = arms[from].turn_to(&arms[movement.to]);
            match turn {
                t if t.abs() < STRAIGHT_RAD => ways.straight = true,
                t if t > 0.0 => ways.left = true,
                _ => ways.right = true,
            }
        }
        ways
    }

    fn name(self) -> String {
        let words = [(self.left, "Left"), (self.straight, "Straight"), (self.right, "Right")];
        let said: String = words.iter().filter(|(is, _)| *is).map(|(_, word)| *word).collect();
        format!("Arrow{said}")
    }

    fn outlines(self) -> Vec<Outline> {
        let Self { left, straight, right } = self;
        let turn = if straight { LEFT_BRANCH } else { LEFT };
        let parts = [(straight, STRAIGHT, false), (left, turn, false), (right, turn, true)];
        parts.iter().filter(|(is, ..)| *is).map(|(_, ring, mirrored)| outline(ring, *mirrored)).collect()
    }
}

fn outline(ring: Ring, mirrored: bool) -> Outline {
    let side = if mirrored { -1.0 } else { 1.0 };
    let corner = |[u, v]: &[f64; 2]| Corner::Local { u_m: *u, v_m: side * v, z_m: 0.0, height_m: 0.0 };
    let mut corners: Vec<Corner> = ring.iter().map(corner).collect();
    if mirrored {
        corners.reverse();
    }
    Outline { closed: true, corners, ..Outline::default() }
}

/// An arrow on each entering lane of an arm that leads somewhere.
pub(crate) fn arrows(ids: &mut Ids, arms: &[Arm], from: usize, movements: &[Movement]) -> Vec<Object> {
    let arm = &arms[from];
    if arm.length_m < SHORTEST_M || arm.is_rail() {
        return Vec::new();
    }
    let (s, orientation) = arm.before_end(MIDDLE_M);
    let lanes = (0..).zip(runs(&arm.lanes.entering));
    let arrow = |(lane, strip): (u8, &EndStrip)| {
        let ways = Some(Ways::of(arms, from, lane, movements)).filter(|ways| *ways != Ways::default())?;
        Some(Object {
            id: ids.next(),
            name: ways.name(),
            kind: "roadMark".into(),
            s,
            t: f64::from(arm.sign_in()) * (strip.inner_m + 0.5 * strip.width_m),
            // Headings are told along the road, whichever way the traffic goes.
            hdg_rad: if arm.sign_in() < 0 { 0.0 } else { PI },
            orientation,
            length_m: Some(LENGTH_M),
            width_m: Some(2.0),
            outlines: ways.outlines(),
            ..Object::default()
        })
    };
    lanes.filter_map(arrow).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_simple_and_counter_clockwise() {
        let all = |straight| Ways { left: true, straight, right: true }.outlines();
        for outline in all(true).into_iter().chain(all(false)) {
            let ring: Vec<[f64; 2]> = outline
                .corners
                .iter()
                .map(|corner| match corner {
                    Corner::Local { u_m, v_m, .. } => [*u_m, *v_m],
                    other => panic!("{other:?}"),
                })
                .collect();
            let n = ring.len();
            let cross = |o: [f64; 2], a: [f64; 2], b: [f64; 2]| {
                (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
            };
            let area: f64 = (0..n).map(|i| cross([0.0; 2], ring[i], ring[(i + 1) % n])).sum();
            assert!(area > 0.5, "{area}");
            for i in 0..n {
                for k in i + 2..n {
                    if (i, k) == (0, n - 1) {
                        continue;
                    }
                    let (a, b, c, d) = (ring[i], ring[i + 1], ring[k], ring[(k + 1) % n]);
                    let apart =
                        cross(a, b, c) * cross(a, b, d) > 0.0 || cross(c, d, a) * cross(c, d, b) > 0.0;
                    assert!(apart, "edges {i} and {k} meet");
                }
            }
        }
    }

    #[test]
    fn names_say_the_ways() {
        let ways = Ways { left: true, straight: true, right: false };
        assert_eq!(ways.name(), "ArrowLeftStraight");
        assert_eq!(ways.outlines().len(), 2);
    }
}
