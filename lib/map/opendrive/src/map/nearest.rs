//! The nearest lane, in three dimensions.

use nalgebra::Point3;

use super::tree::{LaneIndex, Segment};
use super::{LaneHit, LaneId, LaneInfo, Map};

/// The chains of segments stay this near to the true centre lines, metres; refinement makes up for it.
const CHAIN_TOLERANCE_M: f64 = 0.01;
/// Shortest stretch of s that makes a segment, unless it is a lane's only one.
const MIN_SEGMENT_M: f64 = 1e-9;
/// Steps of s shorter than this end the search; the distance is then exact to rounding.
const CONVERGED_M: f64 = 1e-9;

/// Samples all lanes; also writes down their lengths and widths.
pub(super) fn index(map: &mut Map) -> LaneIndex {
    let mut segments = Vec::new();
    for road in 0..map.network.roads.len() as u32 {
        for section in 0..map.section_count(road) as u16 {
            let samples = map.section_samples(road, section, CHAIN_TOLERANCE_M);
            let lanes = map.section(road, section).map_or(0..0, |span| span.lanes.clone());
            for i in lanes {
                let line = map.lane_polyline_at(map.lanes[i].id, &samples);
                let (mut length, mut narrow, mut wide) = (0.0, f64::INFINITY, 0.0_f64);
                for k in 0..line.s.len() {
                    let width = (line.left[k] - line.right[k]).norm();
                    (narrow, wide) = (narrow.min(width), wide.max(width));
                    if k == 0 {
                        continue;
                    }
                    let segment = Segment {
                        a: line.centre[k - 1],
                        b: line.centre[k],
                        s: [line.s[k - 1], line.s[k]],
                        lane: i as u32,
                    };
                    // The two sides of a sideways jump are no way to go.
                    if segment.s[1] - segment.s[0] > MIN_SEGMENT_M || line.s.len() == 2 {
                        length += (segment.b - segment.a).norm();
                        segments.push(segment);
                    }
                }
                if line.s.len() == 1 {
                    segments.push(Segment {
                        a: line.centre[0],
                        b: line.centre[0],
                        s: [line.s[0]; 2],
                        lane: i as u32,
                    });
                }
                map.lanes[i].length_m = length;
                map.lanes[i].width_range_m = [narrow.min(wide), wide];
            }
        }
    }
    LaneIndex::of(segments)
}

/// Most segments kept for refinement.
const MAX_CANDIDATES: usize = 64;

impl Map {
    /// The lane, among those that pass the filter, whose centre line is nearest to a point, in three
    /// dimensions (so that on an overpass the deck that the point is on answers). None only where no lane
    /// passes.
    ///
    /// Of lanes at the same distance the first by [`LaneId`] answers.
    pub fn nearest_lane(&self, point: Point3<f64>, filter: impl Fn(&LaneInfo) -> bool) -> Option<LaneHit> {
        self.nearest_in(&self.index, point, filter)
    }

    /// The nearest lane for motor traffic.
    #[must_use]
    pub fn nearest_driving_lane(&self, point: Point3<f64>) -> Option<LaneHit> {
        self.nearest_in(&self.drivable_index, point, |_| true)
    }

    fn nearest_in(
        &self,
        index: &LaneIndex,
        point: Point3<f64>,
        filter: impl Fn(&LaneInfo) -> bool,
    ) -> Option<LaneHit> {
        // The true line is within a tolerance of its chord: chords farther than the best one by two may not
        // win.
        let mut candidates = [(0.0_f64, 0_usize); MAX_CANDIDATES];
        let mut count = 0;
        let mut limit = f64::INFINITY;
        index.search(point, f64::INFINITY, |i, segment| {
            let distance2 = segment.distance2(point).0;
            if distance2 <= limit * limit && filter(&self.lanes[segment.lane as usize]) {
                let distance = distance2.sqrt();
                limit = limit.min(distance + 2.0 * CHAIN_TOLERANCE_M);
                if count == MAX_CANDIDATES {
                    count = keep(&mut candidates, |c| c.0 <= limit);
                }
                if count == MAX_CANDIDATES {
                    // Too many lanes lie on top of each other: the farthest gives way.
                    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
                    count -= 1;
                }
                candidates[count] = (distance, i);
                count += 1;
            }
            limit * limit
        });
        let candidates = &mut candidates[..count];
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut hit: Option<LaneHit> = None;
        for (distance, i) in candidates {
            if hit.is_some_and(|h| *distance > h.distance_m + CHAIN_TOLERANCE_M) {
                break;
            }
            hit = nearer(hit, self.refine(point, &index.segments[*i]));
        }
        hit
    }

