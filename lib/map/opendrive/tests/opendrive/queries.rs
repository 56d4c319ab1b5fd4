//! Areas, ways, stop lines, crossings: against what can be worked out by hand, and against brute force.

use crate::common::*;
use nalgebra::Point3;
use opendrive::*;
use proptest::prelude::*;

fn pos(lane: LaneId, along_m: f64) -> LanePos {
    LanePos { lane, along_m }
}

#[track_caller]
fn close(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} is not {b}");
}

#[test]
fn ways_lead_through_the_junction() {
    let map = Map::new(network());
    let from = pos(id(A, 0, -1), 25.0);
    // 25 m to the junction, then half a radian of a curve of 11.75 m radius.
    let route = map.route(from, pos(id(LEFT, 0, -1), 5.0), 100.0).expect("a way");
    close(route.way_m, 25.0 + 5.875, 1e-9);
    assert_eq!(route.lanes, [id(A, 0, -1), id(A, 1, -1), id(LEFT, 0, -1)]);
    let whole = 25.0 + 11.75 * std::f64::consts::FRAC_PI_2 + 30.0;
    let to = pos(id(C, 0, 1), 30.0);
    close(map.distance_ahead(from, to, 1e3).expect("a way"), whole, 1e-9);
    assert_eq!(map.distance_ahead(to, from, 1e3), None);
    assert_eq!(map.distance_ahead(from, to, whole - 0.01), None);
    // Against s, on the same lane.
    close(
        map.distance_ahead(pos(id(B, 0, 1), 10.0), pos(id(B, 0, 1), 30.0), 1e3).expect("a way"),
        20.0,
        1e-9,
    );
    assert_eq!(map.distance_ahead(pos(id(B, 0, 1), 30.0), pos(id(B, 0, 1), 10.0), 1e3), None);
}

#[test]
fn the_next_junction_is_found_from_before_and_not_from_after() {
    let map = Map::new(network());
    let ahead = map.junction_ahead(pos(id(A, 0, -1), 10.0), 1e3).expect("a junction");
    assert_eq!((ahead.what, ahead.pos.lane), (0, id(A, 1, -1)));
    close(ahead.way_m, 40.0, 1e-9);
    close(map.junction_ahead(pos(id(B, 0, 1), 10.0), 1e3).expect("a junction").way_m, 30.0, 1e-9);
    assert_eq!(map.junction_ahead(pos(id(A, 0, -1), 10.0), 39.0), None);
    // Inside it, and behind it, there is none ahead.
    assert_eq!(map.junction_ahead(pos(id(AHEAD, 0, -1), 1.0), 1e3), None);
    assert_eq!(map.junction_ahead(pos(id(C, 0, 1), 1.0), 1e3), None);
}

/// One lane round a circle of 300 m, linked to itself.
fn circle() -> Network {
    let lane = Lane { predecessors: vec![-1], successors: vec![-1], ..lane(-1, LaneType::Driving, 4.0) };
    let link = |contact| Some(RoadLink::Road { id: "o".to_owned(), contact });
    Network {
        roads: vec![Road {
            id: "o".to_owned(),
            length_m: 300.0,
            predecessor: link(ContactPoint::End),
            successor: link(ContactPoint::Start),
            plan_view: vec![Geometry {
                length_m: 300.0,
                curve: Curve::Arc { curvature: std::f64::consts::TAU / 300.0 },
                ..Geometry::default()
            }],
            sections: vec![LaneSection { right: vec![lane], ..LaneSection::default() }],
            ..Road::default()
        }],
        ..Network::default()
    }
}

#[test]
fn a_way_may_lead_round_a_loop() {
    let map = Map::new(circle());
    let lane = id(0, 0, -1);
    // The lane's middle runs 2 m outside the circle.
    let per_s = 1.0 + 2.0 * std::f64::consts::TAU / 300.0;
    let way = |from, to| map.distance_ahead(pos(lane, from), pos(lane, to), 1e4).expect("a way");
    close(way(10.0, 50.0), 40.0 * per_s, 1e-6);
    close(way(50.0, 10.0), 260.0 * per_s, 1e-6);
    close(way(50.0, 50.0), 0.0, 1e-9);
}

