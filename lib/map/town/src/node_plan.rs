//! Where streets end at their nodes.

use frames::math::{atan2, cos, sin, tan};
use frames::wrap_pi;
use opendrive::ContactPoint;
use std::f64::consts::PI;

use crate::TownError;
use crate::arm::{Arm, counter_clockwise, inner_m, runs};
use crate::control::{Hold, holds, is_walked};
use crate::junction::{NEARLY_STRAIGHT_RAD, bulb_reach_m, lead_m};
use crate::layout::{Edge, Layout, Line, NodeKind, Role};
use crate::path::{Path, Pose2};
use crate::section::{EndLanes, EndStrip};

/// Half the length of a crossover, metres.
const CROSSOVER_HALF_M: f64 = 12.0;
/// Turns to the left that are given room, radians, and the least radius of their inner borders, metres.
const LEFT_RAD: std::ops::RangeInclusive<f64> = 0.4..=2.4;
const LEFT_TURN_M: f64 = 5.5;
/// Room of a kerb's fillet beyond the sidewalk's inner edge, metres.
const SIDEWALK_ROOM_M: f64 = 1.0;
/// From the outermost rail or lane to where the other road's junction part begins at a level crossing,
/// metres.
const RAIL_GAP_M: f64 = 3.0;

/// What is known of a node before its streets are built.
#[derive(Clone, Debug)]
pub(crate) struct NodePlan {
    /// Its arms, in the order of the edges (parts of roundabouts: the ring first). Road ids, lengths and
    /// heights come later.
    pub(crate) arms: Vec<Arm>,
    /// What holds back the traffic of each arm.
    pub(crate) holds: Vec<Hold>,
    /// The middle of a seam or crossover, along its axis.
    pub(crate) axis: Pose2,
    /// Kerb radius that leaves room for sidewalks, metres.
    pub(crate) kerb_radius_m: f64,
    /// Whether the roads of two arms are joined without a junction.
    pub(crate) direct: bool,
}

/// The heading in which an edge leaves its node.
pub(crate) fn heading(layout: &Layout, edge: &Edge, contact: ContactPoint) -> f64 {
    let end = edge.at(contact);
    if let Role::Fixed(pose) | Role::Ring(pose) = end.role {
        return pose.heading_rad;
    }
    if let Some(heading) = end.heading_rad {
        return heading;
    }
    match (&edge.line, contact) {
        (Line::Chain(start, _), ContactPoint::Start) => return start.heading_rad,
        (Line::Chain(start, pieces), ContactPoint::End) => {
            return Path::chain(*start, pieces).end().turned(PI).heading_rad;
        }
        (Line::Via(_), _) => {}
    }
    let (vias, other) = match contact {
        ContactPoint::Start => (edge.vias().first(), edge.to.node),
        ContactPoint::End => (edge.vias().last(), edge.from.node),
    };
    let here = layout.nodes[end.node].at_m;
    let next = vias.map_or(layout.nodes[other].at_m, |v| v.at_m);
    atan2(next[1] - here[1], next[0] - here[0])
}

/// Places every node's arms.
pub(crate) fn node_plans(layout: &Layout) -> Result<Vec<NodePlan>, TownError> {
    let mut arms: Vec<Vec<Arm>> = layout.nodes.iter().map(|_| Vec::new()).collect();
    for (index, edge) in layout.edges.iter().enumerate() {
        if edge.from.node.max(edge.to.node) >= layout.nodes.len() {
            let problem = "it leads to a node that does not exist".into();
            return Err(TownError::Layout { place: edge.name.clone(), problem });
        }
        for contact in [ContactPoint::Start, ContactPoint::End] {
            let end = edge.at(contact);
            let node = &layout.nodes[end.node];
            let [x_m, y_m] = node.at_m;
            arms[end.node].push(Arm {
                edge: index,
                road: String::new(),
                length_m: 0.0,
                contact,
                outward: Pose2 { x_m, y_m, heading_rad: wrap_pi(heading(layout, edge, contact)) },
                z_m: 0.0,
                slope: 0.0,
                lanes: edge.shape.end_lanes(&end.ending, contact),
                shape: edge.shape,
                lead_m: lead_m(false),
                crosswalk: false,
            });
        }
    }
    arms.into_iter().enumerate().map(|(node, arms)| node_plan(layout, node, arms)).collect()
}

