//! Roads in line: lanes go on where they lie; some end, begin, fork off or join.

use frames::math::cos;
use frames::wrap_pi;

use crate::arm::{Arm, inner_m, runs};
use crate::movements::Movement;
use crate::path::Pose2;

/// A driving lane at a seam.
#[derive(Clone, Copy, Debug)]
struct SeamLane {
    arm: usize,
    index: u8,
    /// Middle of the lane, metres to the right of the axis.
    right_m: f64,
}

/// The movements of a seam, for the traffic along its axis and against it. `axis`: a pose on it.
pub(crate) fn movements(arms: &[Arm], axis: Pose2) -> Vec<Movement> {
    let mut all = Vec::new();
    for axis in [axis, axis.turned(std::f64::consts::PI)] {
        one_way(arms, axis, &mut all);
    }
    all
}

/// Whether an arm leads away along an axis.
fn ahead(arm: &Arm, axis: Pose2) -> bool {
    cos(wrap_pi(arm.outward.heading_rad - axis.heading_rad)) > 0.0
}

fn one_way(arms: &[Arm], axis: Pose2, all: &mut Vec<Movement>) {
    let lanes = |leaving: bool| {
        let mut found: Vec<SeamLane> = Vec::new();
        for (i, arm) in arms.iter().enumerate().filter(|(_, arm)| ahead(arm, axis) == leaving) {
            let strips = if leaving { &arm.lanes.leaving } else { &arm.lanes.entering };
            let (_, left) = axis.locate(arm.outward);
            for (index, strip) in runs(strips).enumerate() {
                let right_m = strip.inner_m + 0.5 * strip.width_m - left;
                found.push(SeamLane { arm: i, index: index as u8, right_m });
            }
        }
        found.sort_by(|a, b| a.right_m.total_cmp(&b.right_m));
        found
    };
    let (entering, leaving) = (lanes(false), lanes(true));
    let common = entering.len().min(leaving.len());
    if common == 0 {
        return;
    }
    // The shift of the shorter row along the longer one that moves lanes least sideways.
    let room = entering.len().max(leaving.len()) - common;
    let (from_longer, to_longer) = (entering.len() > common, leaving.len() > common);
    let pair = |k: usize, shift: usize| {
        let from = if from_longer { k + shift } else { k };
        let to = if to_longer { k + shift } else { k };
        (entering[from], leaving[to])
    };
    let sideways = |shift: &usize| {
        (0..common).map(|k| pair(k, *shift)).map(|(a, b)| (a.right_m - b.right_m).abs()).sum::<f64>()
    };
    let shift = (0..=room).min_by(|a, b| sideways(a).total_cmp(&sideways(b))).unwrap_or(0);
    // Lanes without a partner end in, or begin from, the nearest one that has.
    let mut links: Vec<(SeamLane, SeamLane)> = Vec::new();
    for k in 0..common + room {
        let partner = k.clamp(shift, shift + common - 1) - shift;
        links.push(if from_longer {
            (entering[k], leaving[partner])
        } else if to_longer {
            (entering[partner], leaving[k])
        } else {
            (entering[k.min(common - 1)], leaving[k.min(common - 1)])
        });
        if room == 0 && k + 1 == common {
            break;
        }
    }

    let first = all.len();
    for (from, to) in links {
        let goes_on = |m: &Movement| {
            (m.from, m.to) == (from.arm, to.arm)
                && m.from_lane + m.lanes == from.index
                && m.to_lane + m.lanes == to.index
        };
        match all[first..].last_mut().filter(|m| goes_on(m)) {
            Some(movement) => movement.lanes += 1,
            None => all.push(Movement {
                from: from.arm,
                to: to.arm,
                from_lane: from.index,
                to_lane: to.index,
                lanes: 1,
                marked: true,
                ..Movement::default()
            }),
        }
    }
    edges(arms, &mut all[first..]);
}

/// Gives what lies beside the lanes of each arm to one movement: the outermost or the innermost that uses it.
fn edges(arms: &[Arm], movements: &mut [Movement]) {
    for (i, arm) in arms.iter().enumerate() {
        let (entering, leaving) = (arm.entering().len() as u8, arm.leaving());
        if let Some(m) = movements.iter_mut().rev().find(|m| m.from == i && m.from_lane + m.lanes == entering)
        {
            m.outer[0] = true;
        }
        if let Some(m) = movements.iter_mut().rev().find(|m| m.to == i && m.to_lane + m.lanes == leaving) {
            m.outer[1] = true;
        }
        if let Some(m) = movements.iter_mut().find(|m| m.from == i && m.from_lane == 0) {
            m.inner[0] = true;
        }
        if let Some(m) = movements.iter_mut().find(|m| m.to == i && m.to_lane == 0) {
            m.inner[1] = true;
        }
    }
}

