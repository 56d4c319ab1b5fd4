//! Lines without width.

use glam::Vec3;

/// Samples are at most this far apart, cells: somewhat less than one, so that rounding leaves no cell out.
const STEP: f32 = 0.99;

/// Calls with the cell of each sample of a chain of points, and the height there: the points themselves and,
/// between two of them, as many at even distances as it takes to go on by less than a cell. So a line has no
/// gap, and is one cell wide. Samples outside the grid are dropped.
pub(crate) fn draw(points: impl Iterator<Item = Vec3>, cells: usize, mut cell: impl FnMut(usize, f32)) {
    let size = cells as f32;
    let mut sample = |at: Vec3| {
        if (0.0..size).contains(&at.x) && (0.0..size).contains(&at.y) {
            cell(at.y as usize * cells + at.x as usize, at.z);
        }
    };
    let mut last: Option<Vec3> = None;
    for point in points.filter(|p| p.is_finite()) {
        if let Some(from) = last.filter(|from| crosses(*from, point, size)) {
            let steps = ((point - from).truncate().length() / STEP).ceil().max(1.0) as usize;
            (1..steps).for_each(|k| sample(from.lerp(point, k as f32 / steps as f32)));
        }
        sample(point);
        last = Some(point);
    }
}

/// Whether the box about two points has a point over the grid.
fn crosses(a: Vec3, b: Vec3, size: f32) -> bool {
    let (low, high) = (a.min(b), a.max(b));
    high.x >= 0.0 && high.y >= 0.0 && low.x <= size && low.y <= size
}
