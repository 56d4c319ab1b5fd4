//! The land around the roads: a height grid that stays under every lane.

use nalgebra::Point3;
use schema::Tag;
use schema::geometry::{Part, Surface};

use crate::cover::Facet;
use crate::layer::Layer;
use crate::materials::GRASS;
use crate::region::Region;
use crate::sections::{Ground, Section};
use crate::tiles::Tiles;
use crate::water::Water;

const WATER: Part = Part::new(Tag::Water, Surface::Glass, [0.03, 0.055, 0.06]);
/// Finest grid, metres.
const CELL_M: f64 = 4.0;
/// Most nodes along one side of the grid.
const MAX_NODES: f64 = 700.0;
/// The land stays this far under lanes, metres.
const UNDER_M: f64 = 0.09;
/// Steepest land (rise over run).
const SLOPE: f64 = 0.5;
/// The beds of waters lie this far under their level, metres.
const BED_M: f64 = 1.5;
/// Lanes are sampled this densely across and along, metres.
const SAMPLE_M: f64 = 1.0;

/// A height grid over a region.
#[derive(Debug)]
pub(crate) struct Terrain {
    origin: [f64; 2],
    cell: f64,
    columns: usize,
    rows: usize,
    heights: Vec<f64>,
}

impl Terrain {
    /// The land of a region, from the lanes of its sections, the patches between them and the waters.
    pub(crate) fn new(sections: &[Section], patches: &[Facet], waters: &[Water], region: &Region) -> Self {
        let extent = (region.max[0] - region.min[0]).max(region.max[1] - region.min[1]);
        let cell = CELL_M.max(extent / MAX_NODES);
        let nodes = |low: f64, high: f64| ((high - low) / cell).ceil().max(1.0) as usize + 1;
        let columns = nodes(region.min[0], region.max[0]);
        let rows = nodes(region.min[1], region.max[1]);
        let mut terrain = Self { origin: region.min, cell, columns, rows, heights: Vec::new() };
        let mut caps = terrain.caps(sections);
        terrain.stay_under(&mut caps, patches);
        terrain.sink(&mut caps, waters);
        terrain.heights = filled(caps, columns, rows);
        terrain.limit_slope();
        terrain
    }

    /// The highest height of each node that keeps the cells around it under all lanes; infinite where no lane is.
    fn caps(&self, sections: &[Section]) -> Vec<f64> {
        let mut caps = vec![f64::INFINITY; self.columns * self.rows];
        for section in sections {
            for strip in section.strips.iter().filter(|s| s.ground != Ground::Land) {
                for i in 0..section.s.len() - 1 {
                    let (r0, r1, l0, l1) =
                        (strip.right[i], strip.right[i + 1], strip.left[i], strip.left[i + 1]);
                    let raise = strip.raise[i][0].max(strip.raise[i][1]);
                    let along =
                        ((r1 - r0).norm().max((l1 - l0).norm()) / SAMPLE_M).ceil().clamp(1.0, 64.0) as usize;
                    let across =
                        ((l0 - r0).norm().max((l1 - r1).norm()) / SAMPLE_M).ceil().clamp(1.0, 64.0) as usize;
                    for a in 0..=along {
                        let u = a as f64 / along as f64;
                        let (right, left) = (r0 + (r1 - r0) * u, l0 + (l1 - l0) * u);
                        for b in 0..=across {
                            let p = right + (left - right) * (b as f64 / across as f64);
                            self.cap(&mut caps, p, p.z - raise - UNDER_M);
                        }
                    }
                }
            }
        }
        caps
    }

    /// Lowers the nodes around facets, which are narrow.
    fn stay_under(&self, caps: &mut [f64], facets: &[Facet]) {
        for facet in facets {
            for k in 0..3 {
                let (a, b) = (facet.corners[k], facet.corners[(k + 1) % 3]);
                let pieces = ((b - a).norm() / SAMPLE_M).ceil().clamp(1.0, 200.0) as usize;
                for i in 0..pieces {
                    let p = a + (b - a) * (i as f64 / pieces as f64);
                    self.cap(caps, p, p.z - UNDER_M);
                }
            }
        }
    }

    /// Lowers the nodes in and beside waters, so that land falls through their level at their edge.
    fn sink(&self, caps: &mut [f64], waters: &[Water]) {
        let reach = 2.0 * self.cell;
        for water in waters {
            for (i, cap) in caps.iter_mut().enumerate() {
                let (c, r) = (i % self.columns, i / self.columns);
                let [x, y] = [(c, 0), (r, 1)].map(|(k, axis)| self.origin[axis] + k as f64 * self.cell);
                let clearance = water.clearance_m(x, y, reach);
                if clearance < reach {
                    *cap = cap.min(water.z_m + (SLOPE * clearance).max(-BED_M));
                }
            }
        }
    }

    /// Lowers the nodes of the cells that a point, or a point half a sample away, lies in.
    fn cap(&self, caps: &mut [f64], p: Point3<f64>, z: f64) {
        // The first and last nodes of the cells.
        let nodes = |v: f64, low: f64, n: usize| {
            let [first, last] = [-0.6, 0.6].map(|by| ((v + by * SAMPLE_M - low) / self.cell).floor());
            let last = (last + 1.0).min((n - 1) as f64);
            (first < last && last > 0.0).then(|| (first.max(0.0) as usize, last as usize))
        };
        let columns = nodes(p.x, self.origin[0], self.columns);
        let rows = nodes(p.y, self.origin[1], self.rows);
        let (Some((c0, c1)), Some((r0, r1))) = (columns, rows) else { return };
        for row in r0..=r1 {
            for cap in &mut caps[row * self.columns + c0..=row * self.columns + c1] {
                *cap = cap.min(z);
            }
        }
    }

