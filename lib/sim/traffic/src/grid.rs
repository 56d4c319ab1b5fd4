//! Positions in square cells: a sorted list, so that a look at a cell and those around it is three
//! searches.

/// Numbers of things by cell.
#[derive(Debug)]
pub(crate) struct Grid {
    cell_m: f64,
    /// Cell and number, sorted; those of one cell in the order in which they came.
    sorted: Vec<((i32, i32), usize)>,
}

fn cell([x_m, y_m]: [f64; 2], cell_m: f64) -> (i32, i32) {
    ((x_m / cell_m).floor() as i32, (y_m / cell_m).floor() as i32)
}

impl Grid {
    pub(crate) fn new(cell_m: f64) -> Self {
        Self { cell_m, sorted: Vec::new() }
    }

    pub(crate) fn clear(&mut self) {
        self.sorted.clear();
    }

    /// Adds a thing at a place.
    pub(crate) fn insert(&mut self, x_m: f64, y_m: f64, number: usize) {
        let cell = cell([x_m, y_m], self.cell_m);
        let at = self.sorted.partition_point(|(other, _)| *other <= cell);
        self.sorted.insert(at, (cell, number));
    }

    /// Adds things, given by place and number, at once.
    pub(crate) fn fill(&mut self, things: impl Iterator<Item = ([f64; 2], usize)>) {
        let (cell_m, sorted) = (self.cell_m, &mut self.sorted);
        sorted.extend(things.map(|([x, y], number)| (cell([x, y], cell_m), number)));
        sorted.sort_unstable();
    }

    /// Everything in the cell of a place and the eight around it: all within a cell's side are among them.
    pub(crate) fn around(&self, x_m: f64, y_m: f64) -> impl Iterator<Item = usize> + '_ {
        let (x, y) = cell([x_m, y_m], self.cell_m);
        (x.saturating_sub(1)..=x.saturating_add(1)).flat_map(move |column| {
            let last = (column, y.saturating_add(1));
            let from = self.sorted.partition_point(|(cell, _)| *cell < (column, y.saturating_sub(1)));
            self.sorted[from..].iter().take_while(move |(cell, _)| *cell <= last).map(|(_, number)| *number)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_within_a_cells_side_are_found_once(
            points in prop::collection::vec((-20.0..20.0f64, -20.0..20.0f64), 0..60),
            x in -20.0..20.0f64,
            y in -20.0..20.0f64,
        ) {
            let mut grid = Grid::new(3.0);
            for (i, (x, y)) in points.iter().enumerate() {
                grid.insert(*x, *y, i);
            }
            let mut filled = Grid::new(3.0);
            filled.fill(points.iter().enumerate().map(|(i, (x, y))| ([*x, *y], i)));
            prop_assert_eq!(&grid.sorted, &filled.sorted);
            let mut found: Vec<usize> = grid.around(x, y).collect();
            found.sort_unstable();
            prop_assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
            for (i, (px, py)) in points.iter().enumerate() {
                let near = (px - x).abs() <= 3.0 && (py - y).abs() <= 3.0;
                let far = (px - x).abs() > 6.0 || (py - y).abs() > 6.0;
                let is_found = found.binary_search(&i).is_ok();
                prop_assert!(if near { is_found } else { !(far && is_found) }, "{i}");
            }
            grid.clear();
            prop_assert_eq!(grid.around(x, y).count(), 0);
        }
    }
}