/// The movements of a crossover: straight on, and from the left pockets back on the other side.
pub(crate) fn crossover(arms: &[Arm], axis: Pose2, least_diameter_m: f64) -> Vec<Movement> {
    let mut all = Vec::new();
    for (from, arm) in arms.iter().enumerate() {
        let turns = arm.entering();
        let pockets = turns.iter().take_while(|t| **t == crate::section::Turn::Left).count() as u8;
        let Some(to) = (0..arms.len()).find(|to| ahead(&arms[*to], axis) != ahead(arm, axis)) else {
            continue;
        };
        let lanes = (turns.len() as u8 - pockets).min(arms[to].leaving());
        all.push(Movement {
            from,
            to,
            from_lane: pockets,
            lanes,
            outer: [true; 2],
            marked: true,
            ..Movement::default()
        });
        for from_lane in 0..pockets {
            let start = inner_m(&arm.lanes.entering, from_lane);
            let wide = |k: &u8| start + inner_m(&arm.lanes.leaving, *k) >= least_diameter_m;
            let to_lane = (0..arm.leaving()).find(wide).unwrap_or(arm.leaving().saturating_sub(1));
            all.push(Movement { from, to: from, from_lane, to_lane, lanes: 1, ..Movement::default() });
        }
    }
    all
}

/// The movements of a part of a roundabout: the ring comes in by arm 0 and goes on by arm 1; a street, if
/// there is one, is arm 2.
pub(crate) fn ring(arms: &[Arm]) -> Vec<Movement> {
    let on_ring = arms[0].entering().len() as u8;
    let mut all = vec![Movement {
        from: 0,
        to: 1,
        lanes: on_ring.min(arms[1].leaving()),
        inner: [true; 2],
        ..Movement::default()
    }];
    let Some(street) = arms.get(2) else { return all };
    let (entering, leaving) = (street.entering().len() as u8, street.leaving());
    // Out of the ring by its outermost lane, into whatever lane the street has; the outermost one has the
    // kerb.
    for to_lane in 0..leaving {
        let outer = [to_lane + 1 == leaving; 2];
        let from_lane = on_ring - 1;
        let corner = outer[0];
        all.push(Movement {
            from: 0,
            to: 2,
            from_lane,
            to_lane,
            lanes: 1,
            outer,
            corner,
            ..Movement::default()
        });
    }
    if leaving == 0 {
        let from_lane = on_ring;
        all.push(Movement {
            from: 0,
            to: 2,
            from_lane,
            outer: [true; 2],
            corner: true,
            ..Movement::default()
        });
    }
    // Into the ring: the outer lanes side by side, inner ones too many into its innermost lane.
    let common = entering.min(on_ring);
    all.extend((0..entering - common).map(|from_lane| Movement {
        from: 2,
        to: 1,
        from_lane,
        lanes: 1,
        ..Movement::default()
    }));
    all.push(Movement {
        from: 2,
        to: 1,
        from_lane: entering - common,
        to_lane: on_ring - common,
        lanes: common,
        outer: [true; 2],
        corner: true,
        ..Movement::default()
    });
    all
}

/// The way round a turning circle, and back.
pub(crate) fn turning(arm: &Arm) -> Vec<Movement> {
    let lanes = (arm.entering().len() as u8).min(arm.leaving());
    vec![Movement { lanes, outer: [true; 2], corner: true, ..Movement::default() }]
}

/// The movements of a level crossing: everything straight on.
pub(crate) fn rail(arms: &[Arm]) -> Vec<Movement> {
    let mut all = Vec::new();
    for from in 0..arms.len() {
        let Some(to) = crate::arm::opposite(arms, from) else { continue };
        let lanes = (arms[from].entering().len() as u8).min(arms[to].leaving());
        let movement = Movement {
            from,
            to,
            lanes,
            outer: [true; 2],
            marked: !arms[from].is_rail(),
            ..Movement::default()
        };
        if lanes > 0 {
            all.push(movement);
        }
    }
    all
}
