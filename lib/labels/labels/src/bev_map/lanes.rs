//! Lanes about an agent, as SimBEV2X's masks take them from the map.

use std::collections::{BTreeMap, BTreeSet};

use crate::bev::{LaneAreas, LaneStrip};
use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, LaneType, Map, MarkType, Marking};

/// Most samples that are skipped at the beginning of a road before a lane begins.
const SKIPPED_SAMPLES: usize = 2000;
/// Every so many samples one point of the middle is kept.
const MIDLINE_STEP: usize = 10;
/// Roads at one place that differ this much in height lie above one another, metres.
const CLEARANCE_M: f64 = 4.8;
/// Side of the squares of the plan in which that is looked for, metres.
const SQUARE_M: f64 = 4.0;

/// Collects lanes about agents; keeps what does not depend on them.
#[derive(Debug)]
pub struct LaneCollector<'m> {
    map: &'m Map,
    step_m: f64,
    multi_level: bool,
    has_sidewalks: bool,
    /// Samples of the lanes of junctions.
    crossing: BTreeMap<LaneId, Vec<Crossing>>,
}

/// A sample of a lane in a junction.
#[derive(Clone, Debug)]
struct Crossing {
    at: Point3<f64>,
    /// The sidewalk nearest to it, and those beside that.
    sidewalks: Vec<LaneId>,
}

/// Whether it counts as a driving lane there.
fn is_driving(lane: &LaneInfo) -> bool {
    lane.lane_type.is_drivable() || matches!(lane.lane_type, LaneType::Bus | LaneType::Taxi | LaneType::Hov)
}

/// Whether a marking counts: any but none, grass and kerbs.
fn counts(marking: &Marking) -> bool {
    !matches!(marking.mark_type, MarkType::None | MarkType::Grass | MarkType::Curb)
}

impl<'m> LaneCollector<'m> {
    /// For lanes of a map, sampled every so many metres along their roads.
    #[must_use]
    pub fn new(map: &'m Map, step_m: f64) -> Self {
        let has_sidewalks = map.lanes().iter().any(|lane| lane.lane_type.is_walkable());
        Self { map, step_m, multi_level: is_multi_level(map), has_sidewalks, crossing: BTreeMap::new() }
    }

    /// The lanes about a place.
    ///
    /// Road are all driving lanes with a sample nearer than `radius_m`, and beside them, outward from lane to
    /// lane, lanes for parking, bicycles and traffic of both directions, and borders, shoulders and lanes
    /// without use that are marked on a side; any other lane ends that walk. Sidewalks are those that another
    /// walk meets, outward over all lanes up to the next driving one; samples in junctions bring the sidewalk
    /// nearest to them and its neighbours, too.
    pub fn about(&mut self, place: Point3<f64>, radius_m: f64) -> LaneAreas {
        let (mut roads, mut sidewalks) = (BTreeSet::new(), BTreeSet::new());
        let map = self.map;
        for hit in map.lanes_within(place, radius_m, is_driving) {
            let Some(lane) = map.lane(hit.lane) else { continue };
            let near = |at: &Point3<f64>| (at - place).norm() < radius_m;
            for s in self.samples(lane) {
                if map.lane_point(lane.id, s, 0.0).is_some_and(|at| near(&at.position)) {
                    roads.insert(lane.id);
                    self.walk(lane, s, &mut roads, &mut sidewalks);
                }
            }
            if lane.junction.is_some() && self.has_sidewalks {
                let crossing = self.crossing(lane).iter().filter(|sample| near(&sample.at));
                sidewalks.extend(crossing.flat_map(|sample| sample.sidewalks.iter().copied()));
            }
        }
        let strips = |lanes: &BTreeSet<LaneId>, marked: bool| {
            lanes.iter().filter_map(|id| self.strip(*id, marked)).collect()
        };
        let in_reach =
            |ring: &&opendrive::Crosswalk| ring.polygon.iter().any(|p| (p - place).norm() < radius_m);
        LaneAreas {
            roads: strips(&roads, true),
            sidewalks: strips(&sidewalks, false),
            crosswalks: map.crosswalks().iter().filter(in_reach).map(|c| c.polygon.clone()).collect(),
            multi_level: self.multi_level,
        }
    }

    /// Values of s along a lane: multiples of the step.
    fn samples(&self, lane: &LaneInfo) -> impl Iterator<Item = f64> + use<> {
        let (step_m, end) = (self.step_m, lane.s_end);
        let first = (lane.s_start / step_m).ceil().max(0.0) as usize;
        let first = Some(first).filter(|first| *first <= SKIPPED_SAMPLES);
        first
            .into_iter()
            .flat_map(move |first| (first..).map(move |k| k as f64 * step_m).take_while(move |s| *s <= end))
    }