fn node_plan(layout: &Layout, index: usize, mut arms: Vec<Arm>) -> Result<NodePlan, TownError> {
    let node = &layout.nodes[index];
    let role = |arm: &Arm| layout.edges[arm.edge].at(arm.contact).role;
    let is_ring = |arm: &Arm| matches!(role(arm), Role::Ring(_));
    // The ring comes in, the ring goes out, the street.
    arms.sort_by_key(|arm| (!is_ring(arm), is_ring(arm) && arm.contact == ContactPoint::Start));
    if node.kind != NodeKind::Ring {
        arms.sort_by_key(|arm| (arm.edge, arm.contact == ContactPoint::End));
    }
    let problem = |problem: String| {
        let name = if node.name.is_empty() { format!("node {index}") } else { node.name.clone() };
        Err(TownError::Layout { place: name, problem })
    };
    let fits = match node.kind {
        NodeKind::Crossing(_) | NodeKind::Seam { .. } => arms.len() >= 2,
        // Its streets have gone over to the parts of its ring.
        NodeKind::Roundabout { .. } => arms.is_empty(),
        NodeKind::Crossover => arms.len() == 2,
        NodeKind::DeadEnd { .. } | NodeKind::MapEdge => arms.len() == 1,
        NodeKind::RailCrossing => arms.len() == 4,
        NodeKind::Ring => arms.len() == 3,
    };
    if !fits {
        return problem(format!("{} streets meet at a node of kind {:?}", arms.len(), node.kind));
    }
    let beyond = |arm: &Arm| arm.shape.left.beyond_kerb_m().max(arm.shape.right.beyond_kerb_m());
    let widest = arms.iter().map(beyond).fold(0.0, f64::max);
    let holds = holds(node.kind, &arms);
    for (arm, hold) in arms.iter_mut().zip(&holds) {
        let sidewalks = arm.shape.left.sidewalk_m > 0.0 && arm.shape.right.sidewalk_m > 0.0;
        arm.crosswalk = node.crosswalks && sidewalks && is_walked(node.kind, *hold);
        arm.lead_m = lead_m(arm.crosswalk);
    }
    let axis = Pose2 { x_m: node.at_m[0], y_m: node.at_m[1], heading_rad: 0.0 };
    let kerb_radius_m = node.kerb_radius_m.max(widest + SIDEWALK_ROOM_M);
    let mut plan = NodePlan { arms, holds, axis, kerb_radius_m, direct: false };
    match node.kind {
        NodeKind::Crossing(_) => crossing(&mut plan),
        NodeKind::RailCrossing => rail_crossing(&mut plan),
        NodeKind::Seam { length_m } => seam(layout, &mut plan, length_m)?,
        NodeKind::Crossover => crossover(&mut plan),
        NodeKind::DeadEnd { radius_m } => {
            let arm = &plan.arms[0];
            let line = inner_m(&arm.lanes.entering, 0);
            let circle = radius_m - (arm.paved()[0] - line);
            if circle < 2.0 {
                return problem("the turning circle is too small for the street's lanes".into());
            }
            move_out(&mut plan, &[bulb_reach_m(line, circle)]);
        }
        NodeKind::MapEdge | NodeKind::Ring | NodeKind::Roundabout { .. } => {}
    }
    keep_what_is_given(layout, &mut plan.arms);
    Ok(plan)
}

/// Moves streets out until their kerbs meet in fillets and left turns have room.
fn crossing(plan: &mut NodePlan) {
    for arm in &mut plan.arms {
        arm.outward = arm.outward.moved(0.0, aside_m(arm));
    }
    let arms = plan.arms.iter().map(|arm| {
        let ([left, right], aside) = (arm.paved(), aside_m(arm));
        (arm.outward.heading_rad, [left + aside, right - aside], arm.lead_m)
    });
    let mut distances = setbacks(&arms.collect::<Vec<_>>(), plan.kerb_radius_m);
    leave_room_for_left_turns(&plan.arms, &mut distances);
    move_out(plan, &distances);
}