#[test]
fn curves_get_no_more_samples_than_they_need() {
    let map = Map::new(circle());
    for tolerance in [0.2, 0.02, 0.002] {
        // The outer border has the greatest radius; a chord of length c leaves an arc by c^2 / (8 radius).
        let radius = 300.0 / std::f64::consts::TAU + 4.0;
        let needed = std::f64::consts::TAU * radius / (8.0 * radius * tolerance).sqrt();
        let pieces = map.section_samples(0, 0, tolerance).len() - 1;
        assert!(pieces as f64 >= needed && pieces as f64 <= 2.2 * needed, "{pieces} pieces, {needed} needed");
    }
}

/// Two roads that a third splits into without connecting roads.
fn split() -> Network {
    let road = |name: &str, x_m: f64, section: LaneSection| Road {
        id: name.to_owned(),
        length_m: 40.0,
        plan_view: vec![Geometry { x_m, length_m: 40.0, ..Geometry::default() }],
        sections: vec![section],
        ..Road::default()
    };
    let right = |ids: &[i16]| LaneSection {
        right: ids.iter().map(|i| lane(*i, LaneType::Driving, 3.0)).collect(),
        ..LaneSection::default()
    };
    let junction = Some(RoadLink::Junction { id: "d".to_owned() });
    let mut trunk = road("trunk", 0.0, right(&[-1, -2]));
    trunk.successor = junction.clone();
    let mut main = road("main", 40.0, right(&[-1]));
    main.predecessor = junction.clone();
    let mut exit = road("exit", 40.0, right(&[-1]));
    exit.predecessor = junction;
    exit.lane_offset = vec![Cubic::constant(-3.0)];
    let connection = |to: &str, from: i16| Connection {
        id: to.to_owned(),
        incoming_road: "trunk".to_owned(),
        connecting_road: to.to_owned(),
        contact: ContactPoint::Start,
        lane_links: vec![LaneLink { from, to: -1, ..LaneLink::default() }],
        ..Connection::default()
    };
    Network {
        roads: vec![trunk, main, exit],
        junctions: vec![Junction {
            id: "d".to_owned(),
            kind: JunctionKind::Direct,
            connections: vec![connection("main", -1), connection("exit", -2)],
            ..Junction::default()
        }],
        ..Network::default()
    }
}

#[test]
fn direct_junctions_join_lanes_without_connecting_roads() {
    let map = Map::new(split());
    assert_eq!(map.successors(id(0, 0, -1)), [id(1, 0, -1)]);
    assert_eq!(map.successors(id(0, 0, -2)), [id(2, 0, -1)]);
    assert_eq!(map.predecessors(id(2, 0, -1)), [id(0, 0, -2)]);
    let ahead = map.junction_ahead(pos(id(0, 0, -2), 15.0), 1e3).expect("a junction");
    assert_eq!((ahead.what, ahead.pos), (0, pos(id(0, 0, -2), 40.0)));
    close(
        map.distance_ahead(pos(id(0, 0, -2), 15.0), pos(id(2, 0, -1), 5.0), 1e3).expect("a way"),
        30.0,
        1e-9,
    );
    assert_eq!(map.distance_ahead(pos(id(0, 0, -2), 15.0), pos(id(1, 0, -1), 5.0), 1e3), None);
    assert!(map.junction_area(0).is_empty());
}

