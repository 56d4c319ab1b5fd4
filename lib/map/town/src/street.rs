//! Streets: the roads between two junctions.

use opendrive::{
    Corner, Lane, LaneHeight, LaneSection, LaneType, MarkColour, MarkType, Object, Orientation, Outline,
    Road, RoadType, Speed, SpeedUnit,
};
use std::f64::consts::PI;

use crate::TownError;
use crate::ids::Ids;
use crate::marks::{self, KERB_M, MarkFrom, clipped};
use crate::path::Path;
use crate::profile::Profile;
use crate::section::{CrossSection, Ending, RoadKind, Turn, Use};
use crate::strips::{PARKING_TAPER_M, Strip, Strips};
use crate::word::bicycles;

/// Length of a parking space, metres.
const SPACE_M: f64 = 6.0;
/// Distance before a junction from which lanes must not be changed any more, metres.
const NO_CHANGE_M: f64 = 20.0;
/// Distance from a junction on which the centre line is continuous, metres.
const NO_OVERTAKING_M: f64 = 15.0;
/// A turn pocket may be entered until this far before its end, metres.
const POCKET_CHANGE_M: f64 = 12.0;

/// A street that is ready to be built.
pub(crate) struct Plan<'a> {
    pub(crate) name: &'a str,
    pub(crate) path: Path,
    pub(crate) elevation: Profile,
    pub(crate) shape: &'a CrossSection,
    /// What is special about its start and its end.
    pub(crate) endings: [Ending; 2],
}

/// Builds a street.
pub(crate) fn street(ids: &mut Ids, plan: Plan<'_>) -> Result<Road, TownError> {
    let Plan { name, path, elevation, shape, endings } = plan;
    let strips = Strips::new(name, shape, &endings, path.length_m)?;
    let mut road = Road {
        id: ids.next(),
        name: name.to_owned(),
        length_m: path.length_m,
        types: vec![road_type(shape)],
        superelevation: crate::banking::banking(&path, shape).records(),
        plan_view: path.pieces,
        elevation: elevation.clipped(0.0, path.length_m),
        lane_offset: strips.offset.records(),
        ..Road::default()
    };
    let breaks = strips.breaks();
    let mut before: Option<[Vec<Option<i16>>; 2]> = None;
    for span in breaks.windows(2) {
        let (mut section, numbers) = section(shape, &strips, span[0], span[1], path.length_m);
        if let (Some(before), Some(last)) = (&before, road.sections.last_mut()) {
            link(last, &mut section, before, &numbers);
        }
        road.sections.push(section);
        before = Some(numbers);
    }
    parking_spaces(ids, &mut road, &strips);
    road.objects.extend(bicycles(ids, &strips));
    Ok(road)
}

/// The type record of a street or connecting road.
pub(crate) fn road_type(shape: &CrossSection) -> RoadType {
    let speed = Speed { max: shape.limit_kmh, unit: SpeedUnit::KilometresPerHour };
    let kind = match shape.kind {
        RoadKind::Town => "town",
        RoadKind::Rural => "rural",
        RoadKind::Motorway => "motorway",
        RoadKind::Rail => "unknown",
    };
    RoadType { s: 0.0, kind: kind.into(), speed: Some(speed), ..RoadType::default() }
}

/// The lane type of a strip.
pub(crate) fn lane_type(kind: Use) -> LaneType {
    match kind {
        Use::Median { .. } => LaneType::Median,
        Use::Lane(_) => LaneType::Driving,
        Use::Rail => LaneType::Rail,
        Use::Bike => LaneType::Biking,
        Use::Edge => LaneType::Shoulder,
        Use::Parking => LaneType::Parking,
        Use::Verge => LaneType::None,
        Use::Sidewalk => LaneType::Sidewalk,
    }
}

/// How far a strip stands above the carriageway.
pub(crate) fn heights(kind: Use, kerb: bool) -> Vec<LaneHeight> {
    let up = match kind {
        Use::Median { raised } => raised,
        Use::Verge => kerb,
        Use::Sidewalk => true,
        _ => false,
    };
    if up { vec![LaneHeight { s_offset: 0.0, inner_m: KERB_M, outer_m: KERB_M }] } else { Vec::new() }
}

/// One lane section, and the lane id of each strip in it (left, right).
fn section(
    shape: &CrossSection,
    strips: &Strips,
    start: f64,
    end: f64,
    length: f64,
) -> (LaneSection, [Vec<Option<i16>>; 2]) {
    let middle = 0.5 * (start + end);
    let mut section = LaneSection { s: start, ..LaneSection::default() };
    section.centre.marks = clipped(&centre_marks(shape, strips, middle, length), start, end);
    let mut numbers: [Vec<Option<i16>>; 2] = Default::default();
    for (side, right) in [false, true].into_iter().enumerate() {
        let all = if right { &strips.right } else { &strips.left };
        let facts = if right { &shape.right } else { &shape.left };
        let present: Vec<(&Strip, Use)> =
            all.iter().filter_map(|strip| Some((strip, strip.kind_at(middle)?))).collect();
        let sign = if right { -1 } else { 1 };
        let mut next = 0;
        numbers[side] = all
            .iter()
            .map(|strip| {
                strip.kind_at(middle).map(|_| {
                    next += sign;
                    next
                })
            })
            .collect();
        let lanes = present.iter().enumerate().map(|(i, (strip, kind))| {
            let outside = present.get(i + 1).map(|p| p.1);
            let marks = border_marks(*kind, outside, facts.kerb, right, length);
            Lane {
                id: sign * (i as i16 + 1),
                lane_type: lane_type(*kind),
                widths: strip.width.clipped(start, end),
                marks: clipped(&marks, start, end),
                heights: heights(*kind, facts.kerb),
                ..Lane::default()
            }
        });
        let lanes = lanes.collect();
        if right {
            section.right = lanes;
        } else {
            section.left = lanes;
        }
    }
    (section, numbers)
}

