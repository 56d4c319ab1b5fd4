//! Paint on the road: lane markings, and what is none.

use nalgebra::Point3;
use opendrive::{LaneId, LaneInfo, Map, Stripe};

/// Chains of points keep this near to the true lines, metres.
const TOLERANCE_M: f64 = 0.02;
/// Chains are cut to pieces of about this length, so that few points of a long road are looked at, metres.
const PIECE_M: f64 = 40.0;
/// In junctions it is tried at this distance whether a marking is covered by another road's asphalt, metres.
const COVER_STEP_M: f64 = 1.0;
/// Half the width of the widest lane that covers markings, metres.
const COVER_REACH_M: f64 = 6.0;
/// Markings this near to a lane's border are not covered by it, metres.
const BORDER_M: f64 = 0.2;
/// Surfaces this near in height lie on one another, metres.
const STOREY_M: f64 = 1.0;

/// Where paint is wanted: rectangles of the plan, metres in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reach {
    /// Smallest x and y, then the largest.
    rectangles: Vec<[[f64; 2]; 2]>,
}

impl Reach {
    /// Adds all that is nearer than `radius_m` to one of some places (an agent's way), and somewhat more.
    pub fn add(&mut self, places_m: impl Iterator<Item = [f64; 3]>, radius_m: f64) {
        let mut around = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for place in places_m {
            for axis in 0..2 {
                around[0][axis] = around[0][axis].min(place[axis] - radius_m);
                around[1][axis] = around[1][axis].max(place[axis] + radius_m);
            }
        }
        self.rectangles.push(around);
    }

    /// Whether any of some points may be near: the box around them has a point in a rectangle.
    fn touches(&self, points: &[Point3<f64>]) -> bool {
        let low = |axis: usize| points.iter().fold(f64::INFINITY, |low, p| low.min(p[axis]));
        let high = |axis: usize| points.iter().fold(f64::NEG_INFINITY, |high, p| high.max(p[axis]));
        let (low, high) = ([low(0), low(1)], [high(0), high(1)]);
        let meets = |[from, to]: &[[f64; 2]; 2]| (0..2).all(|a| low[a] <= to[a] && high[a] >= from[a]);
        self.rectangles.iter().any(meets)
    }
}

/// Middles of the lane markings of a map that lie within reach, dashes and gaps alike: chains of points in
/// the world.
///
/// Lane markings are all painted lines beside a lane for vehicles, each line of a double one. In a junction
/// those are left out over which another road's lanes run: their asphalt has no lines.
#[must_use]
pub fn road_lines(map: &Map, reach: &Reach) -> Vec<Vec<Point3<f64>>> {
    let mut lines = Vec::new();
    for stripe in map.stripes().iter().filter(|stripe| stripe.mark_type.is_painted()) {
        if !beside(map, stripe).any(|lane| lane.is_paved() && !lane.lane_type.is_track()) {
            continue;
        }
        let (_, line) = map.stripe_line(stripe, TOLERANCE_M);
        let in_junction = beside(map, stripe).any(|lane| lane.junction.is_some());
        let visible =
            if in_junction && reach.touches(&line) { uncovered(map, stripe.road, &line) } else { vec![line] };
        let pieces = visible.iter().flat_map(|line| pieces(line));
        lines.extend(pieces.filter(|piece| reach.touches(piece)));
    }
    lines
}

/// Paint that is no lane marking, as points in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paint {
    /// Middles of stop lines: chains of points.
    pub stop_lines: Vec<Vec<Point3<f64>>>,
    /// Outlines of parking spaces: chains of points, the last one equal to the first.
    pub parking: Vec<Vec<Point3<f64>>>,
    /// Arrows and words: closed polygons, corners each once.
    pub arrows: Vec<Vec<Point3<f64>>>,
}