#[test]
fn a_sidewalk_goes_on_from_section_to_section() {
    let map = Map::new(network());
    let walks = map.sidewalks(A);
    assert_eq!(walks.len(), 1);
    assert_eq!(walks[0].lanes, [id(A, 0, -2), id(A, 1, -2)]);
    // 2 m over 50 m, and the integral of 0.03 d^2 - 0.001 d^3 over its last 16 m.
    close(walks[0].area.size_m2(), 100.0 + 0.01 * 4096.0 - 0.000_25 * 65_536.0, 0.1);
    assert!(walks[0].area.contains(30.0, -4.0) && !walks[0].area.contains(30.0, -2.9));
    assert!(walks[0].area.outline.iter().all(|p| (p.z - 2.0).abs() < 1e-9));
    // Road "b" has no sidewalk.
    assert!(map.sidewalks(B).is_empty() && map.sidewalks(99).is_empty());
}

#[test]
fn a_junction_is_the_ground_of_its_lanes() {
    let map = Map::new(network());
    let areas = map.junction_area(0);
    assert_eq!(areas.len(), 1);
    let [told, inside] = check_area(&map, 0, 0.02, 60);
    assert!(told > 3500 && inside > 1500, "{inside} of {told}");
    // Straight on: 20 m by 3.5 m; the way back beside it, too; of the quarter ring (radii 10 and 13.5 m about
    // (50, 10.5)) what lies beyond both.
    let outside = |x: f64, y: f64| y > 4.0 && x > 50.0 && x - 50.0 < 14.0;
    let mut ring = 0.0;
    for i in 0..1400 {
        for k in 0..1400 {
            let (x, y) = (50.0 + 0.01 * (f64::from(i) + 0.5), -3.0 + 0.01 * (f64::from(k) + 0.5));
            let radius = ((x - 50.0) * (x - 50.0) + (y - 10.5) * (y - 10.5)).sqrt();
            ring += if outside(x, y) && y < 10.5 && (10.0..13.5).contains(&radius) { 1e-4 } else { 0.0 };
        }
    }
    close(areas[0].size_m2(), 140.0 + ring, 0.2);
}

#[test]
fn crossings_lie_where_the_polygon_meets_the_lane() {
    let map = Map::new(network());
    let spans = map.crosswalk_spans();
    // From x = 43.5 to 46.5 on a section that begins at 30 and ends at 50.
    let want = [(-1, [13.5, 16.5]), (1, [3.5, 6.5])];
    assert_eq!(spans.len(), 2);
    for (span, (lane, along)) in spans.iter().zip(want) {
        assert_eq!((span.crosswalk, span.lane), (0, id(A, 1, lane)));
        close(span.along_m[0], along[0], 1e-3);
        close(span.along_m[1], along[1], 1e-3);
    }
}

/// A line of paint across the right lane of road "a", with the given corners in its own coordinates.
fn stop_object(s: f64, corners: &[(f64, f64)]) -> Object {
    Object {
        id: "p".to_owned(),
        name: "Stop_Line 3".to_owned(),
        s,
        t: -1.25,
        hdg_rad: frames::deg(90.0),
        outlines: vec![Outline {
            closed: false,
            corners: corners
                .iter()
                .map(|&(u_m, v_m)| Corner::Local { u_m, v_m, z_m: 0.0, height_m: 0.0 })
                .collect(),
            ..Outline::default()
        }],
        ..Object::default()
    }
}

#[test]
fn a_light_without_a_line_gets_one() {
    let map = Map::new(network());
    let lines = map.stop_lines();
    assert_eq!(lines.len(), 1);
    let line = &lines[0];
    assert_eq!((line.source, &line.signals[..], line.width_m), (StopLineSource::Derived, &[0][..], 0.4));
    assert_eq!(line.lanes, [pos(id(A, 1, -1), 19.5)]);
    assert!((line.ends[0] - Point3::new(49.5, 0.5, 2.0)).norm() < 1e-9);
    assert!((line.ends[1] - Point3::new(49.5, -3.0, 2.0)).norm() < 1e-9);
}

