//! The land around the roads: a height grid that stays under every lane.

use nalgebra::Point3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface};

use crate::surfaces::blocks::Blocks;
use crate::surfaces::cover::{Cover, Facet};
use crate::surfaces::field::{Field, halved, pulled};
use crate::surfaces::materials::GRASS;
use crate::surfaces::region::Region;
use crate::surfaces::sections::{Ground, Section, WIDEST_M};
use crate::surfaces::water::Water;
use schema::Layer;

const WATER: MeshPart = MeshPart::new(Tag::Water, Surface::Glass, [0.03, 0.055, 0.06]);
/// Side of a cell; nodes lie on whole multiples of it in the world, metres.
const CELL_M: f64 = 4.0;
/// The land stays this far under lanes, metres.
const UNDER_M: f64 = 0.09;
/// Steepest land (rise over run).
const SLOPE: f64 = 0.5;
/// A node is looked at from so many nodes away for that: what is farther does not matter, however high or
/// low.
const SLOPE_STEPS: usize = 16;
/// The land depends on what lies within this distance along x and y and no farther, metres: the way of
/// [`SLOPE_STEPS`] (64), squares of two nodes (8) between squares of four (16), these (6), lanes beside a
/// node (5), and a cell.
pub(crate) const REACH_M: f64 = 104.0;
/// The beds of waters lie this far under their level, metres.
const BED_M: f64 = 1.5;
/// Land less than this under lanes cannot be seen, metres, if it is so at all of this many places and one
/// more along each side of a cell (each third of a metre).
const HIDDEN_M: f64 = 0.5;
const HIDDEN_STEPS: u32 = 12;
/// Lanes are sampled this densely across and along, metres.
const SAMPLE_M: f64 = 1.0;

/// A height grid over a region. Its heights are those of the land but near its edges ([`REACH_M`]).
#[derive(Debug)]
pub(crate) struct Terrain {
    origin: [f64; 2],
    columns: usize,
    rows: usize,
    heights: Vec<f64>,
}

impl Terrain {
    /// The land of a region, from the lanes of its sections, the patches between them, the waters, and what
    /// the map says of places far from all of these. Corners of the region are multiples of four cells.
    pub(crate) fn new(
        sections: &[&Section],
        patches: &[Facet],
        waters: &[Water],
        field: &Field,
        region: &Region,
    ) -> Self {
        let nodes = |k: usize| ((region.max[k] - region.min[k]) / CELL_M).ceil().max(1.0) as usize + 1;
        let (columns, rows) = (nodes(0), nodes(1));
        let mut terrain = Self { origin: region.min, columns, rows, heights: Vec::new() };
        let mut caps = terrain.caps(sections, region);
        terrain.stay_under(&mut caps, patches);
        terrain.sink(&mut caps, waters);
        terrain.heights = terrain.filled(&caps, field);
        terrain.limit_slope();
        terrain
    }

    /// Nodes under no lane: between the means of squares of two and four nodes, and where these know nothing,
    /// as the map has it. Squares lie on a grid of the world, so that every region has the same.
    fn filled(&self, caps: &[f64], field: &Field) -> Vec<f64> {
        let half = |n: usize| n.div_ceil(2);
        let (columns, rows) = (self.columns, self.rows);
        let twos = halved(caps, columns, rows);
        let mut fours = halved(&twos, half(columns), half(rows));
        let side = half(half(columns));
        for (i, four) in fours.iter_mut().enumerate().filter(|(_, v)| !v.is_finite()) {
            let middle = |i: usize, k: usize| self.origin[k] + (4.0 * i as f64 + 1.5) * CELL_M;
            *four = field.height(middle(i % side, 0), middle(i / side, 1)) - UNDER_M;
        }
        let twos = pulled(&twos, half(columns), half(rows), &fours);
        pulled(caps, columns, rows, &twos)
    }

