//! What the map makes of virtual junctions, one-sided sections, rows of objects, and the like.

use crate::common;

use crate::common::id;
use nalgebra::Point3;
use opendrive::*;

/// The file's inertial frame, without the offset that its header states.
fn map() -> Map {
    let mut network = Network::parse(include_str!("../data/everything.xodr")).expect("the file is good");
    network.header.offset = HeaderOffset::default();
    Map::new(network)
}

#[test]
fn a_road_goes_on_through_a_virtual_junction_and_is_joined_in_its_middle() {
    let map = map();
    // Sections of the main street: 0 to 100, 100 to 110, 110 to 130, 130 on.
    let spans: Vec<f64> = (0..4).filter_map(|k| map.section_span(0, k)).map(|span| span[0]).collect();
    assert_eq!(spans, [0.0, 100.0, 110.0, 130.0]);
    assert_eq!(map.section_count(0), 4);
    // Straight on, on both sides, through all of them.
    for k in 0..3 {
        assert_eq!(map.successors(id(0, k, -1)), [id(0, k + 1, -1)]);
        assert_eq!(map.predecessors(id(0, k, 2)), [id(0, k + 1, 2)]);
    }
    // From the side road by the connecting road into the last section.
    assert_eq!(map.successors(id(1, 0, -1)), [id(2, 0, -1)]);
    assert_eq!(map.successors(id(2, 0, -1)), [id(0, 3, -1)]);
    assert_eq!(map.predecessors(id(0, 3, -1)), [id(0, 2, -1), id(2, 0, -1)]);
}

#[test]
fn traffic_leaves_the_main_road_where_a_connecting_road_begins() {
    let mut network = Network::parse(include_str!("../data/everything.xodr")).expect("the file is good");
    // The same connecting road the other way about, from the main road against s.
    network.roads[2].predecessor =
        Some(RoadLink::Along { id: "1".to_owned(), s: 130.0, direction: TrackDirection::Against });
    network.roads[2].successor = None;
    let lane = &mut network.roads[2].sections[0].right[0];
    (lane.predecessors, lane.successors) = (vec![1], Vec::new());
    network.junctions[0].connections[0].incoming_road = "1".to_owned();
    network.junctions[0].connections[0].lane_links[0] = LaneLink { from: 1, to: -1, overlap_m: None };
    let map = Map::new(network);
    assert_eq!(map.successors(id(0, 3, 1)), [id(2, 0, -1), id(0, 2, 1)]);
    assert_eq!(map.predecessors(id(2, 0, -1)), [id(0, 3, 1)]);
}

#[test]
fn one_sided_sections_keep_their_other_side() {
    let map = map();
    // The right side of the section from 100 m on is that of the section before.
    let lane = map.lane(id(0, 1, -1)).expect("there");
    assert_eq!(lane.lane_type, LaneType::Driving);
    assert_eq!(map.lane_width(id(0, 3, -2), 150.0), Some(0.5));
    assert_eq!(map.successors(id(0, 0, -2)), [id(0, 1, -2)]);
    // Lane 1 travels against s, unless it is travelled both ways.
    assert_eq!(map.predecessors(id(0, 0, 1)), [id(0, 1, 1)]);
}

#[test]
fn cut_records_hold_as_before() {
    let mut network = Network::parse(include_str!("../data/everything.xodr")).expect("the file is good");
    network.roads[0].sections.truncate(1);
    let whole = Map::new(Network {
        junctions: Vec::new(),
        roads: vec![network.roads[0].clone()],
        ..Network::default()
    });
    let cut = Map::new(Network { header: Header::default(), ..network });
    assert_eq!((whole.section_count(0), cut.section_count(0)), (1, 3));
    for lane in [-2, -1, 1, 2] {
        for (k, s) in [(0, 35.0), (0, 109.0), (1, 110.5), (1, 129.0), (2, 131.0), (2, 199.0)] {
            let (a, b) = (whole.lane_bounds(id(0, 0, lane), s), cut.lane_bounds(id(0, k, lane), s));
            let (a, b) = (a.expect("there"), b.expect("there"));
            assert!((a.outer - b.outer).norm() < 1e-12 && (a.inner - b.inner).norm() < 1e-12, "{lane} {s}");
            assert_eq!(whole.speed_limit(id(0, 0, lane), s), cut.speed_limit(id(0, k, lane), s));
            assert_eq!(whole.lane_height(id(0, 0, lane), s), cut.lane_height(id(0, k, lane), s));
            assert_eq!(whole.left_marking(id(0, 0, lane), s), cut.left_marking(id(0, k, lane), s));
        }
    }
}

