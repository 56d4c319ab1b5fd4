//! Reads any bytes as an OpenDRIVE file. What is read survives writing, a map can be made of it, and the map
//! answers.

#![no_main]

use libfuzzer_sys::fuzz_target;
use nalgebra::Point3;
use opendrive::{Area, LanePos, Map, Network, read_bytes, write};

/// Most lanes, stripes and so on that are asked about: one input must not take long.
const ASKED: usize = 12;

fuzz_target!(|bytes: &[u8]| {
    let Ok(network) = read_bytes(bytes) else { return };
    let again = Network::parse(&write(&network)).expect("what was written can be read");
    let again = Network {
        warnings: network.warnings.clone(),
        unknown_elements: network.unknown_elements.clone(),
        ..again
    };
    assert!(again == network, "writing changed the network");
    ask(&Map::new(network));
});

fn ask(map: &Map) {
    let mut places = vec![Point3::origin(), Point3::new(10.0, -3.0, 1.0), Point3::new(1e6, 1e6, -1e4)];
    for lane in map.lanes().iter().take(ASKED) {
        let middle = 0.5 * (lane.s_start + lane.s_end);
        assert!(map.lane_width(lane.id, middle).is_some_and(|width| width >= 0.0), "a lane without width");
        places.extend(map.lane_point(lane.id, middle, 0.3).map(|p| p.position));
        let _ = map.lane_polyline(lane.id, 0.1);
        let _ = map.ahead(LanePos { lane: lane.id, along_m: 1.0 }, 50.0);
        let _ = map.behind(LanePos { lane: lane.id, along_m: 1.0 }, 50.0);
        let _ = (map.left_marking(lane.id, middle), map.lane_change(lane.id, middle));
        let _ = (map.speed_limit(lane.id, middle), map.lane_height(lane.id, middle));
        let pos = LanePos { lane: lane.id, along_m: 1.0 };
        let _ = (map.junction_ahead(pos, 300.0), map.lane_way_m(lane.id, lane.s_start, lane.s_end));
        let _ = map.distance_ahead(pos, LanePos { along_m: 2.0, ..pos }, 100.0);
        for next in map.successors(lane.id) {
            assert!(map.predecessors(*next).contains(&lane.id), "a link that leads one way only");
        }
    }
    for stripe in map.stripes().iter().take(ASKED) {
        let _ = map.stripe_strips(stripe, 0.1);
    }
    for signal in 0..map.signals().len().min(ASKED) {
        let _ = map.stop_points(signal);
    }
    for junction in 0..map.junctions().len().min(ASKED) {
        let _ = map.entry_lanes(junction);
        check(&map.junction_area(junction));
    }
    for road in 0..map.network().roads.len().min(ASKED) as u32 {
        let walks = map.sidewalks(road);
        check(&walks.into_iter().map(|walk| walk.area).collect::<Vec<_>>());
    }
    if map.objects().len() < 100 * ASKED && map.signals().len() < 100 * ASKED {
        for line in map.stop_lines() {
            assert!(line.lanes.iter().all(|pos| map.lane(pos.lane).is_some()), "a stop line on no lane");
        }
        let _ = map.crosswalk_spans();
    }
    for place in places {
        let _ = map.nearest_driving_lane(place);
        if let Some(hit) = map.nearest_lane(place, |_| true) {
            let _ = map.lane_coordinates(hit.lane, place);
        }
    }
}

fn check(areas: &[Area]) {
    for area in areas {
        assert!(area.rings().all(|ring| ring.len() >= 3) && area.size_m2() >= 0.0, "an area inside out");
    }
}
