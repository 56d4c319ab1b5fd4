//! Areas and lines drawn into the cells of a mask and some cells around it.

use crate::space::V3;

/// Cells that something covers, and how high it is there.
#[derive(Clone, Debug)]
pub(crate) struct Cover {
    /// Cells along a side, those around included, and how many these are.
    pub(crate) side: usize,
    margin: usize,
    pub(crate) covered: Vec<bool>,
    /// Least and greatest height, m.
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
}

impl Cover {
    /// Of nothing, for masks of some cells a side.
    pub(crate) fn new(cells: usize, margin: usize) -> Self {
        let side = cells + 2 * margin;
        Self {
            side,
            margin,
            covered: vec![false; side * side],
            low: vec![f64::INFINITY; side * side],
            high: vec![f64::NEG_INFINITY; side * side],
        }
    }

    /// The number here of a mask's cell.
    pub(crate) fn cell(&self, row: usize, column: usize) -> usize {
        (row + self.margin) * self.side + column + self.margin
    }

    fn add(&mut self, cell: usize, z: f64) {
        self.covered[cell] = true;
        self.low[cell] = self.low[cell].min(z);
        self.high[cell] = self.high[cell].max(z);
    }

    /// Covers the cells whose middles are inside of an odd number of rings. Points are row and column from
    /// the first cell's middle, and height; between the borders that a row meets the height goes straight.
    pub(crate) fn fill(&mut self, rings: &[Vec<V3>]) {
        let rows = || rings.iter().flatten().map(|point| point[0]);
        let margin = self.margin as f64;
        let first = (rows().fold(f64::INFINITY, f64::min) + margin).ceil().max(0.0);
        let last = (rows().fold(f64::NEG_INFINITY, f64::max) + margin).floor().min(self.side as f64 - 1.0);
        if first > last {
            return;
        }
        for row in first as usize..=last as usize {
            let at = row as f64 - margin;
            let mut borders: Vec<[f64; 2]> = Vec::new();
            for ring in rings {
                for (k, b) in ring.iter().enumerate() {
                    let a = ring[(k + ring.len() - 1) % ring.len()];
                    if (a[0] > at) != (b[0] > at) {
                        let share = (at - a[0]) / (b[0] - a[0]);
                        borders.push([1, 2].map(|i| a[i] + share * (b[i] - a[i])));
                    }
                }
            }
            borders.sort_by(|a, b| a[0].total_cmp(&b[0]));
            for pair in borders.as_chunks::<2>().0 {
                let [[left, z_left], [right, z_right]] = *pair;
                let mut column = (left + margin).ceil().max(0.0);
                while column <= (right + margin).min(self.side as f64 - 1.0) {
                    let share = if right > left { (column - margin - left) / (right - left) } else { 0.0 };
                    self.add(row * self.side + column as usize, z_left + share * (z_right - z_left));
                    column += 1.0;
                }
            }
        }
    }

    /// Covers the cells that a chain of points goes through, looked at every tenth of a cell.
    pub(crate) fn draw(&mut self, points: &[V3]) {
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
            let steps = (10.0 * length).ceil().max(1.0);
            for k in 0..=steps as usize {
                let at = [0, 1, 2].map(|i| from[i] + (to[i] - from[i]) * k as f64 / steps);
                let place = [0, 1].map(|i| at[i].round() + self.margin as f64);
                if place.iter().all(|&p| p >= 0.0 && p < self.side as f64) {
                    self.add(place[0] as usize * self.side + place[1] as usize, at[2]);
                }
            }
        }
    }

    /// Sums of the covered cells, to look at many at once.
    pub(crate) fn sums(&self) -> Sums {
        Sums::of(self.side, &self.covered)
    }

    /// Whether heights in a cell and its neighbours all lie within some metres: no deck above another.
    pub(crate) fn is_level(&self, cell: usize, within_m: f64) -> bool {
        let (row, column) = (cell / self.side, cell % self.side);
        if row == 0 || column == 0 || row + 1 == self.side || column + 1 == self.side {
            return false;
        }
        let around = (0..9).map(|k| (row + k / 3 - 1) * self.side + column + k % 3 - 1);
        let (low, high) = around.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), cell| {
            (low.min(self.low[cell]), high.max(self.high[cell]))
        });
        high - low <= within_m
    }

    /// Cells that are reached from some others, neighbour by neighbour, over covered cells of one height
    /// each, by steps of at most so many metres.
    pub(crate) fn reached(&self, from: &[usize], step_m: f64) -> Vec<bool> {
        let is_one = |cell: usize| self.covered[cell] && self.high[cell] - self.low[cell] <= step_m;
        let mut reached = vec![false; self.covered.len()];
        let mut open: Vec<usize> = from.iter().copied().filter(|&cell| is_one(cell)).collect();
        open.iter().for_each(|&cell| reached[cell] = true);
        while let Some(cell) = open.pop() {
            let (row, column) = (cell / self.side, cell % self.side);
            let neighbours = [
                (row > 0).then(|| cell - self.side),
                (row + 1 < self.side).then_some(cell + self.side),
                (column > 0).then(|| cell - 1),
                (column + 1 < self.side).then_some(cell + 1),
            ];
            for to in neighbours.into_iter().flatten() {
                let gap = (self.low[to] - self.high[cell]).max(self.low[cell] - self.high[to]);
                if !reached[to] && is_one(to) && gap <= step_m {
                    reached[to] = true;
                    open.push(to);
                }
            }
        }
        reached
    }
}

/// Sums of cells over rectangles that begin at the first cell.
pub(crate) struct Sums {
    side: usize,
    sums: Vec<u32>,
}

