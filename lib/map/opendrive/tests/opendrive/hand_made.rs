//! A network small enough that every answer can be worked out by hand.

use crate::common::*;
use nalgebra::Point3;
use opendrive::*;
use proptest::prelude::*;

#[track_caller]
fn near(a: Point3<f64>, b: [f64; 3]) {
    let b = Point3::from(b);
    assert!((a - b).norm() < 1e-9, "{a} is not {b}");
}

#[test]
fn the_network_itself_is_sound() {
    // A reader that warned about everything would pass the round trip below.
    let mut broken = network();
    broken.roads[0].plan_view[0].length_m = 49.0;
    broken.roads[1].successor =
        Some(RoadLink::Road { id: "nowhere".to_owned(), contact: ContactPoint::Start });
    let warnings = Network::parse(&write(&broken)).expect("our own file").warnings;
    let texts: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(texts[0].contains("road a") && texts[0].contains("49.000 m"));
    assert!(texts[1].contains("road ahead") && texts[1].contains("nowhere"));
}

#[test]
fn what_is_written_reads_back_equal() {
    let network = network();
    let again = Network::parse(&write(&network)).expect("our own file");
    assert_eq!(again.warnings, []);
    assert_eq!(again, network);
}

#[test]
fn lanes_lie_where_widths_and_offset_put_them() {
    let map = Map::new(network());
    let right = map.lane_point(id(A, 0, -1), 10.0, 0.0).expect("lane");
    near(right.position, [10.0, 0.5 - 1.75, 2.0]);
    assert_eq!((right.heading_rad, right.width_m, right.metres_per_s), (0.0, 3.5, 1.0));
    let left = map.lane_point(id(A, 0, 1), 10.0, 1.0).expect("lane");
    // Lane 1 runs west: one metre to its left is south.
    near(left.position, [10.0, 0.5 + 1.75 - 1.0, 2.0]);
    assert!((left.heading_rad.abs() - std::f64::consts::PI).abs() < 1e-12);
    let bounds = map.lane_bounds(id(A, 0, 1), 10.0).expect("lane");
    near(bounds.inner, [10.0, 0.5, 2.0]);
    near(bounds.outer, [10.0, 4.0, 2.0]);
    assert_eq!((bounds.left, bounds.right), (bounds.inner, bounds.outer));
    // The widening sidewalk: 2 + 0.03 d^2 - 0.001 d^3, d counted from s = 34.
    let width = map.lane_width(id(A, 1, -2), 44.0).expect("lane");
    assert!((width - (2.0 + 3.0 - 1.0)).abs() < 1e-12);
    assert_eq!(map.lane_height(id(A, 0, -2), 1.0), Some([0.12, 0.15]));
    // On the curve the lane lies outside the reference line and is longer than it.
    let curve = map.lane_point(id(LEFT, 0, -1), 5.0, 0.0).expect("lane");
    assert!((curve.metres_per_s - 1.175).abs() < 1e-12);
    assert!((curve.heading_rad - 0.5).abs() < 1e-12);
    let length = map.lane(id(LEFT, 0, -1)).expect("lane").length_m;
    assert!((length - 11.75 * std::f64::consts::FRAC_PI_2).abs() < 0.02);
}

#[test]
fn sections_end_just_before_the_next_begins() {
    let map = Map::new(network());
    assert_eq!(map.section_span(A, 0), Some([0.0, 30.0_f64.next_down()]));
    assert_eq!(map.section_span(A, 1), Some([30.0, 50.0]));
    assert_eq!(map.section_span(A, 2), None);
}

#[test]
fn the_graph_follows_the_direction_of_travel() {
    let map = Map::new(network());
    assert_eq!(map.successors(id(A, 0, -1)), [id(A, 1, -1)]);
    assert_eq!(map.successors(id(A, 1, -1)), [id(AHEAD, 0, -1), id(LEFT, 0, -1)]);
    assert_eq!(map.successors(id(LEFT, 0, -1)), [id(C, 0, 1)]);
    assert_eq!(map.successors(id(AHEAD, 0, -1)), [id(B, 0, -1)]);
    assert_eq!(map.successors(id(B, 0, 1)), [id(BACK, 0, -1)]);
    assert_eq!(map.successors(id(BACK, 0, -1)), [id(A, 1, 1)]);
    assert_eq!(map.successors(id(A, 1, 1)), [id(A, 0, 1)]);
    assert_eq!(map.successors(id(A, 0, 1)), []);
    assert_eq!(map.predecessors(id(C, 0, 1)), [id(LEFT, 0, -1)]);
    // The lane that comes after begins where the one before ends.
    for lane in map.lanes() {
        for next in map.successors(lane.id) {
            let end = map.point_at(LanePos { lane: lane.id, along_m: lane.s_length() }).expect("end");
            let start = map.point_at(LanePos { lane: *next, along_m: 0.0 }).expect("start");
            assert!((end.position - start.position).norm() < 1e-6, "{:?} {next:?}", lane.id);
        }
    }
}

