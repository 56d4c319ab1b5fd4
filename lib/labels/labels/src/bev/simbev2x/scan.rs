//! Filling polygons with corners on whole cells, as OpenCV's `fillPoly` does.

/// Bits after the point of a border's place in a row.
const SHIFT: u32 = 16;
const ONE: i64 = 1 << SHIFT;

/// A corner: column and row.
pub(crate) type Corner = [i64; 2];

/// Fills a polygon: even-odd between its borders, row by row, and all cells of its outline. Polygons of fewer
/// than three corners cover nothing. Calls with each cell (row times `cells` plus column), some of them
/// several times.
///
/// Equal to OpenCV for polygons within the grid and for most others: an edge that crosses the grid's border
/// is cut there at whole cells first, as there.
pub(crate) fn fill(corners: &[Corner], cells: usize, mut cell: impl FnMut(usize)) {
    let Some(&last) = corners.last().filter(|_| corners.len() >= 3) else { return };
    let sides = corners.iter().map(|&corner| side(corner, cells as i64));
    if sides.fold(u8::MAX, |all, side| all & side) != 0 {
        // All of it beyond one border.
        return;
    }
    let mut borders: Vec<Border> = Vec::with_capacity(corners.len());
    let mut from = last;
    for &to in corners {
        let (visible, clipped) = clip(from, to, cells as i64);
        if visible {
            outline(clipped, cells, &mut cell);
        }
        borders.extend(Border::of([from, to], clipped));
        from = to;
    }
    let size = cells as i64;
    let first = borders.iter().map(|b| b.rows[0]).min().unwrap_or(0).max(0);
    let end = borders.iter().map(|b| b.rows[1]).max().unwrap_or(0).min(size);
    let mut crossings: Vec<i64> = Vec::new();
    for row in first..end {
        crossings.clear();
        let here = borders.iter().filter(|b| b.rows[0] <= row && row < b.rows[1]);
        crossings.extend(here.map(|b| b.start + (row - b.rows[0]) * b.slope));
        crossings.sort_unstable();
        for pair in crossings.chunks_exact(2) {
            let left = ((pair[0] + ONE - 1) >> SHIFT).max(0);
            let right = (pair[1] >> SHIFT).min(size - 1);
            (left..=right).for_each(|column| cell((row * size + column) as usize));
        }
    }
}

/// An edge that is not level, from above to below.
#[derive(Clone, Copy)]
struct Border {
    /// First row, and the one after the last.
    rows: [i64; 2],
    /// Column in the first row, and columns per row, in steps of `1 / ONE`.
    start: i64,
    slope: i64,
}

impl Border {
    /// Of an edge and the part of it within the grid, which says its slope.
    fn of(edge: [Corner; 2], clipped: [Corner; 2]) -> Option<Self> {
        if edge[0][1] == edge[1][1] {
            return None;
        }
        let [a, b] = if clipped[0][1] == clipped[1][1] { edge } else { clipped };
        let slope = (b[0] - a[0]) * ONE / (b[1] - a[1]);
        let (near, far) =
            if edge[0][1] < edge[1][1] { ([edge[0], a], edge[1]) } else { ([edge[1], b], edge[0]) };
        let [top, on] = near;
        Some(Self { rows: [top[1], far[1]], start: on[0] * ONE + (top[1] - on[1]) * slope, slope })
    }
}

/// Where a point is beyond the grid: bits left, right, above, below.
fn side([x, y]: Corner, size: i64) -> u8 {
    u8::from(x < 0) | u8::from(x >= size) << 1 | u8::from(y < 0) << 2 | u8::from(y >= size) << 3
}

/// The part of an edge within the grid, its ends cut to whole cells; and whether there is one.
fn clip(mut a: Corner, mut b: Corner, size: i64) -> (bool, [Corner; 2]) {
    let sides = |a: Corner, b: Corner| (side(a, size), side(b, size));
    // Rows first, then columns.
    for (axis, beyond) in [(1_usize, 0b1100_u8), (0, 0b0011)] {
        let (of_a, of_b) = sides(a, b);
        if of_a & of_b != 0 || of_a | of_b == 0 {
            break;
        }
        let other = 1 - axis;
        let cut = |end: Corner, from: Corner, to: Corner| {
            let limit = if end[axis] < 0 { 0 } else { size - 1 };
            let along = (limit - end[axis]) as f64 * (to[other] - from[other]) as f64;
            let mut new = end;
            new[other] += (along / (to[axis] - from[axis]) as f64) as i64;
            new[axis] = limit;
            new
        };
        if of_a & beyond != 0 {
            a = cut(a, a, b);
        }
        if of_b & beyond != 0 {
            b = cut(b, a, b);
        }
    }
    let (of_a, of_b) = sides(a, b);
    (of_a | of_b == 0, [a, b])
}

