//! One triangle's cells, column by column.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use schema::Tag;

/// Priority and tie-break of every label in one number, 1 to 31: of two, the greater wins.
pub(super) const RANK: [u8; 256] = {
    // Labels outside the table never occur in a grid; they rank with "free".
    let mut rank = [0_u8; 256];
    let mut tag = 1;
    while tag < Tag::COUNT {
        // How many labels lose against this one.
        let mut beaten = 1;
        let mut other = 1;
        while other < Tag::COUNT {
            let (a, b) = (PRIORITY[tag], PRIORITY[other]);
            if a > b || (a == b && tag < other) {
                beaten += 1;
            }
            other += 1;
        }
        rank[tag] = beaten;
        tag += 1;
    }
    rank
};

/// [`Tag::voxel_priority`] at compile time (a test compares them).
const PRIORITY: [u8; Tag::COUNT] = {
    let mut priority = [1_u8; Tag::COUNT];
    priority[Tag::Unlabeled as usize] = 0;
    priority[Tag::RoadLine as usize] = 8;
    priority[Tag::Road as usize] = 7;
    priority[Tag::Sidewalk as usize] = 7;
    priority[Tag::Pedestrian as usize] = 6;
    priority[Tag::Rider as usize] = 6;
    priority[Tag::Motorcycle as usize] = 5;
    priority[Tag::Bicycle as usize] = 5;
    priority[Tag::Car as usize] = 4;
    priority[Tag::Truck as usize] = 3;
    priority[Tag::Bus as usize] = 3;
    priority[Tag::TrafficLight as usize] = 2;
    priority[Tag::TrafficSign as usize] = 2;
    priority[Tag::TrafficCone as usize] = 2;
    priority[Tag::Barrier as usize] = 2;
    priority
};

/// A triangle in grid coordinates (in cells) with its label.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridTriangle {
    corners: [Vec3; 3],
    tag: u8,
}

/// The piece of a triangle between two planes of constant x: at most five corners.
struct Polygon {
    corners: [Vec3; 6],
    len: usize,
}

/// Lowest and highest value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) low: f32,
    pub(super) high: f32,
}

impl Span {
    pub(super) const EMPTY: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY };

    /// The cells of a column of so many that it has a point in.
    pub(super) fn cells(self, count: usize) -> Range<usize> {
        cells(self.low, self.high, count)
    }

    fn add(&mut self, value: f32) {
        // Values are finite here, so plain comparisons do.
        if value < self.low {
            self.low = value;
        }
        if value > self.high {
            self.high = value;
        }
    }
}

/// The cells between two coordinates (both included), clipped to the grid.
fn cells(low: f32, high: f32, count: usize) -> Range<usize> {
    if !(high >= 0.0 && low < count as f32) {
        return 0..0;
    }
    // Not negative, so truncation is floor.
    let first = low.max(0.0) as usize;
    let last = (high as usize).min(count - 1);
    first..(last + 1).max(first)
}

/// The value on the line from `a` to `b` where another coordinate goes from `from` to `to` and is now `at`.
fn between(a: f32, b: f32, from: f32, to: f32, at: f32) -> f32 {
    let value = a + (b - a) * ((at - from) / (to - from));
    // Rounding must not leave the edge.
    value.clamp(a.min(b), a.max(b))
}

impl GridTriangle {
    /// The same triangle with its coordinates in another order.
    pub(super) fn permuted(self, axes: [usize; 3]) -> Self {
        Self { corners: self.corners.map(|c| Vec3::from_array(axes.map(|axis| c[axis]))), tag: self.tag }
    }

    /// None where the label never writes or a corner is no number.
    pub(super) fn new(corners: [Vec3A; 3], tag: Tag) -> Option<Self> {
        let finite = corners.iter().all(|c| c.is_finite());
        (finite && tag != Tag::Unlabeled).then(|| Self { corners: corners.map(Vec3::from), tag: tag as u8 })
    }

    fn span(&self, axis: usize) -> Span {
        let [a, b, c] = self.corners.map(|p| p[axis]);
        Span { low: a.min(b).min(c), high: a.max(b).max(c) }
    }

    /// Whether its bounding box has a point in a grid of this size or nearer to it than `margin` cells.
    pub(super) fn reaches_about(&self, size: Vec3A, margin: f32) -> bool {
        (0..3).all(|axis| {
            let span = self.span(axis);
            span.high >= -margin && span.low < size[axis] + margin
        })
    }

    /// The slices along x it touches.
    pub(super) fn slices(&self, count: usize) -> Range<usize> {
        let span = self.span(0);
        cells(span.low, span.high, count)
    }

    /// Labels the cells it touches in some slices; `slab` holds exactly these slices' cells, `heights` is
    /// room for one span per column of a slice.
    pub(super) fn write(&self, slices: Range<usize>, nz: usize, slab: &mut [u8], heights: &mut [Span]) {
        let mut writer = Writer { slab, nz, rank: self.rank(), tag: self.tag };
        self.columns(slices, heights, |column, span| writer.write(column, span));
    }