#[test]
fn ahead_and_behind_cross_the_junction() {
    let map = Map::new(network());
    let from = LanePos { lane: id(A, 0, -1), along_m: 25.0 };
    let ahead = map.ahead(from, 30.0);
    let want = [(AHEAD, 5.0), (LEFT, 5.0)];
    assert_eq!(ahead.len(), 2);
    for (got, (road, along)) in ahead.iter().zip(want) {
        assert_eq!(got.lane, id(road, 0, -1));
        assert!((got.along_m - along).abs() < 1e-9);
        let back = map.behind(*got, 30.0);
        assert_eq!(back.len(), 1);
        assert_eq!(back[0].lane, from.lane);
        assert!((back[0].along_m - 25.0).abs() < 1e-9);
    }
    assert!(map.ahead(from, 1e6).is_empty());
    // Against s: from "b" westwards, 10 m there, 20 m in the junction, 5 m on "a".
    let west = map.ahead(LanePos { lane: id(B, 0, 1), along_m: 30.0 }, 35.0);
    assert_eq!(west.len(), 1);
    assert_eq!(west[0].lane, id(A, 1, 1));
    near(map.point_at(west[0]).expect("place").position, [45.0, 2.25, 2.0]);
}

#[test]
fn neighbours_are_seen_from_the_driver() {
    let map = Map::new(network());
    assert_eq!(map.left_of(id(A, 0, -1)), Some(id(A, 0, 1)));
    assert_eq!(map.left_of(id(A, 0, 1)), Some(id(A, 0, -1)));
    assert_eq!(map.right_of(id(A, 0, -1)), Some(id(A, 0, -2)));
    assert_eq!(map.right_of(id(A, 0, 1)), None);
    assert!(!map.same_direction(id(A, 0, -1), id(A, 0, 1)));
    assert!(map.same_direction(id(A, 0, -1), id(A, 0, -2)));
}

#[test]
fn markings_are_seen_from_the_driver() {
    let map = Map::new(network());
    let right = map.right_marking(id(A, 0, -1), 3.0);
    assert_eq!((right.mark_type, right.colour, right.width_m), (MarkType::Broken, MarkColour::White, 0.15));
    assert_eq!(right.lane_change, LaneChange::Both);
    let left = map.left_marking(id(A, 0, -1), 3.0);
    assert_eq!((left.mark_type, left.colour), (MarkType::SolidBroken, MarkColour::Yellow));
    assert_eq!(map.left_marking(id(A, 0, 1), 3.0).mark_type, MarkType::SolidBroken);
    assert_eq!(map.right_marking(id(A, 0, 1), 3.0).mark_type, MarkType::None);
    assert_eq!(map.lane_change(id(A, 0, -1), 3.0), LaneChange::Right);
    // An increase mark lets lane ids grow: to the left along s, to the right against it.
    let mut network = network();
    network.roads[0].sections[0].centre.marks[0].lane_change = Some(MarkChange::Increase);
    let map = Map::new(network);
    assert_eq!(map.left_marking(id(A, 0, -1), 3.0).lane_change, LaneChange::Left);
    assert_eq!(map.left_marking(id(A, 0, 1), 3.0).lane_change, LaneChange::Right);
}

#[test]
fn stripes_cover_their_lines() {
    let map = Map::new(network());
    let stripes = map.stripes_of(A, 0);
    // Broken white at the right of lane -1; yellow double line at the centre, solid left, broken right.
    let facts: Vec<_> = stripes.iter().map(|s| (s.border_of, s.dash.is_some(), s.t_offset_m)).collect();
    assert_eq!(facts, [(-1, true, 0.0), (0, false, 0.15), (0, true, -0.15)]);
    let dashes = map.stripe_strips(&stripes[0], 0.05);
    assert_eq!(dashes.len(), 4); // 30 m in steps of 3 + 6
    near(dashes[1].left[0], [9.0, 0.5 - 3.5 + 0.075, 2.0]);
    near(dashes[1].right[1], [12.0, 0.5 - 3.5 - 0.075, 2.0]);
    for dash in &dashes {
        let area = Area { outline: dash.polygon(), holes: Vec::new() };
        assert!((area.size_m2() - 3.0 * 0.15).abs() < 1e-9);
    }
    let solid = map.stripe_strips(&stripes[1], 0.05);
    assert_eq!(solid.len(), 1);
    near(solid[0].left[0], [0.0, 0.5 + 0.15 + 0.075, 2.0]);
}

