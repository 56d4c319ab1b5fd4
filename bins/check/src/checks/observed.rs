//! What lidars saw of voxel grids, against their returns.

use std::collections::HashSet;

use schema::ReturnKind;

use super::clouds::{Cloud, Kind};
use crate::config::GridConfig;
use crate::files::{Npz, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::space::{V3, add, scale, sub};

/// A place this near to a cell's face may be told to either side, m.
const EDGE_M: f64 = 1e-3;
/// One ray of so many is followed, at so many places.
const RAY_STRIDE: usize = 61;
const PLACES: usize = 24;
/// So many free cells are held against all rays.
const FREE_CELLS: usize = 40;

const FREE: u8 = 1;
const OCCUPIED: u8 = 2;

/// The archive of an agent.
pub(crate) struct Observed {
    config: GridConfig,
    archive: Npz,
}

/// A ray from a sensor to its return, in the agent's frame, m.
struct Ray {
    from: V3,
    to: V3,
}

impl Observed {
    pub(crate) fn new(config: GridConfig, archive: Npz) -> Self {
        Self { config, archive }
    }

    /// There is one at frames 0, n, 2 n, ...: n.
    pub(crate) fn every(&self) -> u32 {
        self.config.every
    }

    /// Checks a frame.
    pub(crate) fn check(&self, frame: usize, clouds: &[Cloud<'_>], ledger: &mut Ledger) {
        let sides = self.sides();
        let read = self.archive.frame(frame as u32).and_then(|array| {
            let fits = array.shape == sides && array.descr == "|u1";
            let most = array.bytes.iter().max().copied().unwrap_or(0);
            if fits && most <= OCCUPIED {
                Ok(array.bytes)
            } else {
                Err(Unreadable(format!(
                    "frame {frame}: is {:?} of {} up to {most}",
                    array.shape, array.descr
                )))
            }
        });
        let Some(seen) = ledger.read(read) else { return };
        let sweeps: Vec<_> = clouds.iter().filter(|c| c.ranger.kind == Kind::Lidar).collect();
        ledger.expect(Rule::Observed, !sweeps.is_empty(), || {
            format!("frame {frame}: no lidar sweeps, so that nothing is observed")
        });
        let rays: Vec<Ray> = sweeps.into_iter().flat_map(rays_of).collect();

        let mut near_returns = HashSet::new();
        for ray in &rays {
            let (first, last) = (self.cell(ray.to, -EDGE_M), self.cell(ray.to, EDGE_M));
            for i in first[0]..=last[0] {
                for j in first[1]..=last[1] {
                    near_returns.extend((first[2]..=last[2]).filter_map(|k| self.index([i, j, k])));
                }
            }
            if let (true, Some(cell)) = (first == last, self.index(first)) {
                ledger.expect(Rule::Observed, seen[cell] == OCCUPIED, || {
                    format!("frame {frame}: the voxel {first:?} of a return is {}", seen[cell])
                });
            }
        }
        let strays = (0..seen.len()).filter(|cell| seen[*cell] == OCCUPIED && !near_returns.contains(cell));
        ledger.all_off(Rule::Observed, strays.count() as u64, "stray", || {
            format!("frame {frame}: voxels without a return are occupied")
        });
        for ray in rays.iter().step_by(RAY_STRIDE) {
            self.follow(ray, &seen, frame, ledger);
        }
        self.check_free(&rays, &seen, frame, ledger);
    }

    /// Places on a ray's way are observed.
    fn follow(&self, ray: &Ray, seen: &[u8], frame: usize, ledger: &mut Ledger) {
        for place in 0..PLACES {
            let share = (place as f64 + 0.5) / PLACES as f64;
            let at = add(ray.from, scale(sub(ray.to, ray.from), share));
            let cell = self.cell(at, EDGE_M);
            if let (true, Some(there)) = (cell == self.cell(at, -EDGE_M), self.index(cell)) {
                ledger.expect(Rule::Observed, seen[there] != 0, || {
                    format!("frame {frame}: the voxel {cell:?} on a ray's way is unobserved")
                });
            }
        }
    }

    /// Free cells, some of them spread over the grid, are on a ray's way.
    fn check_free(&self, rays: &[Ray], seen: &[u8], frame: usize, ledger: &mut Ledger) {
        let free = seen.iter().filter(|cell| **cell == FREE).count();
        let places = (0..seen.len()).filter(|cell| seen[*cell] == FREE);
        for place in places.step_by((free / FREE_CELLS).max(1)) {
            let [_, across, up] = self.sides();
            let cell = [place / up / across, place / up % across, place % up];
            let is_passed = rays.iter().any(|ray| self.passes(ray, cell));
            ledger.expect(Rule::Observed, is_passed, || {
                format!("frame {frame}: no ray passes the voxel {cell:?}, which is free")
            });
        }
    }

    /// Whether a ray passes a cell, or an edge's width beside it: clipped at its six faces.
    fn passes(&self, ray: &Ray, cell: [usize; 3]) -> bool {
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (axis, &place) in cell.iter().enumerate() {
            let low = self.low()[axis] + place as f64 * self.config.voxel_m - EDGE_M;
            let high = low + self.config.voxel_m + 2.0 * EDGE_M;
            let way = ray.to[axis] - ray.from[axis];
            if way.abs() < 1e-12 {
                if ray.from[axis] < low || ray.from[axis] > high {
                    return false;
                }
                continue;
            }
            let (a, b) = ((low - ray.from[axis]) / way, (high - ray.from[axis]) / way);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        first <= last
    }

    fn low(&self) -> V3 {
        let GridConfig { range_m, lower_m, mount_z_m, .. } = self.config;
        [-range_m, -range_m, mount_z_m + lower_m]
    }

    fn sides(&self) -> [usize; 3] {
        let GridConfig { range_m, voxel_m, lower_m, upper_m, .. } = self.config;
        let cells = |way_m: f64| (way_m / voxel_m).round() as usize;
        [cells(2.0 * range_m), cells(2.0 * range_m), cells(upper_m - lower_m)]
    }

    fn cell(&self, at: V3, edge_m: f64) -> [i64; 3] {
        let low = self.low();
        [0, 1, 2].map(|axis| ((at[axis] + edge_m - low[axis]) / self.config.voxel_m).floor() as i64)
    }

    fn index(&self, cell: [i64; 3]) -> Option<usize> {
        let sides = self.sides();
        let at = |axis: usize| usize::try_from(cell[axis]).ok().filter(|&c| c < sides[axis]);
        Some((at(0)? * sides[1] + at(1)?) * sides[2] + at(2)?)
    }
}

fn rays_of<'a>(cloud: &'a Cloud<'_>) -> impl Iterator<Item = Ray> + 'a {
    let agent_from_sensor = &cloud.ranger.agent_from_sensor;
    let from = agent_from_sensor.origin;
    // Rays that fog or rain ended are left out.
    let points = cloud.points.iter().zip(&cloud.kinds).filter(|(_, kind)| ReturnKind::is_of_surface(**kind));
    points.map(move |(point, _)| Ray { from, to: agent_from_sensor.outward(*point) })
}