    /// Which of two labels wins: the greater.
    pub(super) fn rank(&self) -> u8 {
        RANK[usize::from(self.tag)]
    }

    /// Its label.
    pub(super) fn tag(&self) -> u8 {
        self.tag
    }

    /// Calls with each column that it has a point in, in some slices (counted from the first of them), and
    /// the heights that it reaches from and to there; `heights` is room for one span per column of a slice.
    #[inline]
    pub(super) fn columns(
        &self,
        slices: Range<usize>,
        heights: &mut [Span],
        mut column: impl FnMut(usize, Span),
    ) {
        let ny = heights.len();
        let x = self.span(0);
        let touched = cells(x.low, x.high, slices.end);
        for i in touched.start.max(slices.start)..touched.end {
            let row = (i - slices.start) * ny;
            let piece = self.between_x(i as f32, (i + 1) as f32);
            let y = piece.span(1);
            let columns = cells(y.low, y.high, ny);
            if columns.len() == 1 && y.low >= 0.0 && y.high < (columns.start + 1) as f32 {
                column(row + columns.start, piece.span(2));
                continue;
            }
            // The part of a flat piece over one column has its lowest and highest points on the piece's
            // border, so walking along the border finds them for all columns at once.
            heights[columns.clone()].fill(Span::EMPTY);
            piece.walk_border(&columns, heights);
            for j in columns {
                column(row + j, heights[j]);
            }
        }
    }

    /// The piece between two planes of constant x.
    fn between_x(&self, x0: f32, x1: f32) -> Polygon {
        let mut out = Polygon { corners: [Vec3::ZERO; 6], len: 0 };
        for e in 0..3 {
            let (a, b) = (self.corners[e], self.corners[(e + 1) % 3]);
            if x0 <= a.x && a.x <= x1 {
                out.push(a);
            }
            // Cuts in the order in which the edge meets them, so that the piece's corners go around it.
            let cuts = if a.x <= b.x { [x0, x1] } else { [x1, x0] };
            for cut in cuts {
                if (a.x < cut && cut < b.x) || (b.x < cut && cut < a.x) {
                    let y = between(a.y, b.y, a.x, b.x, cut);
                    out.push(Vec3::new(cut, y, between(a.z, b.z, a.x, b.x, cut)));
                }
            }
        }
        out
    }
}

impl Polygon {
    fn push(&mut self, corner: Vec3) {
        if let Some(place) = self.corners.get_mut(self.len) {
            *place = corner;
            self.len += 1;
        }
    }

    fn span(&self, axis: usize) -> Span {
        let mut span = Span::EMPTY;
        self.corners[..self.len].iter().for_each(|c| span.add(c[axis]));
        span
    }

    /// Adds to each column's span the heights of the border's parts over it.
    fn walk_border(&self, columns: &Range<usize>, heights: &mut [Span]) {
        let corners = &self.corners[..self.len];
        let Some(mut from) = corners.last() else { return };
        for to in corners {
            let (a, b) = if from.y <= to.y { (from, to) } else { (to, from) };
            walk_edge(a, b, columns, heights);
            from = to;
        }
    }
}

/// One edge of a border, `a` at the lower y: the heights at its ends and wherever it changes columns.
fn walk_edge(a: &Vec3, b: &Vec3, columns: &Range<usize>, heights: &mut [Span]) {
    let over = cells(a.y, b.y, columns.end);
    if over.is_empty() {
        return;
    }
    let per_column = (b.z - a.z) / (b.y - a.y);
    let (low, high) = if a.z <= b.z { (a.z, b.z) } else { (b.z, a.z) };
    // Rounding must not leave the edge.
    let at = |y: usize| (a.z + per_column * (y as f32 - a.y)).clamp(low, high);
    let mut z = if a.y >= 0.0 { a.z } else { at(0) };
    let last = over.end - 1;
    for (heights, boundary) in heights[over.start..last].iter_mut().zip(over.start + 1..) {
        let next = at(boundary);
        heights.add(z);
        heights.add(next);
        z = next;
    }
    heights[last].add(z);
    heights[last].add(if b.y < over.end as f32 { b.z } else { at(over.end) });
}

/// Writes one label into columns.
struct Writer<'a> {
    slab: &'a mut [u8],
    nz: usize,
    rank: u8,
    tag: u8,
}

impl Writer<'_> {
    /// Labels the cells of a column from the lowest to the highest point.
    fn write(&mut self, column: usize, z: Span) {
        let base = column * self.nz;
        for k in cells(z.low, z.high, self.nz) {
            let cell = &mut self.slab[base + k];
            if RANK[usize::from(*cell)] < self.rank {
                *cell = self.tag;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_follow_the_priority_table() {
        for a in Tag::ALL {
            assert_eq!(PRIORITY[a as usize], a.voxel_priority(), "{a:?}");
            for b in Tag::ALL {
                let wins = (a.voxel_priority(), b as u8) > (b.voxel_priority(), a as u8);
                assert_eq!(RANK[a as usize] > RANK[b as usize], wins, "{a:?} against {b:?}");
            }
        }
    }
}