    /// Every lane that passes the filter and whose centre line comes within `radius_m` of a point, at its
    /// nearest place, nearest lane first.
    pub fn lanes_within(
        &self,
        point: Point3<f64>,
        radius_m: f64,
        filter: impl Fn(&LaneInfo) -> bool,
    ) -> Vec<LaneHit> {
        let reach = radius_m.max(0.0) + CHAIN_TOLERANCE_M;
        let mut near: Vec<usize> = Vec::new();
        self.index.search(point, reach * reach, |i, segment| {
            if segment.distance2(point).0 <= reach * reach && filter(&self.lanes[segment.lane as usize]) {
                near.push(i);
            }
            reach * reach
        });
        let mut hits: Vec<LaneHit> =
            near.iter().filter_map(|i| self.refine(point, &self.index.segments[*i])).collect();
        hits.retain(|h| h.distance_m <= radius_m);
        hits.sort_by(|a, b| a.lane.cmp(&b.lane).then(a.distance_m.total_cmp(&b.distance_m)));
        hits.dedup_by_key(|h| h.lane);
        hits.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m).then(a.lane.cmp(&b.lane)));
        hits
    }

    /// The nearest place of one lane.
    #[must_use]
    pub fn project(&self, id: LaneId, point: Point3<f64>) -> Option<LaneHit> {
        self.nearest_in_chain(id, point)
    }

    fn nearest_in_chain(&self, id: LaneId, point: Point3<f64>) -> Option<LaneHit> {
        let lane = self.lane_index(id)?;
        let info = &self.lanes[lane];
        let samples = self.section_samples(id.road, id.section, CHAIN_TOLERANCE_M);
        let line = self.lane_polyline_at(info.id, &samples);
        let segments = (1..line.s.len()).map(|k| Segment {
            a: line.centre[k - 1],
            b: line.centre[k],
            s: [line.s[k - 1], line.s[k]],
            lane: lane as u32,
        });
        segments.fold(None, |hit: Option<LaneHit>, segment| {
            let distance = segment.distance2(point).0.sqrt();
            if hit.is_some_and(|h| distance > h.distance_m + 2.0 * CHAIN_TOLERANCE_M) {
                return hit;
            }
            nearer(hit, self.refine(point, &segment))
        })
    }

    /// The nearest place of the true centre line within a segment's stretch of s: the root of the offset's
    /// projection onto the tangent, by the secant method kept inside a shrinking bracket.
    fn refine(&self, point: Point3<f64>, segment: &Segment) -> Option<LaneHit> {
        let info = &self.lanes[segment.lane as usize];
        let [mut low, mut high] = segment.s;
        let (mut low_seen, mut high_seen) = (false, false);
        let mut s = low + (high - low) * segment.distance2(point).1;
        let mut place = self.centre_at(info.id, s)?;
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..60 {
            let slope = (point - place.0).dot(&place.1);
            if slope > 0.0 {
                (low, low_seen) = (s, true);
            } else {
                (high, high_seen) = (s, true);
            }
            // The rate of the slope is minus the squared speed where the line is straight, and is measured
            // from the second step on.
            let measured = last.map(|(s_last, slope_last)| (slope - slope_last) / (s - s_last));
            let rate = measured.filter(|r| *r < 0.0).unwrap_or(-place.1.norm_squared());
            let mut next = if rate < 0.0 { s - slope / rate } else { s };
            if next >= high {
                // The end of the stretch may be nearest; once it is known not to be, halving is safe.
                next = if high_seen { 0.5 * (low + high) } else { high };
            } else if next <= low {
                next = if low_seen { 0.5 * (low + high) } else { low };
            }
            if (next - s).abs() < CONVERGED_M {
                break;
            }
            last = Some((s, slope));
            s = next;
            place = self.centre_at(info.id, s)?;
        }
        let (centre, _, frame, width_m) = place;
        let offset = point - centre;
        Some(LaneHit {
            lane: info.id,
            s,
            t_m: offset.dot(&frame.left) * info.direction,
            distance_m: offset.norm(),
            width_m,
        })
    }
}

/// Moves the candidates that pass to the front and counts them.
fn keep(candidates: &mut [(f64, usize)], pass: impl Fn(&(f64, usize)) -> bool) -> usize {
    let mut kept = 0;
    for i in 0..candidates.len() {
        if pass(&candidates[i]) {
            candidates.swap(kept, i);
            kept += 1;
        }
    }
    kept
}

/// The nearer of two hits; at equal distance the first lane, then the smaller s.
fn nearer(a: Option<LaneHit>, b: Option<LaneHit>) -> Option<LaneHit> {
    match (a, b) {
        (Some(x), Some(y)) => {
            let order =
                x.distance_m.total_cmp(&y.distance_m).then(x.lane.cmp(&y.lane)).then(x.s.total_cmp(&y.s));
            Some(if order.is_le() { x } else { y })
        }
        (x, y) => x.or(y),
    }
}
