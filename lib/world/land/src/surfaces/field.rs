//! Heights of the land far from roads: a coarse grid over the whole map, from its roads and waters.

use opendrive::Map;

use crate::surfaces::region::Region;
use crate::surfaces::water::Water;

/// Finest side of a cell, metres.
const CELL_M: f64 = 32.0;
/// Most cells along a side.
const MAX_CELLS: f64 = 2048.0;
/// How often cells between known ones are set to the mean of those beside them, on each level.
const SWEEPS: usize = 16;
/// Roads are sampled this densely, metres.
const SAMPLE_M: f64 = 8.0;

/// A height for every place of a map and around it.
#[derive(Debug)]
pub(crate) struct Field {
    low: [f64; 2],
    cell_m: f64,
    columns: usize,
    rows: usize,
    heights: Vec<f64>,
}

impl Field {
    /// The heights of a map: the mean of roads and waters in each cell, smooth between them.
    pub(crate) fn new(map: &Map, waters: &[Water]) -> Self {
        let mut points = Vec::new();
        for road in 0..map.network().roads.len() as u32 {
            let length = map.road_length(road).unwrap_or(0.0);
            let pieces = (length / SAMPLE_M).ceil().clamp(1.0, 1e5) as usize;
            let at = (0..=pieces).map(|i| length * i as f64 / pieces as f64);
            points.extend(at.filter_map(|s| map.road_point(road, s, 0.0, 0.0)));
        }
        let mut bounds = Region { min: [0.0; 2], max: [1.0; 2] };
        if let Some(first) = points.first() {
            bounds = Region { min: [first.x, first.y], max: [first.x, first.y] };
        }
        for p in &points {
            for (k, v) in [p.x, p.y].into_iter().enumerate() {
                (bounds.min[k], bounds.max[k]) = (bounds.min[k].min(v), bounds.max[k].max(v));
            }
        }
        let extent = (0..2).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
        let mut cell_m = CELL_M;
        while extent / cell_m > MAX_CELLS {
            cell_m *= 2.0;
        }
        // A cell more on each side, on a grid that does not depend on the map's extent.
        let low = bounds.min.map(|v| ((v / cell_m).floor() - 1.0) * cell_m);
        let cells = |k: usize| ((bounds.max[k] - low[k]) / cell_m).floor() as usize + 2;
        let (columns, rows) = (cells(0), cells(1));
        let mut sums = vec![(0.0, 0.0); columns * rows];
        let cell = |x: f64, y: f64| {
            let of = |v: f64, low: f64, n: usize| (((v - low) / cell_m).floor().max(0.0) as usize).min(n - 1);
            of(y, low[1], rows) * columns + of(x, low[0], columns)
        };
        for p in &points {
            let sum: &mut (f64, f64) = &mut sums[cell(p.x, p.y)];
            *sum = (sum.0 + p.z, sum.1 + 1.0);
        }
        for (i, sum) in sums.iter_mut().enumerate() {
            let [x, y] =
                [(i % columns, 0), (i / columns, 1)].map(|(c, k)| low[k] + (c as f64 + 0.5) * cell_m);
            for water in waters.iter().filter(|w| w.clearance_m(x, y, cell_m) <= 0.0) {
                *sum = (sum.0 + water.z_m, sum.1 + 1.0);
            }
        }
        let means = sums.into_iter().map(|(sum, n)| if n > 0.0 { sum / n } else { f64::INFINITY }).collect();
        let heights = filled(means, columns, rows);
        Self { low, cell_m, columns, rows, heights }
    }

    /// Height at a place; beyond the map that of its edge.
    pub(crate) fn height(&self, x: f64, y: f64) -> f64 {
        let axis = |v: f64, k: usize| (v - self.low[k]) / self.cell_m - 0.5;
        bilinear(&self.heights, [self.columns, self.rows], [axis(x, 0), axis(y, 1)])
    }
}

/// The value of a grid between its cells, at a place in cells from the middle of the first; that of the edge
/// beyond it.
pub(crate) fn bilinear(values: &[f64], [columns, rows]: [usize; 2], at: [f64; 2]) -> f64 {
    let axis = |at: f64, n: usize| {
        let at = at.clamp(0.0, (n - 1) as f64);
        let low = (at.floor() as usize).min(n.saturating_sub(2));
        (low, (low + 1).min(n - 1), at - low as f64)
    };
    let (c0, c1, u) = axis(at[0], columns);
    let (r0, r1, v) = axis(at[1], rows);
    let z = |c: usize, r: usize| values[r * columns + c];
    let low = z(c0, r0) + u * (z(c1, r0) - z(c0, r0));
    let high = z(c0, r1) + u * (z(c1, r1) - z(c0, r1));
    low + v * (high - low)
}

