//! Paving for the places in and around junctions that lanes surround, or leave a narrow gap between, without
//! covering them.

use std::ops::Range;
use std::sync::OnceLock;

use nalgebra::Point3;
use opendrive::Map;

use crate::surfaces::blocks::Blocks;
use crate::surfaces::cover::{Cover, Facet, PATCH_BELOW_M};
use crate::surfaces::materials::{ASPHALT, pavement};
use crate::surfaces::raster::Raster;
use crate::surfaces::region::Region;
use crate::surfaces::sections::Ground;
use schema::Layer;

/// Side of a cell, metres.
const CELL_M: f64 = 0.5;
/// Land that is nowhere farther than this from lanes is a gap, metres.
const GAP_M: f32 = 0.9;
/// Enclosed land of which more than this is farther than [`GAP_M`] from lanes is an island, square metres.
const ISLAND_M2: f64 = 110.0;
/// Gaps reach this far out of a junction, metres.
const MARGIN_M: f64 = 6.0;
/// Junctions that differ more in height, and decks over one another, are no matter for paving at one level,
/// metres.
const LEVEL_M: f64 = 3.0;
/// Larger groups of junctions are looked at one by one.
const MAX_CELLS: f64 = 2.5e5;
/// No corner of a patch lies this much lower or higher than all lanes around it, metres.
const BEYOND_M: f64 = 0.05;
/// Lanes are known so far around a window, metres: patches go on for a cell under those beside them.
const BESIDE_M: f64 = 2.0;

/// Junctions that are looked at together: islands often lie between several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    region: Region,
    z_m: [f64; 2],
}

impl Window {
    fn with(&self, other: &Self) -> Self {
        let min = [0, 1].map(|k| self.region.min[k].min(other.region.min[k]));
        let max = [0, 1].map(|k| self.region.max[k].max(other.region.max[k]));
        let z_m = [self.z_m[0].min(other.z_m[0]), self.z_m[1].max(other.z_m[1])];
        Self { region: Region { min, max }, z_m }
    }

    fn meets(&self, other: &Self) -> bool {
        self.region.meets(&other.region)
    }

    /// Whether it is small and level enough for one look.
    fn is_usable(&self) -> bool {
        let [x, y] = [0, 1].map(|k| (self.region.max[k] - self.region.min[k]) / CELL_M);
        x * y <= MAX_CELLS && self.z_m[1] - self.z_m[0] <= LEVEL_M
    }
}

/// The usable ones of some windows, joined where they meet, so that no gap is paved twice.
fn joined(windows: impl Iterator<Item = Window>) -> Vec<Window> {
    let mut found: Vec<Window> = Vec::new();
    for mut window in windows.filter(Window::is_usable) {
        // What is joined may meet what was apart from both before.
        while let Some(i) = found.iter().position(|w| w.meets(&window) && w.with(&window).is_usable()) {
            window = window.with(&found.swap_remove(i));
        }
        found.push(window);
    }
    found
}

/// The paving of a whole map, window by window, each made when it is first asked for.
#[derive(Debug)]
pub(crate) struct Paving(Vec<(Window, OnceLock<Vec<Facet>>)>);

impl Paving {
    /// The windows of a map's junctions.
    pub(crate) fn new(map: &Map) -> Self {
        let windows = map.junctions().iter().map(|j| j.bounds).map(|[low, high]| {
            let bounds = Region { min: [low.x, low.y], max: [high.x, high.y] };
            Window { region: bounds.grown(MARGIN_M), z_m: [low.z, high.z] }
        });
        Self(joined(windows).into_iter().map(|window| (window, OnceLock::new())).collect())
    }

    /// The patches that reach into a region: facets of no road. `cover` gives the lanes of a window.
    pub(crate) fn patches(&self, region: &Region, cover: impl Fn(&Region) -> Cover) -> Vec<Facet> {
        let near = self.0.iter().filter(|(window, _)| window.region.grown(BESIDE_M).meets(region));
        let all = near.flat_map(|(window, patches)| {
            patches.get_or_init(|| in_window(window, &cover(&window.region.grown(BESIDE_M))))
        });
        all.filter(|facet| facet.bounds().meets(region)).copied().collect()
    }
}