impl Sums {
    pub(crate) fn of(side: usize, cells: &[bool]) -> Self {
        let mut sums = vec![0; (side + 1) * (side + 1)];
        for row in 0..side {
            for column in 0..side {
                let above = row * (side + 1) + column;
                let here = above + side + 2;
                sums[here] =
                    sums[here - 1] + sums[above + 1] - sums[above] + u32::from(cells[row * side + column]);
            }
        }
        Self { side, sums }
    }

    /// How many cells are set in the square of so many cells on each side of one, and how many there are.
    fn around(&self, cell: usize, reach: usize) -> (u32, u32) {
        let ends = |at: usize| (at.saturating_sub(reach), (at + reach + 1).min(self.side));
        let ((top, bottom), (left, right)) = (ends(cell / self.side), ends(cell % self.side));
        let sum = |row: usize, column: usize| self.sums[row * (self.side + 1) + column];
        let set = sum(bottom, right) + sum(top, left) - sum(bottom, left) - sum(top, right);
        (set, ((bottom - top) * (right - left)) as u32)
    }

    /// Whether all cells of the square are set.
    pub(crate) fn all(&self, cell: usize, reach: usize) -> bool {
        let (set, cells) = self.around(cell, reach);
        set == cells
    }

    /// Whether a cell that is not set is alone among the nine about it, or with one other.
    pub(crate) fn is_lone_gap(&self, cell: usize) -> bool {
        let (set, cells) = self.around(cell, 1);
        set < cells && set + 2 >= cells
    }

    /// Whether any cell of the square is.
    pub(crate) fn any(&self, cell: usize, reach: usize) -> bool {
        self.around(cell, reach).0 > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(cover: &Cover) -> Vec<usize> {
        (0..cover.covered.len()).filter(|&cell| cover.covered[cell]).collect()
    }

    #[test]
    fn rings_cover_middles_with_the_height_between_their_borders() {
        let mut cover = Cover::new(4, 1);
        // Rows 0 to 2 and columns 1 to 2 of the mask, with a hole around (1, 1); the height is ten times the
        // column.
        let ring = |low: f64, high: f64, left: f64, right: f64| {
            vec![
                [low, left, 10.0 * left],
                [low, right, 10.0 * right],
                [high, right, 10.0 * right],
                [high, left, 10.0 * left],
            ]
        };
        cover.fill(&[ring(-0.5, 2.5, 0.5, 2.5), ring(0.6, 1.4, 0.6, 1.4)]);
        let want: Vec<usize> =
            [(0, 1), (0, 2), (1, 2), (2, 1), (2, 2)].map(|(r, c)| cover.cell(r, c)).to_vec();
        assert_eq!(cells(&cover), want);
        assert!((cover.low[cover.cell(1, 2)] - 20.0).abs() < 1e-9);
        cover.fill(&[ring(-9.0, 9.0, -9.0, 9.0)]);
        assert_eq!(cells(&cover).len(), 36, "cells around the mask, too");
    }

    #[test]
    fn chains_cover_the_cells_they_go_through() {
        let mut cover = Cover::new(4, 0);
        cover.draw(&[[0.0, 0.0, 1.0], [0.0, 3.0, 4.0], [9.0, 3.0, 4.0]]);
        assert_eq!(cells(&cover), [0, 1, 2, 3, 7, 11, 15]);
        assert!((cover.low[2] - 2.5).abs() < 0.11 && (cover.high[2] - 3.5).abs() < 0.11);
    }

    #[test]
    fn squares_are_summed() {
        let mut cover = Cover::new(5, 0);
        cover.fill(&[vec![[0.5, 0.5, 0.0], [0.5, 9.0, 0.0], [9.0, 9.0, 0.0], [9.0, 0.5, 0.0]]]);
        let sums = cover.sums();
        assert!(sums.all(cover.cell(2, 2), 1) && !sums.all(cover.cell(2, 2), 2));
        assert!(!sums.is_lone_gap(cover.cell(2, 2)) && !sums.is_lone_gap(cover.cell(1, 0)));
        let mut gap = cover.covered.clone();
        for (column, is_lone) in [(3, true), (2, true), (4, false)] {
            gap[cover.cell(3, column)] = false;
            assert_eq!(Sums::of(5, &gap).is_lone_gap(cover.cell(3, 3)), is_lone, "{column}");
        }
        assert!(sums.all(cover.cell(4, 4), 2), "what is beyond is not looked at");
        assert!(!sums.any(cover.cell(0, 0), 0) && sums.any(cover.cell(0, 0), 1));
    }

    #[test]
    fn decks_are_not_reached_from_below() {
        let mut cover = Cover::new(6, 0);
        let strip = |rows: [f64; 2], columns: [f64; 2], z: f64| {
            vec![
                [rows[0], columns[0], z],
                [rows[0], columns[1], z],
                [rows[1], columns[1], z],
                [rows[1], columns[0], z],
            ]
        };
        // A road along row 1, a deck 5 m above that crosses it in column 3, and one that joins the road in
        // column 5.
        cover.fill(&[strip([0.5, 1.5], [-0.5, 5.5], 0.0)]);
        cover.fill(&[strip([-0.5, 5.5], [2.5, 3.5], 5.0)]);
        cover.fill(&[strip([1.5, 4.5], [4.5, 5.5], 0.3)]);
        let start = [cover.cell(1, 0)];
        assert_eq!(cover.reached(&start, 0.5).iter().filter(|&&r| r).count(), 3, "the road up to the deck");
        assert!(cover.is_level(cover.cell(1, 1), 1.0) && !cover.is_level(cover.cell(1, 2), 1.0));
        let beyond = [cover.cell(1, 4)];
        assert_eq!(cover.reached(&beyond, 0.5).iter().filter(|&&r| r).count(), 5);
        assert_eq!(cover.reached(&beyond, 0.2).iter().filter(|&&r| r).count(), 2);
    }
}
