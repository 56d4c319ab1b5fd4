//! Junctions: connecting roads, connections, crosswalks.

use frames::math::{acos, cos, sin_cos};
use opendrive::{
    Connection, ContactPoint, Junction, Lane, LaneLink, LaneSection, LaneType, MarkColour, MarkType, Object,
    Orientation, Road, RoadLink, RoadMark,
};
use std::f64::consts::{FRAC_PI_2, PI};

use crate::arm::{Arm, inner_m, next_to_the_right, opposite, runs};
use crate::fill::{close, fill};
use crate::ids::Ids;
use crate::marks;
use crate::movements::Movement;
use crate::path::{Bend, Path, Piece};
use crate::profile::{hermite, ramp, swing};
use crate::section::{EndStrip, Turn, Use};
use crate::street::{heights, lane_type, rectangle, road_type};

/// Straight metres beyond a street's end where there is a crosswalk, and where there is none.
const LEAD_M: [f64; 2] = [4.5, 0.5];
/// Middle of a crosswalk, metres beyond the street's end.
const CROSSWALK_AT_M: f64 = 2.5;
/// Extent of a crosswalk along the street, metres.
const CROSSWALK_DEPTH_M: f64 = 3.0;
/// Corners sharper than this are left without fillet: the streets go straight on.
pub(crate) const NEARLY_STRAIGHT_RAD: f64 = 0.05;
/// Room between a turn to the left and the kerb that it goes round, metres.
const KERB_ROOM_M: f64 = 0.3;
/// Narrower gaps between the directions need no asphalt of their own, metres.
const FILL_FROM_M: f64 = 0.3;

/// Straight metres that an arm keeps beyond its street's end.
pub(crate) fn lead_m(crosswalk: bool) -> f64 {
    LEAD_M[usize::from(!crosswalk)]
}

/// What is done about ground between the lanes of a junction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gaps {
    /// It is land.
    Leave,
    /// It is paved.
    Pave,
    /// Slits in the median are closed.
    Close,
}

/// What a junction is built from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan<'a> {
    pub(crate) name: &'a str,
    pub(crate) arms: &'a [Arm],
    pub(crate) kerb_radius_m: f64,
    pub(crate) gaps: Gaps,
    /// Radius of the carriageway of a turning circle, metres; 0 where there is none.
    pub(crate) circle_m: f64,
}

/// A junction's roads and its record, before signals.
#[derive(Debug)]
pub(crate) struct Built {
    pub(crate) junction: Junction,
    /// Connecting roads, in the order of `movements`.
    pub(crate) roads: Vec<Road>,
    pub(crate) movements: Vec<Movement>,
}

/// Builds the connecting roads of a junction.
pub(crate) fn junction(ids: &mut Ids, plan: &Plan<'_>, movements: Vec<Movement>) -> Built {
    let mut built = Built {
        junction: Junction { id: ids.next(), name: plan.name.to_owned(), ..Junction::default() },
        roads: Vec::new(),
        movements,
    };
    for movement in &built.movements {
        let road = connecting_road(ids, &built.junction.id, plan, movement);
        let section = road.sections.first();
        let lanes = section.iter().flat_map(|s| s.right.iter().chain(&s.left));
        built.junction.connections.push(Connection {
            id: built.junction.connections.len().to_string(),
            incoming_road: plan.arms[movement.from].road.clone(),
            connecting_road: road.id.clone(),
            contact: ContactPoint::Start,
            lane_links: lanes
                .flat_map(|lane| {
                    lane.predecessors.iter().map(|from| LaneLink {
                        from: *from,
                        to: lane.id,
                        ..LaneLink::default()
                    })
                })
                .collect(),
            ..Connection::default()
        });
        built.roads.push(road);
    }
    match plan.gaps {
        Gaps::Leave => {}
        Gaps::Pave => {
            // What goes round a kerb first: there is nothing but pavement up to the lanes on the left.
            let mut order: Vec<usize> = (0..built.roads.len()).collect();
            let turn = |i: &usize| {
                let movement = &built.movements[*i];
                plan.arms[movement.from].turn_to(&plan.arms[movement.to])
            };
            order.sort_by_key(|i| !built.movements[*i].corner || turn(i) > -NEARLY_STRAIGHT_RAD);
            fill(&mut built.roads, &order, plan.arms);
        }
        Gaps::Close => close(&mut built.roads, plan.arms),
    }
    for (index, arm) in plan.arms.iter().enumerate().filter(|(_, arm)| arm.crosswalk) {
        crosswalk(ids, &mut built, index, arm);
    }
    built
}

