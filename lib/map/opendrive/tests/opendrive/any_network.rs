//! Whatever a file can state, the questions about it have answers: no panic, no hang, no broken polygon.

use crate::any::Any;
use nalgebra::Point3;
use opendrive::*;
use proptest::prelude::*;

fn sound(area: &Area) -> bool {
    area.size_m2() >= 0.0
        && area.rings().all(|r| r.len() >= 3 && r.iter().all(|p| p.x.is_finite() && p.y.is_finite()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_question_has_an_answer(seed: u64) {
        let map = Map::new(Any(seed).network());
        for junction in 0..map.junctions().len() {
            prop_assert!(map.junction_area(junction).iter().all(sound));
        }
        for road in 0..map.network().roads.len() as u32 {
            prop_assert!(map.sidewalks(road).iter().all(|walk| sound(&walk.area) && !walk.lanes.is_empty()));
        }
        for line in map.stop_lines() {
            prop_assert!(line.lanes.iter().all(|p| map.lane(p.lane).is_some_and(|l| (0.0..=l.s_length()).contains(&p.along_m))));
            prop_assert!(line.signals.is_sorted_by(|a, b| a < b));
            prop_assert!(line.source != StopLineSource::Derived || !line.signals.is_empty());
        }
        for span in map.crosswalk_spans() {
            prop_assert!(span.along_m[0] <= span.along_m[1] && span.crosswalk < map.crosswalks().len());
        }
        for lane in map.lanes() {
            let at = |along_m| LanePos { lane: lane.id, along_m };
            let way = map.lane_way_m(lane.id, lane.s_start, lane.s_end);
            prop_assert!(way.is_some_and(|way| way >= 0.0));
            let ahead = map.junction_ahead(at(0.0), 200.0);
            prop_assert!(ahead.is_none_or(|a| a.what < map.junctions().len() && (0.0..=200.0).contains(&a.way_m)));
            for next in map.successors(lane.id) {
                prop_assert!(map.predecessors(*next).contains(&lane.id));
            }
            for before in map.predecessors(lane.id) {
                prop_assert!(map.successors(*before).contains(&lane.id));
            }
            let _ = map.lane_coordinates(lane.id, Point3::new(1.0, 2.0, 3.0));
        }
    }
}
