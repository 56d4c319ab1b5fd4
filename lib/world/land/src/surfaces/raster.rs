//! The plan as cells: which lie under something, how far they are from it, and what hangs together.

use std::f64::consts::SQRT_2;
use std::ops::Range;

use nalgebra::Point3;

use crate::surfaces::region::Region;

/// A grid of square cells over a region. Cells are numbered along x, row by row from the south.
#[derive(Debug)]
pub struct Raster {
    low: [f64; 2],
    cell_m: f64,
    /// Cells along x.
    pub columns: usize,
    /// Cells along y.
    pub rows: usize,
}

impl Raster {
    /// Cells of a side over a region, the last ones reaching beyond it.
    #[must_use]
    pub fn new(region: &Region, cell_m: f64) -> Self {
        let cells = |k: usize| ((region.max[k] - region.min[k]) / cell_m).ceil().max(1.0) as usize;
        Self { low: region.min, cell_m, columns: cells(0), rows: cells(1) }
    }

    /// The same grid with cells of half the side.
    pub(crate) fn halved(&self) -> Self {
        Self { low: self.low, cell_m: 0.5 * self.cell_m, columns: 2 * self.columns, rows: 2 * self.rows }
    }

    /// The four quarters of a cell in the grid with cells of half the side.
    pub(crate) fn quarters(&self, cell: usize) -> [usize; 4] {
        let (column, row) = (cell % self.columns, cell / self.columns);
        let first = 4 * row * self.columns + 2 * column;
        [first, first + 1, first + 2 * self.columns, first + 2 * self.columns + 1]
    }

    /// How many cells there are, at least one.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "no grid is empty")]
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// The south-western corner of the cell in a column and row.
    pub(crate) fn corner(&self, column: usize, row: usize) -> [f64; 2] {
        [self.low[0] + column as f64 * self.cell_m, self.low[1] + row as f64 * self.cell_m]
    }

    pub(crate) fn middle(&self, cell: usize) -> [f64; 2] {
        self.corner(cell % self.columns, cell / self.columns).map(|v| v + 0.5 * self.cell_m)
    }

    /// The cell that a point lies in.
    #[must_use]
    pub fn cell(&self, x: f64, y: f64) -> Option<usize> {
        let of = |v: f64, low: f64, n: usize| {
            let at = ((v - low) / self.cell_m).floor();
            (at >= 0.0 && at < n as f64).then_some(at as usize)
        };
        Some(of(y, self.low[1], self.rows)? * self.columns + of(x, self.low[0], self.columns)?)
    }

    /// The columns and rows (first to before last) of the cells whose middles lie in a region, its northern
    /// and eastern sides not included.
    pub(crate) fn span(&self, region: &Region) -> [[usize; 2]; 2] {
        [(0, self.columns), (1, self.rows)].map(|(k, n)| {
            let first = |v: f64| ((v - self.low[k]) / self.cell_m - 0.5).ceil().clamp(0.0, n as f64) as usize;
            [first(region.min[k]), first(region.max[k])]
        })
    }

    /// Calls `mark` for every cell of the columns and rows asked for (first to before last) whose middle lies
    /// in a triangle of the plan.
    pub fn under(
        &self,
        corners: &[Point3<f64>; 3],
        columns: [usize; 2],
        rows: [usize; 2],
        mut mark: impl FnMut(usize),
    ) {
        // In cells, so that middles are whole numbers.
        let points = corners
            .map(|p| [(p.x - self.low[0]) / self.cell_m - 0.5, (p.y - self.low[1]) / self.cell_m - 0.5]);
        let fold = |k: usize, pick: fn(f64, f64) -> f64| pick(pick(points[0][k], points[1][k]), points[2][k]);
        let whole = |v: f64, most: [usize; 2]| v.clamp(most[0] as f64, most[1] as f64) as usize;
        let first = whole(fold(1, f64::min).ceil(), rows);
        let last = whole(fold(1, f64::max).floor() + 1.0, rows);
        for row in first..last {
            let y = row as f64;
            let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in 0..3 {
                let (a, b) = (points[k], points[(k + 1) % 3]);
                if (a[1] <= y) != (b[1] <= y) {
                    let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                    (from, to) = (from.min(x), to.max(x));
                }
            }
            if from <= to {
                let (from, to) = (whole(from.ceil(), columns), whole(to.floor() + 1.0, columns));
                (from..to).for_each(|column| mark(row * self.columns + column));
            }
        }
    }

    /// The cells that share a side with a cell.
    pub(crate) fn beside(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (column, row, columns) = (cell % self.columns, cell / self.columns, self.columns);
        let near = [
            (column > 0).then(|| cell - 1),
            (column + 1 < columns).then_some(cell + 1),
            (row > 0).then(|| cell - columns),
            (row + 1 < self.rows).then_some(cell + columns),
        ];
        near.into_iter().flatten()
    }