/// Means of the known values of two by two cells each; infinite where there is none. Columns and rows are
/// rounded up.
pub(crate) fn halved(values: &[f64], columns: usize, rows: usize) -> Vec<f64> {
    let (half_columns, half_rows) = (columns.div_ceil(2), rows.div_ceil(2));
    let mut sums = vec![(0.0, 0.0f64); half_columns * half_rows];
    for (i, v) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
        let sum = &mut sums[(i / columns / 2) * half_columns + i % columns / 2];
        *sum = (sum.0 + v, sum.1 + 1.0);
    }
    sums.iter().map(|(sum, n)| if *n > 0.0 { sum / n } else { f64::INFINITY }).collect()
}

/// The values, and between the halved grid's where there is none.
pub(crate) fn pulled(values: &[f64], columns: usize, rows: usize, coarse: &[f64]) -> Vec<f64> {
    let size = [columns.div_ceil(2), rows.div_ceil(2)];
    // Coarse values sit in the middle of two by two.
    let of = |i: usize| {
        let at = [i % columns, i / columns].map(|i| 0.5 * (i as f64 - 0.5));
        bilinear(coarse, size, at)
    };
    values.iter().enumerate().map(|(i, v)| if v.is_finite() { *v } else { of(i) }).collect()
}

/// Fills cells without a value from those with one: averages over ever larger squares, then back down (push
/// and pull, Gortler et al., 1996), on each level drawn smooth, so that the land between roads has no steps.
fn filled(values: Vec<f64>, columns: usize, rows: usize) -> Vec<f64> {
    if values.iter().all(|v| v.is_finite()) {
        return values;
    }
    if values.iter().all(|v| !v.is_finite()) {
        return vec![0.0; values.len()];
    }
    let (half_columns, half_rows) = (columns.div_ceil(2), rows.div_ceil(2));
    let coarse = filled(halved(&values, columns, rows), half_columns, half_rows);
    let mut smooth = pulled(&values, columns, rows, &coarse);
    let open: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_finite()).collect();
    for _ in 0..SWEEPS {
        for &i in &open {
            let (c, r) = (i % columns, i / columns);
            let (mut sum, mut n) = (0.0, 0.0);
            for (is_there, j) in [
                (c > 0, i.wrapping_sub(1)),
                (c + 1 < columns, i + 1),
                (r > 0, i.wrapping_sub(columns)),
                (r + 1 < rows, i + columns),
            ] {
                if is_there {
                    (sum, n) = (sum + smooth[j], n + 1.0);
                }
            }
            if n > 0.0 {
                smooth[i] = sum / n;
            }
        }
    }
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_of_roads_is_a_plane() {
        // Two roads 500 m apart at 0 and 10 m: halfway it is 5 m, beyond them it is level.
        let lane = || testkit::both_ways(&[(opendrive::LaneType::Driving, 3.5)]);
        let mut roads: Vec<_> =
            [("1", 0.0), ("2", 512.0)].map(|(id, y)| testkit::road(id, [0.0, y], 0.0, 1000.0, lane())).into();
        roads[1].elevation = vec![opendrive::Cubic::constant(10.0)];
        let field = Field::new(&testkit::map(roads), &[]);
        assert!(field.height(500.0, 2.0).abs() < 0.3 && (field.height(500.0, 520.0) - 10.0).abs() < 0.3);
        assert!((field.height(500.0, 264.0) - 5.0).abs() < 1.0, "{}", field.height(500.0, 264.0));
        assert!(field.height(500.0, -4000.0).abs() < 0.3 && (field.height(500.0, 9e5) - 10.0).abs() < 0.3);
    }

    #[test]
    fn places_between_cells_are_weighed() {
        let values = [0.0, 1.0, 2.0, 4.0];
        let at = |x: f64, y: f64| bilinear(&values, [2, 2], [x, y]);
        assert_eq!([at(0.0, 0.0), at(1.0, 1.0), at(0.5, 0.0), at(0.5, 0.5)], [0.0, 4.0, 0.5, 1.75]);
        assert_eq!([at(-3.0, 0.25), at(9.0, 9.0)], [0.5, 4.0]);
        assert_eq!(halved(&[1.0, f64::INFINITY, 3.0, f64::INFINITY, f64::INFINITY, 7.0], 3, 2), [1.0, 5.0]);
    }
}