/// Ends streets and railway before one another.
fn rail_crossing(plan: &mut NodePlan) {
    let wide = |arm: &Arm| arm.paved()[0].max(arm.paved()[1]);
    let across = |rail: bool| {
        plan.arms.iter().filter(|o| o.is_rail() != rail).map(wide).fold(0.0, f64::max) + RAIL_GAP_M
    };
    let distances: Vec<f64> = plan.arms.iter().map(|arm| across(arm.is_rail())).collect();
    move_out(plan, &distances);
}

/// Puts both ends of a road on its axis, with room for the U-turn between them.
fn crossover(plan: &mut NodePlan) {
    plan.axis.heading_rad = seam_axis(&plan.arms.iter().collect::<Vec<_>>());
    let (axis, back) = (plan.axis, plan.axis.turned(PI));
    for arm in &mut plan.arms {
        arm.outward = if leads_along(arm, axis) { axis } else { back }.moved(CROSSOVER_HALF_M, 0.0);
    }
}

/// What a layout gives exactly stays so.
fn keep_what_is_given(layout: &Layout, arms: &mut [Arm]) {
    for arm in arms {
        let edge = &layout.edges[arm.edge];
        match (edge.at(arm.contact).role, &edge.line) {
            (Role::Fixed(pose) | Role::Ring(pose), _) => arm.outward = pose,
            (_, Line::Chain(start, _)) if arm.contact == ContactPoint::Start => arm.outward = *start,
            (_, Line::Chain(start, pieces)) => arm.outward = Path::chain(*start, pieces).end().turned(PI),
            _ => {}
        }
    }
}

/// How far to the left of an arm's axis (seen outwards) its reference line lies at a crossing, metres: a
/// one-way street lies with the middle of its carriageway on the axis, lest its kerbs be too near to one
/// corner.
fn aside_m(arm: &Arm) -> f64 {
    let [left, right] = arm.paved();
    if arm.shape.is_one_way() { 0.5 * (right - left) } else { 0.0 }
}

/// Moves the ends of streets out until every turn to the left can have the least radius: on oblique arms the
/// lanes may meet before the kerbs do. `distances_m`: from the junction's centre to each arm's end, grown
/// where needed.
fn leave_room_for_left_turns(arms: &[Arm], distances_m: &mut [f64]) {
    for (i, from) in arms.iter().enumerate().filter(|(_, arm)| !arm.entering().is_empty()) {
        for (j, to) in arms.iter().enumerate().filter(|(_, arm)| arm.leaving() > 0) {
            let turn = from.turn_to(to);
            if i == j || from.is_rail() || to.is_rail() || !LEFT_RAD.contains(&turn) {
                continue;
            }
            // The same as for the kerbs: two lines parallel to the axes, left of the one and right of the
            // other arm.
            let (left, right) = (
                inner_m(&from.lanes.entering, 0) + aside_m(from),
                inner_m(&to.lanes.leaving, 0) - aside_m(to),
            );
            let (sin, cos) = (-sin(turn), -cos(turn));
            let tangent = LEFT_TURN_M * tan(0.5 * turn);
            distances_m[i] = distances_m[i].max((right + left * cos) / sin + tangent + from.lead_m);
            distances_m[j] = distances_m[j].max((left + right * cos) / sin + tangent + to.lead_m);
        }
    }
}

/// Moves each arm's end away from the node along its heading.
fn move_out(plan: &mut NodePlan, distances_m: &[f64]) {
    for (arm, distance) in plan.arms.iter_mut().zip(distances_m) {
        arm.outward = arm.outward.moved(*distance, 0.0);
    }
}

