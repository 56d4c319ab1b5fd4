//! Which lanes of an arm lead to which lanes of another at a crossing.

use std::ops::Range;

use crate::arm::{Arm, counter_clockwise, inner_m, next_to_the_right, opposite};
use crate::section::Turn;

/// A way through a junction that needs a connecting road.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Movement {
    /// Arm it enters by.
    pub(crate) from: usize,
    /// Arm it leaves by.
    pub(crate) to: usize,
    /// First driving lane it takes, counted from the inside, pockets included.
    pub(crate) from_lane: u8,
    /// First driving lane it leads to.
    pub(crate) to_lane: u8,
    /// Number of driving lanes; 0 for a mere corner of gutter and sidewalk.
    pub(crate) lanes: u8,
    /// Whether it carries what lies beyond the lanes of the entering and of the leaving side; what only one
    /// of them has runs out on the way.
    pub(crate) outer: [bool; 2],
    /// The same for what lies inside of the lanes.
    pub(crate) inner: [bool; 2],
    /// Whether it goes round a kerb.
    pub(crate) corner: bool,
    /// Whether lines are painted on it.
    pub(crate) marked: bool,
}

/// All movements of a crossing, by entering arm.
///
/// Pockets serve their turns alone. Other lanes: straight on from every lane that has a partner; turns to the
/// left leave the innermost lane and turns to the right the outermost one; where nothing goes straight on,
/// they share the lanes out. Lanes of one arm never cross one another: from the inside out they lead to arms
/// further and further right.
///
/// Without `lefts` nothing turns to the left but what has no other way.
pub(crate) fn crossing(arms: &[Arm], lefts: bool) -> Vec<Movement> {
    let mut all = Vec::new();
    for from in 0..arms.len() {
        of_arm(arms, from, lefts, &mut all);
    }
    all
}

fn of_arm(arms: &[Arm], from: usize, lefts: bool, all: &mut Vec<Movement>) {
    let first = all.len();
    let arm = &arms[from];
    let exits: Vec<usize> = {
        let open =
            |to: &usize| *to != from && arms[*to].leaving() > 0 && arms[*to].is_rail() == arm.is_rail();
        let angle = |to: &usize| counter_clockwise(arm.outward.heading_rad, arms[*to].outward.heading_rad);
        let mut exits: Vec<usize> = (0..arms.len()).filter(open).collect();
        exits.sort_by(|a, b| angle(b).total_cmp(&angle(a)));
        exits
    };
    // From left to right: turns to the left, straight on, turns to the right.
    let straight = opposite(arms, from).filter(|to| exits.contains(to));
    let (mut left, right): (Vec<usize>, Vec<usize>) =
        match straight.and_then(|s| exits.iter().position(|e| *e == s)) {
            Some(at) => (exits[..at].to_vec(), exits[at + 1..].to_vec()),
            None => exits.iter().partition(|to| arm.turn_to(&arms[**to]) > 0.0),
        };
    if !lefts && (straight.is_some() || !right.is_empty()) {
        left.clear();
    }
    let lanes = shares(arm, !left.is_empty(), straight.map(|s| arms[s].leaving()), !right.is_empty());
    let part = |lanes: &Range<u8>, i: usize, of: usize| {
        let n = lanes.len();
        let start = (i * n / of).min(n.saturating_sub(1));
        let end = ((i + 1) * n / of).max(start + 1).min(n);
        lanes.start + start as u8..lanes.start + end as u8
    };
    for (i, to) in left.iter().enumerate() {
        let lanes = part(&lanes[0], i, left.len());
        join(arms, [from, *to], lanes, 0, all);
    }
    if let Some(to) = straight {
        let range = lanes[1].clone();
        let room = arms[to].leaving().saturating_sub(range.len() as u8);
        let at = inner_m(&arm.lanes.entering, range.start);
        let off = |k: &u8| (inner_m(&arms[to].lanes.leaving, *k) - at).abs();
        let to_lane = (0..=room).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
        join(arms, [from, to], range, to_lane, all);
    }
    for (i, to) in right.iter().enumerate() {
        let lanes = part(&lanes[2], i, right.len());
        let to_lane = arms[*to].leaving().saturating_sub(lanes.len() as u8);
        join(arms, [from, *to], lanes, to_lane, all);
    }
    corner(arms, from, first, all);
}