#[test]
fn signals_control_what_references_say() {
    let map = Map::new(network());
    let signal = &map.signals()[0];
    assert_eq!(signal.lanes, [id(AHEAD, 0, -1), id(LEFT, 0, -1)]);
    assert_eq!(map.signals_of_lane(id(LEFT, 0, -1)), [0]);
    assert!(map.signals_of_lane(id(A, 1, -1)).is_empty());
    near(signal.pose.translation().into(), [49.0, -6.0, 2.1]);
    let stops = map.stop_points(0);
    assert_eq!(stops.len(), 1);
    assert_eq!(stops[0].lane, id(A, 1, -1));
    near(map.point_at(stops[0]).expect("place").position, [50.0, -1.25, 2.0]);
    let group = &map.signal_groups()[0];
    assert_eq!(
        (group.junction, group.controllers[0].sequence, &group.controllers[0].signals[..]),
        (0, Some(3), &[0][..])
    );
    let junction = &map.junctions()[0];
    assert_eq!(junction.roads, [AHEAD, LEFT, BACK]);
    assert_eq!(junction.incoming, [id(A, 1, -1), id(B, 0, 1)]);
    assert_eq!(map.entry_lanes(0).len(), 3);
    assert_eq!(junction.signals, [0]);
    near(junction.bounds[0], [50.0, -3.0, 2.0]);
    assert!(map.junction_of(id(A, 0, 1)).is_none());
}

#[test]
fn crosswalks_ignore_the_lane_offset_and_the_repeated_corner() {
    let map = Map::new(network());
    let crosswalk = &map.crosswalks()[0];
    assert_eq!(crosswalk.polygon.len(), 4);
    // Its x axis points north: u is y, v is -x; the lane offset of 0.5 has no part in it.
    near(crosswalk.polygon[0], [46.5, -4.0, 2.0]);
    near(crosswalk.polygon[2], [43.5, 4.0, 2.0]);
}

#[test]
fn speed_limits_come_from_lane_road_or_the_lane_before() {
    let map = Map::new(network());
    let limit = |lane, s| map.speed_limit(lane, s).expect("limit");
    assert!((limit(id(A, 0, -1), 2.0) - 30.0 * 0.44704).abs() < 1e-12);
    assert!((limit(id(A, 0, -1), 6.0) - 30.0 / 3.6).abs() < 1e-12);
    assert!((limit(id(AHEAD, 0, -1), 6.0) - 30.0 * 0.44704).abs() < 1e-12);
    assert_eq!(map.speed_limit(id(B, 0, -1), 6.0), None);
}

#[test]
fn jumps_of_the_lane_offset_get_two_samples() {
    let mut network = network();
    let jump = 20.000_000_000_000_004;
    network.roads[0].lane_offset.push(Cubic { s: jump, a: 9.5, ..Cubic::default() });
    let map = Map::new(network);
    assert_eq!(map.section_samples(A, 0, 0.1), [0.0, jump.next_down(), jump, 30.0_f64.next_down()]);
    let line = map.lane_polyline(id(A, 0, -1), 0.1);
    near(line.left[1], [20.0, 0.5, 2.0]);
    near(line.left[2], [20.0, 9.5, 2.0]);
}

#[test]
fn left_hand_traffic_turns_every_lane_round() {
    let mut network = network();
    for road in &mut network.roads {
        road.rule = TrafficRule::Left;
    }
    let map = Map::new(network);
    assert_eq!(map.lane(id(A, 0, -1)).map(|l| l.direction), Some(-1.0));
    assert_eq!(map.successors(id(A, 1, -1)), [id(A, 0, -1)]);
    assert_eq!(map.successors(id(AHEAD, 0, -1)), [id(A, 1, -1)]);
}