#[test]
fn rows_follow_the_road_or_run_straight_and_change_their_size() {
    let map = map();
    let fence: Vec<&ObjectInfo> = map.objects().iter().filter(|o| o.id == "r1").collect();
    // One stretched object, four copies, three copies.
    assert_eq!(fence.len(), 1 + 4 + 3);
    let chain = &fence[0].outlines[0];
    assert_eq!((fence[0].size_m.x, fence[0].size_m.y, fence[0].size_m.z), (20.0, 0.2, 1.2));
    let last = chain.base.len() - 1;
    // t runs from 6 to 7; the surface is that of the road: slope 0.01, crossfall, shape, then the stated
    // offset.
    let at = |s: f64, t: f64, up: f64| map.road_point(0, s, t, up).expect("there");
    assert!((chain.base[0] - at(10.0, 6.0, 0.0)).norm() < 1e-12);
    assert!((chain.base[last] - at(30.0, 7.0, 0.5)).norm() < 1e-12);
    assert!((chain.height_m[0] - 1.0).abs() < 1e-12 && (chain.height_m[last] - 1.2).abs() < 1e-12);
    // Detached copies lie on the straight line between the row's ends; sizes grow from start to end.
    let (from, to) = (at(40.0, 6.0, 0.0), at(49.0, 6.9, 0.0));
    for (i, copy) in fence[1..5].iter().enumerate() {
        let part = i as f64 / 3.0;
        assert!((Point3::from(copy.pose.translation()) - (from + (to - from) * part)).norm() < 1e-12);
        assert!((copy.size_m.x - 2.0 * (0.2 + 0.3 * part)).abs() < 1e-12, "{}", copy.size_m);
    }
    assert!((fence[6].s - 65.0).abs() < 1e-12 && (fence[6].t - 6.0).abs() < 1e-12);
    // They stand at a right angle to the surface under them.
    let up = fence[6].pose.up();
    let [ahead, left] = [at(65.1, 6.0, 0.0), at(65.0, 6.1, 0.0)].map(|p| p - at(65.0, 6.0, 0.0));
    assert!(up.dot(&ahead).abs() < 1e-6 && up.dot(&left).abs() < 1e-6 && up.z > 0.99);
}

#[test]
fn strokes_are_painted_one_by_one() {
    let map = map();
    let found: Vec<(f64, f64, f64, f64)> = (map.stripes_of(0, 0).iter())
        .filter(|s| s.border_of == 1 && s.dash.is_none() && s.s_end - s.s_start < 50.0)
        .map(|s| (s.s_start, s.s_end, s.t_offset_m, s.width_m))
        .collect();
    assert_eq!(found, [(3.0, 4.5, 0.2, 0.2), (8.0, 10.5, -0.2, 0.15)]);
}

#[test]
fn many_dashes_on_a_long_curve_are_painted_without_looking_at_all_of_it_each_time() {
    let line = MarkLine { length_m: 0.1, space_m: 0.1, ..MarkLine::default() };
    let mark = RoadMark { mark_type: MarkType::Broken, lines: vec![line], ..RoadMark::default() };
    let road = Road {
        id: "1".to_owned(),
        length_m: 8000.0,
        plan_view: vec![Geometry {
            length_m: 8000.0,
            curve: Curve::Spiral { curvature_start: 0.0, curvature_end: 0.2 },
            ..Geometry::default()
        }],
        sections: vec![LaneSection {
            centre: Lane { marks: vec![mark], ..Lane::default() },
            right: vec![common::lane(-1, LaneType::Driving, 3.0)],
            ..LaneSection::default()
        }],
        ..Road::default()
    };
    let map = Map::new(Network { roads: vec![road], ..Network::default() });
    let dashes = map.stripe_strips(&map.stripes()[0], 1e-4);
    assert_eq!(dashes.len(), 40_000);
    let painted: f64 = dashes.iter().map(|d| (d.left[0] - d.left[d.left.len() - 1]).norm()).sum();
    assert!((painted - 4000.0).abs() < 30.0, "{painted}");
}

#[test]
fn signals_stand_where_they_really_stand_and_hold_where_they_are_given() {
    let map = map();
    let light = &map.signals()[0];
    let want = map.road_point(1, 5.0, 3.0, 3.5).expect("there");
    assert!((Point3::from(light.pose.translation()) - want).norm() < 1e-12);
    assert_eq!((light.s, light.lanes.contains(&id(0, 0, -1))), (95.0, true));
    let sign = &map.signals()[1];
    assert!((Point3::from(sign.pose.translation()) - Point3::new(94.0, 7.0, 4.0)).norm() < 1e-12);
}
