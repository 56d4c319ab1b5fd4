//! Streets: the roads between two junctions.

use opendrive::{
    Corner, Cubic, Lane, LaneHeight, LaneSection, LaneType, MarkColour, MarkType, Object, Orientation,
    Outline, Road, RoadType, Speed, SpeedUnit,
};
use std::f64::consts::PI;

use crate::assemble::Ids;
use crate::marks::{self, KERB_M, MarkFrom, clipped};
use crate::path::Path;
use crate::section::{CrossSection, Side};

/// Length of the stretch at each end that keeps the junction's lanes, metres.
const APPROACH_M: f64 = 10.0;
/// Way on which a gutter widens to a parking lane, metres.
const PARKING_TAPER_M: f64 = 6.0;
/// Way on which a median opens, metres.
const MEDIAN_TAPER_M: f64 = 15.0;
/// Least length of a stretch with medians or parking lanes, metres; shorter streets keep the junction's lanes.
const MIDDLE_MIN_M: f64 = 20.0;
/// Length of a parking space, metres.
const SPACE_M: f64 = 6.0;
/// Distance before a junction from which lanes must not be changed any more, metres.
const NO_CHANGE_M: f64 = 20.0;
/// Distance from a junction on which the centre line is continuous, metres.
const NO_OVERTAKING_M: f64 = 15.0;

/// Builds a street along a reference line, level at both ends, with a smooth rise between them.
pub(crate) fn street(ids: &mut Ids, name: &str, path: Path, z_m: [f64; 2], shape: &CrossSection) -> Road {
    let length = path.length_m;
    let mut road = Road {
        id: ids.next(),
        name: name.to_owned(),
        length_m: length,
        types: vec![road_type(shape.speed_limit_kmh)],
        plan_view: path.pieces,
        elevation: vec![ramp(z_m[0], z_m[1], length, 0.0)],
        ..Road::default()
    };
    let ends = [0.0, APPROACH_M, length - APPROACH_M];
    if shape.changes() && ends[2] - ends[1] >= MIDDLE_MIN_M {
        let middle = ends[2] - ends[1];
        road.sections = vec![
            section(shape, ends[0], ends[1], length, None),
            section(shape, ends[1], ends[2], length, Some(middle)),
            section(shape, ends[2], length, length, None),
        ];
        link_sections(&mut road.sections);
        for (side, sign) in [(&shape.left, 1.0), (&shape.right, -1.0)] {
            parking_spaces(ids, &mut road, side, sign, [ends[1], ends[2]], shape.median_m);
        }
    } else {
        road.sections = vec![section(shape, 0.0, length, length, None)];
    }
    road
}

/// The type record of a street or connecting road.
pub(crate) fn road_type(speed_limit_kmh: f64) -> RoadType {
    let speed = Speed { max: speed_limit_kmh, unit: SpeedUnit::KilometresPerHour };
    RoadType { s: 0.0, kind: "town".into(), speed: Some(speed), ..RoadType::default() }
}

/// The cubic from one value to another over `length`, level at both ends.
pub(crate) fn ramp(from: f64, to: f64, length: f64, s: f64) -> Cubic {
    let rise = to - from;
    Cubic {
        s,
        a: from,
        b: 0.0,
        c: 3.0 * rise / (length * length),
        d: -2.0 * rise / (length * length * length),
    }
}

/// A lane that stands a kerb's height above the carriageway.
pub(crate) fn raised() -> Vec<LaneHeight> {
    vec![LaneHeight { s_offset: 0.0, inner_m: KERB_M, outer_m: KERB_M }]
}

/// The section from `start` to `end`; `middle` is its length where median and parking lanes belong.
fn section(shape: &CrossSection, start: f64, end: f64, length: f64, middle: Option<f64>) -> LaneSection {
    let median = middle.filter(|_| shape.median_m > 0.0);
    let one_way = shape.left.lanes == 0 || shape.right.lanes == 0;
    let centre_marks: Vec<MarkFrom> = if one_way || median.is_some() {
        vec![(0.0, marks::none())]
    } else if shape.left.lanes > 1 || shape.right.lanes > 1 {
        vec![(0.0, marks::line(MarkType::SolidSolid, MarkColour::Yellow))]
    } else {
        let solid = marks::line(MarkType::Solid, MarkColour::Yellow);
        vec![
            (0.0, solid.clone()),
            (NO_OVERTAKING_M, marks::overtaking_line()),
            ((length - NO_OVERTAKING_M).max(NO_OVERTAKING_M), solid),
        ]
    };
    let mut section = LaneSection { s: start, ..LaneSection::default() };
    section.centre.marks = clipped(&centre_marks, start, end);
    section.left = side_lanes(&shape.left, 1, shape.median_m, [start, end, length], middle);
    section.right = side_lanes(&shape.right, -1, shape.median_m, [start, end, length], middle);
    section
}