impl Paint {
    /// The paint of a map that lies within reach.
    #[must_use]
    pub fn of(map: &Map, reach: &Reach) -> Self {
        let stop_lines = map.stop_lines().into_iter().map(|line| line.ends.to_vec());
        let mut paint =
            Self { stop_lines: stop_lines.filter(|line| reach.touches(line)).collect(), ..Self::default() };
        for object in map.objects() {
            let ring = object.outlines.first().map_or(&[][..], |outline| &outline.base);
            if object.kind.eq_ignore_ascii_case("parkingspace") && ring.len() >= 3 && reach.touches(ring) {
                let closed = ring.iter().chain(ring.first());
                paint.parking.push(closed.copied().collect());
            }
        }
        let read = map.road_symbols().into_iter().flat_map(|symbol| symbol.areas);
        paint.arrows.extend(read.filter(|area| reach.touches(area)));
        paint
    }
}

/// The lanes on both sides of the border that carries a stripe.
fn beside<'m>(map: &'m Map, stripe: &Stripe) -> impl Iterator<Item = &'m LaneInfo> + use<'m> {
    let lanes = match stripe.border_of {
        0 => [-1, 1],
        lane => [lane, lane.saturating_add(lane.signum())],
    };
    let (road, section) = (stripe.road, stripe.section);
    lanes.into_iter().filter_map(move |lane| map.lane(LaneId { road, section, lane }))
}

/// The parts of a line that no lane of another road covers.
fn uncovered(map: &Map, road: u32, line: &[Point3<f64>]) -> Vec<Vec<Point3<f64>>> {
    let covered = |at: Point3<f64>| {
        let near = map.lanes_within(at, COVER_REACH_M, |lane| lane.id.road != road && lane.is_paved());
        // What runs along a lane's border is no more covered than uncovered.
        let inside = |hit: &&opendrive::LaneHit| hit.t_m.abs() < 0.5 * hit.width_m - BORDER_M;
        near.iter().filter(inside).any(|hit| {
            let there = map.lane_point(hit.lane, hit.s, 0.0);
            there.is_some_and(|there| (there.position.z - at.z).abs() < STOREY_M)
        })
    };
    let mut parts = vec![Vec::new()];
    for pair in line.windows(2) {
        let steps = ((pair[1] - pair[0]).norm() / COVER_STEP_M).ceil().max(1.0) as usize;
        for k in 0..steps {
            let ends = [k, k + 1].map(|k| pair[0] + (pair[1] - pair[0]) * (k as f64 / steps as f64));
            if covered(nalgebra::center(&ends[0], &ends[1])) {
                parts.push(Vec::new());
            } else if let Some(part) = parts.last_mut() {
                if part.is_empty() {
                    part.push(ends[0]);
                }
                part.push(ends[1]);
            }
        }
    }
    parts.retain(|part| part.len() > 1);
    parts
}

