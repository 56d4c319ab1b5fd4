//! Voxel grids that rays pass through.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::PictureError;

/// Cells along the side of a block. Blocks without an occupied cell are passed in one step.
const BLOCK: usize = 8;

/// A grid of cells with a tag each, 0 free.
#[derive(Clone, Debug)]
pub struct VoxelGrid {
    shape: [usize; 3],
    tags: Vec<u8>,
    blocks: [usize; 3],
    is_occupied: Vec<bool>,
    /// Corner of the first cell in the agent's frame, and side of a cell, metres.
    lower_m: [f64; 3],
    voxel_m: f64,
}

/// Where a ray meets an occupied cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// The cell.
    pub(crate) cell: [i64; 3],
    /// The axis across the face that it meets, and the way that the face looks.
    pub(crate) axis: usize,
    pub(crate) outwards: i64,
    /// How far along the ray, in lengths of its direction.
    pub(crate) along: f64,
}

impl VoxelGrid {
    /// Of tags in C order; `lower_m` is the grid's lowest corner in the agent's frame.
    ///
    /// # Errors
    /// There are not as many cells as that.
    pub fn new(
        shape: [usize; 3],
        tags: Vec<u8>,
        lower_m: [f64; 3],
        voxel_m: f64,
    ) -> Result<Self, PictureError> {
        let expected = shape.iter().product();
        if tags.len() != expected {
            return Err(PictureError::Shape { what: "voxels", found: tags.len(), expected });
        }
        let blocks = shape.map(|n| n.div_ceil(BLOCK));
        let layer = blocks[1] * blocks[2];
        let mut is_occupied = vec![false; blocks[0] * layer];
        let [_, ny, nz] = shape;
        is_occupied.par_chunks_mut(layer.max(1)).enumerate().for_each(|(bx, layer)| {
            for x in bx * BLOCK..((bx + 1) * BLOCK).min(shape[0]) {
                for y in 0..ny {
                    let column = &tags[(x * ny + y) * nz..][..nz];
                    for (bz, part) in column.chunks(BLOCK).enumerate() {
                        layer[y / BLOCK * blocks[2] + bz] |= part.iter().any(|tag| *tag != 0);
                    }
                }
            }
        });
        Ok(Self { shape, tags, blocks, is_occupied, lower_m, voxel_m })
    }

    /// Side of a cell, metres.
    pub(crate) fn voxel_m(&self) -> f64 {
        self.voxel_m
    }

    /// The tag of a cell; 0 outside.
    pub(crate) fn tag(&self, cell: [i64; 3]) -> u8 {
        let inside = (0..3).all(|k| cell[k] >= 0 && (cell[k] as usize) < self.shape[k]);
        if !inside {
            return 0;
        }
        let [x, y, z] = cell.map(|i| i as usize);
        self.tags[(x * self.shape[1] + y) * self.shape[2] + z]
    }

    /// A point of the agent's frame in cells from the grid's lowest corner.
    pub(crate) fn in_cells(&self, point: Point3<f64>) -> Point3<f64> {
        Point3::from([0, 1, 2].map(|k| (point[k] - self.lower_m[k]) / self.voxel_m))
    }

    /// The first occupied cell on a ray from a place (in cells) on, not before `from` lengths of its
    /// direction.
    pub(crate) fn first_hit(&self, origin: Point3<f64>, direction: Vector3<f64>, from: f64) -> Option<Hit> {
        let block = BLOCK as f64;
        let whole = self.shape.map(|n| n as f64);
        let (enter, leave, axis) = span(origin, direction, [0.0; 3], whole)?;
        let start = enter.max(from);
        if start >= leave {
            return None;
        }
        let blocks = self.blocks.map(|n| n as i64);
        for step in Walk::new(origin, direction, block, ([0; 3], blocks), start, axis) {
            let [x, y, z] = step.cell.map(|i| i as usize);
            if !self.is_occupied[(x * self.blocks[1] + y) * self.blocks[2] + z] {
                continue;
            }
            let low = step.cell.map(|i| i * BLOCK as i64);
            let high = [0, 1, 2].map(|k| (low[k] + BLOCK as i64).min(self.shape[k] as i64));
            for fine in Walk::new(origin, direction, 1.0, (low, high), step.enter, step.axis) {
                if self.tag(fine.cell) != 0 {
                    let outwards = if direction[fine.axis] > 0.0 { -1 } else { 1 };
                    return Some(Hit { cell: fine.cell, axis: fine.axis, outwards, along: fine.enter });
                }
            }
        }
        None
    }
}

/// From where to where a ray is in a box, and across which axis it enters.
fn span(
    origin: Point3<f64>,
    direction: Vector3<f64>,
    low: [f64; 3],
    high: [f64; 3],
) -> Option<(f64, f64, usize)> {
    let (mut enter, mut leave, mut axis) = (0.0_f64, f64::INFINITY, 2);
    for k in 0..3 {
        if direction[k] == 0.0 {
            if origin[k] < low[k] || origin[k] >= high[k] {
                return None;
            }
            continue;
        }
        let ends = [(low[k] - origin[k]) / direction[k], (high[k] - origin[k]) / direction[k]];
        let (first, last) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if first > enter {
            (enter, axis) = (first, k);
        }
        leave = leave.min(last);
    }
    (enter < leave).then_some((enter, leave, axis))
}

/// A step of a walk: a cell, where the ray enters it, and across which axis.
struct Step {
    cell: [i64; 3],
    enter: f64,
    axis: usize,
}

