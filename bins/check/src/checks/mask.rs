//! The mask of a frame, and where its cells are.

use schema::{BevClass, Tag};

use super::boxes::Labelled;

/// The mask of a frame, and where it lies.
pub(super) struct Mask {
    /// Channel by channel, row by row.
    pub(super) bits: Vec<u8>,
    pub(super) cells: usize,
    pub(super) cell_m: f64,
    /// Whether it follows our rule.
    pub(super) is_exact: bool,
    /// The agent's place, and its heading as cosine and sine.
    pub(super) origin: [f64; 2],
    pub(super) heading: [f64; 2],
}

/// The tag of what an object channel shows.
pub(super) fn tag_of(class: BevClass) -> Option<Tag> {
    use BevClass::*;
    Some(match class {
        Road | Hazard | RoadLine | Sidewalk | Crosswalk => return None,
        TrafficCone => Tag::TrafficCone,
        Barrier => Tag::Barrier,
        Car => Tag::Car,
        Truck => Tag::Truck,
        Bus => Tag::Bus,
        Motorcycle => Tag::Motorcycle,
        Bicycle => Tag::Bicycle,
        Rider => Tag::Rider,
        Pedestrian => Tag::Pedestrian,
    })
}

impl Mask {
    /// Whether a cell has all its neighbours.
    pub(super) fn is_inner(&self, cell: usize) -> bool {
        let last = self.cells - 1;
        [cell / self.cells, cell % self.cells].iter().all(|&at| at > 0 && at < last)
    }

    pub(super) fn channel(&self, class: BevClass) -> &[u8] {
        let cells = self.cells * self.cells;
        &self.bits[class as usize * cells..][..cells]
    }

    /// Row and column of a world point, in cells from the first one's middle.
    pub(super) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let (x, y) = (x - self.origin[0], y - self.origin[1]);
        let [cos, sin] = self.heading;
        let (ahead, left) = (cos * x + sin * y, cos * y - sin * x);
        let middle = 0.5 * self.cells as f64 - 0.5;
        [middle - ahead / self.cell_m, middle - left / self.cell_m]
    }

    /// Cells whose centre is within some cells of a polygon in the grid.
    pub(super) fn near(&self, polygon: &[[f64; 2]], cells: f64) -> Vec<usize> {
        let last = self.cells as f64 - 1.0;
        let ends = |axis: usize| {
            let values = || polygon.iter().map(|p| p[axis]);
            let low = values().fold(f64::INFINITY, f64::min) - cells;
            let high = values().fold(f64::NEG_INFINITY, f64::max) + cells;
            (low.ceil().max(0.0), high.floor().min(last))
        };
        let ((top, bottom), (left, right)) = (ends(0), ends(1));
        let mut found = Vec::new();
        let mut row = top;
        while row <= bottom {
            let mut column = left;
            while column <= right {
                if distance(polygon, [row, column]) <= cells {
                    found.push(row as usize * self.cells + column as usize);
                }
                column += 1.0;
            }
            row += 1.0;
        }
        found
    }

    /// What a box stands on, in cells.
    pub(super) fn footprint(&self, labelled: &Labelled) -> [[f64; 2]; 4] {
        labelled.footprint().map(|[x, y]| self.place(x, y))
    }

    /// What a box covers, in cells.
    pub(super) fn outline(&self, labelled: &Labelled) -> Vec<[f64; 2]> {
        labelled.outline().into_iter().map(|[x, y]| self.place(x, y)).collect()
    }

    /// Whether a cell that is set has its centre within some cells of a place.
    pub(super) fn is_near(&self, set: &[u8], [row, column]: [f64; 2], cells: f64) -> bool {
        let (first, last) = ((row - cells).ceil() as usize, (row + cells) as usize);
        (first..=last).any(|r| {
            let (left, right) = ((column - cells).ceil() as usize, (column + cells) as usize);
            (left..=right).any(|c| {
                set[r * self.cells + c] == 1 && libm::hypot(r as f64 - row, c as f64 - column) <= cells
            })
        })
    }
}

/// Distance of a point from a polygon, 0 inside.
fn distance(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let mut is_inside = false;
    let mut least = f64::INFINITY;
    for (k, &[bx, by]) in polygon.iter().enumerate() {
        let [ax, ay] = polygon[(k + polygon.len() - 1) % polygon.len()];
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            is_inside = !is_inside;
        }
        let (ex, ey) = (bx - ax, by - ay);
        let length = ex * ex + ey * ey;
        let share =
            if length > 0.0 { (((x - ax) * ex + (y - ay) * ey) / length).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min(libm::hypot(ax + share * ex - x, ay + share * ey - y));
    }
    if is_inside { 0.0 } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_a_square() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        for (point, want) in
            [([1.0, 1.0], 0.0), ([3.0, 1.0], 1.0), ([3.0, 3.0], 2.0_f64.sqrt()), ([-0.5, 0.2], 0.5)]
        {
            assert!((distance(&square, point) - want).abs() < 1e-12, "{point:?}");
        }
        assert_eq!(distance(&[], [0.0, 0.0]), f64::INFINITY);
    }
}