/// A chain cut to pieces that share their ends.
fn pieces(line: &[Point3<f64>]) -> Vec<Vec<Point3<f64>>> {
    let mut pieces: Vec<Vec<Point3<f64>>> = Vec::new();
    let mut length_m = PIECE_M;
    for pair in line.windows(2) {
        let steps = ((pair[1] - pair[0]).norm() / PIECE_M).ceil().max(1.0) as usize;
        let step = (pair[1] - pair[0]) / steps as f64;
        for k in 0..steps {
            if length_m >= PIECE_M {
                pieces.push(vec![pair[0] + step * k as f64]);
                length_m = 0.0;
            }
            if let Some(piece) = pieces.last_mut() {
                piece.push(pair[0] + step * (k + 1) as f64);
            }
            length_m += step.norm();
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use opendrive::{LaneType, MarkType, RoadMark};
    use testkit::{both_ways, map, road};

    use super::*;

    fn reach(at: [f64; 3], radius_m: f64) -> Reach {
        let mut reach = Reach::default();
        reach.add([at].into_iter(), radius_m);
        reach
    }

    /// 200 m to the east, a lane of 3.5 m each way, sidewalks of 2 m; marked in the middle and on both edges
    /// of the road.
    fn street() -> Map {
        let mut section = both_ways(&[(LaneType::Driving, 3.5), (LaneType::Sidewalk, 2.0)]);
        let mark = |mark_type| vec![RoadMark { mark_type, width_m: Some(0.12), ..RoadMark::default() }];
        section.centre.marks = mark(MarkType::SolidSolid);
        for side in [&mut section.left, &mut section.right] {
            for lane in side.iter_mut() {
                // The sidewalk's own border is marked, too: no vehicle drives beside it.
                lane.marks = mark(if lane.lane_type == LaneType::Driving {
                    MarkType::Broken
                } else {
                    MarkType::Solid
                });
            }
        }
        map(vec![road("1", [0.0, 0.0], 0.0, 200.0, section)])
    }

    #[test]
    fn dashes_are_whole_lines_and_double_lines_two() {
        let lines = road_lines(&street(), &reach([100.0, 0.0, 0.0], 500.0));
        let mut offsets: Vec<(i64, f64)> = Vec::new();
        for line in &lines {
            let y = line[0].y;
            assert!(line.iter().all(|p| (p.y - y).abs() < 1e-9), "a straight road");
            let length: f64 = line.windows(2).map(|w| w[1].x - w[0].x).sum();
            match offsets.iter_mut().find(|(at, _)| *at == (y * 1000.0).round() as i64) {
                Some((_, sum)) => *sum += length.abs(),
                None => offsets.push(((y * 1000.0).round() as i64, length.abs())),
            }
        }
        offsets.sort_by_key(|(at, _)| *at);
        // Edges at 3.5 m; the lines of the double one 0.12 m to either side.
        let at: Vec<i64> = offsets.iter().map(|(at, _)| *at).collect();
        assert_eq!(at, [-3500, -120, 120, 3500]);
        assert!(offsets.iter().all(|(_, length)| (length - 200.0).abs() < 1e-6), "{offsets:?}");
    }

    #[test]
    fn other_paint_has_lists_of_its_own() {
        let text = r#"<OpenDRIVE><header/><road id="1" length="50" junction="-1">
            <planView><geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry></planView>
            <lanes><laneSection s="0"><center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right></laneSection></lanes>
            <objects>
            <object id="1" type="parkingSpace" s="10" t="-6" zOffset="0" hdg="0"><outline>
            <cornerRoad s="8" t="-5" dz="0" height="0"/><cornerRoad s="13" t="-5" dz="0" height="0"/>
            <cornerRoad s="13" t="-7" dz="0" height="0"/><cornerRoad s="8" t="-7" dz="0" height="0"/></outline></object>
            <object id="2" type="roadMark" name="ArrowLeft" s="20" t="-2" zOffset="0" hdg="0" length="3" width="1"/>
            <object id="3" type="roadMark" name="StopLine" s="30" t="-2" zOffset="0" hdg="0" length="0.4" width="4"/>
            </objects></road></OpenDRIVE>"#;
        let map = testkit::map_from_text(text);
        let paint = Paint::of(&map, &reach([20.0, 0.0, 0.0], 30.0));
        assert_eq!((paint.stop_lines.len(), paint.parking.len(), paint.arrows.len()), (1, 1, 1));
        assert_eq!(paint.parking[0].len(), 5, "closed");
        let span = |axis: usize| {
            let all = paint.arrows[0].iter().map(|p| p[axis]);
            (all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max))
        };
        assert_eq!((span(0), span(1)), ((18.5, 21.5), (-2.5, -1.5)));
        assert!(paint.stop_lines[0].iter().all(|p| (p.x - 30.0).abs() < 0.5), "{:?}", paint.stop_lines);
        assert!(road_lines(&map, &reach([20.0, 0.0, 0.0], 30.0)).is_empty());
    }

    #[test]
    fn what_is_far_away_is_left_out() {
        let near = road_lines(&street(), &reach([20.0, 0.0, 0.0], 30.0));
        let last = near.iter().flatten().map(|p| p.x).fold(0.0, f64::max);
        assert!((50.0..=51.0 + 2.0 * PIECE_M).contains(&last), "{last}");
        assert!(road_lines(&street(), &reach([20.0, 500.0, 0.0], 30.0)).is_empty());
    }
}
