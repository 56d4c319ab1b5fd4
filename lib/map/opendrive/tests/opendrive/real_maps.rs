//! The CARLA towns, where they are at hand: counts, graph, and the traps they hold.

use crate::common;

use nalgebra::Point3;
use opendrive::*;
use testkit::real_map;

/// Roads, in junctions, junctions, connections, driving metres / 10, signals, dynamic, references,
/// controllers, crosswalks.
type Counts = [usize; 10];

fn counts(map: &Map) -> Counts {
    let network = map.network();
    let driving = map.lanes().iter().filter(|l| l.lane_type == LaneType::Driving);
    let metres: f64 = driving.map(LaneInfo::s_length).sum();
    [
        network.roads.len(),
        network.roads.iter().filter(|r| r.junction.is_some()).count(),
        network.junctions.len(),
        network.junctions.iter().map(|j| j.connections.len()).sum(),
        (metres / 10.0).round() as usize,
        map.signals().len(),
        map.signals().iter().filter(|s| s.dynamic).count(),
        network.roads.iter().map(|r| r.signal_references.len()).sum(),
        network.controllers.len(),
        map.crosswalks().len(),
    ]
}

#[test]
fn towns_hold_what_was_counted_in_them() {
    let expected: [(&str, Counts); 6] = [
        ("Town01", [122, 96, 12, 96, 640, 36, 36, 72, 36, 0]),
        ("Town02", [84, 64, 8, 64, 292, 24, 24, 48, 24, 0]),
        ("Town03", [369, 287, 35, 289, 1378, 38, 38, 112, 38, 73]),
        ("Town04", [276, 223, 27, 223, 3345, 43, 43, 121, 43, 27]),
        ("Town06", [200, 128, 23, 128, 2551, 19, 19, 82, 19, 14]),
        ("Town10HD", [108, 85, 9, 85, 595, 21, 17, 63, 16, 16]),
    ];
    for (name, want) in expected {
        let Some(map) = real_map(name) else { return };
        assert_eq!(counts(&map), want, "{name}");
        // Every light controls something, and there is a place to stop before it.
        for (i, signal) in map.signals().iter().enumerate().filter(|(_, s)| s.dynamic) {
            assert!(
                !signal.lanes.is_empty() && !map.stop_points(i).is_empty(),
                "{name} signal {}",
                signal.id
            );
        }
        sound(&map, name);
    }
}

/// The graph is symmetric and its lanes touch; the written file reads back equal.
fn sound(map: &Map, name: &str) {
    let mut loose = 0;
    for lane in map.lanes() {
        for next in map.successors(lane.id) {
            assert!(map.predecessors(*next).contains(&lane.id), "{name} {:?} {next:?}", lane.id);
            if lane.lane_type != LaneType::Driving {
                continue;
            }
            let end = map.point_at(LanePos { lane: lane.id, along_m: lane.s_length() }).expect("end");
            let start = map.point_at(LanePos { lane: *next, along_m: 0.0 }).expect("start");
            let turn = frames::wrap_pi(end.heading_rad - start.heading_rad).abs();
            loose += usize::from((end.position - start.position).norm() > 0.01 || turn > 0.1);
        }
        for before in map.predecessors(lane.id) {
            assert!(map.successors(*before).contains(&lane.id), "{name} {:?} {before:?}", lane.id);
        }
    }
    // One link of Town03 joins lanes that lie side by side.
    assert!(loose <= usize::from(name == "Town03"), "{name}: {loose} links do not touch");
    let again = Network::parse(&write(map.network())).expect("our own file");
    assert_eq!(Network { warnings: map.network().warnings.clone(), ..again }, *map.network());
}

#[test]
fn crosswalks_lie_on_lanes() {
    for name in ["Town03", "Town10HD"] {
        let Some(map) = real_map(name) else { return };
        for crosswalk in map.crosswalks() {
            assert!(crosswalk.polygon.len() == 4 || crosswalk.polygon.len() == 6, "{name} {}", crosswalk.id);
            // Its middle is on a lane, at the lane's height; placed with the lane offset it would miss by
            // metres.
            let sum = crosswalk.polygon.iter().fold(nalgebra::Vector3::zeros(), |sum, p| sum + p.coords);
            let centre = Point3::from(sum / crosswalk.polygon.len() as f64);
            let under = map.lanes_within(centre, 10.0, |l| l.lane_type != LaneType::Sidewalk);
            assert!(under.iter().any(|h| h.is_inside()), "{name} {} is on no lane", crosswalk.id);
        }
    }
}