/// How far from a junction's centre each arm's street must end, metres, so that the kerbs of neighbouring
/// arms meet in a fillet of the given radius. `arms`: outward heading in radians, kerb distance on its left
/// (entering) and right (leaving) side seen outwards, and straight lead, metres.
pub(crate) fn setbacks(arms: &[(f64, [f64; 2], f64)], kerb_radius_m: f64) -> Vec<f64> {
    let mut needs = vec![0.0f64; arms.len()];
    for (a, (heading, [left, _], _)) in arms.iter().enumerate() {
        let angle = |b: &usize| counter_clockwise(*heading, arms[*b].0);
        let Some(b) = (0..arms.len()).filter(|b| *b != a).min_by(|x, y| angle(x).total_cmp(&angle(y))) else {
            continue;
        };
        let between = angle(&b);
        if between > PI - NEARLY_STRAIGHT_RAD {
            continue;
        }
        let right = arms[b].1[1];
        // Where two lines parallel to the arms cross, along either arm; from there the fillet's tangent.
        let (sin, cos) = (sin(between), cos(between));
        let tangent = kerb_radius_m / tan(0.5 * between);
        needs[a] = needs[a].max((right + left * cos) / sin + tangent);
        needs[b] = needs[b].max((left + right * cos) / sin + tangent);
    }
    needs.iter().zip(arms).map(|(need, (_, _, lead))| need + lead).collect()
}

/// Whether an arm leads away along an axis.
fn leads_along(arm: &Arm, axis: Pose2) -> bool {
    cos(wrap_pi(arm.outward.heading_rad - axis.heading_rad)) > 0.0
}

/// The heading of a seam: that of its first arm that is no ramp, along its road's s; halfway to that of the
/// second one where these two are all there is.
fn seam_axis(arms: &[&Arm]) -> f64 {
    let Some(first) = arms.first() else { return 0.0 };
    let along = match first.contact {
        ContactPoint::Start => first.outward.heading_rad,
        ContactPoint::End => first.outward.heading_rad + PI,
    };
    match arms {
        [first, second] => {
            let bend = wrap_pi(second.outward.heading_rad - first.outward.heading_rad - PI);
            wrap_pi(along + 0.5 * bend)
        }
        _ => wrap_pi(along),
    }
}

/// A seam: main arms on its axis, ramps beside it.
fn seam(layout: &Layout, plan: &mut NodePlan, length_m: f64) -> Result<(), TownError> {
    let ramps: Vec<Option<bool>> = plan
        .arms
        .iter()
        .map(|arm| match layout.edges[arm.edge].at(arm.contact).role {
            Role::Ramp { forward } => Some(forward),
            _ => None,
        })
        .collect();
    let mains: Vec<&Arm> =
        plan.arms.iter().zip(&ramps).filter(|(_, r)| r.is_none()).map(|(a, _)| a).collect();
    if mains.is_empty() {
        let name = layout.edges[plan.arms[0].edge].name.clone();
        return Err(TownError::Layout {
            place: name,
            problem: "it begins or ends at a seam of ramps only".into(),
        });
    }
    let axis = Pose2 { heading_rad: seam_axis(&mains), ..plan.axis };
    let direct = plan.arms.len() == 2 && mains.len() == 2 && same(&mains[0].lanes, &mains[1].lanes);
    let half = if direct { 0.0 } else { 0.5 * length_m };
    // Carriageways of their own lie where the lanes of a road with both directions lead to.
    let two_way = mains.iter().find(|arm| !arm.shape.is_one_way());
    let at = |arm: &Arm, ramp: Option<bool>| {
        let out = if leads_along(arm, axis) { axis } else { axis.turned(PI) };
        match (ramp, two_way) {
            (Some(forward), _) => ramp_end(arm, &mains, if forward { axis } else { axis.turned(PI) }, half),
            (None, Some(model)) if arm.shape.is_one_way() => {
                // Its entering traffic comes along the same side of the axis as the other road's leaving
                // traffic.
                if arm.entering().is_empty() {
                    out.moved(half, inner_m(&arm.lanes.leaving, 0) - inner_m(&model.lanes.entering, 0))
                } else {
                    out.moved(half, inner_m(&model.lanes.leaving, 0) - inner_m(&arm.lanes.entering, 0))
                }
            }
            _ => out.moved(half, 0.0),
        }
    };
    let outward: Vec<Pose2> = plan.arms.iter().zip(&ramps).map(|(arm, ramp)| at(arm, *ramp)).collect();
    for (arm, outward) in plan.arms.iter_mut().zip(outward) {
        arm.outward = outward;
    }
    (plan.axis, plan.direct) = (axis, direct);
    Ok(())
}