#[test]
fn stated_stop_lines_take_the_light_of_their_lane() {
    // A chain of two, a flat ring, and a ring with a width: the first and second have the ordinary width.
    let shapes: [(&[(f64, f64)], f64); 3] = [
        (&[(-1.7, 0.0), (1.7, 0.0)], 0.4),
        (&[(-1.7, 0.0), (0.0, 1e-6), (1.7, 0.0)], 0.4),
        (&[(-1.7, -0.3), (1.7, -0.3), (1.7, 0.3), (-1.7, 0.3)], 0.6),
    ];
    for (corners, width) in shapes {
        let mut network = network();
        network.roads[0].objects.push(stop_object(47.0, corners));
        let lines = Map::new(network).stop_lines();
        assert_eq!(lines.len(), 1);
        let line = &lines[0];
        assert_eq!((line.source, &line.signals[..]), (StopLineSource::Object(1), &[0][..]));
        close(line.width_m, width, 1e-9);
        assert_eq!(line.lanes.len(), 1);
        assert_eq!(line.lanes[0].lane, id(A, 1, -1));
        close(line.lanes[0].along_m, 17.0, 1e-6);
        // Left of the driver first: t runs from -1.25 + 1.7 to -1.25 - 1.7, the lane offset has no part in
        // it.
        assert!((line.ends[0] - Point3::new(47.0, 0.45, 2.0)).norm() < 1e-5, "{}", line.ends[0]);
        assert!((line.ends[1] - Point3::new(47.0, -2.95, 2.0)).norm() < 1e-5);
    }
}

#[test]
fn a_line_just_inside_the_junction_or_across_the_whole_road_holds_the_lane_before() {
    let mut inside = network();
    inside.roads[1].objects.push(stop_object(1.0, &[(-1.7, 0.0), (1.7, 0.0)]));
    let mut wide = network();
    wide.roads[0].objects.push(stop_object(47.0, &[(-2.0, 0.0), (6.0, 0.0)]));
    for network in [inside, wide] {
        let lines = Map::new(network).stop_lines();
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].signals, [0]);
        assert_eq!(lines[0].lanes.iter().map(|p| p.lane).collect::<Vec<_>>(), [id(A, 1, -1)]);
    }
    // A line far before the light is another one, and one along the lane holds nobody.
    let mut network = network();
    network.roads[0].objects.push(stop_object(20.0, &[(-1.7, 0.0), (1.7, 0.0)]));
    network.roads[0].objects.push(stop_object(25.0, &[(0.0, -1.7), (0.0, 1.7)]));
    let lines = Map::new(network).stop_lines();
    let facts: Vec<_> = lines.iter().map(|l| (l.source, l.lanes.len(), l.signals.len())).collect();
    assert_eq!(
        facts,
        [
            (StopLineSource::Object(1), 1, 0),
            (StopLineSource::Object(2), 0, 0),
            (StopLineSource::Derived, 1, 1)
        ]
    );
}

#[test]
fn a_signal_may_stand_for_paint() {
    let mut network = network();
    network.roads[0].signals.push(Signal {
        id: "paint".to_owned(),
        name: "StopLine".to_owned(),
        kind: "roadMark".to_owned(),
        s: 48.0,
        validity: vec![LaneValidity { from: -1, to: -1 }],
        ..Signal::default()
    });
    let lines = Map::new(network).stop_lines();
    assert_eq!(lines.len(), 1);
    assert_eq!((lines[0].source, &lines[0].signals[..]), (StopLineSource::Signal(1), &[0][..]));
    assert!((lines[0].ends[0] - Point3::new(48.0, 0.5, 2.0)).norm() < 1e-9);
    assert!((lines[0].ends[1] - Point3::new(48.0, -3.0, 2.0)).norm() < 1e-9);
}

