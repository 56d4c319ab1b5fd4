//! Even-odd filling of a polygon that lies in space.

use glam::Vec3;

/// Calls with each cell whose centre lies inside, and the polygon's height there: between two borders of a
/// row the height runs straight from one to the other. Polygons of fewer than three corners cover nothing.
pub(crate) fn fill(corners: &[Vec3], cells: usize, mut cell: impl FnMut(usize, f32)) {
    if corners.len() < 3 || !corners.iter().all(|c| c.is_finite()) {
        return;
    }
    let low = corners.iter().fold(f32::INFINITY, |low, c| low.min(c.y));
    let high = corners.iter().fold(f32::NEG_INFINITY, |high, c| high.max(c.y));
    let first = (low - 0.5).ceil().max(0.0);
    let last = (high - 0.5).floor().min(cells as f32 - 1.0);
    if first > last {
        return;
    }
    let mut borders: Vec<(f32, f32)> = Vec::new();
    for row in first as usize..=last as usize {
        let v = row as f32 + 0.5;
        borders.clear();
        for (at, &b) in corners.iter().enumerate() {
            let a = corners[(at + corners.len() - 1) % corners.len()];
            // Half open in v: a corner on the line counts for one of its two edges.
            if (a.y <= v) != (b.y <= v) {
                let t = (v - a.y) / (b.y - a.y);
                borders.push((a.x + t * (b.x - a.x), a.z + t * (b.z - a.z)));
            }
        }
        borders.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in borders.chunks_exact(2) {
            let ((u0, z0), (u1, z1)) = (pair[0], pair[1]);
            let start = (u0 - 0.5).ceil().max(0.0);
            let end = (u1 - 0.5).floor().min(cells as f32 - 1.0);
            let per_column = if u1 > u0 { (z1 - z0) / (u1 - u0) } else { 0.0 };
            if start <= end {
                for column in start as usize..=end as usize {
                    cell(row * cells + column, z0 + (column as f32 + 0.5 - u0) * per_column);
                }
            }
        }
    }
}