/// The lanes of one side, from the inside out; `span` is the section's start and end and the road's length.
fn side_lanes(side: &Side, sign: i16, median_m: f64, span: [f64; 3], middle: Option<f64>) -> Vec<Lane> {
    let [start, end, length] = span;
    let mut lanes: Vec<Lane> = Vec::new();
    let mut add = |lane_type, widths, marks, heights| {
        let id = sign * (lanes.len() as i16 + 1);
        lanes.push(Lane { id, lane_type, widths, marks, heights, ..Lane::default() });
    };
    if let Some(middle) = middle.filter(|_| median_m > 0.0) {
        let widths = swelling(0.0, 0.5 * median_m, middle, MEDIAN_TAPER_M);
        let edge = marks::line(MarkType::Solid, MarkColour::Yellow);
        add(LaneType::Median, widths, vec![edge], raised());
    }
    for index in 0..side.lanes {
        let marks = if index + 1 < side.lanes {
            clipped(&divider(sign, length), start, end)
        } else {
            vec![marks::line(MarkType::Solid, MarkColour::White)]
        };
        add(LaneType::Driving, vec![Cubic::constant(side.lane_m)], marks, Vec::new());
    }
    let (edge_type, edge) = match (middle, side.parking_m) {
        (Some(middle), Some(parking)) => {
            (LaneType::Parking, swelling(side.gutter_m, parking, middle, PARKING_TAPER_M))
        }
        _ => (LaneType::Shoulder, vec![Cubic::constant(side.gutter_m)]),
    };
    add(edge_type, edge, vec![marks::kerb()], Vec::new());
    add(LaneType::Sidewalk, vec![Cubic::constant(side.sidewalk_m)], vec![marks::none()], raised());
    lanes
}

/// The line between two lanes of one direction: no change shortly before the junction ahead.
fn divider(sign: i16, length: f64) -> Vec<MarkFrom> {
    let solid = marks::line(MarkType::Solid, MarkColour::White);
    let broken = marks::line(MarkType::Broken, MarkColour::White);
    if sign < 0 {
        // Travel is along s: the junction ahead is at the end.
        vec![(0.0, broken), ((length - NO_CHANGE_M).max(0.0), solid)]
    } else {
        vec![(0.0, solid), (NO_CHANGE_M.min(length), broken)]
    }
}

/// A width that grows on a taper, stays, and shrinks again.
fn swelling(narrow: f64, wide: f64, length: f64, taper: f64) -> Vec<Cubic> {
    let taper = taper.min(0.4 * length);
    vec![
        ramp(narrow, wide, taper, 0.0),
        Cubic { s: taper, ..Cubic::constant(wide) },
        ramp(wide, narrow, taper, length - taper),
    ]
}

/// Links each lane to the one that goes on where it ends. Counted from the outside, the lanes of a side are the same
/// in every section; only a median is extra, on the inside.
fn link_sections(sections: &mut [LaneSection]) {
    for index in 1..sections.len() {
        let (before, after) = sections.split_at_mut(index);
        let (Some(before), Some(after)) = (before.last_mut(), after.first_mut()) else { continue };
        for (a, b) in [(&mut before.left, &mut after.left), (&mut before.right, &mut after.right)] {
            for (a, b) in a.iter_mut().rev().zip(b.iter_mut().rev()) {
                a.successors.push(b.id);
                b.predecessors.push(a.id);
            }
        }
    }
}

/// Parking spaces along the constant part of a parking lane, as objects; `sign` is that of t on its side.
fn parking_spaces(ids: &mut Ids, road: &mut Road, side: &Side, sign: f64, span: [f64; 2], median_m: f64) {
    let Some(width) = side.parking_m else { return };
    // Where a median still opens, t of the parking lane changes; spaces keep clear of it.
    let taper = if median_m > 0.0 { MEDIAN_TAPER_M } else { PARKING_TAPER_M };
    let (start, end) = (span[0] + taper, span[1] - taper);
    let count = ((end - start) / SPACE_M).floor().max(0.0) as u32;
    let first = start + 0.5 * (end - start - f64::from(count) * SPACE_M);
    let t = sign * (0.5 * median_m + side.driving_m() + 0.5 * width);
    for index in 0..count {
        let (length, half_length, half_width) = (SPACE_M, 0.5 * SPACE_M, 0.5 * width);
        road.objects.push(Object {
            id: ids.next(),
            name: "ParkingSpace".into(),
            kind: "parkingSpace".into(),
            s: first + (f64::from(index) + 0.5) * SPACE_M,
            t,
            hdg_rad: if sign > 0.0 { PI } else { 0.0 },
            orientation: if sign > 0.0 { Orientation::Against } else { Orientation::Along },
            length_m: Some(length),
            width_m: Some(width),
            height_m: Some(0.0),
            outlines: vec![rectangle(half_length, half_width)],
            ..Object::default()
        });
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