    /// How far the middle of each cell is from that of the nearest cell that is `from`, metres, along steps
    /// to the eight neighbours: up to 8 % more than the straight way (Borgefors, 1986). Infinite where there
    /// is none.
    #[must_use]
    pub fn distances_m(&self, from: impl Fn(usize) -> bool) -> Vec<f32> {
        let mut far: Vec<f32> = (0..self.len()).map(|i| if from(i) { 0.0 } else { f32::INFINITY }).collect();
        let (straight, diagonal) = (self.cell_m as f32, (self.cell_m * SQRT_2) as f32);
        let (columns, rows) = (self.columns, self.rows);
        for back in [false, true] {
            for k in 0..self.len() {
                let i = if back { self.len() - 1 - k } else { k };
                let (column, row) = (i % columns, i / columns);
                let mut least = far[i];
                let mut step = |there: bool, j: usize, by: f32| {
                    if there {
                        least = least.min(far[j] + by);
                    }
                };
                if back {
                    let (right, above) = (column + 1 < columns, row + 1 < rows);
                    step(right, i + 1, straight);
                    step(above, i + columns, straight);
                    step(above && right, i + columns + 1, diagonal);
                    step(above && column > 0, i + columns - 1, diagonal);
                } else {
                    let (left, below) = (column > 0, row > 0);
                    step(left, i.wrapping_sub(1), straight);
                    step(below, i.wrapping_sub(columns), straight);
                    step(below && left, i.wrapping_sub(columns + 1), diagonal);
                    step(below && column + 1 < columns, i.wrapping_sub(columns - 1), diagonal);
                }
                far[i] = least;
            }
        }
        far
    }

    /// Groups of cells that are `wanted` and hang together by their sides, each as its runs along x; groups
    /// and runs ascend by their first cell.
    #[must_use]
    pub fn groups(&self, wanted: impl Fn(usize) -> bool) -> Vec<Vec<Range<usize>>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        // Each run's group is that of the run named here, in the end one that names itself.
        let mut parents: Vec<usize> = Vec::new();
        let mut above = 0..0;
        for row in 0..self.rows {
            let (first, mut cell, end) = (runs.len(), row * self.columns, (row + 1) * self.columns);
            while cell < end {
                let start = cell;
                while cell < end && wanted(cell) {
                    cell += 1;
                }
                if cell > start {
                    parents.push(runs.len());
                    runs.push(start..cell);
                }
                cell += 1;
            }
            let mut k = above.start;
            for i in first..runs.len() {
                while k < above.end && runs[k].end + self.columns <= runs[i].start {
                    k += 1;
                }
                let mut j = k;
                while j < above.end && runs[j].start + self.columns < runs[i].end {
                    let (a, b) = (root(&mut parents, i), root(&mut parents, j));
                    parents[a.max(b)] = a.min(b);
                    j += 1;
                }
            }
            above = first..runs.len();
        }
        let mut groups: Vec<Vec<Range<usize>>> = Vec::new();
        let mut numbers = vec![0; runs.len()];
        for (i, run) in runs.into_iter().enumerate() {
            let root = root(&mut parents, i);
            if root == i {
                numbers[i] = groups.len();
                groups.push(Vec::new());
            }
            groups[numbers[root]].push(run);
        }
        groups
    }

    /// Whether a run ends at the edge of the grid.
    #[must_use]
    pub fn at_edge(&self, run: &Range<usize>) -> bool {
        run.start < self.columns
            || run.end > self.len() - self.columns
            || run.start.is_multiple_of(self.columns)
            || run.end.is_multiple_of(self.columns)
    }

    /// The part of the grid that holds some runs and a cell more on each side where there is one, and for
    /// each of its cells whether the runs hold it.
    #[must_use]
    pub fn around(&self, runs: &[Range<usize>]) -> (Self, Vec<bool>) {
        let fold = |of: fn(&Range<usize>, usize) -> usize, pick: fn(usize, usize) -> usize, start: usize| {
            runs.iter().map(|r| of(r, self.columns)).fold(start, pick)
        };
        let low = [
            fold(|r, n| r.start % n, usize::min, self.columns).saturating_sub(1),
            fold(|r, n| r.start / n, usize::min, self.rows).saturating_sub(1),
        ];
        let high = [
            (fold(|r, n| (r.end - 1) % n, usize::max, 0) + 2).min(self.columns),
            (fold(|r, n| (r.end - 1) / n, usize::max, 0) + 2).min(self.rows),
        ];
        let (columns, rows) = (high[0] - low[0], high[1] - low[1]);
        let part = Self { low: self.corner(low[0], low[1]), cell_m: self.cell_m, columns, rows };
        let mut held = vec![false; part.len()];
        for cell in runs.iter().cloned().flatten() {
            held[(cell / self.columns - low[1]) * columns + cell % self.columns - low[0]] = true;
        }
        (part, held)
    }
}