#[test]
fn the_deck_that_a_point_is_on_answers() {
    let Some(map) = real_map("Town04") else { return };
    // Find a place of the lower road right under the upper one, 11 m apart.
    let lanes: Vec<_> = map.lanes().iter().filter(|l| l.lane_type == LaneType::Driving).collect();
    let mut found = 0;
    for lane in &lanes {
        let place = map.lane_point(lane.id, 0.5 * (lane.s_start + lane.s_end), 0.0).expect("lane").position;
        for height in [0.0, 11.0] {
            let query = Point3::new(place.x, place.y, height);
            let hit = map.nearest_driving_lane(query).expect("lane");
            let at = map.lane_point(hit.lane, hit.s, 0.0).expect("lane").position;
            if (at - query).norm() < 2.0 {
                assert!((at.z - height).abs() < 2.0);
                found += usize::from((place.z - height).abs() > 5.0);
            }
        }
    }
    assert!(found > 0, "no place under or over another road was met");
}

#[test]
fn the_nearest_lane_is_the_nearest_by_brute_force() {
    let Some(map) = real_map("Town10HD") else { return };
    let dense: Vec<Point3<f64>> = map
        .lanes()
        .iter()
        .filter(|l| l.lane_type == LaneType::Driving)
        .flat_map(|l| {
            let steps = (l.s_length() / 0.1).ceil().max(1.0);
            (0..=steps as usize).map(move |i| (l, l.s_start + l.s_length() * (i as f64 / steps)))
        })
        .filter_map(|(l, s)| Some(map.lane_point(l.id, s, 0.0)?.position))
        .collect();
    for i in 0..150 {
        // Points of a coarse lattice that does not line up with the town.
        let point = Point3::new(
            -120.0 + 17.3 * f64::from(i % 15),
            -70.0 + 21.7 * f64::from(i / 15),
            f64::from(i % 4),
        );
        let hit = map.nearest_driving_lane(point).expect("lane");
        let best = dense.iter().map(|p| (p - point).norm()).fold(f64::INFINITY, f64::min);
        assert!(hit.distance_m <= best + 1e-9, "{point}: {} > {best}", hit.distance_m);
        // A sample lies within half a step (and the lane's shift) of the true place.
        assert!(best <= hit.distance_m + 0.06, "{point}: {} < {best}", hit.distance_m);
    }
}

#[test]
fn junction_areas_are_the_ground_of_their_lanes() {
    for name in ["Town03", "Town04", "Town10HD"] {
        let Some(map) = real_map(name) else { return };
        let mut sums = [0, 0];
        for junction in 0..map.junctions().len() {
            let found = common::check_area(&map, junction, 0.05, 20);
            sums = [sums[0] + found[0], sums[1] + found[1]];
            for area in map.junction_area(junction) {
                assert!(area.size_m2() > 0.0 && area.rings().all(|r| r.len() >= 3));
            }
        }
        let lattice = 400 * map.junctions().len();
        assert!(10 * sums[0] > 9 * lattice && 5 * sums[1] > lattice, "{name}: {sums:?} of {lattice}");
    }
}