/// Where a ramp ends beside the main road of a seam. `axis`: along the traffic that it leaves or enters.
fn ramp_end(arm: &Arm, mains: &[&Arm], axis: Pose2, half_m: f64) -> Pose2 {
    // Main roads behind and ahead, seen by the traffic.
    let behind = mains.iter().find(|m| !leads_along(m, axis)).map_or(&[][..], |m| &m.lanes.entering);
    let ahead = mains.iter().find(|m| leads_along(m, axis)).map_or(&[][..], |m| &m.lanes.leaving);
    let leaves = arm.leaving() > 0;
    let own = [&arm.lanes.entering, &arm.lanes.leaving];
    let (lanes, left) = if leaves { (own[1], own[0]) } else { (own[0], own[1]) };
    let (beside, joined) = if leaves { (ahead, behind) } else { (behind, ahead) };
    let shoulder: f64 = beside.iter().filter(|s| s.kind.outer_order().is_some()).map(|s| s.width_m).sum();
    let own_shoulder: f64 = left.iter().map(|s| s.width_m).sum();
    let last = runs(beside).last().map_or(0.0, |s| s.inner_m + s.width_m);
    let right_m = last + shoulder + own_shoulder;
    let from_lane = runs(joined).count().saturating_sub(runs(lanes).count());
    // One arc from the main road's direction.
    let angle = (right_m - inner_m(joined, from_lane as u8)) / half_m.max(1.0);
    if leaves {
        axis.moved(half_m, -right_m).turned(-angle)
    } else {
        axis.moved(-half_m, -right_m).turned(angle).turned(PI)
    }
}

/// Whether the lanes of two arms go on into each other as they are.
fn same(a: &EndLanes, b: &EndLanes) -> bool {
    let equal = |a: &[EndStrip], b: &[EndStrip]| {
        a.len() == b.len()
            && a.iter().zip(b).all(|(a, b)| {
                a.kind == b.kind && a.width_m == b.width_m && (a.inner_m - b.inner_m).abs() < 1e-9
            })
    };
    equal(&a.entering, &b.leaving) && equal(&a.leaving, &b.entering)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn right_angles_set_back_by_kerb_and_radius() {
        let arm = |heading: f64, kerb: f64, lead: f64| (heading, [kerb; 2], lead);
        let arms =
            [arm(0.0, 7.5, 4.5), arm(FRAC_PI_2, 4.0, 0.5), arm(PI, 7.5, 4.5), arm(-FRAC_PI_2, 4.0, 0.5)];
        let got = setbacks(&arms, 6.0);
        for (got, want) in got.iter().zip([4.0 + 6.0 + 4.5, 7.5 + 6.0 + 0.5, 14.5, 14.0]) {
            assert!((got - want).abs() < 1e-9, "{got} {want}");
        }
    }

    #[test]
    fn oblique_kerbs_touch_their_fillet_where_the_street_ends() {
        // Two arms 60 degrees apart: the fillet's centre is a radius from both kerbs.
        let (kerb, radius, angle) = (4.0, 6.0, PI / 3.0);
        let got = setbacks(&[(0.0, [kerb; 2], 0.0), (angle, [kerb; 2], 0.0)], radius);
        let centre = [got[0], kerb + radius];
        let to_other = centre[1] * cos(angle) - centre[0] * sin(angle);
        assert!((to_other + kerb + radius).abs() < 1e-9);
        assert!((got[0] - got[1]).abs() < 1e-9);
    }
}