/// The cells that a ray passes, in order (Amanatides and Woo, "A fast voxel traversal algorithm for ray
/// tracing", 1987).
struct Walk {
    cell: [i64; 3],
    bounds: ([i64; 3], [i64; 3]),
    step: [i64; 3],
    /// Where the ray leaves the cell across each axis, and how far it is from there to the next.
    next: [f64; 3],
    pitch: [f64; 3],
    enter: f64,
    axis: usize,
}

impl Walk {
    /// From `start` on, within cells `low` to below `high` of a side.
    fn new(
        origin: Point3<f64>,
        direction: Vector3<f64>,
        side: f64,
        (low, high): ([i64; 3], [i64; 3]),
        start: f64,
        axis: usize,
    ) -> Self {
        let at = origin + direction * start;
        let (mut cell, mut step, mut next, mut pitch) = ([0; 3], [0; 3], [f64::INFINITY; 3], [0.0; 3]);
        for k in 0..3 {
            // Rounding may put the start beyond the border that the ray has just crossed.
            cell[k] = ((at[k] / side).floor() as i64).clamp(low[k], (high[k] - 1).max(low[k]));
            if direction[k] != 0.0 {
                let is_up = direction[k] > 0.0;
                step[k] = if is_up { 1 } else { -1 };
                let border = (cell[k] + i64::from(is_up)) as f64 * side;
                next[k] = (border - origin[k]) / direction[k];
                pitch[k] = side / direction[k].abs();
            }
        }
        Self { cell, bounds: (low, high), step, next, pitch, enter: start, axis }
    }
}

impl Iterator for Walk {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        let (low, high) = self.bounds;
        let is_inside = (0..3).all(|k| self.cell[k] >= low[k] && self.cell[k] < high[k]);
        if !is_inside {
            return None;
        }
        let here = Step { cell: self.cell, enter: self.enter, axis: self.axis };
        let k = if self.next[0] <= self.next[1] && self.next[0] <= self.next[2] {
            0
        } else if self.next[1] <= self.next[2] {
            1
        } else {
            2
        };
        self.enter = self.enter.max(self.next[k]);
        self.axis = k;
        self.cell[k] += self.step[k];
        self.next[k] += self.pitch[k];
        // A ray without direction stays where it is.
        if self.step[k] == 0 {
            self.bounds.1 = self.bounds.0;
        }
        Some(here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid with every 37th cell occupied or so.
    fn grid() -> VoxelGrid {
        let shape = [19, 17, 11];
        let tags = (0..shape.iter().product::<usize>()).map(|i| u8::from(i * i % 37 == 7)).collect();
        VoxelGrid::new(shape, tags, [0.0; 3], 1.0).expect("fits")
    }

    /// The first occupied cell by trying all of them.
    fn by_trying(grid: &VoxelGrid, origin: Point3<f64>, direction: Vector3<f64>) -> Option<([i64; 3], f64)> {
        let mut best: Option<([i64; 3], f64)> = None;
        for x in 0..grid.shape[0] as i64 {
            for y in 0..grid.shape[1] as i64 {
                for z in 0..grid.shape[2] as i64 {
                    let cell = [x, y, z];
                    let (low, high) = (cell.map(|i| i as f64), cell.map(|i| (i + 1) as f64));
                    if grid.tag(cell) == 0 {
                        continue;
                    }
                    if let Some((enter, ..)) = span(origin, direction, low, high)
                        && best.is_none_or(|(_, along)| enter < along)
                    {
                        best = Some((cell, enter));
                    }
                }
            }
        }
        best
    }

    #[test]
    fn rays_meet_what_trying_all_cells_finds() {
        let grid = grid();
        let mut met = 0;
        for i in 0..400 {
            let number = |k: u32, range: f64| f64::from((i * 7919 + k * 104_729) % 1009) / 1009.0 * range;
            let origin = Point3::new(number(1, 40.0) - 10.0, number(2, 40.0) - 10.0, number(3, 20.0) - 5.0);
            let target = Point3::new(number(4, 19.0), number(5, 17.0), number(6, 11.0));
            let direction = target - origin;
            let found = grid.first_hit(origin, direction, 0.0).map(|hit| (hit.cell, hit.along));
            let wanted = by_trying(&grid, origin, direction);
            assert_eq!(found.map(|f| f.0), wanted.map(|w| w.0), "{origin} {direction}");
            if let (Some((_, a)), Some((_, b))) = (found, wanted) {
                assert!((a - b).abs() < 1e-9);
                met += 1;
            }
        }
        assert!(met > 100, "{met} rays met something");
    }

    #[test]
    fn faces_look_back_at_the_ray() {
        let mut tags = vec![0; 1000];
        tags[5 * 100 + 5 * 10 + 5] = 14;
        let grid = VoxelGrid::new([10; 3], tags, [-1.0, -1.0, 0.0], 0.2).expect("fits");
        assert!((grid.in_cells(Point3::new(0.1, -1.0, 1.0)) - Point3::new(5.5, 0.0, 5.0)).norm() < 1e-12);
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let (mut origin, mut direction) = (Point3::new(5.5, 5.5, 5.5), Vector3::zeros());
            origin[axis] -= sign * 20.0;
            direction[axis] = sign;
            let hit = grid.first_hit(origin, direction, 0.0).expect("meets it");
            assert_eq!((hit.cell, hit.axis, hit.outwards), ([5; 3], axis, -(sign as i64)));
            assert!((hit.along - 19.5).abs() < 1e-12);
            assert_eq!(grid.first_hit(origin, direction, 21.0), None, "what is nearer is passed over");
        }
        assert!(VoxelGrid::new([10; 3], vec![0; 999], [0.0; 3], 0.2).is_err());
    }
}
