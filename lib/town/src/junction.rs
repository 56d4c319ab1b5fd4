//! Junctions: connecting roads, connections, crosswalks.

use frames::math::{asin, cos, sin, tan};
use opendrive::{
    Connection, ContactPoint, Cubic, Curve, Junction, Lane, LaneLink, LaneSection, LaneType, MarkColour,
    MarkType, Object, Orientation, Road, RoadLink,
};
use std::f64::consts::{FRAC_PI_2, PI};

use crate::assemble::Ids;
use crate::marks;
use crate::movements::{Arm, Movement, counter_clockwise, movements, opposite};
use crate::path::{Bend, Path};
use crate::street::{raised, ramp, rectangle, road_type};

/// Straight metres beyond a street's end where there is a crosswalk, and where there is none.
const LEAD_M: [f64; 2] = [4.5, 0.5];
/// Middle of a crosswalk, metres beyond the street's end.
const CROSSWALK_AT_M: f64 = 2.5;
/// Extent of a crosswalk along the street, metres.
const CROSSWALK_DEPTH_M: f64 = 3.0;
/// Corners sharper than this are left without fillet: the streets go straight on.
const NEARLY_STRAIGHT_RAD: f64 = 0.05;

/// Straight metres that an arm keeps beyond its street's end.
pub(crate) fn lead_m(crosswalk: bool) -> f64 {
    LEAD_M[usize::from(!crosswalk)]
}

/// How far from a junction's centre each arm's street must end, metres, so that the kerbs of neighbouring arms meet
/// in a fillet of the given radius. `arms`: outward heading in radians, kerb distance on its left (entering) and
/// right (leaving) side seen outwards, and straight lead, metres.
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

/// A junction's roads and its record, before signals.
#[derive(Debug)]
pub(crate) struct Built {
    pub(crate) junction: Junction,
    /// Connecting roads, in the order of `movements`.
    pub(crate) roads: Vec<Road>,
    pub(crate) movements: Vec<Movement>,
}

/// Builds the connecting roads of a level junction.
pub(crate) fn junction(ids: &mut Ids, name: &str, arms: &[Arm], z_m: f64, kerb_radius_m: f64) -> Built {
    let mut built = Built {
        junction: Junction { id: ids.next(), name: name.to_owned(), ..Junction::default() },
        roads: Vec::new(),
        movements: movements(arms),
    };
    for movement in &built.movements {
        let road = connecting_road(ids, &built.junction.id, arms, movement, z_m, kerb_radius_m);
        let sign = arms[movement.from].incoming().1;
        built.junction.connections.push(Connection {
            id: built.junction.connections.len().to_string(),
            incoming_road: arms[movement.from].road.clone(),
            connecting_road: road.id.clone(),
            contact: ContactPoint::Start,
            lane_links: road.sections[0]
                .right
                .iter()
                .flat_map(|lane| {
                    lane.predecessors.iter().map(|from| LaneLink {
                        from: *from,
                        to: lane.id,
                        ..LaneLink::default()
                    })
                })
                .filter(|link| link.from.signum() == sign)
                .collect(),
            ..Connection::default()
        });
        built.roads.push(road);
    }
    for (index, arm) in arms.iter().enumerate().filter(|(_, arm)| arm.crosswalk) {
        crosswalk(ids, &mut built, index, arm);
    }
    built
}

/// One connecting road. Its reference line is the inner (left) border of its first lane, and runs with the traffic:
/// all lanes are right of it.
fn connecting_road(
    ids: &mut Ids,
    junction: &str,
    arms: &[Arm],
    movement: &Movement,
    z_m: f64,
    kerb_radius_m: f64,
) -> Road {
    let (from, to) = (&arms[movement.from], &arms[movement.to]);
    let ((entry, entry_sign), (exit, exit_sign)) = (from.incoming(), to.outgoing());
    let inner = [entry.inner_m(movement.from_lane), exit.inner_m(movement.to_lane)];
    let start = from.outward.turned(PI).moved(0.0, -inner[0]);
    let end = to.outward.moved(0.0, -inner[1]);
    // Round a corner the kerb has the stated radius, and all borders are concentric with it.
    let follows_kerb = movement.corner && from.turn_to(to) < -NEARLY_STRAIGHT_RAD;
    let bend = Bend {
        radius_m: if follows_kerb { kerb_radius_m + entry.kerb_m() - inner[0] } else { f64::INFINITY },
        ease_m: 0.0,
        lead_in_m: from.lead_m,
        lead_out_m: to.lead_m,
    };
    let path = Path::between(start, end, &bend);
    let length = path.length_m;

    let mut lanes: Vec<Lane> = Vec::new();
    // `order`: place of the lane on the streets at both ends, counted from the inside.
    let mut add = |lane_type, widths: [f64; 2], order: [u8; 2], mark, heights| {
        let width = if widths[0] == widths[1] {
            Cubic::constant(widths[0])
        } else {
            ramp(widths[0], widths[1], length, 0.0)
        };
        lanes.push(Lane {
            id: -(lanes.len() as i16 + 1),
            lane_type,
            widths: vec![width],
            marks: vec![mark],
            heights,
            predecessors: vec![entry_sign * (i16::from(order[0]) + 1)],
            successors: vec![exit_sign * (i16::from(order[1]) + 1)],
            ..Lane::default()
        });
    };
    let straight = from.turn_to(to).abs() < NEARLY_STRAIGHT_RAD;
    for index in 0..movement.lanes {
        let order = [movement.from_lane + index, movement.to_lane + index];
        // Along the straight kerb of a T junction the edge line goes on.
        let edge = movement.corner && straight && index + 1 == movement.lanes;
        let mark = if edge { marks::line(MarkType::Solid, MarkColour::White) } else { marks::none() };
        add(LaneType::Driving, [entry.lane_m, exit.lane_m], order, mark, Vec::new());
    }
    if movement.corner {
        let order = [entry.lanes, exit.lanes];
        add(LaneType::Shoulder, [entry.gutter_m, exit.gutter_m], order, marks::kerb(), Vec::new());
        let order = order.map(|o| o + 1);
        add(LaneType::Sidewalk, [entry.sidewalk_m, exit.sidewalk_m], order, marks::none(), raised());
    }

    let mut section = LaneSection { right: lanes, ..LaneSection::default() };
    if follows_kerb && movement.lanes > 0 {
        // Seen from this turn, other lanes of the street turn away: between them the pavement would have a hole.
        let fork = |arm: usize, lanes: u8| opposite(arms, arm).is_none() && lanes > movement.lanes;
        let forks = [fork(movement.from, entry.lanes), fork(movement.to, exit.lanes)];
        section.left.extend(gore(&path, forks, entry.lane_m.max(exit.lane_m)));
    }
    section.centre.marks = vec![marks::none()];
    let link = |arm: &Arm| Some(RoadLink::Road { id: arm.road.clone(), contact: arm.contact });
    Road {
        id: ids.next(),
        length_m: length,
        junction: Some(junction.to_owned()),
        predecessor: link(from),
        successor: link(to),
        types: vec![road_type(from.shape.speed_limit_kmh)],
        plan_view: path.pieces,
        elevation: vec![Cubic::constant(z_m)],
        sections: vec![section],
        ..Road::default()
    }
}