/// What lies inside of the lanes, from them inwards: the side's own strips, then on one-way roads those
/// beyond the reference line.
fn inside<'a>(own: &'a [EndStrip], other: &'a [EndStrip]) -> Vec<&'a EndStrip> {
    let first = own.iter().position(|s| s.kind.runs()).unwrap_or(own.len());
    let mut strips: Vec<&EndStrip> = own[..first].iter().rev().collect();
    if runs(other).next().is_none() {
        strips.extend(other);
    }
    strips
}

/// Order of strips beside the lanes, outwards or inwards: what has the same one at both ends goes on.
fn order(kind: Use) -> u8 {
    kind.outer_order().map_or(0, |o| o + 1)
}

/// A strip beside the lanes of a connecting road, as it is at the two ends.
type Beside<'a> = [Option<&'a EndStrip>; 2];

/// Pairs what lies beside the lanes at the two ends.
fn paired<'a>(entry: &[&'a EndStrip], exit: &[&'a EndStrip]) -> Vec<Beside<'a>> {
    let of = |strips: &[&'a EndStrip], k: u8| strips.iter().find(|s| order(s.kind) == k).copied();
    (0..5).map(|k| [of(entry, k), of(exit, k)]).filter(|pair| pair.iter().any(Option::is_some)).collect()
}

/// One connecting road. Its reference line is the inner (left) border of its first lane, and runs with the
/// traffic.
fn connecting_road(ids: &mut Ids, junction: &str, plan: &Plan<'_>, movement: &Movement) -> Road {
    let arms = plan.arms;
    let (from, to) = (&arms[movement.from], &arms[movement.to]);
    let (entry, exit) = (&from.lanes.entering, &to.lanes.leaving);
    let path = path(plan, movement);
    let length = path.length_m;

    let mut right: Vec<Lane> = Vec::new();
    let kerbs = [from.shape.entering(from.contact).kerb, to.shape.leaving(to.contact).kerb];
    let lane_of = |pair: Beside<'_>, id: i16, mark: RoadMark| {
        let width = |end: Option<&EndStrip>| end.map_or(0.0, |s| s.width_m);
        let kind = pair.into_iter().flatten().next().map_or(Use::Edge, |s| s.kind);
        Lane {
            id,
            lane_type: lane_type(kind),
            widths: vec![ramp(0.0, width(pair[0]), length, width(pair[1]))],
            marks: vec![mark],
            heights: heights(kind, kerbs[0] || kerbs[1]),
            predecessors: pair[0].iter().map(|s| s.lane).collect(),
            successors: pair[1].iter().map(|s| s.lane).collect(),
            ..Lane::default()
        }
    };
    let white = |kind| marks::line(kind, MarkColour::White);
    let straight = from.turn_to(to).abs() < NEARLY_STRAIGHT_RAD && movement.from != movement.to;
    let lanes = |strips, first: u8| runs(strips).skip(first.into()).take(movement.lanes.into());
    let rail = from.is_rail();
    for (k, (a, b)) in lanes(entry, movement.from_lane).zip(lanes(exit, movement.to_lane)).enumerate() {
        let last = k + 1 == usize::from(movement.lanes);
        // Along the straight kerb of a T junction the edge line goes on.
        let mark = match (movement.marked && !rail, last) {
            (true, false) => white(MarkType::Broken),
            (true, true) if movement.outer != [false; 2] => white(MarkType::Solid),
            (false, true) if movement.corner && straight => white(MarkType::Solid),
            _ => marks::none(),
        };
        right.push(lane_of([Some(a), Some(b)], -(right.len() as i16 + 1), mark));
    }
    let beyond = |strips: &'_ [EndStrip], on: bool| -> Vec<EndStrip> {
        strips.iter().filter(|s| on && s.kind.outer_order().is_some()).copied().collect()
    };
    let (outer_in, outer_out) = (beyond(entry, movement.outer[0]), beyond(exit, movement.outer[1]));
    for pair in paired(&outer_in.iter().collect::<Vec<_>>(), &outer_out.iter().collect::<Vec<_>>()) {
        let edge = pair.iter().flatten().any(|s| s.kind == Use::Edge);
        let mark = if edge && (kerbs[0] || kerbs[1]) { marks::kerb() } else { marks::none() };
        right.push(lane_of(pair, -(right.len() as i16 + 1), mark));
    }

    let left = left_lanes(plan, movement, length, &lane_of);
    let mut section = LaneSection { left, right, ..LaneSection::default() };
    section.centre.marks = vec![centre_mark(arms, movement)];
    let link = |arm: &Arm| Some(RoadLink::Road { id: arm.road.clone(), contact: arm.contact });
    Road {
        id: ids.next(),
        length_m: length,
        junction: Some(junction.to_owned()),
        predecessor: link(from),
        successor: link(to),
        types: vec![road_type(&from.shape)],
        elevation: vec![hermite(0.0, from.z_m, -from.slope, length, to.z_m, to.slope)],
        plan_view: path.pieces,
        sections: vec![section],
        ..Road::default()
    }
}

