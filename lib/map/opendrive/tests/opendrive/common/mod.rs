//! A small network made by hand: a street, a junction with a left turn and a way straight on, two streets
//! after it.

use nalgebra::Point3;
use opendrive::*;
use testkit::road_link;

pub(crate) use testkit::lane;

pub(crate) fn mark(mark_type: MarkType, colour: MarkColour) -> RoadMark {
    RoadMark { mark_type, colour, width_m: Some(0.15), ..RoadMark::default() }
}

fn line(x_m: f64, y_m: f64, hdg_rad: f64, length_m: f64) -> Geometry {
    Geometry { s: 0.0, x_m, y_m, hdg_rad, length_m, curve: Curve::Line }
}

/// Street "a" runs 50 m east in two sections; the junction "j" spans 20 m; "b" goes on east, "c" leaves
/// north.
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

/// A road whose records all vary, for comparison against slow sums.
pub(crate) fn winding(widths: &[[f64; 4]], curve: f64) -> Network {
    let lanes = |sign: i16| {
        let lane = |(i, w): (usize, &[f64; 4])| Lane {
            id: sign * (i as i16 + 1),
            lane_type: LaneType::Driving,
            widths: vec![Cubic::constant(w[0]), Cubic { s: 20.0, a: w[0], b: w[1], c: w[2], d: w[3] }],
            ..Lane::default()
        };
        widths.iter().enumerate().map(lane).collect::<Vec<_>>()
    };
    let piece = Curve::Spiral { curvature_start: -curve, curvature_end: curve };
    Network {
        roads: vec![Road {
            id: "1".to_owned(),
            length_m: 60.0,
            plan_view: vec![Geometry { length_m: 60.0, curve: piece, ..Geometry::default() }],
            elevation: vec![Cubic { s: 0.0, a: 1.0, b: 0.05, c: 1e-3, d: -1e-5 }],
            superelevation: vec![Cubic { s: 10.0, a: 0.0, b: 1e-3, c: 0.0, d: 0.0 }],
            lane_offset: vec![Cubic { s: 0.0, a: 0.3, b: -0.02, c: 0.0, d: 0.0 }],
            sections: vec![LaneSection { left: lanes(1), right: lanes(-1), ..LaneSection::default() }],
            ..Road::default()
        }],
        ..Network::default()
    }
}

/// How deep a place lies in a lane, by the lane's own coordinates alone, metres; negative outside.
fn depth_in_lane(map: &Map, lane: &LaneInfo, x: f64, y: f64) -> f64 {
    let z = map.lane_point(lane.id, lane.s_start, 0.0).expect("place").position.z;
    let hit = map.project(lane.id, Point3::new(x, y, z)).expect("place");
    let place = map.lane_point(lane.id, hit.s, 0.0).expect("place");
    let (sin, cos) = frames::math::sin_cos(place.heading_rad);
    let beyond = ((x - place.position.x) * cos + (y - place.position.y) * sin).abs();
    let from_ends = (hit.s - lane.s_start).min(lane.s_end - hit.s);
    (0.5 * hit.width_m - hit.t_m.abs()).min(if from_ends <= 0.0 { -beyond } else { from_ends })
}

/// Compares a junction's area with its lanes on a lattice of places; those within `margin_m` of a lane's
/// border decide nothing. Answers with the numbers of places that decide, and of those inside.
pub(crate) fn check_area(map: &Map, junction: usize, margin_m: f64, lattice: u32) -> [usize; 2] {
    let info = &map.junctions()[junction];
    let areas = map.junction_area(junction);
    let unpaved = [LaneType::None, LaneType::Median, LaneType::Curb, LaneType::Sidewalk, LaneType::Walking];
    // Each paved lane with its bounding box.
    let lanes =
        info.lanes.iter().map(|id| map.lane(*id).expect("lane")).filter(|l| !unpaved.contains(&l.lane_type));
    let boxed: Vec<(&LaneInfo, [f64; 4])> = lanes
        .map(|lane| {
            let line = map.lane_polyline(lane.id, 0.05);
            let far = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
            let span = line.left.iter().chain(&line.right).fold(far, |b, p| {
                [b[0].min(p.x - 0.1), b[1].min(p.y - 0.1), b[2].max(p.x + 0.1), b[3].max(p.y + 0.1)]
            });
            (lane, span)
        })
        .collect();
    let [low, high] = info.bounds;
    let (mut told, mut inside) = (0, 0);
    for i in 0..lattice {
        for k in 0..lattice {
            let part = |i: u32, shift: f64| (f64::from(i) + shift) / f64::from(lattice);
            let x = low.x - 1.0 + (high.x - low.x + 2.0) * part(i, 0.37);
            let y = low.y - 1.0 + (high.y - low.y + 2.0) * part(k, 0.59);
            let near = boxed.iter().filter(|(_, b)| x > b[0] && y > b[1] && x < b[2] && y < b[3]);
            let depths = near.map(|(lane, _)| depth_in_lane(map, lane, x, y));
            let deepest = depths.fold(f64::NEG_INFINITY, f64::max);
            if deepest.abs() <= margin_m {
                continue;
            }
            let got = areas.iter().filter(|a| a.contains(x, y)).count();
            assert_eq!(got, usize::from(deepest > 0.0), "junction {} at {x}, {y}: {deepest}", info.id);
            told += 1;
            inside += got;
        }
    }
    [told, inside]
}
