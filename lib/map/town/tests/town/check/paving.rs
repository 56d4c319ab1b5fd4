//! Junctions have no holes: ground that pavement surrounds.

use nalgebra::Point3;
use opendrive::Map;

/// Side of a cell that is looked at, metres.
const CELL_M: f64 = 0.4;
/// Larger enclosed land is no hole, square metres.
const LAND_M2: f64 = 150.0;
/// Smaller holes are chips, square metres.
const CHIP_M2: f64 = 1.5;
/// Roads this far above or below a junction do not pave it, metres.
const LEVEL_M: f64 = 3.0;

/// A raster over one junction.
struct Raster {
    west_m: f64,
    south_m: f64,
    columns: usize,
    paved: Vec<bool>,
}

impl Raster {
    fn middle(&self, i: usize) -> [f64; 2] {
        let (column, row) = (i % self.columns, i / self.columns);
        [self.west_m + (column as f64 + 0.5) * CELL_M, self.south_m + (row as f64 + 0.5) * CELL_M]
    }

    /// Paves the cells whose middles lie in a quadrilateral.
    fn pave(&mut self, ring: [&Point3<f64>; 4]) {
        let rows = self.paved.len() / self.columns;
        let clip = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
        let y = |p: &Point3<f64>| (p.y - self.south_m) / CELL_M - 0.5;
        let low = ring.iter().map(|p| y(p)).fold(f64::INFINITY, f64::min);
        let high = ring.iter().map(|p| y(p)).fold(f64::NEG_INFINITY, f64::max);
        for row in clip(low.ceil(), rows)..clip(high.floor() + 1.0, rows) {
            let at = row as f64;
            let mut cuts: Vec<f64> = Vec::new();
            for (i, a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % 4];
                if (y(a) <= at) != (y(b) <= at) {
                    let x = a.x + (at - y(a)) / (y(b) - y(a)) * (b.x - a.x);
                    cuts.push((x - self.west_m) / CELL_M - 0.5);
                }
            }
            cuts.sort_by(f64::total_cmp);
            for pair in cuts.chunks_exact(2) {
                for column in clip(pair[0].ceil(), self.columns)..clip(pair[1].floor() + 1.0, self.columns) {
                    self.paved[row * self.columns + column] = true;
                }
            }
        }
    }

    /// Cells that are reached from one, none of them paved.
    fn reached(&self, start: usize, seen: &mut [bool]) -> Vec<usize> {
        let mut found = Vec::new();
        let mut stack = vec![start];
        while let Some(i) = stack.pop() {
            if std::mem::replace(&mut seen[i], true) {
                continue;
            }
            found.push(i);
            let column = i % self.columns;
            stack.extend((column > 0).then(|| i - 1));
            stack.extend((column + 1 < self.columns).then_some(i + 1));
            stack.extend(i.checked_sub(self.columns));
            stack.extend(Some(i + self.columns).filter(|n| *n < self.paved.len()));
        }
        found
    }
}

pub(super) fn faults(map: &Map) -> Vec<String> {
    let lines: Vec<_> = map.lanes().iter().map(|lane| map.lane_polyline(lane.id, 0.02)).collect();
    let mut faults = Vec::new();
    for junction in map.junctions() {
        let [low, high] = junction.bounds;
        let (west_m, south_m) = (low.x - 6.0, low.y - 6.0);
        let cells = |from: f64, to: f64| ((to + 6.0 - from) / CELL_M).ceil().max(1.0) as usize;
        let (columns, rows) = (cells(west_m, high.x), cells(south_m, high.y));
        let mut raster = Raster { west_m, south_m, columns, paved: vec![false; columns * rows] };
        let near = |p: &Point3<f64>| {
            p.x > west_m - 20.0 && p.x < high.x + 26.0 && p.y > south_m - 20.0 && p.y < high.y + 26.0
        };
        let level = |p: &Point3<f64>| p.z > low.z - LEVEL_M && p.z < high.z + LEVEL_M;
        for line in &lines {
            for k in 1..line.s.len() {
                let ring = [&line.left[k - 1], &line.left[k], &line.right[k], &line.right[k - 1]];
                if near(ring[0]) && level(ring[0]) {
                    raster.pave(ring);
                }
            }
        }
        // From the frame inwards everything is land.
        let mut seen = raster.paved.clone();
        for i in 0..raster.paved.len() {
            let (column, row) = (i % columns, i / columns);
            if (column == 0 || row == 0 || column + 1 == columns || row + 1 == rows) && !seen[i] {
                raster.reached(i, &mut seen);
            }
        }
        for i in 0..raster.paved.len() {
            if seen[i] {
                continue;
            }
            let hole = raster.reached(i, &mut seen);
            let area = hole.len() as f64 * CELL_M * CELL_M;
            if area > CHIP_M2 && area < LAND_M2 {
                let [x, y] = raster.middle(hole[hole.len() / 2]);
                faults
                    .push(format!("junction {} has a hole of {area:.1} m2 at ({x:.1}, {y:.1})", junction.id));
            }
        }
    }
    faults
}
