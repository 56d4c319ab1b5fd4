//! The nearest lane, in three dimensions.

use nalgebra::Point3;

use super::{LaneHit, LaneId, LaneInfo, Map};

/// The chains of segments stay this near to the true centre lines, metres; refinement makes up for it.
const CHAIN_TOLERANCE_M: f64 = 0.01;
/// Segments in a leaf of the tree.
const LEAF: usize = 4;
/// Shortest stretch of s that makes a segment, unless it is a lane's only one.
const MIN_SEGMENT_M: f64 = 1e-9;
/// Steps of s shorter than this end the search; the distance is then exact to rounding.
const CONVERGED_M: f64 = 1e-9;
/// Deepest tree: 2^48 leaves.
const MAX_DEPTH: usize = 48;

/// A piece of a lane's centre line.
#[derive(Clone, Copy, Debug)]
struct Segment {
    a: Point3<f64>,
    b: Point3<f64>,
    s: [f64; 2],
    lane: u32,
}

impl Segment {
    /// Squared distance to a point, and the nearest part of the way from `a` to `b`.
    fn distance2(&self, point: Point3<f64>) -> (f64, f64) {
        let (way, to) = (self.b - self.a, point - self.a);
        let length2 = way.norm_squared();
        let part = if length2 > 0.0 { (to.dot(&way) / length2).clamp(0.0, 1.0) } else { 0.0 };
        ((to - way * part).norm_squared(), part)
    }
}

/// A box of the tree: an inner node's first child follows it, its second is `other`; a leaf has `count` segments
/// from `other` on.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [f64; 3],
    max: [f64; 3],
    other: u32,
    count: u32,
}

impl Node {
    fn distance2(&self, point: Point3<f64>) -> f64 {
        (0..3)
            .map(|i| {
                let d = (self.min[i] - point[i]).max(point[i] - self.max[i]).max(0.0);
                d * d
            })
            .sum()
    }
}

/// A tree of boxes over all centre-line segments.
#[derive(Debug, Default)]
pub(super) struct LaneIndex {
    segments: Vec<Segment>,
    nodes: Vec<Node>,
}

impl LaneIndex {
    /// Samples all lanes; also writes down their lengths and widths.
    pub(super) fn new(map: &mut Map) -> Self {
        Self::of(Self::segments(map))
    }

    /// The same for the lanes of motor traffic alone, which most questions are about.
    pub(super) fn drivable(&self, lanes: &[LaneInfo]) -> Self {
        let drivable = |segment: &&Segment| lanes[segment.lane as usize].lane_type.is_drivable();
        Self::of(self.segments.iter().filter(drivable).copied().collect())
    }

    fn segments(map: &mut Map) -> Vec<Segment> {
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
        segments
    }

    fn of(segments: Vec<Segment>) -> Self {
        let mut index = Self { nodes: Vec::with_capacity(segments.len()), segments };
        let all = 0..index.segments.len();
        if !all.is_empty() {
            index.build(all);
        }
        index
    }

    /// Splits at the median of the longest side, over and over.
    fn build(&mut self, range: std::ops::Range<usize>) {
        let at = self.nodes.len();
        let mut node = Node {
            min: [f64::INFINITY; 3],
            max: [f64::NEG_INFINITY; 3],
            other: range.start as u32,
            count: range.len() as u32,
        };
        for segment in &self.segments[range.clone()] {
            for i in 0..3 {
                node.min[i] = node.min[i].min(segment.a[i]).min(segment.b[i]);
                node.max[i] = node.max[i].max(segment.a[i]).max(segment.b[i]);
            }
        }
        self.nodes.push(node);
        if range.len() <= LEAF {
            return;
        }
        let side = |i: usize| node.max[i] - node.min[i];
        let axis = (0..3).fold(0, |best, i| if side(i) > side(best) { i } else { best });
        let middle = range.start + range.len() / 2;
        let key = |s: &Segment| s.a[axis] + s.b[axis];
        self.segments[range.clone()].sort_by(|a, b| {
            key(a).total_cmp(&key(b)).then(a.lane.cmp(&b.lane)).then(a.s[0].total_cmp(&b.s[0]))
        });
        self.build(range.start..middle);
        let second = self.nodes.len() as u32;
        self.build(middle..range.end);
        (self.nodes[at].other, self.nodes[at].count) = (second, 0);
    }

    /// Calls `visit` with the segments whose box is nearer than the squared distance it answered last.
    fn search(&self, point: Point3<f64>, mut limit2: f64, mut visit: impl FnMut(usize, &Segment) -> f64) {
        let mut stack = [(0_u32, 0.0_f64); MAX_DEPTH];
        let mut depth = 0;
        if let Some(root) = self.nodes.first() {
            stack[0] = (0, root.distance2(point));
            depth = 1;
        }
        while depth > 0 {
            depth -= 1;
            let (at, distance2) = stack[depth];
            if distance2 > limit2 {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                let first = node.other as usize;
                for i in first..first + node.count as usize {
                    limit2 = visit(i, &self.segments[i]);
                }
                continue;
            }
            let (a, b) = (at + 1, node.other);
            let (da, db) = (self.nodes[a as usize].distance2(point), self.nodes[b as usize].distance2(point));
            let (near, far) = if da <= db { ((a, da), (b, db)) } else { ((b, db), (a, da)) };
            // Depth stays logarithmic because the tree is balanced.
            stack[depth] = far;
            stack[depth + 1] = near;
            depth += 2;
        }
    }
}

/// Chords with heights, found by their place in plan.
pub(super) struct Heights(LaneIndex);

impl Heights {
    pub(super) fn new(chords: impl IntoIterator<Item = [Point3<f64>; 2]>) -> Self {
        // Laid flat; in the place of their stretch of s they carry the heights of their ends.
        let flat = |p: Point3<f64>| Point3::new(p.x, p.y, 0.0);
        let segment = |[a, b]: [Point3<f64>; 2]| Segment { a: flat(a), b: flat(b), s: [a.z, b.z], lane: 0 };
        Self(LaneIndex::of(chords.into_iter().map(segment).collect()))
    }

    /// The height of the nearest chord, where it is nearest; 0 where there is none.
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let point = Point3::new(x, y, 0.0);
        let mut best = (f64::INFINITY, 0.0);
        self.0.search(point, f64::INFINITY, |_, segment| {
            let (distance2, part) = segment.distance2(point);
            if distance2 < best.0 {
                best = (distance2, segment.s[0] + (segment.s[1] - segment.s[0]) * part);
            }
            best.0
        });
        best.1
    }
}

/// Most segments kept for refinement.
const MAX_CANDIDATES: usize = 64;

impl Map {
    /// The lane, among those that pass the filter, whose centre line is nearest to a point, in three dimensions
    /// (so that on an overpass the deck that the point is on answers). None only where no lane passes.
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
        // The true line is within a tolerance of its chord: chords farther than the best one by two may not win.
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

    /// Every lane that passes the filter and whose centre line comes within `radius_m` of a point, at its nearest
    /// place, nearest lane first.
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

    /// The nearest place of the true centre line within a segment's stretch of s: the root of the offset's projection
    /// onto the tangent, by the secant method kept inside a shrinking bracket.
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
            // The rate of the slope is minus the squared speed where the line is straight, and is measured from the
            // second step on.
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