fn in_window(window: &Window, cover: &Cover) -> Vec<Facet> {
    let raster = Raster::new(&window.region, CELL_M);
    let z_m = [window.z_m[0] - 0.5 * LEVEL_M, window.z_m[1] + 0.5 * LEVEL_M];
    let fine = raster.halved();
    let mut under = vec![false; fine.len()];
    for (area, facets) in cover.areas(window.region) {
        let [columns, rows] = fine.span(&area);
        for facet in facets.filter(|f| f.corners.iter().any(|p| p.z > z_m[0] && p.z < z_m[1])) {
            fine.under(&facet.corners, columns, rows, |i| under[i] = true);
        }
    }
    let quarters = |i: usize| raster.quarters(i).map(|q| under[q]);
    // Slivers are narrower than cells: those that are covered in part may belong to one, but do not make land
    // wider.
    let covered: Vec<bool> = (0..raster.len()).map(|i| quarters(i) == [true; 4]).collect();
    let touched: Vec<bool> = (0..raster.len()).map(|i| quarters(i) != [false; 4]).collect();
    let far_m = raster.distances_m(|i| touched[i]);
    // Land is what can be reached in strides wider than a gap from outside or from the middle of an island.
    let mut open = vec![false; raster.len()];
    for core in raster.groups(|i| far_m[i] > GAP_M) {
        let cells: usize = core.iter().map(Range::len).sum();
        if cells as f64 * CELL_M * CELL_M > ISLAND_M2 || core.iter().any(|run| raster.at_edge(run)) {
            core.into_iter().for_each(|run| open[run].fill(true));
        }
    }
    // The factor makes up for diagonal steps.
    let land_m = raster.distances_m(|i| open[i]);
    let reach_m = |i: usize| 1.09 * if touched[i] { GAP_M + CELL_M as f32 } else { GAP_M };
    let gaps = raster.groups(|i| !covered[i] && land_m[i] > reach_m(i));
    let cells = gaps.into_iter().map(|runs| runs.into_iter().flatten().collect::<Vec<usize>>());
    cells
        .filter_map(|gap| {
            Some(Patch::new(&raster, &gap, &covered, cover, z_m)?.facets(&raster, &gap, &covered))
        })
        .flatten()
        .collect()
}

/// How one gap is paved.
struct Patch<'a> {
    cover: &'a Cover,
    ground: Ground,
    z_m: [f64; 2],
    /// A point of a plane through the lanes around, and its slopes along x and y.
    middle: Point3<f64>,
    slope: [f64; 2],
    /// Where its corners may lie, metres.
    range_m: [f64; 2],
}

impl<'a> Patch<'a> {
    /// None where a single cell is open to land, or the lanes around lie on several levels.
    fn new(
        raster: &Raster,
        gap: &[usize],
        covered: &[bool],
        cover: &'a Cover,
        z_m: [f64; 2],
    ) -> Option<Self> {
        let mut around: Vec<usize> =
            gap.iter().flat_map(|i| raster.beside(*i)).filter(|i| covered[*i]).collect();
        around.sort_unstable();
        around.dedup();
        if around.is_empty() || (gap.len() == 1 && around.len() < 4) {
            return None;
        }
        let found: Vec<(Ground, Point3<f64>)> = around
            .iter()
            .flat_map(|i| {
                let [x, y] = raster.middle(*i);
                cover.at(x, y).map(move |(f, z)| (f.ground, Point3::new(x, y, z)))
            })
            .filter(|(_, p)| p.z > z_m[0] && p.z < z_m[1])
            .collect();
        let of = |ground: Ground| found.iter().filter(|(g, _)| *g == ground).count();
        let ground = if of(Ground::Walk) > 2 * of(Ground::Paved) { Ground::Walk } else { Ground::Paved };
        let mut points: Vec<Point3<f64>> =
            found.iter().filter(|(g, _)| *g == ground).map(|(_, p)| *p).collect();
        if points.is_empty() {
            points = found.iter().map(|(_, p)| *p).collect();
        }
        let middle = Point3::from(
            points.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / points.len() as f64,
        );
        // Least squares; the constant keeps gaps in line, which do not tell the slope across, from tilting.
        let [mut xx, mut xy, mut yy, mut xz, mut yz] = [0.0; 5];
        for d in points.iter().map(|p| p - middle) {
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
            (xz, yz) = (xz + d.x * d.z, yz + d.y * d.z);
        }
        let more = 0.1 * points.len() as f64;
        let (xx, yy) = (xx + more, yy + more);
        let det = xx * yy - xy * xy;
        let slope = [(yy * xz - xy * yz) / det, (xx * yz - xy * xz) / det];
        let off = |p: &Point3<f64>| {
            (p.z - middle.z - slope[0] * (p.x - middle.x) - slope[1] * (p.y - middle.y)).abs()
        };
        let fold = |pick: fn(f64, f64) -> f64| points.iter().map(|p| p.z).fold(middle.z, pick);
        let range_m = [fold(f64::min) - BEYOND_M, fold(f64::max) + BEYOND_M];
        (points.iter().map(off).fold(0.0, f64::max) < 1.0).then_some(Self {
            cover,
            ground,
            z_m,
            middle,
            slope,
            range_m,
        })
    }