/// The paved wedge to the left of a turn around a kerb, where the street it comes from (`forks[0]`) or leads to
/// (`forks[1]`) has more lanes, which turn the other way.
fn gore(path: &Path, forks: [bool; 2], width_m: f64) -> Option<Lane> {
    let arc = path.pieces.iter().find(|piece| matches!(piece.curve, Curve::Arc { .. }))?;
    let Curve::Arc { curvature } = arc.curve else { return None };
    let radius = 1.0 / curvature.abs();
    // The wedge ends where the turn's left border meets the lane across: R (1 - sin(angle)) = width. It is widest
    // before that, and runs out under that lane.
    let cross_m = (radius * asin((1.0 - width_m / radius).clamp(0.0, 1.0))).min(0.5 * arc.length_m);
    let (widest_m, end_m) = (0.7 * cross_m, (1.5 * cross_m).min(arc.length_m));
    if !forks.contains(&true) || widest_m < 0.1 {
        return None;
    }
    let (start, end) = (arc.s, arc.s + arc.length_m);
    let mut widths = vec![Cubic::constant(0.0)];
    let mut wedge = |from: f64, widest: f64, to: f64| {
        widths.push(ramp(0.0, width_m, widest - from, from));
        widths.push(ramp(width_m, 0.0, to - widest, widest));
        widths.push(Cubic { s: to, ..Cubic::default() });
    };
    // Where both ends fork, the first wedge alone is drawn: the arc has no room for two.
    if forks[0] {
        wedge(start, start + widest_m, start + end_m);
    } else {
        wedge(end - end_m, end - widest_m, end);
    }
    Some(Lane { id: 1, lane_type: LaneType::Shoulder, widths, marks: vec![marks::none()], ..Lane::default() })
}

/// A crosswalk over an arm from kerb to kerb, on the straight part of a connecting road that uses the arm.
fn crosswalk(ids: &mut Ids, built: &mut Built, index: usize, arm: &Arm) {
    let (entering, leaving) = (arm.incoming().0, arm.outgoing().0);
    let Some(place) = built.movements.iter().position(|m| m.from == index || m.to == index) else { return };
    let (movement, road) = (&built.movements[place], &mut built.roads[place]);
    // Lateral middle of the carriageway from the street's reference line, to the left of the travel direction.
    let (s, middle, inner) = if movement.from == index {
        (CROSSWALK_AT_M, 0.5 * (leaving.kerb_m() - entering.kerb_m()), entering.inner_m(movement.from_lane))
    } else {
        let s = road.length_m - CROSSWALK_AT_M;
        (s, 0.5 * (entering.kerb_m() - leaving.kerb_m()), leaving.inner_m(movement.to_lane))
    };
    let across = entering.kerb_m() + leaving.kerb_m();
    road.objects.push(Object {
        id: ids.next(),
        name: "Crosswalk".into(),
        kind: "crosswalk".into(),
        s,
        t: middle + inner,
        // Its length runs across the street.
        hdg_rad: FRAC_PI_2,
        orientation: Orientation::Both,
        length_m: Some(across),
        width_m: Some(CROSSWALK_DEPTH_M),
        outlines: vec![rectangle(0.5 * across, 0.5 * CROSSWALK_DEPTH_M)],
        ..Object::default()
    });
}

#[cfg(test)]
mod tests {
    use super::*;

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