#[test]
fn every_signal_has_a_line_before_every_lane_it_holds() {
    for name in ["Town01", "Town03", "Town04", "Town06", "Town10HD"] {
        let Some(map) = real_map(name) else { return };
        let lines = map.stop_lines();
        for (i, signal) in map.signals().iter().enumerate().filter(|(_, s)| s.dynamic || s.is_stop_sign()) {
            for stop in map.stop_points(i) {
                let at = map.point_at(stop).expect("place").position;
                let own = lines.iter().filter(|l| l.signals.contains(&i));
                // Its line is no farther than lines of the file are looked for, and across the way.
                let found = own.filter(|l| {
                    let middle = nalgebra::center(&l.ends[0], &l.ends[1]);
                    (middle - at).norm() < 15.0 + 0.5 * (l.ends[1] - l.ends[0]).norm()
                });
                assert!(found.count() > 0, "{name}: signal {} has no line at {at}", signal.id);
            }
        }
        for line in &lines {
            assert!((0.5..40.0).contains(&(line.ends[1] - line.ends[0]).norm()));
            for pos in &line.lanes {
                let place = map.point_at(*pos).expect("place");
                let middle = nalgebra::center(&line.ends[0], &line.ends[1]);
                assert!((place.position - middle).norm() < 30.0 && (place.position.z - middle.z).abs() < 1.0);
                // Left is left.
                let (sin, cos) = frames::math::sin_cos(place.heading_rad);
                let way = line.ends[1] - line.ends[0];
                assert!(sin * way.x - cos * way.y > 0.0, "{name}: line at {middle} runs from right to left");
            }
        }
    }
}

#[test]
fn places_on_lanes_are_found_back() {
    for name in ["Town03", "Town04"] {
        let Some(map) = real_map(name) else { return };
        for (i, lane) in map.lanes().iter().enumerate().filter(|(_, l)| l.s_length() > 0.5) {
            let part = 0.05 + 0.9 * ((i * 37 % 100) as f64 / 100.0);
            let s = lane.s_start + part * lane.s_length();
            let width = map.lane_width(lane.id, s).expect("lane");
            let offset = (part - 0.5) * 0.9 * width;
            let place = map.lane_point(lane.id, s, offset).expect("lane").position;
            // Where a tight curve folds its inner side over, a place has two coordinates; both must give it
            // back.
            let (s_found, offset_found) = map.lane_coordinates(lane.id, place).expect("its own place");
            let again = map.lane_point(lane.id, s_found, offset_found).expect("lane").position;
            assert!((again - place).norm() < 1e-6, "{name} {:?} {s} {offset}", lane.id);
        }
    }
}

#[test]
fn words_of_towns_lie_on_their_lanes_before_junctions() {
    for (name, stops, arrows) in [("Town03", 22, 13), ("Town04", 10, 21), ("Town10HD", 3, 12)] {
        let Some(map) = real_map(name) else { return };
        let symbols = map.road_symbols();
        let of = |word: &str| symbols.iter().filter(|symbol| symbol.word == word).count();
        assert_eq!((of("STOP"), of("")), (stops, arrows), "{name}");
        for symbol in symbols.iter().filter(|symbol| symbol.word == "STOP") {
            // A lane that it lies in, readable by its traffic, who come to a junction: it ends soon.
            let lanes = map.lanes_within(symbol.place, 3.0, |lane| lane.lane_type == LaneType::Driving);
            let fits = |hit: &LaneHit| {
                let Some(here) = map.lane_point(hit.lane, hit.s, 0.0) else { return false };
                let (sin, cos) = frames::math::sin_cos(here.heading_rad);
                let mut corners = symbol.areas.iter().flatten().map(|p| p - symbol.place);
                let within = corners.all(|off| {
                    let (ahead, left) = (cos * off.x + sin * off.y, cos * off.y - sin * off.x);
                    (hit.t_m + left).abs() < 0.5 * hit.width_m && ahead.abs() < 2.01
                });
                let end = map.lane(hit.lane).map(|l| if l.direction > 0.0 { l.s_end } else { l.s_start });
                // Strokes of the P come last: its bow is to the right, and ahead.
                let bow = symbol.areas.last().into_iter().flatten().fold([0.0; 2], |sum, p| {
                    let off = p - symbol.place;
                    [sum[0] + cos * off.x + sin * off.y, sum[1] + cos * off.y - sin * off.x]
                });
                within && bow[0] > 0.0 && bow[1] < 0.0 && end.is_some_and(|end| (end - hit.s).abs() < 40.0)
            };
            assert!(lanes.iter().any(fits), "{name}: STOP at {}", symbol.place);
        }
    }
}