    /// A corner of the patch: under the lanes that lie there, else on the plane through those around.
    fn corner(&self, [x, y]: [f64; 2]) -> Point3<f64> {
        let plane = self.middle.z + self.slope[0] * (x - self.middle.x) + self.slope[1] * (y - self.middle.y);
        let plane = plane.clamp(self.range_m[0], self.range_m[1]);
        let over = |ground: Ground| {
            let heights = self.cover.at(x, y).filter(|(f, _)| f.ground == ground).map(|(_, z)| z);
            let level = heights.filter(|z| *z > self.z_m[0] && *z < self.z_m[1]);
            level.min_by(|a, b| (a - plane).abs().total_cmp(&(b - plane).abs()))
        };
        // Pavement falls to the road; the road does not climb onto pavement.
        let z = over(self.ground).or_else(|| over(Ground::Paved)).unwrap_or(plane);
        Point3::new(x, y, z - PATCH_BELOW_M)
    }

    /// The gap and a cell more under the lanes around, row by row.
    fn facets(&self, raster: &Raster, gap: &[usize], covered: &[bool]) -> Vec<Facet> {
        let mut cells: Vec<usize> = gap
            .iter()
            .flat_map(|i| raster.beside(*i).filter(|n| covered[*n]))
            .chain(gap.iter().copied())
            .collect();
        cells.sort_unstable();
        cells.dedup();
        let in_row = |a: &usize, b: &usize| *b == a + 1 && !b.is_multiple_of(raster.columns);
        let runs = cells.chunk_by(in_row).filter_map(|run| Some((*run.first()?, run.len())));
        runs.flat_map(|(first, count)| {
            let (column, row) = (first % raster.columns, first / raster.columns);
            let [a, b, c, d] = [(0, 0), (count, 0), (count, 1), (0, 1)]
                .map(|(right, up)| self.corner(raster.corner(column + right, row + up)));
            [[a, b, c], [a, c, d]].map(|corners| Facet { corners, road: None, ground: self.ground })
        })
        .collect()
    }
}