/// The run that names itself at the end of a chain, which is shortened on the way.
fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may stop")]
mod tests {
    use super::*;
    use crate::surfaces::cover::height_in;

    fn raster() -> Raster {
        Raster::new(&Region { min: [-3.0, 2.0], max: [7.0, 8.0] }, 0.25)
    }

    #[test]
    fn triangles_cover_the_cells_whose_middles_they_hold() {
        let raster = raster();
        assert_eq!((raster.columns, raster.rows), (40, 24));
        let mut random = random::Stream::new(1, 0, "test/raster", 0);
        let mut marked = 0;
        for _ in 0..300 {
            let corners =
                [(); 3].map(|()| Point3::new(random.uniform(-5.0, 9.0), random.uniform(0.0, 10.0), 0.0));
            let mut under = vec![0; raster.len()];
            raster.under(&corners, [0, raster.columns], [0, raster.rows], |i| under[i] += 1);
            for (i, times) in under.iter().enumerate() {
                let [x, y] = raster.middle(i);
                assert_eq!(raster.cell(x, y), Some(i));
                assert_eq!(*times, i32::from(height_in(&corners, x, y).is_some()), "{corners:?} {x} {y}");
                marked += times;
            }
            // Two halves of the grid make the whole.
            let mut halves = vec![0; raster.len()];
            for columns in [[0, 17], [17, raster.columns]] {
                raster.under(&corners, columns, [0, raster.rows], |i| halves[i] += 1);
            }
            assert_eq!(halves, under);
        }
        assert!(marked > 10_000);
    }

    #[test]
    fn quarters_lie_in_their_cell() {
        let raster = raster();
        let fine = raster.halved();
        let mut seen = vec![0; fine.len()];
        for cell in 0..raster.len() {
            for quarter in raster.quarters(cell) {
                let [x, y] = fine.middle(quarter);
                assert_eq!(raster.cell(x, y), Some(cell));
                seen[quarter] += 1;
            }
        }
        assert!(seen.iter().all(|n| *n == 1));
    }

    #[test]
    fn distances_are_those_of_brute_force() {
        let raster = raster();
        let seeds = [5, 330, 331, 700];
        let far = raster.distances_m(|i| seeds.contains(&i));
        for (i, far) in far.iter().enumerate() {
            let [x, y] = raster.middle(i);
            let least = seeds.map(|s| {
                let [u, v] = raster.middle(s);
                ((x - u) * (x - u) + (y - v) * (y - v)).sqrt()
            });
            let least = least.into_iter().fold(f64::INFINITY, f64::min);
            let share = (f64::from(*far) + 1e-5) / (least + 1e-5);
            assert!((0.9999..1.083).contains(&share), "{far} instead of {least}");
        }
        assert!(raster.distances_m(|_| false).iter().all(|d| d.is_infinite()));
    }

    #[test]
    fn groups_are_those_of_a_flood() {
        let raster = raster();
        let mut random = random::Stream::new(2, 0, "test/raster/groups", 0);
        for share in [0.0, 0.3, 0.5, 0.6, 0.7, 1.0] {
            let wanted: Vec<bool> = (0..raster.len()).map(|_| random.chance(share)).collect();
            let groups = raster.groups(|i| wanted[i]);
            let mut seen = vec![false; raster.len()];
            for group in &groups {
                // From the first cell a flood reaches all others and no more.
                let mut flood = vec![group[0].start];
                seen[group[0].start] = true;
                let mut next = 0;
                while next < flood.len() {
                    let near: Vec<usize> =
                        raster.beside(flood[next]).filter(|i| wanted[*i] && !seen[*i]).collect();
                    near.iter().for_each(|i| seen[*i] = true);
                    flood.extend(near);
                    next += 1;
                }
                flood.sort_unstable();
                assert_eq!(group.iter().cloned().flatten().collect::<Vec<_>>(), flood);
                let edge = |i: &usize| raster.beside(*i).count() < 4;
                assert_eq!(group.iter().any(|r| raster.at_edge(r)), flood.iter().any(edge));

                let (part, held) = raster.around(group);
                let cells = (0..part.len()).filter(|i| held[*i]).map(|i| {
                    let [x, y] = part.middle(i);
                    raster.cell(x, y).unwrap()
                });
                assert_eq!(cells.collect::<Vec<_>>(), flood);
            }
            assert_eq!(seen, wanted);
        }
    }
}