#[test]
fn places_that_do_not_exist_answer_with_nothing() {
    let map = Map::new(network());
    for lane in [id(A, 0, 0), id(A, 0, 7), id(A, 9, -1), id(99, 0, -1), id(u32::MAX, u16::MAX, i16::MIN)] {
        assert!(map.lane(lane).is_none());
        assert!(map.lane_point(lane, 1.0, 0.0).is_none());
        assert!(map.lane_polyline(lane, 0.1).s.is_empty());
        assert!(map.successors(lane).is_empty() && map.left_of(lane).is_none());
        assert!(map.ahead(LanePos { lane, along_m: 0.0 }, 1.0).is_empty());
        assert_eq!(map.left_marking(lane, 0.0), Marking::default());
    }
    assert!(map.section_samples(99, 0, 0.1).is_empty());
    assert!(Map::new(Network::default()).nearest_driving_lane(Point3::origin()).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn borders_add_up_and_polylines_stay_within_tolerance(
        widths in prop::collection::vec([1.0..4.0f64, -0.02..0.02f64, -1e-3..1e-3f64, -1e-5..1e-5f64], 1..4),
        curve in 0.001..0.04f64, tolerance in 0.005..0.2f64, s in 0.0..60.0f64,
    ) {
        let map = Map::new(winding(&widths, curve));
        let mut t = 0.3 - 0.02 * s;
        for (i, w) in widths.iter().enumerate() {
            let d = s - 20.0;
            let width = if d < 0.0 { w[0] } else { w[0] + d * w[1] + d * d * w[2] + d * d * d * w[3] }.max(0.0);
            let lane = id(0, 0, i as i16 + 1);
            prop_assert!((map.lane_width(lane, s).expect("there") - width).abs() < 1e-12);
            let bounds = map.lane_bounds(lane, s).expect("there");
            prop_assert!((bounds.inner - map.road_point(0, s, t, 0.0).expect("there")).norm() < 1e-9);
            t += width;
            prop_assert!((bounds.outer - map.road_point(0, s, t, 0.0).expect("there")).norm() < 1e-9);
        }
        // Every true border point is within tolerance (and a little) of the sampled chain.
        let lane = id(0, 0, widths.len() as i16);
        let line = map.lane_polyline(lane, tolerance);
        prop_assert_eq!((line.s[0], line.s[line.s.len() - 1]), (0.0, 60.0));
        let k = line.s.partition_point(|x| *x <= s).clamp(1, line.s.len() - 1);
        let (a, b) = (line.left[k - 1], line.left[k]);
        let p = map.lane_bounds(lane, s).expect("there").outer;
        let part = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
        prop_assert!((p - (a + (b - a) * part)).norm() <= 1.3 * tolerance);
    }

    #[test]
    fn headings_point_along_the_lane(s in 1.0..59.0f64, lane in prop::sample::select(vec![-2i16, -1, 1, 2])) {
        let map = Map::new(winding(&[[3.0, 0.01, 1e-3, -1e-5], [2.5, -0.01, 0.0, 1e-5]], 0.03));
        let lane = id(0, 0, lane);
        let at = |s: f64| map.lane_point(lane, s, 0.0).expect("there");
        let h = 1e-5;
        let step = (at(s + h).position - at(s - h).position) / (2.0 * h);
        let point = at(s);
        prop_assert!((step.norm() - point.metres_per_s).abs() < 1e-6);
        let travel = step * map.lane(lane).expect("there").direction / step.norm();
        prop_assert!((point.pose().forward() - travel).norm() < 1e-6);
        // Offsets run along the road's cross-section, from which a widening lane turns by a few hundredths.
        let offset = map.lane_point(lane, s, 0.5).expect("there").position - point.position;
        prop_assert!((offset.norm() - 0.5).abs() < 1e-9);
        prop_assert!(offset.dot(&point.pose().rotate(nalgebra::Vector3::y())) > 0.49);
    }

    #[test]
    fn nearest_lane_agrees_with_dense_samples(x in -10.0..70.0f64, y in -30.0..30.0f64, z in -2.0..8.0f64) {
        let map = Map::new(winding(&[[3.0, 0.01, 1e-3, -1e-5], [2.5, -0.01, 0.0, 1e-5]], 0.03));
        let point = Point3::new(x, y, z);
        let hit = map.nearest_driving_lane(point).expect("there");
        let dense = map.lanes().iter().flat_map(|l| (0..=6000).map(move |i| (l.id, f64::from(i) * 0.01)));
        let best = dense.map(|(lane, s)| (map.lane_point(lane, s, 0.0).expect("there").position - point).norm())
            .fold(f64::INFINITY, f64::min);
        prop_assert!(hit.distance_m <= best + 1e-9);
        prop_assert!(hit.distance_m >= best - 0.01);
        let place = map.lane_point(hit.lane, hit.s, 0.0).expect("there");
        prop_assert!(((place.position - point).norm() - hit.distance_m).abs() < 1e-9);
    }
}