    /// The highest height of each node that keeps the cells around it under all lanes; infinite where no lane
    /// is.
    fn caps(&self, sections: &[&Section], region: &Region) -> Vec<f64> {
        let mut caps = vec![f64::INFINITY; self.columns * self.rows];
        let near = region.grown(WIDEST_M);
        for section in sections {
            for strip in section.strips.iter().filter(|s| s.ground != Ground::Land) {
                for i in (0..section.s.len() - 1).filter(|i| section.inside(*i, &near)) {
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
        let reach = 2.0 * CELL_M;
        for water in waters {
            for (i, cap) in caps.iter_mut().enumerate() {
                let (c, r) = (i % self.columns, i / self.columns);
                let [x, y] = [(c, 0), (r, 1)].map(|(k, axis)| self.origin[axis] + k as f64 * CELL_M);
                let clearance = water.clearance_m(x, y, reach);
                if clearance < reach {
                    *cap = cap.min(water.z_m + (SLOPE * clearance).max(-BED_M));
                }
            }
        }
    }

    /// Lowers the nodes of the cells that a point, or a point half a sample away, lies in.
    fn cap(&self, caps: &mut [f64], p: Point3<f64>, z: f64) {
        // The first and last nodes of the cells, counted in the world: no region rounds them otherwise.
        let nodes = |v: f64, low: f64, n: usize| {
            let [first, last] = [-0.6, 0.6].map(|by| ((v + by * SAMPLE_M) / CELL_M).floor() - low / CELL_M);
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

    /// Lowers nodes until no slope is steeper than [`SLOPE`], as far as nodes within [`SLOPE_STEPS`] ask for
    /// it: steps of a chamfer distance (Borgefors, 1986), all nodes at once.
    fn limit_slope(&mut self) {
        let (straight, diagonal) = (SLOPE * CELL_M, SLOPE * CELL_M * std::f64::consts::SQRT_2);
        let (columns, rows) = (self.columns, self.rows);
        let mut next = self.heights.clone();
        for _ in 0..SLOPE_STEPS {
            for r in 0..rows {
                for c in 0..columns {
                    let mut height = self.heights[r * columns + c];
                    for nr in r.saturating_sub(1)..=(r + 1).min(rows - 1) {
                        for nc in c.saturating_sub(1)..=(c + 1).min(columns - 1) {
                            let rise = if nr == r || nc == c { straight } else { diagonal };
                            height = height.min(self.heights[nr * columns + nc] + rise);
                        }
                    }
                    next[r * columns + c] = height;
                }
            }
            if next == self.heights {
                break;
            }
            std::mem::swap(&mut self.heights, &mut next);
        }
    }

    fn node(&self, column: usize, row: usize) -> Point3<f64> {
        let z = self.heights[row * self.columns + column];
        Point3::new(self.origin[0] + column as f64 * CELL_M, self.origin[1] + row as f64 * CELL_M, z)
    }

    /// Height of the land at a point; beyond the grid that of its edge.
    pub(crate) fn height(&self, x: f64, y: f64) -> f64 {
        let at = |v: f64, low: f64, n: usize| {
            let (cell, last) = ((v / CELL_M).floor() - low / CELL_M, (n - 2) as f64);
            match cell {
                cell if cell < 0.0 => (0, 0.0),
                cell if cell > last => (n - 2, 1.0),
                cell => (cell as usize, v / CELL_M - (v / CELL_M).floor()),
            }
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

    /// The corners of every cell whose south-western one lies in an area, counter-clockwise from there.
    fn cells<'a>(&'a self, area: &'a Region) -> impl Iterator<Item = [Point3<f64>; 4]> + 'a {
        let corners =
            |c, r| [self.node(c, r), self.node(c + 1, r), self.node(c + 1, r + 1), self.node(c, r + 1)];
        let all = (0..self.rows - 1).flat_map(move |r| (0..self.columns - 1).map(move |c| corners(c, r)));
        all.filter(|[p, ..]| area.contains(p.x, p.y))
    }

    /// Land, but for what lies hidden under lanes and paving: that would be cells of voxel grids that nobody
    /// ever sees.
    pub(crate) fn build(&self, cover: &Cover, area: &Region, blocks: &mut Blocks) {
        for corners in self.cells(area) {
            if !self.is_hidden(cover, &corners) {
                blocks.quad(Layer::Terrain, GRASS, corners);
            }
        }
    }

    /// Whether the lanes of one road lie closely over all of a cell. Between those of two roads there may be
    /// gaps that are too narrow for any point to lie in, but not for a ray.
    fn is_hidden(&self, cover: &Cover, corners: &[Point3<f64>; 4]) -> bool {
        let (low, side) = (corners[0], corners[2] - corners[0]);
        let at = |k: u32, low: f64, side: f64| low + side * f64::from(k) / f64::from(HIDDEN_STEPS);
        let place = |i: u32, j: u32| (at(i, low.x, side.x), at(j, low.y, side.y));
        let is_under = |road: u32, (x, y): (f64, f64)| {
            let land = self.height(x, y);
            cover.at(x, y).any(|(facet, z)| facet.road == Some(road) && z > land && z - land < HIDDEN_M)
        };
        let (x, y) = place(0, 0);
        let mut roads: Vec<u32> = cover.at(x, y).filter_map(|(facet, _)| facet.road).collect();
        roads.dedup();
        roads
            .into_iter()
            .any(|road| (0..=HIDDEN_STEPS).all(|i| (0..=HIDDEN_STEPS).all(|j| is_under(road, place(i, j)))))
    }

    /// Water over every cell of the land that reaches below it in or beside its outline: the shore is where
    /// land rises through it.
    pub(crate) fn build_waters(&self, waters: &[Water], area: &Region, blocks: &mut Blocks) {
        for water in waters {
            for corners in self.cells(area) {
                let reach = 1.5 * (corners[2].x - corners[0].x);
                let middle = nalgebra::center(&corners[0], &corners[2]);
                if corners.iter().any(|p| p.z < water.z_m)
                    && water.clearance_m(middle.x, middle.y, reach) < reach
                {
                    blocks.quad(Layer::Water, WATER, corners.map(|p| Point3::new(p.x, p.y, water.z_m)));
                }
            }
        }
    }
}