/// What lies to the left of a connecting road's lanes: the strips that both ends have inside, or paving.
fn left_lanes(
    plan: &Plan<'_>,
    movement: &Movement,
    length: f64,
    lane_of: &dyn Fn(Beside<'_>, i16, RoadMark) -> Lane,
) -> Vec<Lane> {
    let arms = plan.arms;
    let (from, to) = (&arms[movement.from], &arms[movement.to]);
    let (entry, exit) = (&from.lanes.entering, &to.lanes.leaving);
    let kerbs = from.shape.entering(from.contact).kerb || to.shape.leaving(to.contact).kerb;
    let rail = from.is_rail();
    let mut left: Vec<Lane> = Vec::new();
    let inner = |on: bool, own, other| if on { inside(own, other) } else { Vec::new() };
    let inner_in = inner(movement.inner[0], entry, &from.lanes.leaving);
    let inner_out = inner(movement.inner[1], exit, &to.lanes.entering);
    for pair in paired(&inner_in, &inner_out) {
        let edge = pair.iter().flatten().any(|s| s.kind == Use::Edge);
        let mark = if edge && (kerbs) { marks::kerb() } else { marks::none() };
        let lane = lane_of(pair, left.len() as i16 + 1, mark);
        let width = |end: Option<&EndStrip>| end.map_or(0.0, |s| s.width_m);
        // The border on its other side belongs to the opposite traffic, which swings aside in arcs, too.
        left.push(Lane { widths: swing(width(pair[0]), length, width(pair[1])), ..lane });
    }
    let between = [inner_m(entry, movement.from_lane), inner_m(exit, movement.to_lane)];
    if left.is_empty() && movement.lanes > 0 && !rail {
        // Only pockets lie further inside, on the way in; on the way out nothing.
        let pockets = from.entering().iter().take_while(|t| **t == Turn::Left).count();
        let innermost = movement.to_lane == 0 && usize::from(movement.from_lane) <= pockets;
        if innermost && is_opposite(arms, movement) && between.iter().all(|b| *b > FILL_FROM_M) {
            // Between the directions of a wide street the junction is paved, too.
            let widths = vec![ramp(0.0, between[0], length, between[1])];
            let marks = vec![marks::none()];
            left.push(Lane { id: 1, lane_type: LaneType::Shoulder, widths, marks, ..Lane::default() });
        }
    }
    left
}

fn is_opposite(arms: &[Arm], movement: &Movement) -> bool {
    movement.from != movement.to && opposite(arms, movement.from) == Some(movement.to)
}

/// The line on the left of a connecting road's lanes.
fn centre_mark(arms: &[Arm], movement: &Movement) -> RoadMark {
    let from = &arms[movement.from];
    let innermost = movement.from_lane == 0 && movement.to_lane == 0;
    let painted = movement.marked && !from.is_rail() && innermost;
    let lone = from.shape.is_one_way() || from.shape.median.through;
    if painted && (lone && movement.inner != [false; 2]) {
        marks::line(MarkType::Solid, MarkColour::Yellow)
    } else if painted && !lone && from.contact == ContactPoint::End {
        // Two directions side by side share one line: this one's.
        marks::line(MarkType::SolidSolid, MarkColour::Yellow)
    } else {
        marks::none()
    }
}

fn path(plan: &Plan<'_>, movement: &Movement) -> Path {
    let (from, to) = (&plan.arms[movement.from], &plan.arms[movement.to]);
    let inner =
        [inner_m(&from.lanes.entering, movement.from_lane), inner_m(&to.lanes.leaving, movement.to_lane)];
    let start = from.outward.turned(PI).moved(0.0, -inner[0]);
    let end = to.outward.moved(0.0, -inner[1]);
    if plan.circle_m > 0.0 {
        return bulb(plan, from, inner);
    }
    // Round a corner the kerb has the stated radius, and all borders are concentric with it.
    let follows_kerb = movement.corner && from.turn_to(to) < -NEARLY_STRAIGHT_RAD;
    let kerb = from.paved()[0];
    let bend = Bend {
        radius_m: if follows_kerb {
            plan.kerb_radius_m + kerb - inner[0]
        } else {
            left_turn_m(plan, movement, inner)
        },
        ease_m: 0.0,
        lead_in_m: from.lead_m,
        lead_out_m: to.lead_m,
    };
    Path::between(start, end, &bend)
}

/// Largest radius of a turn to the left round a kerb: its arc stays off the kerb's, which has the stated
/// radius. Infinite where there is no such kerb. `inner`: from the axes of both arms to the line, metres.
fn left_turn_m(plan: &Plan<'_>, movement: &Movement, inner: [f64; 2]) -> f64 {
    let (from, to) = (&plan.arms[movement.from], &plan.arms[movement.to]);
    let turn = from.turn_to(to);
    let around = next_to_the_right(plan.arms, movement.to) == Some(movement.from);
    if !around || movement.from == movement.to || turn < NEARLY_STRAIGHT_RAD {
        return f64::INFINITY;
    }
    // Both arcs are nearest to each other in the middle of the corner. Where two lines at a distance g meet
    // under the turn, an arc of radius R leaves g + (r - R) (1 - cos(turn / 2)) to a kerb of radius r there,
    // times 1 / cos.
    let gap = (from.paved()[1] + inner[0]).min(to.paved()[0] + inner[1]);
    plan.kerb_radius_m + (gap - KERB_ROOM_M).max(0.0) / (1.0 - cos(0.5 * turn))
}

/// Half the angle that each neck of a turning circle swings out by, from the geometry of three circles that
/// touch: the line turns right by the angle, left by half a turn and twice the angle, and right again.
///
/// `line_m`: distance of the line from the axis; `circle_m`, `neck_m`: radii of the line in the circle and
/// the necks.
pub(crate) fn neck_angle(line_m: f64, circle_m: f64, neck_m: f64) -> f64 {
    acos(((neck_m + line_m) / (circle_m + neck_m)).clamp(-1.0, 1.0))
}

/// Radius of the line in the necks, metres.
pub(crate) const NECK_M: f64 = 12.0;

/// Round a turning circle: the line keeps its distance from the kerb.
fn bulb(plan: &Plan<'_>, arm: &Arm, inner: [f64; 2]) -> Path {
    let kerb = arm.paved()[0];
    let circle = (plan.circle_m - (kerb - inner[0])).max(1.0);
    // Seen by traffic, the line lies to the left of its lane: on the axis or right of it.
    let line = 0.5 * (inner[0] + inner[1]);
    let angle = neck_angle(line, circle, NECK_M);
    let start = arm.outward.turned(PI).moved(0.0, -inner[0]);
    Path::chain(
        start,
        &[
            Piece::Line(arm.lead_m),
            Piece::Arc(-1.0 / NECK_M, angle * NECK_M),
            Piece::Arc(1.0 / circle, (PI + 2.0 * angle) * circle),
            Piece::Arc(-1.0 / NECK_M, angle * NECK_M),
            Piece::Line(arm.lead_m),
        ],
    )
}

/// From a turning circle's middle back to the end of its street, along the street, metres.
pub(crate) fn bulb_reach_m(line_m: f64, circle_m: f64) -> f64 {
    let (sin, _) = sin_cos(neck_angle(line_m, circle_m, NECK_M));
    (circle_m + NECK_M) * sin + LEAD_M[1]
}

/// A crosswalk over an arm from kerb to kerb, on the straight part of a connecting road that uses the arm.
fn crosswalk(ids: &mut Ids, built: &mut Built, index: usize, arm: &Arm) {
    let [entering, leaving] = arm.paved();
    let Some(place) = built.movements.iter().position(|m| m.from == index || m.to == index) else { return };
    let (movement, road) = (&built.movements[place], &mut built.roads[place]);
    // Lateral middle of the carriageway from the street's reference line, to the left of the travel
    // direction.
    let (s, middle, inner) = if movement.from == index {
        let inner = inner_m(&arm.lanes.entering, movement.from_lane);
        (CROSSWALK_AT_M, 0.5 * (leaving - entering), inner)
    } else {
        let inner = inner_m(&arm.lanes.leaving, movement.to_lane);
        (road.length_m - CROSSWALK_AT_M, 0.5 * (entering - leaving), inner)
    };
    let across = entering + leaving;
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
