//! Which cells a triangle covers.

use std::ops::RangeInclusive;

use glam::Vec3A;

/// Rounding must not open seams between triangles that share an edge: spans of centres are wider by this,
/// cells.
const SEAM: f32 = 1e-4;

/// A triangle in grid coordinates that has a point over the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    corners: [Vec3A; 3],
    low: Vec3A,
    high: Vec3A,
}

/// Height over the grid, never outside the triangle's own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Height {
    at: Vec3A,
    per_column: f32,
    per_row: f32,
    range: [f32; 2],
}

impl Height {
    /// At the centre of a cell.
    pub(crate) fn at(&self, row: usize, column: usize) -> f32 {
        let (du, dv) = (column as f32 + 0.5 - self.at.x, row as f32 + 0.5 - self.at.y);
        let z = self.at.z + du * self.per_column + dv * self.per_row;
        z.clamp(self.range[0], self.range[1])
    }
}

impl Triangle {
    /// None where its bounding box misses the grid or a corner is no number.
    pub(crate) fn new(corners: [Vec3A; 3], cells: usize) -> Option<Self> {
        let [a, b, c] = corners;
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        let size = cells as f32;
        let over = high.x >= 0.0 && high.y >= 0.0 && low.x <= size && low.y <= size;
        // A sum is finite only if all its terms are.
        (over && (a + b + c).is_finite()).then_some(Self { corners, low, high })
    }

    /// Whether its bounding box holds a cell's centre: small triangles mostly don't.
    pub(crate) fn may_cover_a_centre(&self) -> bool {
        // By the scalar functions, which are one instruction each.
        let holds = |low: f32, high: f32| (low - 0.5 - SEAM).ceil() <= (high - 0.5 + SEAM).floor();
        holds(self.low.x, self.high.x) && holds(self.low.y, self.high.y)
    }

    /// Lowest and highest z.
    pub(crate) fn z_range(&self) -> [f32; 2] {
        [self.low.z, self.high.z]
    }

    pub(crate) fn height(&self) -> Height {
        let [a, b, c] = self.corners;
        let range = self.z_range();
        let normal = (b - a).cross(c - a);
        let (per_column, per_row) = (-normal.x / normal.z, -normal.y / normal.z);
        if per_column.is_finite() && per_row.is_finite() {
            Height { at: a, per_column, per_row, range }
        } else {
            // Seen from the edge: its top.
            Height { at: a.with_z(range[1]), per_column: 0.0, per_row: 0.0, range }
        }
    }

    fn edges(&self) -> [Edge; 3] {
        let [a, b, c] = self.corners;
        [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)]
    }

    /// Calls with the run of cells of each row whose centres it covers.
    pub(crate) fn centres(&self, cells: usize, mut run: impl FnMut(usize, RangeInclusive<usize>)) {
        if !self.may_cover_a_centre() {
            return;
        }
        let (low, high) = (self.low.y, self.high.y);
        let Some(rows) = indices((low - 0.5).ceil(), high - 0.5, cells) else { return };
        let edges = self.edges();
        for row in rows {
            let v = row as f32 + 0.5;
            let mut span = [f32::INFINITY, f32::NEG_INFINITY];
            for edge in &edges {
                edge.cross(&mut span, v);
            }
            if let Some(columns) = indices((span[0] - 0.5 - SEAM).ceil(), span[1] - 0.5 + SEAM, cells) {
                run(row, columns);
            }
        }
    }
}

/// The whole numbers from `first` (a whole number) to `high`, clipped to the grid.
fn indices(first: f32, high: f32, cells: usize) -> Option<RangeInclusive<usize>> {
    let first = first.max(0.0);
    let last = high.floor().min(cells as f32 - 1.0);
    if first <= last { Some(first as usize..=last as usize) } else { None }
}

fn widen(span: &mut [f32; 2], u: f32) {
    span[0] = span[0].min(u);
    span[1] = span[1].max(u);
}

/// An edge of a triangle.
#[derive(Clone, Copy)]
struct Edge {
    a: Vec3A,
    b: Vec3A,
    /// Columns per row; not finite for an edge along a row.
    slope: f32,
}

impl Edge {
    fn new(a: Vec3A, b: Vec3A) -> Self {
        // From the lower end always: triangles that share an edge must find the same places on it.
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        Self { a: low, b: high, slope: (high.x - low.x) / (high.y - low.y) }
    }

    /// Widens a span by where the edge meets a line of constant row.
    fn cross(&self, span: &mut [f32; 2], v: f32) {
        let (a, b) = (self.a, self.b);
        if v < a.y || v > b.y {
            return;
        }
        if self.slope.is_finite() {
            let u = a.x + self.slope * (v - a.y);
            widen(span, u.clamp(a.x.min(b.x), a.x.max(b.x)));
        } else {
            widen(span, a.x);
            widen(span, b.x);
        }
    }
}