/// Lanes that lead from one arm to another, the first of them to `to_lane`; lanes too many share the
/// outermost one.
fn join(arms: &[Arm], [from, to]: [usize; 2], lanes: Range<u8>, to_lane: u8, all: &mut Vec<Movement>) {
    let leaving = arms[to].leaving();
    let common = (lanes.len() as u8).min(leaving.saturating_sub(to_lane));
    if common > 0 {
        let from_lane = lanes.start;
        all.push(Movement { from, to, from_lane, to_lane, lanes: common, ..Movement::default() });
    }
    for from_lane in lanes.start + common..lanes.end {
        let to_lane = leaving.saturating_sub(1);
        all.push(Movement { from, to, from_lane, to_lane, lanes: 1, ..Movement::default() });
    }
}

/// Lanes for turns to the left, for what goes straight on (with so many leaving lanes), and for turns to the
/// right.
fn shares(arm: &Arm, left: bool, straight: Option<u8>, right: bool) -> [Range<u8>; 3] {
    let turns = arm.entering();
    let all = turns.len() as u8;
    // Pockets for turns that the junction does not offer are lanes like others.
    let first = if left { turns.iter().take_while(|t| **t == Turn::Left).count() as u8 } else { 0 };
    let pocket_right =
        if right { turns.iter().rev().take_while(|t| **t == Turn::Right).count() as u8 } else { 0 };
    let last = all - pocket_right.min(all - first);
    let count = last - first;
    // Whether turns have to share the lanes in the middle.
    let (share_left, share_right) = (left && first == 0 && count > 0, right && last == all && count > 0);
    let mut ranges = [0..first, first..last, last..all];
    match straight {
        Some(leaving) => {
            let surplus = count.saturating_sub(leaving.max(1));
            if share_right {
                ranges[2] = last - surplus.max(1)..last;
                ranges[1] = first..last - surplus;
                if share_left {
                    ranges[0] = first..first + 1;
                }
            } else if share_left {
                ranges[0] = first..first + surplus.max(1);
                ranges[1] = first + surplus..last;
            }
        }
        None => match (share_left, share_right) {
            (true, true) => {
                ranges[0] = first..first + count.div_ceil(2);
                ranges[2] = last - (count / 2).max(1)..last;
            }
            // Whatever is left over turns the only way there is.
            (true, false) => ranges[0] = first..last,
            (false, true) => ranges[2] = first..last,
            (false, false) if left => ranges[0] = 0..last,
            (false, false) => ranges[2] = first..all,
        },
    }
    ranges
}

