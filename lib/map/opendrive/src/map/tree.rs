//! A tree of boxes over the centre lines of lanes, and over other chords.
//!
//! By hand rather than with rstar, which finds the same chords more slowly: near lanes 5.2 instead of 1.1
//! microseconds a place in Town03, 6.4 instead of 3.5 in Town11.

use nalgebra::Point3;

use super::types::LaneInfo;

/// Segments in a leaf of the tree.
const LEAF: usize = 4;
/// Deepest tree: 2^48 leaves.
const MAX_DEPTH: usize = 48;

/// A piece of a lane's centre line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) a: Point3<f64>,
    pub(super) b: Point3<f64>,
    pub(super) s: [f64; 2],
    pub(super) lane: u32,
}

impl Segment {
    /// Squared distance to a point, and the nearest part of the way from `a` to `b`.
    pub(super) fn distance2(&self, point: Point3<f64>) -> (f64, f64) {
        let (way, to) = (self.b - self.a, point - self.a);
        let length2 = way.norm_squared();
        let part = if length2 > 0.0 { (to.dot(&way) / length2).clamp(0.0, 1.0) } else { 0.0 };
        ((to - way * part).norm_squared(), part)
    }
}

/// A box of the tree: an inner node's first child follows it, its second is `other`; a leaf has `count`
/// segments from `other` on.
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
    pub(super) segments: Vec<Segment>,
    nodes: Vec<Node>,
}

impl LaneIndex {
    /// The lanes of motor traffic alone, which most questions are about.
    pub(super) fn drivable(&self, lanes: &[LaneInfo]) -> Self {
        let drivable = |segment: &&Segment| lanes[segment.lane as usize].lane_type.is_drivable();
        Self::of(self.segments.iter().filter(drivable).copied().collect())
    }

    pub(super) fn of(segments: Vec<Segment>) -> Self {
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
    pub(super) fn search(
        &self,
        point: Point3<f64>,
        mut limit2: f64,
        mut visit: impl FnMut(usize, &Segment) -> f64,
    ) {
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
