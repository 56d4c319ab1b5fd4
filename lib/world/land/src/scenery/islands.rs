//! Ground that the carriageway encloses and that is no place for a house: islands in roundabouts and between
//! lanes.

use std::f32::consts::PI;
use std::ops::Range;

use crate::surfaces::{Cover, Ground, Raster, Region};

/// Side of a cell, metres.
const CELL_M: f64 = 1.0;
/// Enclosed ground is an island if no place of it is farther than this from the carriageway, metres: half a
/// house, its garden and a sidewalk.
const HALF_LOT_M: f32 = 12.0;
/// Enclosed ground that is nearly a disc is the middle of a roundabout up to this radius, metres. Larger
/// ground is no island, however narrow, nor is ground that reaches farther than such a disc along x or y: so
/// that it is known of every place what it is, without looking far.
const ROUND_M: f32 = 45.0;
/// The area of such a disc is less than this times that of the largest disc in it (a square's is 1.27, a long
/// block's more).
const ROUNDNESS: f32 = 1.15;

/// Where islands are.
pub(crate) struct Islands {
    raster: Raster,
    island: Vec<bool>,
}

impl Islands {
    /// The islands of a region.
    pub(crate) fn new(cover: &Cover, region: &Region) -> Self {
        let raster = Raster::new(region, CELL_M);
        let mut paved = vec![false; raster.len()];
        for facet in cover.facets().iter().filter(|f| f.ground == Ground::Paved) {
            raster.under(&facet.corners, [0, raster.columns], [0, raster.rows], |i| paved[i] = true);
        }
        let mut island = vec![false; raster.len()];
        for ground in raster.groups(|i| !paved[i]) {
            let area_m2 = ground.iter().map(Range::len).sum::<usize>() as f32 * (CELL_M * CELL_M) as f32;
            if area_m2 > ROUNDNESS * PI * ROUND_M * ROUND_M || ground.iter().any(|run| raster.at_edge(run)) {
                continue;
            }
            // To the edge of the carriageway it is half a cell less than to the middle of its next cell.
            let (part, held) = raster.around(&ground);
            if (part.columns.max(part.rows) - 2) as f32 * CELL_M as f32 > 2.0 * ROUND_M {
                continue;
            }
            let far_m = part.distances_m(|i| !held[i]).into_iter().fold(0.0, f32::max);
            let radius_m = far_m - 0.5 * CELL_M as f32;
            if radius_m < HALF_LOT_M || area_m2 < ROUNDNESS * PI * radius_m * radius_m {
                ground.into_iter().for_each(|run| island[run].fill(true));
            }
        }
        Self { raster, island }
    }

    /// Whether a point lies on an island.
    pub(crate) fn holds(&self, x: f64, y: f64) -> bool {
        self.raster.cell(x, y).is_some_and(|i| self.island[i])
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::surfaces::Facet;

    /// A carriageway 8 m wide around an ellipse or, with `corners`, a rectangle of these half sides.
    fn ring(cover: &mut Cover, centre: [f64; 2], half: [f64; 2], corners: bool) {
        let at = |k: usize, wider: f64| {
            let half = half.map(|h| h + wider);
            let [u, v] = if corners {
                [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][k / 16 % 4]
            } else {
                let (s, c) = frames::math::sin_cos(k as f64 / 64.0 * std::f64::consts::TAU);
                [c, s]
            };
            Point3::new(centre[0] + u * half[0], centre[1] + v * half[1], 0.0)
        };
        for k in 0..64 {
            let [a, b, c, d] = [at(k, 0.0), at(k, 8.0), at(k + 1, 8.0), at(k + 1, 0.0)];
            for corners in [[a, b, c], [a, c, d]] {
                cover.add(Facet { corners, road: Some(0), ground: Ground::Paved });
            }
        }
    }

    #[test]
    fn discs_and_narrow_ground_are_islands_and_blocks_are_not() {
        let region = Region { min: [-200.0, -200.0], max: [200.0, 200.0] };
        let shapes = [
            ([-150.0, -150.0], [14.0, 14.0], false, true),
            ([-60.0, -140.0], [40.0, 40.0], false, true),
            ([60.0, -150.0], [14.0, 30.0], false, false),
            ([150.0, -150.0], [9.0, 30.0], true, true),
            ([-150.0, 0.0], [14.0, 14.0], true, false),
            ([-60.0, 40.0], [14.0, 60.0], true, false),
            ([60.0, 40.0], [40.0, 40.0], true, false),
            ([150.0, 40.0], [3.0, 3.0], true, true),
            ([150.0, 140.0], [10.0, 50.0], true, false),
        ];
        let mut cover = Cover::new(region);
        for (centre, half, corners, _) in shapes {
            ring(&mut cover, centre, half, corners);
        }
        let islands = Islands::new(&cover, &region);
        for (centre, half, corners, wanted) in shapes {
            for (u, v) in [(0.0, 0.0), (0.6, 0.0), (-0.6, 0.0), (0.0, 0.6), (0.0, -0.6)] {
                let held = islands.holds(centre[0] + u * half[0], centre[1] + v * half[1]);
                assert_eq!(held, wanted, "{half:?} {corners} at {u} {v}");
            }
            // Neither the carriageway nor the land around it.
            for beyond in [4.0, 9.5] {
                assert!(!islands.holds(centre[0] + half[0] + beyond, centre[1]), "{half:?}");
            }
        }
        assert!(!islands.holds(0.0, 190.0) && !islands.holds(500.0, 0.0));
    }
}
