//! What lies over a point of the plan: lane surfaces, found through a grid.

use nalgebra::Point3;

use crate::surfaces::region::Region;
use crate::surfaces::sections::Ground;

/// Side of a grid cell, metres.
const CELL_M: f64 = 8.0;
/// Points this far outside a triangle still count, as a share of its extent: shared edges have no gaps.
const EDGE: f64 = 1e-9;

/// Patches between lanes lie this far under those around them, metres: less than paint lies over them.
pub(crate) const PATCH_BELOW_M: f64 = 0.003;

/// A triangle of a lane's surface, or of paving between lanes.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// Counter-clockwise from above.
    pub corners: [Point3<f64>; 3],
    /// Index of its road; none between lanes.
    pub road: Option<u32>,
    /// What it is.
    pub ground: Ground,
}

impl Facet {
    /// The middle of its corners in the plan.
    pub(crate) fn middle(&self) -> [f64; 2] {
        let sum = self.corners.iter().fold([0.0; 2], |[x, y], p| [x + p.x, y + p.y]);
        sum.map(|v| v / 3.0)
    }

    /// The upright box around it in the plan.
    pub(crate) fn bounds(&self) -> Region {
        let [a, b, c] = self.corners.map(|p| [p.x, p.y]);
        let fold = |pick: fn(f64, f64) -> f64| [0, 1].map(|k| pick(pick(a[k], b[k]), c[k]));
        Region { min: fold(f64::min), max: fold(f64::max) }
    }

    /// Whether vehicles drive, stop or park on it, on another road than the one named.
    pub(crate) fn is_driven_by_others(&self, road: u32) -> bool {
        self.ground == Ground::Paved && self.road.is_some_and(|own| own != road)
    }
}

/// All lane surfaces of a region.
#[derive(Debug)]
pub struct Cover {
    region: Region,
    columns: usize,
    rows: usize,
    cells: Vec<Vec<u32>>,
    facets: Vec<Facet>,
}

impl Cover {
    /// A region without lanes.
    #[must_use]
    pub fn new(region: Region) -> Self {
        let cells_along = |low: f64, high: f64| (((high - low) / CELL_M).ceil().max(0.0) as usize) + 1;
        let columns = cells_along(region.min[0], region.max[0]);
        let rows = cells_along(region.min[1], region.max[1]);
        Self { region, columns, rows, cells: vec![Vec::new(); columns * rows], facets: Vec::new() }
    }

    fn cell(&self, x: f64, y: f64) -> [usize; 2] {
        let of = |v: f64, low: f64, n: usize| (((v - low) / CELL_M).floor().max(0.0) as usize).min(n - 1);
        [of(x, self.region.min[0], self.columns), of(y, self.region.min[1], self.rows)]
    }

    /// Adds a facet.
    pub fn add(&mut self, facet: Facet) {
        let [a, b, c] = facet.corners;
        let low = self.cell(a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y));
        let high = self.cell(a.x.max(b.x).max(c.x), a.y.max(b.y).max(c.y));
        let index = self.facets.len() as u32;
        self.facets.push(facet);
        for row in low[1]..=high[1] {
            for column in low[0]..=high[0] {
                self.cells[row * self.columns + column].push(index);
            }
        }
    }

    /// All facets.
    #[must_use]
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The cells of the search grid that meet a region, each with the facets that meet it.
    pub(crate) fn areas<'a>(
        &'a self,
        region: Region,
    ) -> impl Iterator<Item = (Region, impl Iterator<Item = &'a Facet>)> + use<'a> {
        let [c0, r0] = self.cell(region.min[0], region.min[1]);
        let [c1, r1] = self.cell(region.max[0], region.max[1]);
        (r0..=r1).flat_map(move |row| {
            (c0..=c1).map(move |column| {
                let at = |k: usize, n: usize| self.region.min[k] + n as f64 * CELL_M;
                let (min, max) = ([at(0, column), at(1, row)], [at(0, column + 1), at(1, row + 1)]);
                let facets = &self.cells[row * self.columns + column];
                (Region { min, max }, facets.iter().map(|i| &self.facets[*i as usize]))
            })
        })
    }

    /// All facets over a point with their heights there.
    pub fn at(&self, x: f64, y: f64) -> impl Iterator<Item = (&Facet, f64)> {
        let [column, row] = self.cell(x, y);
        self.cells[row * self.columns + column].iter().filter_map(move |i| {
            let facet = &self.facets[*i as usize];
            height_in(&facet.corners, x, y).map(|z| (facet, z))
        })
    }

    /// Whether any lane lies over or under a point.
    #[must_use]
    pub fn any(&self, x: f64, y: f64) -> bool {
        self.at(x, y).next().is_some()
    }

    /// Height of the road's visible surface within a metre of a height: of all that is not raised the
    /// highest.
    pub(crate) fn road_near(&self, x: f64, y: f64, z: f64) -> Option<f64> {
        let flat = self.at(x, y).filter(|(f, h)| f.ground.is_road() && (h - z).abs() < 1.0);
        flat.map(|(_, h)| h).max_by(f64::total_cmp)
    }
}

/// Height of a triangle's plane at a point of its plan; none outside.
pub(crate) fn height_in(corners: &[Point3<f64>; 3], x: f64, y: f64) -> Option<f64> {
    let [a, b, c] = corners;
    // Most points are refused here, with more leave than any triangle's edge has.
    let beyond = |v: f64, a: f64, b: f64, c: f64| {
        let (low, high) = (v - 1e-6, v + 1e-6);
        (a < low && b < low && c < low) || (a > high && b > high && c > high)
    };
    if beyond(y, a.y, b.y, c.y) || beyond(x, a.x, b.x, c.x) {
        return None;
    }
    let det = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if det.abs() < 1e-12 {
        return None;
    }
    let u = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / det;
    let v = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / det;
    (u >= -EDGE && v >= -EDGE && u + v <= 1.0 + EDGE).then(|| a.z + u * (b.z - a.z) + v * (c.z - a.z))
}