/// The cells of a line within the grid, from its left end on, eight-connected (Bresenham, 1965).
fn outline([a, b]: [Corner; 2], cells: usize, cell: &mut impl FnMut(usize)) {
    let ([mut x, mut y], to) = if a[0] <= b[0] { (a, b) } else { (b, a) };
    let (dx, dy) = (to[0] - x, (to[1] - y).abs());
    let down = if to[1] >= y { 1 } else { -1 };
    let (long, short) = (dx.max(dy), dx.min(dy));
    let mut error = long - 2 * short;
    for _ in 0..=long {
        cell((y * cells as i64 + x) as usize);
        let aside = error < 0;
        error += 2 * if aside { long - short } else { -short };
        if dy > dx || aside {
            y += down;
        }
        if dy <= dx || aside {
            x += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rows of a grid of 16 x 16, bit `c` for column `c`.
    fn rows(corners: &[Corner]) -> [u16; 16] {
        let mut rows = [0; 16];
        fill(corners, 16, |cell| rows[cell / 16] |= 1 << (cell % 16));
        rows
    }

    #[test]
    fn outlines_belong_to_polygons() {
        // Corners at (2, 3), (6, 3), (6, 5), (2, 5): five columns in three rows.
        let mut want = [0; 16];
        want[3..=5].fill(0b111_1100);
        assert_eq!(rows(&[[2, 3], [6, 3], [6, 5], [2, 5]]), want);
        // A strip without width is its outline; two points are nothing.
        want = [0; 16];
        want[7] = 0b11_1110;
        assert_eq!(rows(&[[1, 7], [5, 7], [5, 7], [1, 7]]), want);
        assert_eq!(rows(&[[1, 7], [5, 7]]), [0; 16]);
    }

    /// What OpenCV 5.0 fills.
    #[test]
    fn opencv_fills_the_same() {
        let known: [(&[Corner], [u16; 16]); 10] = [
            (
                &[[2, 12], [7, 9], [9, 11]],
                [
                    0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0080, 0x01e0,
                    0x03f8, 0x003c, 0x0000, 0x0000, 0x0000,
                ],
            ),
            (
                &[[7, 2], [6, 14], [8, 1]],
                [
                    0x0000, 0x0100, 0x0180, 0x0180, 0x0180, 0x0080, 0x0080, 0x0080, 0x00c0, 0x00c0, 0x00c0,
                    0x0040, 0x0040, 0x0040, 0x0040, 0x0000,
                ],
            ),
            (
                &[[2, 12], [15, 15], [9, 13], [5, 2], [8, 7]],
                [
                    0x0000, 0x0000, 0x0020, 0x0060, 0x0040, 0x00c0, 0x00c0, 0x0180, 0x0080, 0x01c0, 0x01f0,
                    0x01f8, 0x03fc, 0x07e0, 0x3e00, 0xe000,
                ],
            ),
            (
                &[[15, 4], [13, 2], [5, 12], [3, 10], [7, 8]],
                [
                    0x0000, 0x0000, 0x2000, 0x7000, 0xf800, 0x7800, 0x1c00, 0x0600, 0x0180, 0x00e0, 0x00f8,
                    0x0070, 0x0020, 0x0000, 0x0000, 0x0000,
                ],
            ),
            (
                &[[13, 13], [8, 15], [15, 2], [3, 4], [8, 13], [7, 15]],
                [
                    0x0000, 0x0000, 0xe000, 0x7f80, 0x7ff8, 0x3ff0, 0x3ff0, 0x1fe0, 0x1fe0, 0x0fc0, 0x0fc0,
                    0x0780, 0x0780, 0x3300, 0x0f80, 0x0380,
                ],
            ),
            (
                &[[14, 9], [11, 3], [9, 12], [14, 13]],
                [
                    0x0000, 0x0000, 0x0000, 0x0800, 0x0800, 0x1800, 0x1c00, 0x3c00, 0x3c00, 0x7c00, 0x7e00,
                    0x7e00, 0x7e00, 0x7000, 0x0000, 0x0000,
                ],
            ),
            (
                &[[6, 5], [-4, 12], [15, 23]],
                [
                    0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0040, 0x0060, 0x00f0, 0x00fc, 0x01fe, 0x01ff,
                    0x03ff, 0x03ff, 0x07ff, 0x07ff, 0x0ffc,
                ],
            ),
            (
                &[[21, -7], [-4, 11], [19, 20]],
                [
                    0xf000, 0xf800, 0xfe00, 0xff00, 0xff80, 0xffe0, 0xfff0, 0xfff8, 0xfffe, 0xffff, 0xffff,
                    0xffff, 0xffff, 0xfffc, 0xfff0, 0xffc0,
                ],
            ),
            (
                &[[-8, 5], [17, 8], [-2, 13], [-6, 14], [-8, 3]],
                [
                    0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x0007, 0x00ff, 0x1fff, 0xffff, 0x3fff, 0x07ff,
                    0x00ff, 0x001f, 0x0003, 0x0000, 0x0000,
                ],
            ),
            (
                &[[22, 15], [12, 7], [1, 19], [22, -2]],
                [
                    0x0000, 0x0000, 0x0000, 0x0000, 0x0000, 0x8000, 0xc000, 0xf000, 0xf800, 0xcc00, 0x8600,
                    0x0300, 0x0180, 0x00c0, 0x0060, 0x0030,
                ],
            ),
        ];
        for (corners, want) in known {
            assert_eq!(rows(corners), want, "{corners:?}");
        }
    }
}