    /// Walks outward from a driving lane to both sides.
    fn walk(&self, from: &LaneInfo, s: f64, roads: &mut BTreeSet<LaneId>, sidewalks: &mut BTreeSet<LaneId>) {
        use LaneType::{Bidirectional, Biking, Border, Curb, None, Parking, Shoulder};
        let lanes = self.map.lanes_of(from.id.road, from.id.section);
        let Some(own) = lanes.iter().position(|lane| lane.id == from.id) else { return };
        let sides: [&mut dyn Iterator<Item = &LaneInfo>; 2] =
            [&mut lanes[own + 1..].iter(), &mut lanes[..own].iter().rev()];
        for side in sides {
            let mut beside_road = true;
            for lane in side.take_while(|lane| !is_driving(lane)) {
                match lane.lane_type {
                    _ if !beside_road => {}
                    Parking | Bidirectional | Biking => {
                        roads.insert(lane.id);
                    }
                    None | Shoulder | Border | Curb => {
                        let markings =
                            [self.map.left_marking(lane.id, s), self.map.right_marking(lane.id, s)];
                        if markings.iter().any(counts) {
                            roads.insert(lane.id);
                        }
                    }
                    _ => beside_road = false,
                }
                if lane.lane_type.is_walkable() {
                    sidewalks.insert(lane.id);
                }
            }
        }
    }

    fn crossing(&mut self, lane: &LaneInfo) -> &[Crossing] {
        if !self.crossing.contains_key(&lane.id) {
            let (map, is_walk) = (self.map, |lane: &LaneInfo| lane.lane_type.is_walkable());
            let sample = |s: f64| {
                let at = map.lane_point(lane.id, s, 0.0)?.position;
                let nearest = map.nearest_lane(at, is_walk)?.lane;
                let beside = [nearest.lane - 1, nearest.lane, nearest.lane + 1];
                let beside = beside.map(|lane| LaneId { lane, ..nearest }).into_iter();
                let sidewalks = beside.filter(|id| map.lane(*id).is_some_and(is_walk)).collect();
                Some(Crossing { at, sidewalks })
            };
            let samples = self.samples(lane).filter_map(sample).collect();
            self.crossing.insert(lane.id, samples);
        }
        self.crossing.get(&lane.id).map_or(&[], Vec::as_slice)
    }

    /// A lane's borders, middle and, where wanted, the points of its markings. None where it has no sample.
    fn strip(&self, id: LaneId, marked: bool) -> Option<LaneStrip> {
        let mut strip = LaneStrip::default();
        let mut centre = Vec::new();
        for s in self.samples(self.map.lane(id)?) {
            let point = |offset_m: f64| self.map.lane_point(id, s, offset_m).map(|at| at.position);
            let width_m = self.map.lane_width(id, s)?;
            centre.push(point(0.0)?);
            strip.left.push(point(0.5 * width_m)?);
            strip.right.push(point(-0.5 * width_m)?);
            let sides = [(1.0, self.map.left_marking(id, s)), (-1.0, self.map.right_marking(id, s))];
            for (side, marking) in sides.into_iter().filter(|(_, marking)| marked && counts(marking)) {
                let lines = if marking.mark_type.is_double() { 3.0 } else { 1.0 };
                strip.markings.push(point(side * 0.5 * (width_m - lines * marking.width_m))?);
            }
        }
        let last = centre.len().checked_sub(1)?;
        strip.midline =
            (0..=last).filter(|k| k % MIDLINE_STEP == 0 || *k == last).map(|k| centre[k]).collect();
        Some(strip)
    }
}

/// Whether driving lanes lie above one another anywhere.
fn is_multi_level(map: &Map) -> bool {
    let mut heights: BTreeMap<[i64; 2], [f64; 2]> = BTreeMap::new();
    for lane in map.lanes().iter().filter(|lane| is_driving(lane)) {
        let steps = (lane.s_length() / SQUARE_M).ceil().max(1.0) as usize;
        for k in 0..=steps {
            let s = lane.s_start + lane.s_length() * k as f64 / steps as f64;
            let Some(at) = map.lane_point(lane.id, s, 0.0).map(|at| at.position) else { continue };
            let square = [at.x, at.y].map(|v| (v / SQUARE_M).floor() as i64);
            let [low, high] = heights.entry(square).or_insert([at.z; 2]);
            (*low, *high) = (low.min(at.z), high.max(at.z));
        }
    }
    heights.values().any(|[low, high]| high - low >= CLEARANCE_M)
}

#[cfg(test)]
mod tests {
    use opendrive::{Cubic, RoadMark};
    use testkit::{both_ways, lane, map, road};

    use super::*;

    fn mark(mark_type: MarkType) -> Vec<RoadMark> {
        vec![RoadMark { mark_type, width_m: Some(0.2), ..RoadMark::default() }]
    }