/// Gives gutter and sidewalk to the movement round the corner, or makes one without lanes.
fn corner(arms: &[Arm], from: usize, first: usize, all: &mut Vec<Movement>) {
    let Some(to) = next_to_the_right(arms, from).filter(|to| !arms[*to].is_rail() && !arms[from].is_rail())
    else {
        return;
    };
    let (entering, leaving) = (arms[from].entering().len() as u8, arms[to].leaving());
    let fits =
        |m: &&mut Movement| m.to == to && m.from_lane + m.lanes == entering && m.to_lane + m.lanes == leaving;
    match all[first..].iter_mut().find(fits) {
        Some(movement) => (movement.outer, movement.corner) = ([true; 2], true),
        None => all.push(Movement {
            from,
            to,
            from_lane: entering,
            to_lane: leaving,
            outer: [true; 2],
            corner: true,
            ..Movement::default()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Pose2;
    use crate::section::{CrossSection, Ending, Pocket, Side};
    use opendrive::ContactPoint;
    use std::f64::consts::PI;

    fn arm_with(heading_rad: f64, lanes: u8, ending: Ending) -> Arm {
        let shape = CrossSection::both_ways(Side::town(lanes, 3.5).with_sidewalk(3.0), 50.0);
        Arm {
            edge: 0,
            road: String::new(),
            length_m: 100.0,
            contact: ContactPoint::End,
            outward: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad },
            z_m: 0.0,
            slope: 0.0,
            lanes: shape.end_lanes(&ending, ContactPoint::End),
            shape,
            lead_m: 0.5,
            crosswalk: false,
        }
    }

    fn arm(heading_rad: f64, lanes: u8) -> Arm {
        arm_with(heading_rad, lanes, Ending::default())
    }

    /// `[from, to, from_lane, to_lane, lanes, corner]`.
    fn rows(arms: &[Arm]) -> Vec<[usize; 6]> {
        let row = |m: &Movement| {
            [m.from, m.to, m.from_lane.into(), m.to_lane.into(), m.lanes.into(), usize::from(m.corner)]
        };
        let mut rows: Vec<[usize; 6]> = crossing(arms, true).iter().map(row).collect();
        rows.sort_unstable();
        rows
    }

    #[test]
    fn a_crossing_of_a_street_and_an_avenue() {
        // East and west: two lanes each way; north and south: one.
        let arms = [arm(0.0, 2), arm(0.5 * PI, 1), arm(PI, 2), arm(-0.5 * PI, 1)];
        let found = rows(&arms);
        assert_eq!(found.len(), 12);
        // From the east: right to the north from the outer lane, straight on with both, left to the south
        // from the inner one.
        assert_eq!(found[..3], [[0, 1, 1, 0, 1, 1], [0, 2, 0, 0, 2, 0], [0, 3, 0, 0, 1, 0]]);
        // From the north: left to the east into its inner lane, right to the west into its outer lane,
        // straight on.
        assert_eq!(found[3..6], [[1, 0, 0, 0, 1, 0], [1, 2, 0, 1, 1, 1], [1, 3, 0, 0, 1, 0]]);
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

    #[test]
    fn pockets_serve_their_turns_alone() {
        let pockets = Ending {
            left: Some(Pocket { lanes: 2, length_m: 40.0, taper_m: 20.0 }),
            right: Some(Pocket::one(40.0, 20.0)),
            ..Ending::default()
        };
        let arms = [arm_with(0.0, 2, pockets), arm(0.5 * PI, 2), arm(PI, 3), arm(-0.5 * PI, 2)];
        let found = rows(&arms);
        // Lanes 0 and 1 turn left, 2 and 3 go straight on to where they lie in line, 4 turns right.
        assert_eq!(found[..3], [[0, 1, 4, 1, 1, 1], [0, 2, 2, 1, 2, 0], [0, 3, 0, 0, 2, 0]]);
    }

    #[test]
    fn turns_to_the_left_can_be_forbidden() {
        let arms = [arm(0.0, 2), arm(0.5 * PI, 2), arm(PI, 2), arm(-0.5 * PI, 2)];
        let all = crossing(&arms, false);
        assert_eq!(all.len(), 8);
        assert!(all.iter().all(|m| arms[m.from].turn_to(&arms[m.to]) < 0.1));
        // All lanes still lead on.
        assert!((0..4).all(|a| (0..2).all(|k| {
            all.iter().any(|m| m.from == a && (m.from_lane..m.from_lane + m.lanes).contains(&k))
        })));
        // Where the only way on is to the left, it stays.
        let bend = [arm(0.0, 1), arm(-0.5 * PI, 1)];
        assert!(crossing(&bend, false).iter().any(|m| m.from == 0 && m.to == 1 && m.lanes == 1));
    }

    #[test]
    fn lanes_of_one_arm_never_cross_and_all_lead_on() {
        for (n, m) in [(1, 1), (2, 1), (3, 1), (3, 2), (1, 3), (2, 2)] {
            for headings in [
                vec![0.0, 1.2, PI, 4.2],
                vec![0.0, 0.9, 2.2, 3.1, 4.6],
                vec![0.0, 2.0, 4.0],
                vec![0.0, 1.7, PI],
            ] {
                let arms: Vec<Arm> = headings
                    .iter()
                    .enumerate()
                    .map(|(i, h)| arm(*h, if i % 2 == 0 { n } else { m }))
                    .collect();
                let all = crossing(&arms, true);
                for (from, arm) in arms.iter().enumerate() {
                    let angle = |m: &Movement| {
                        counter_clockwise(arm.outward.heading_rad, arms[m.to].outward.heading_rad)
                    };
                    let own: Vec<&Movement> = all.iter().filter(|m| m.from == from && m.lanes > 0).collect();
                    for lane in 0..arm.entering().len() as u8 {
                        assert!(own.iter().any(|m| (m.from_lane..m.from_lane + m.lanes).contains(&lane)));
                    }
                    for a in &own {
                        for b in own.iter().filter(|b| angle(a) > angle(b)) {
                            // `a` leads further left: none of its lanes lies outside one of `b`.
                            assert!(
                                a.from_lane + a.lanes <= b.from_lane + 1,
                                "{n} {m} {headings:?}: {a:?} {b:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}