/// Links the lanes of strips that go on.
fn link(
    before: &mut LaneSection,
    after: &mut LaneSection,
    old: &[Vec<Option<i16>>; 2],
    new: &[Vec<Option<i16>>; 2],
) {
    for (a, b) in old.iter().flatten().zip(new.iter().flatten()) {
        let (Some(a), Some(b)) = (a, b) else { continue };
        let of = |section: &mut LaneSection, id: i16, to: i16, forward: bool| {
            let lanes = if id > 0 { &mut section.left } else { &mut section.right };
            if let Some(lane) = lanes.iter_mut().find(|l| l.id == id) {
                if forward { &mut lane.successors } else { &mut lane.predecessors }.push(to);
            }
        };
        of(before, *a, *b, true);
        of(after, *b, *a, false);
    }
}

/// What is painted in the middle of the street.
fn centre_marks(shape: &CrossSection, strips: &Strips, s: f64, length: f64) -> Vec<MarkFrom> {
    let inner = |side: &[Strip]| side.iter().find_map(|strip| strip.kind_at(s));
    let kinds = [inner(&strips.left), inner(&strips.right)];
    let median = kinds.iter().flatten().any(|k| matches!(k, Use::Median { .. }));
    let pocket = kinds.contains(&Some(Use::Lane(Turn::Left)));
    let solid = marks::line(MarkType::Solid, MarkColour::Yellow);
    if shape.kind == RoadKind::Rail || median {
        vec![(0.0, marks::none())]
    } else if shape.is_one_way() {
        // The left edge of the carriageway.
        vec![(0.0, solid)]
    } else if shape.left.lanes > 1 || shape.right.lanes > 1 || pocket {
        vec![(0.0, marks::line(MarkType::SolidSolid, MarkColour::Yellow))]
    } else if shape.left.lanes == 0 {
        vec![(0.0, marks::none())]
    } else {
        vec![
            (0.0, solid.clone()),
            (NO_OVERTAKING_M, marks::overtaking_line()),
            ((length - NO_OVERTAKING_M).max(NO_OVERTAKING_M), solid),
        ]
    }
}

/// What is painted on the border between a strip and the next one outwards.
fn border_marks(kind: Use, outside: Option<Use>, kerb: bool, right: bool, length: f64) -> Vec<MarkFrom> {
    let white = marks::line(MarkType::Solid, MarkColour::White);
    let mark = match (kind, outside) {
        (Use::Median { .. }, _) => marks::line(MarkType::Solid, MarkColour::Yellow),
        (Use::Lane(a), Some(Use::Lane(b))) => {
            let ahead_m = if a == Turn::Left || b == Turn::Right { POCKET_CHANGE_M } else { NO_CHANGE_M };
            return divider(right, length, ahead_m);
        }
        (Use::Lane(_) | Use::Bike, _) => white,
        (Use::Edge | Use::Parking, _) if kerb => marks::kerb(),
        _ => marks::none(),
    };
    vec![(0.0, mark)]
}

/// The line between two lanes of one direction: no change shortly before the junction ahead.
fn divider(right: bool, length: f64, ahead_m: f64) -> Vec<MarkFrom> {
    let solid = marks::line(MarkType::Solid, MarkColour::White);
    let broken = marks::line(MarkType::Broken, MarkColour::White);
    if right {
        // Travel is along s: the junction ahead is at the end.
        vec![(0.0, broken), ((length - ahead_m).max(0.0), solid)]
    } else {
        vec![(0.0, solid), (ahead_m.min(length), broken)]
    }
}

/// Parking spaces, as objects, where a parking lane has its full width and runs parallel to the reference
/// line.
fn parking_spaces(ids: &mut Ids, road: &mut Road, strips: &Strips) {
    for right in [false, true] {
        let side = if right { &strips.right } else { &strips.left };
        for (index, strip) in side.iter().enumerate() {
            for (from, to, _) in strip.spans.iter().filter(|span| span.2 == Use::Parking) {
                let (start, end) = (from + PARKING_TAPER_M, to - PARKING_TAPER_M);
                let width = strip.width.at(0.5 * (start + end));
                let count = ((end - start) / SPACE_M).floor().max(0.0) as u32;
                let first = start + 0.5 * (end - start - f64::from(count) * SPACE_M);
                for i in 0..count {
                    let s = first + (f64::from(i) + 0.5) * SPACE_M;
                    let t = strips.centre_t(right, index, s);
                    let ends = [s - 0.5 * SPACE_M, s + 0.5 * SPACE_M];
                    if ends.iter().any(|e| (strips.centre_t(right, index, *e) - t).abs() > 0.01) {
                        continue;
                    }
                    road.objects.push(Object {
                        id: ids.next(),
                        name: "ParkingSpace".into(),
                        kind: "parkingSpace".into(),
                        s,
                        t,
                        hdg_rad: if right { 0.0 } else { PI },
                        orientation: if right { Orientation::Along } else { Orientation::Against },
                        length_m: Some(SPACE_M),
                        width_m: Some(width),
                        height_m: Some(0.0),
                        outlines: vec![rectangle(0.5 * SPACE_M, 0.5 * width)],
                        ..Object::default()
                    });
                }
            }
        }
    }
}

/// A rectangle around an object's origin, counter-clockwise.
pub(crate) fn rectangle(half_u: f64, half_v: f64) -> Outline {
    let corner = |u: f64, v: f64| Corner::Local { u_m: u * half_u, v_m: v * half_v, z_m: 0.0, height_m: 0.0 };
    Outline {
        closed: true,
        corners: vec![corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)],
        ..Outline::default()
    }
}