    /// 100 m to the east. To the right of the middle: driving, parking, border, shoulder, sidewalk, border;
    /// to the left driving alone.
    fn street(border_mark: MarkType) -> Map {
        use LaneType::*;
        let mut section = both_ways(&[(Driving, 3.5)]);
        section.centre.marks = mark(MarkType::SolidSolid);
        section.right =
            [(Driving, 3.5), (Parking, 2.5), (Border, 0.5), (Shoulder, 1.0), (Sidewalk, 2.0), (Biking, 1.5)]
                .into_iter()
                .zip(1..)
                .map(|((lane_type, width), k)| lane(-k, lane_type, width))
                .collect();
        section.right[0].marks = mark(MarkType::Broken);
        section.right[1].marks = mark(border_mark);
        section.right[2].marks = mark(MarkType::None);
        section.right[3].marks = mark(MarkType::Curb);
        map(vec![road("1", [0.0, 0.0], 0.0, 100.0, section)])
    }

    /// Middles of strips, by their y, to the centimetre.
    fn offsets(strips: &[LaneStrip]) -> Vec<i64> {
        let mut offsets: Vec<i64> = strips.iter().map(|s| (s.midline[0].y * 100.0).round() as i64).collect();
        offsets.sort_unstable();
        offsets
    }

    #[test]
    fn shoulders_and_borders_count_where_they_are_marked() {
        let about = |border_mark| {
            let map = street(border_mark);
            LaneCollector::new(&map, 0.4).about(Point3::new(50.0, 0.0, 0.0), 200.0)
        };
        // Driving at -1.75 and 1.75, parking at -4.75, border at -6.25. The shoulder beyond has kerb and
        // nothing for markings; the sidewalk ends the walk before the bicycle lane.
        assert_eq!(offsets(&about(MarkType::Solid).roads), [-625, -475, -175, 175]);
        assert_eq!(offsets(&about(MarkType::Curb).roads), [-475, -175, 175], "a kerb is no marking");
        assert_eq!(offsets(&about(MarkType::Solid).sidewalks), [-850]);
    }

    #[test]
    fn lanes_are_sampled_along_the_road() {
        let map = street(MarkType::Solid);
        let areas = LaneCollector::new(&map, 0.4).about(Point3::new(50.0, 0.0, 0.0), 200.0);
        let strip = areas
            .roads
            .iter()
            .find(|s| s.midline[0].y < 0.0 && s.midline[0].y > -2.0)
            .expect("the right lane");
        // 0, 0.4, ... 100: 251 samples; of the middle every 4 m, the last one included.
        assert_eq!((strip.left.len(), strip.right.len(), strip.midline.len()), (251, 251, 26));
        assert!((strip.midline[1].x - 4.0).abs() < 1e-9 && (strip.midline[25].x - 100.0).abs() < 1e-6);
        assert!((strip.left[7].y - 0.0).abs() < 1e-9 && (strip.right[7].y + 3.5).abs() < 1e-9);
        // Inside the lane: the double line by 1.5 widths, the dashed one by half a width, without gaps.
        let lines: BTreeSet<i64> = strip.markings.iter().map(|p| (p.y * 1000.0).round() as i64).collect();
        assert_eq!(lines.into_iter().collect::<Vec<_>>(), [-3400, -300]);
        assert_eq!(strip.markings.len(), 2 * 251);
        assert!(areas.sidewalks.iter().all(|s| s.markings.is_empty()));
    }

    #[test]
    fn what_is_far_is_not_collected() {
        let map = street(MarkType::Solid);
        let mut collector = LaneCollector::new(&map, 0.4);
        assert!(collector.about(Point3::new(50.0, 60.0, 0.0), 50.0).roads.is_empty());
        assert_eq!(collector.about(Point3::new(50.0, 60.0, 0.0), 60.0).roads.len(), 1, "the left lane");
    }

    #[test]
    fn junctions_bring_the_sidewalks_beside_them() {
        let map = testkit::crossing(false);
        let areas = LaneCollector::new(&map, 0.4).about(Point3::origin(), 30.0);
        let all = map.lanes().iter().filter(|lane| lane.lane_type.is_walkable()).count();
        assert!(all == 0 || !areas.sidewalks.is_empty());
        assert!(!areas.multi_level);
    }

    #[test]
    fn a_bridge_makes_a_map_multi_level() {
        let street = |id, at, yaw, z| {
            let mut road = road(id, at, yaw, 100.0, both_ways(&[(LaneType::Driving, 3.5)]));
            road.elevation = vec![Cubic::constant(z)];
            road
        };
        let across = |z| {
            map(vec![street("1", [0.0, 0.0], 0.0, 0.0), street("2", [50.0, -50.0], frames::deg(90.0), z)])
        };
        assert!(is_multi_level(&across(6.0)));
        assert!(!is_multi_level(&across(4.0)));
    }
}