#[test]
fn the_speed_limit_at_a_place_is_that_of_its_lane() {
    let map = Map::new(network());
    close(map.speed_limit_at(Point3::new(2.0, -1.0, 2.0)).expect("limit"), 30.0 * 0.44704, 1e-12);
    close(map.speed_limit_at(Point3::new(6.0, -1.0, 2.0)).expect("limit"), 30.0 / 3.6, 1e-12);
    assert_eq!(map.speed_limit_at(Point3::new(100.0, -1.0, 2.0)), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn borders_stay_within_the_tolerance_everywhere(
        widths in prop::collection::vec([1.0..4.0f64, -0.02..0.02f64, -1e-3..1e-3f64, -1e-5..1e-5f64], 1..4),
        curve in 0.001..0.05f64, tolerance in 0.001..0.2f64,
    ) {
        // A width below zero counts as zero: a kink that no record announces.
        let width = |w: &[f64; 4], d: f64| w[0] + d * (w[1] + d * (w[2] + d * w[3]));
        prop_assume!(widths.iter().all(|w| (0..=40).all(|d| width(w, f64::from(d)) > 0.0)));
        let map = Map::new(winding(&widths, curve));
        let samples = map.section_samples(0, 0, tolerance);
        let lines = map.section_borders(0, 0, &samples);
        prop_assert_eq!(lines.len(), 2 * widths.len() + 1);
        for (k, pair) in samples.windows(2).enumerate() {
            // Every true border point, densely, against the chord of its own stretch.
            let dense: Vec<f64> = (0..=100).map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) * 0.01).collect();
            for (line, border) in map.section_borders(0, 0, &dense).iter().zip(&lines) {
                let (a, b) = (border[k], border[k + 1]);
                for p in line {
                    let part = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                    prop_assert!((p - (a + (b - a) * part)).norm() <= tolerance);
                }
            }
        }
    }

    #[test]
    fn lane_coordinates_are_the_inverse(
        s in 1.0..59.0f64, offset in -6.0..6.0f64, up in -2.0..2.0f64, lane in prop::sample::select(vec![-2i16, -1, 1, 2]),
    ) {
        let map = Map::new(winding(&[[3.0, 0.01, 1e-3, -1e-5], [2.5, -0.01, 0.0, 1e-5]], 0.03));
        let lane = id(0, 0, lane);
        let place = map.lane_point(lane, s, offset).expect("there");
        let (s_found, offset_found) = map.lane_coordinates(lane, place.position).expect("there");
        prop_assert!((s_found - s).abs() < 1e-7 && (offset_found - offset).abs() < 1e-7);
        // Above or under the surface, too.
        let width = |i: i16| map.lane_width(id(0, 0, i), s).expect("lane");
        let sign = f64::from(lane.lane.signum());
        let inside = if lane.lane.abs() == 2 { width(lane.lane.signum()) } else { 0.0 };
        let centre = 0.3 - 0.02 * s + sign * (inside + 0.5 * width(lane.lane));
        let t = centre + offset * map.lane(lane).expect("lane").direction;
        let above = map.road_pose(0, s, t, up).expect("there").translation();
        let (s_found, offset_found) = map.lane_coordinates(lane, above.into()).expect("there");
        prop_assert!((s_found - s).abs() < 1e-6 && (offset_found - offset).abs() < 1e-6);
    }

    #[test]
    fn ways_are_the_sums_of_small_steps(a in 0.0..60.0f64, b in 0.0..60.0f64, lane in prop::sample::select(vec![-2i16, -1, 1, 2])) {
        let map = Map::new(winding(&[[3.0, 0.01, 1e-3, -1e-5], [2.5, -0.01, 0.0, 1e-5]], 0.03));
        let lane = id(0, 0, lane);
        let at = |i: u32| map.lane_point(lane, a + (b - a) * f64::from(i) * 1e-4, 0.0).expect("there").position;
        let sum: f64 = (0..10_000).map(|i| (at(i + 1) - at(i)).norm()).sum();
        prop_assert!((map.lane_way_m(lane, a, b).expect("there") - sum).abs() < 1e-5);
    }
}