    /// Lowers nodes until no slope is steeper than [`SLOPE`]: two sweeps of a chamfer distance (Borgefors, 1986).
    fn limit_slope(&mut self) {
        let (straight, diagonal) = (SLOPE * self.cell, SLOPE * self.cell * std::f64::consts::SQRT_2);
        let (columns, rows) = (self.columns as isize, self.rows as isize);
        let forward = [(-1, 0, straight), (0, -1, straight), (-1, -1, diagonal), (1, -1, diagonal)];
        for sign in [1isize, -1] {
            for k in 0..columns * rows {
                let i = if sign > 0 { k } else { columns * rows - 1 - k };
                let (c, r) = (i % columns, i / columns);
                for (dc, dr, rise) in forward {
                    let (nc, nr) = (c + sign * dc, r + sign * dr);
                    if nc >= 0 && nc < columns && nr >= 0 && nr < rows {
                        let limit = self.heights[(nr * columns + nc) as usize] + rise;
                        let height = &mut self.heights[i as usize];
                        *height = height.min(limit);
                    }
                }
            }
        }
    }

    fn node(&self, column: usize, row: usize) -> Point3<f64> {
        let z = self.heights[row * self.columns + column];
        Point3::new(self.origin[0] + column as f64 * self.cell, self.origin[1] + row as f64 * self.cell, z)
    }

    /// Height of the land at a point; beyond the grid that of its edge.
    pub(crate) fn height(&self, x: f64, y: f64) -> f64 {
        let at = |v: f64, low: f64, n: usize| {
            let share = ((v - low) / self.cell).clamp(0.0, (n - 1) as f64);
            let cell = (share.floor() as usize).min(n - 2);
            (cell, share - cell as f64)
        };
        let (c, u) = at(x, self.origin[0], self.columns);
        let (r, v) = at(y, self.origin[1], self.rows);
        let z = |dc: usize, dr: usize| self.heights[(r + dr) * self.columns + c + dc];
        // The two triangles of a cell meet in the diagonal from (0, 0) to (1, 1).
        if u >= v {
            z(0, 0) + u * (z(1, 0) - z(0, 0)) + v * (z(1, 1) - z(1, 0))
        } else {
            z(0, 0) + v * (z(0, 1) - z(0, 0)) + u * (z(1, 1) - z(0, 1))
        }
    }

    /// The corners of every cell, counter-clockwise from its south-west.
    fn cells(&self) -> impl Iterator<Item = [Point3<f64>; 4]> {
        let corners =
            |c, r| [self.node(c, r), self.node(c + 1, r), self.node(c + 1, r + 1), self.node(c, r + 1)];
        (0..self.rows - 1).flat_map(move |r| (0..self.columns - 1).map(move |c| corners(c, r)))
    }

    pub(crate) fn build(&self, tiles: &mut Tiles) {
        for corners in self.cells() {
            tiles.quad(Layer::Terrain, GRASS, corners);
        }
    }

    /// Water over every cell of the land that reaches below it in or beside its outline: the shore is where land rises
    /// through it.
    pub(crate) fn build_waters(&self, waters: &[Water], tiles: &mut Tiles) {
        for water in waters {
            for corners in self.cells() {
                let reach = 1.5 * (corners[2].x - corners[0].x);
                let middle = nalgebra::center(&corners[0], &corners[2]);
                if corners.iter().any(|p| p.z < water.z_m)
                    && water.clearance_m(middle.x, middle.y, reach) < reach
                {
                    tiles.quad(Layer::Water, WATER, corners.map(|p| Point3::new(p.x, p.y, water.z_m)));
                }
            }
        }
    }
}

/// Fills nodes without a value from those with one: averages over ever larger squares, then back down, so that the land between
/// roads is smooth (push and pull, Gortler et al., 1996).
fn filled(values: Vec<f64>, columns: usize, rows: usize) -> Vec<f64> {
    if values.iter().all(|v| v.is_finite()) {
        return values;
    }
    if values.iter().all(|v| !v.is_finite()) {
        return vec![0.0; values.len()];
    }
    let (half_columns, half_rows) = (columns.div_ceil(2), rows.div_ceil(2));
    let mut sums = vec![(0.0, 0.0f64); half_columns * half_rows];
    for (i, v) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
        let (c, r) = (i % columns, i / columns);
        let sum = &mut sums[(r / 2) * half_columns + c / 2];
        sum.0 += v;
        sum.1 += 1.0;
    }
    let coarse = sums.iter().map(|(sum, n)| if *n > 0.0 { sum / n } else { f64::INFINITY }).collect();
    let coarse = filled(coarse, half_columns, half_rows);
    let sample = |c: usize, r: usize| {
        // Coarse values sit in the middle of two by two nodes.
        let axis = |i: usize, n: usize| {
            let at = (0.5 * (i as f64 - 0.5)).clamp(0.0, (n - 1) as f64);
            let low = (at.floor() as usize).min(n.saturating_sub(2));
            (low, (low + 1).min(n - 1), at - low as f64)
        };
        let (c0, c1, u) = axis(c, half_columns);
        let (r0, r1, v) = axis(r, half_rows);
        let z = |c: usize, r: usize| coarse[r * half_columns + c];
        let low = z(c0, r0) + u * (z(c1, r0) - z(c0, r0));
        let high = z(c0, r1) + u * (z(c1, r1) - z(c0, r1));
        low + v * (high - low)
    };
    values
        .iter()
        .enumerate()
        .map(|(i, v)| if v.is_finite() { *v } else { sample(i % columns, i / columns) })
        .collect()
}
