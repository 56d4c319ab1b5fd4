//! A small network made by hand: a street, a junction with a left turn and a way straight on, two streets after it.

#![allow(dead_code, reason = "each test file uses its part")]

use opendrive::*;

/// A lane of constant width.
pub(crate) fn lane(id: i16, lane_type: LaneType, width_m: f64) -> Lane {
    Lane { id, lane_type, widths: vec![Cubic::constant(width_m)], ..Lane::default() }
}

pub(crate) fn mark(mark_type: MarkType, colour: MarkColour) -> RoadMark {
    RoadMark { mark_type, colour, width_m: Some(0.15), ..RoadMark::default() }
}

fn road_link(id: &str, contact: ContactPoint) -> Option<RoadLink> {
    Some(RoadLink::Road { id: id.to_owned(), contact })
}

fn line(x_m: f64, y_m: f64, hdg_rad: f64, length_m: f64) -> Geometry {
    Geometry { s: 0.0, x_m, y_m, hdg_rad, length_m, curve: Curve::Line }
}

/// Street "a" runs 50 m east in two sections; the junction "j" spans 20 m; "b" goes on east, "c" leaves north.
pub(crate) fn network() -> Network {
    let junction = Some(RoadLink::Junction { id: "j".to_owned() });
    let two_way = |predecessors: [&[i16]; 2], successors: [&[i16]; 2]| {
        let link = |mut lane: Lane, i: usize| {
            lane.predecessors = predecessors[i].to_vec();
            lane.successors = successors[i].to_vec();
            lane
        };
        LaneSection {
            s: 0.0,
            left: vec![link(lane(1, LaneType::Driving, 3.5), 0)],
            centre: Lane { marks: vec![mark(MarkType::SolidBroken, MarkColour::Yellow)], ..Lane::default() },
            right: vec![link(lane(-1, LaneType::Driving, 3.5), 1), lane(-2, LaneType::Sidewalk, 2.0)],
            ..LaneSection::default()
        }
    };
    let mut first = two_way([&[], &[]], [&[1], &[-1]]);
    first.right[0].marks = vec![mark(MarkType::Broken, MarkColour::White)];
    first.right[0].speeds =
        vec![LaneSpeed { s_offset: 5.0, speed: Speed { max: 30.0, unit: SpeedUnit::KilometresPerHour } }];
    first.right[1].heights = vec![LaneHeight { s_offset: 0.0, inner_m: 0.12, outer_m: 0.15 }];
    let mut second = two_way([&[1], &[-1]], [&[], &[]]);
    second.s = 30.0;
    second.right[1].widths.push(Cubic { s: 4.0, a: 2.0, b: 0.0, c: 0.03, d: -0.001 });
    let a = Road {
        id: "a".to_owned(),
        name: "High & <Low> \"Street\"".to_owned(),
        length_m: 50.0,
        successor: junction.clone(),
        types: vec![RoadType {
            s: 0.0,
            kind: "town".to_owned(),
            speed: Some(Speed { max: 30.0, unit: SpeedUnit::MilesPerHour }),
            ..RoadType::default()
        }],
        plan_view: vec![line(0.0, 0.0, 0.0, 50.0)],
        elevation: vec![Cubic { s: 0.0, a: 2.0, b: 0.0, c: 0.0, d: 0.0 }],
        superelevation: vec![Cubic::constant(0.0)],
        shape: vec![Shape { s: 0.0, cubic_of_t: Cubic::constant(0.0) }],
        lane_offset: vec![Cubic::constant(0.5)],
        sections: vec![first, second],
        objects: vec![Object {
            id: "x1".to_owned(),
            kind: "crosswalk".to_owned(),
            s: 45.0,
            hdg_rad: frames::deg(90.0),
            outlines: vec![Outline {
                closed: true,
                corners: [(-4.0, -1.5), (4.0, -1.5), (4.0, 1.5), (-4.0, 1.5), (-4.0, -1.5)]
                    .map(|(u_m, v_m)| Corner::Local { u_m, v_m, z_m: 0.0, height_m: 0.0 })
                    .to_vec(),
                ..Outline::default()
            }],
            repeats: Vec::new(),
            validity: vec![LaneValidity { from: -1, to: 1 }],
            ..Object::default()
        }],
        signals: vec![Signal {
            id: "s1".to_owned(),
            s: 49.0,
            t: -6.0,
            z_offset_m: 0.1,
            orientation: Orientation::Along,
            dynamic: true,
            country: "OpenDRIVE".to_owned(),
            kind: "1000001".to_owned(),
            subtype: "-1".to_owned(),
            value: Some(-1.0),
            height_m: Some(1.2),
            validity: vec![LaneValidity::default()],
            ..Signal::default()
        }],
        bridges: vec![Bridge {
            id: "b".to_owned(),
            kind: "concrete".to_owned(),
            s: 10.0,
            length_m: 5.0,
            validity: vec![LaneValidity { from: -2, to: 1 }],
            ..Bridge::default()
        }],
        tunnels: vec![Tunnel {
            id: "t".to_owned(),
            name: "Under the hill".to_owned(),
            kind: TunnelType::Underpass,
            s: 20.0,
            length_m: 7.5,
            lighting: Some(0.8),
            daylight: Some(0.2),
            validity: vec![LaneValidity { from: -1, to: -1 }],
        }],
        ..Road::default()
    };
    let flat = |z| vec![Cubic::constant(z)];
    let one_way = |predecessor: i16, successor: i16| LaneSection {
        right: vec![Lane {
            predecessors: vec![predecessor],
            successors: vec![successor],
            ..lane(-1, LaneType::Driving, 3.5)
        }],
        ..LaneSection::default()
    };
    let reference = |s| SignalReference {
        id: "s1".to_owned(),
        s,
        validity: vec![LaneValidity { from: -1, to: -1 }],
        ..SignalReference::default()
    };
    let ahead = Road {
        id: "ahead".to_owned(),
        length_m: 20.0,
        junction: Some("j".to_owned()),
        predecessor: road_link("a", ContactPoint::End),
        successor: road_link("b", ContactPoint::Start),
        plan_view: vec![line(50.0, 0.5, 0.0, 20.0)],
        elevation: flat(2.0),
        sections: vec![one_way(-1, -1)],
        signal_references: vec![reference(0.0)],
        ..Road::default()
    };
    // A quarter circle to the left whose lane centre goes from (50, -1.25) to (61.75, 10.5).
    let quarter = std::f64::consts::FRAC_PI_2;
    let left = Road {
        id: "left".to_owned(),
        length_m: 10.0 * quarter,
        junction: Some("j".to_owned()),
        predecessor: road_link("a", ContactPoint::End),
        successor: road_link("c", ContactPoint::End),
        plan_view: vec![Geometry {
            curve: Curve::Arc { curvature: 0.1 },
            ..line(50.0, 0.5, 0.0, 10.0 * quarter)
        }],
        elevation: flat(2.0),
        sections: vec![one_way(-1, 1)],
        signal_references: vec![reference(0.0)],
        ..Road::default()
    };
    // The way back from "b" to "a".
    let back = Road {
        id: "back".to_owned(),
        length_m: 20.0,
        junction: Some("j".to_owned()),
        predecessor: road_link("b", ContactPoint::Start),
        successor: road_link("a", ContactPoint::End),
        plan_view: vec![line(70.0, 0.5, std::f64::consts::PI, 20.0)],
        elevation: flat(2.0),
        sections: vec![one_way(1, 1)],
        ..Road::default()
    };
    let mut b_section = two_way([&[], &[-1]], [&[], &[]]);
    b_section.right.truncate(1);
    let b = Road {
        id: "b".to_owned(),
        length_m: 40.0,
        predecessor: junction.clone(),
        plan_view: vec![line(70.0, 0.5, 0.0, 40.0)],
        elevation: flat(2.0),
        sections: vec![b_section.clone()],
        ..Road::default()
    };
    // "c" comes from the north to the junction: travel away from it runs against s, on lane 1.
    let c = Road {
        id: "c".to_owned(),
        length_m: 30.0,
        successor: junction,
        plan_view: vec![line(60.0, 40.5, -quarter, 30.0)],
        elevation: flat(2.0),
        sections: vec![LaneSection { left: b_section.left.clone(), ..LaneSection::default() }],
        ..Road::default()
    };
    let connection = |id: &str, from: (&str, i16), to: (&str, i16)| Connection {
        id: id.to_owned(),
        incoming_road: from.0.to_owned(),
        connecting_road: to.0.to_owned(),
        contact: ContactPoint::Start,
        lane_links: vec![LaneLink { from: from.1, to: to.1, ..LaneLink::default() }],
        ..Connection::default()
    };
    Network {
        header: Header {
            revision: (1, 7),
            name: "hand-made".to_owned(),
            bounds_m: Some([50.0, -10.0, 120.0, 0.0]),
            geo_reference: Some("+proj=tmerc +lat_0=1 <&>".to_owned()),
            ..Header::default()
        },
        roads: vec![a, ahead, left, back, b, c],
        junctions: vec![Junction {
            id: "j".to_owned(),
            name: "crossing".to_owned(),
            kind: JunctionKind::Default,
            connections: vec![
                connection("0", ("a", -1), ("ahead", -1)),
                connection("1", ("a", -1), ("left", -1)),
                connection("2", ("b", 1), ("back", -1)),
            ],
            controllers: vec![JunctionController {
                id: "k".to_owned(),
                kind: "0".to_owned(),
                sequence: Some(3),
            }],
            ..Junction::default()
        }],
        controllers: vec![Controller {
            id: "k".to_owned(),
            name: "main".to_owned(),
            sequence: None,
            signals: vec!["s1".to_owned()],
            ..Controller::default()
        }],
        ..Network::default()
    }
}

/// Index of a road of [`network`].
pub(crate) const A: u32 = 0;
pub(crate) const AHEAD: u32 = 1;
pub(crate) const LEFT: u32 = 2;
pub(crate) const BACK: u32 = 3;
pub(crate) const B: u32 = 4;
pub(crate) const C: u32 = 5;

pub(crate) fn id(road: u32, section: u16, lane: i16) -> LaneId {
    LaneId { road, section, lane }
}