/// Draws the patches of a cover whose middles lie in an area.
pub(crate) fn build(cover: &Cover, area: &Region, blocks: &mut Blocks) {
    let here = |f: &&Facet| {
        let [x, y] = f.middle();
        f.road.is_none() && area.contains(x, y)
    };
    for facet in cover.facets().iter().filter(here) {
        match facet.ground {
            Ground::Walk => blocks.triangle(Layer::Sidewalk, pavement(facet.middle()), facet.corners),
            _ => blocks.triangle(Layer::Road, ASPHALT, facet.corners),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surfaces::cover::height_in;

    const REGION: Region = Region { min: [-30.0; 2], max: [30.0; 2] };

    fn plane(x: f64, y: f64) -> f64 {
        5.0 + 0.02 * x - 0.01 * y
    }

    /// A cover of upright rectangles `[x0, x1, y0, y1]`, raised over the plane.
    fn cover(rectangles: &[([f64; 4], Ground, f64)]) -> Cover {
        let mut cover = Cover::new(REGION.grown(10.0));
        for ([x0, x1, y0, y1], ground, raise) in rectangles {
            let [a, b, c, d] = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
                .map(|(x, y)| Point3::new(*x, *y, plane(*x, *y) + raise));
            for corners in [[a, b, c], [a, c, d]] {
                cover.add(Facet { corners, road: Some(0), ground: *ground });
            }
        }
        cover
    }

    /// A frame 8 m wide around a hole that begins at (0.1, 0.2).
    fn frame(width: f64, height: f64, ground: Ground, raise: f64) -> Cover {
        let (x0, x1, y0, y1) = (0.1, 0.1 + width, 0.2, 0.2 + height);
        let sides = [
            [x0 - 8.0, x1 + 8.0, y0 - 8.0, y0],
            [x0 - 8.0, x1 + 8.0, y1, y1 + 8.0],
            [x0 - 8.0, x0, y0, y1],
            [x1, x1 + 8.0, y0, y1],
        ];
        cover(&sides.map(|side| (side, ground, raise)))
    }

    fn patches(cover: &Cover) -> Vec<Facet> {
        in_window(&Window { region: REGION, z_m: [4.5, 5.5] }, cover)
    }

    /// Ground and height of the patches over a point.
    fn over(patches: &[Facet], x: f64, y: f64) -> Vec<(Ground, f64)> {
        patches.iter().filter_map(|f| Some((f.ground, height_in(&f.corners, x, y)?))).collect()
    }

    #[test]
    fn enclosed_gaps_are_paved_in_the_plane_of_the_lanes_around() {
        for (width, height) in [(4.3, 6.1), (0.7, 5.0), (11.0, 11.0)] {
            let cover = frame(width, height, Ground::Paved, 0.0);
            let patches = patches(&cover);
            for i in 1..40 {
                for j in 1..40 {
                    let (x, y) = (0.1 + width * f64::from(i) / 40.0, 0.2 + height * f64::from(j) / 40.0);
                    let found = over(&patches, x, y);
                    assert!(!found.is_empty(), "a hole of {width} by {height} is open at {x}, {y}");
                    for (ground, z) in found {
                        assert_eq!(ground, Ground::Paved);
                        assert!((z + PATCH_BELOW_M - plane(x, y)).abs() < 1e-3, "{z} at {x}, {y}");
                    }
                }
            }
            for p in patches.iter().flat_map(|f| f.corners) {
                let inside = p.x > -1.0 && p.x < width + 1.2 && p.y > -1.0 && p.y < height + 1.3;
                assert!(inside, "a patch reaches to {p}");
            }
        }
    }

    #[test]
    fn windows_that_meet_are_joined_unless_too_large_or_on_another_level() {
        let window = |x0: f64, x1: f64, z: f64| Window {
            region: Region { min: [x0, 0.0], max: [x1, 10.0] },
            z_m: [z, z + 0.5],
        };
        // The third meets both before it; the fourth lies over them; the fifth would make the first too long;
        // the sixth is too high by itself.
        let mut tall = window(0.0, 10.0, 0.0);
        tall.z_m[1] = 4.0;
        let long = 10.0 + MAX_CELLS * CELL_M * CELL_M / 10.0;
        let all = [
            window(0.0, 10.0, 0.0),
            window(20.0, 30.0, 1.0),
            window(9.0, 21.0, 0.0),
            window(5.0, 15.0, 7.0),
            window(29.0, long, 0.0),
            tall,
        ];
        let mut found: Vec<[f64; 3]> =
            joined(all.into_iter()).iter().map(|w| [w.region.min[0], w.region.max[0], w.z_m[0]]).collect();
        found.sort_by(|a, b| a[2].total_cmp(&b[2]).then(a[0].total_cmp(&b[0])));
        assert_eq!(found, [[0.0, 30.0, 0.0], [29.0, long, 0.0], [5.0, 15.0, 7.0]]);
    }

    #[test]
    fn islands_and_open_land_stay() {
        assert!(patches(&frame(14.0, 14.0, Ground::Paved, 0.0)).is_empty());
        let road = |y0: f64| ([-60.0, 60.0, y0, y0 + 7.0], Ground::Paved, 0.0);
        assert!(patches(&cover(&[road(0.1)])).is_empty());
        assert!(patches(&cover(&[road(0.1), road(9.6)])).is_empty());
        // A corner between two roads is no gap either.
        let corner =
            [([-60.0, 60.0, 0.1, 7.0], Ground::Walk, 0.1), ([0.2, 7.0, 7.0, 60.0], Ground::Walk, 0.1)];
        assert!(patches(&cover(&corner)).is_empty());
    }

    #[test]
    fn narrow_gaps_are_paved_though_their_ends_are_open() {
        let gap = cover(&[
            ([-20.0, 20.0, 0.1, 7.0], Ground::Paved, 0.0),
            ([-20.0, 20.0, 7.8, 12.0], Ground::Paved, 0.0),
        ]);
        let patches = patches(&gap);
        for i in -18..=18 {
            let (x, found) = (f64::from(i), over(&patches, f64::from(i), 7.4));
            let on_plane = |z: f64| (z + PATCH_BELOW_M - plane(x, 7.4)).abs() < 1e-3;
            assert!(found.iter().any(|(_, z)| on_plane(*z)), "{found:?} at {x}");
        }
        assert!(over(&patches, 25.0, 7.4).is_empty());
    }

    #[test]
    fn gaps_among_pavement_become_pavement_and_others_lie_at_the_road() {
        let patches_of = |cover: Cover| patches(&cover);
        let walk = patches_of(frame(3.0, 3.0, Ground::Walk, 0.12));
        let found = over(&walk, 1.6, 1.7);
        assert!(!found.is_empty());
        for (ground, z) in found {
            assert!(ground == Ground::Walk && (z + PATCH_BELOW_M - plane(1.6, 1.7) - 0.12).abs() < 1e-3);
        }
        // Between a kerb and a road.
        let mixed = patches_of(cover(&[
            ([-20.0, 20.0, 0.1, 7.0], Ground::Paved, 0.0),
            ([-20.0, 20.0, 7.8, 12.0], Ground::Walk, 0.12),
        ]));
        let found = over(&mixed, 1.0, 7.4);
        assert!(!found.is_empty());
        for (ground, z) in found {
            assert!(ground == Ground::Paved && (z + PATCH_BELOW_M - plane(1.0, 7.4)).abs() < 0.01, "{z}");
        }
    }
}
