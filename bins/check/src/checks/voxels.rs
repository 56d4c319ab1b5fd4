//! Voxel grids, whole or listed, against returns, and filled against unfilled ones.

use schema::Tag;

use super::boxes::Labelled;
use super::cells::CellArrays;
use super::clouds::{Cloud, Kind, OfSurface};
use super::grid::{Grid, Tags, number};
use crate::config::GridConfig;
use crate::files::{Npz, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::Motion;

/// A return this near to a voxel's face may lie on its other side, m.
const EDGE_M: f64 = 5e-3;

/// The grids of an agent.
pub(crate) struct Grids {
    config: GridConfig,
    /// Whole grids, or lists of occupied cells.
    plain: Npz,
    filled: Option<Npz>,
    /// What is told of each occupied cell.
    cells: CellArrays,
}

impl Grids {
    pub(crate) fn new(config: GridConfig, plain: Npz, filled: Option<Npz>, cells: CellArrays) -> Self {
        Self { config, plain, filled, cells }
    }

    /// There is one at frames 0, n, 2 n, ...: n.
    pub(crate) fn every(&self) -> u32 {
        self.config.every
    }

    /// Cells along each axis.
    fn sides(&self) -> [usize; 3] {
        let GridConfig { range_m, voxel_m, lower_m, upper_m, .. } = self.config;
        let cells = |way_m: f64| (way_m / voxel_m).round() as usize;
        [cells(2.0 * range_m), cells(2.0 * range_m), cells(upper_m - lower_m)]
    }

    /// Whole grids of a frame: tags.
    fn frame(&self, archive: &Npz, frame: usize, ledger: &mut Ledger) -> Option<Vec<u8>> {
        let array = ledger.read(archive.frame_of(frame as u32, "|u1", &self.sides()))?;
        let most = array.bytes.iter().max().copied().unwrap_or(0);
        ledger.expect(Rule::Units, usize::from(most) < Tag::COUNT, || {
            format!("frame {frame}: a voxel has tag {most}")
        });
        (usize::from(most) < Tag::COUNT).then_some(array.bytes)
    }

    /// The list of a frame: places along the axes, and tags.
    fn list(&self, frame: usize, ledger: &mut Ledger) -> Option<Vec<(u64, u8)>> {
        let sides = self.sides();
        let read = self.plain.frame_of(frame as u32, "<u2", &[0, 4]).and_then(|array| {
            let words = array.words();
            let rows = words.as_chunks::<4>().0.iter().map(|[x, y, z, tag]| {
                let place = [*x, *y, *z].map(usize::from);
                let is_inside = (0..3).all(|axis| place[axis] < sides[axis]);
                let is_tag = (1..Tag::COUNT).contains(&usize::from(*tag));
                (is_inside && is_tag).then_some((number(place, sides), *tag as u8)).ok_or_else(|| {
                    Unreadable(format!("frame {frame}: lists {place:?} of {sides:?} cells with tag {tag}"))
                })
            });
            rows.collect::<Result<Vec<_>, _>>()
        });
        let cells = ledger.read(read)?;
        let ascends = cells.is_sorted_by(|a, b| a.0 < b.0);
        ledger.expect(Rule::Cells, ascends, || {
            format!("frame {frame}: listed cells are not in C order, each once")
        });
        ascends.then_some(cells)
    }

    /// Checks the grids of a frame.
    pub(crate) fn check(
        &self,
        scene: &Scene,
        frame: usize,
        (world_from_agent, own): (&Motion, u16),
        (boxes, clouds): (&[Labelled], &[Cloud<'_>]),
        ledger: &mut Ledger,
    ) {
        let plain = if self.config.sparse {
            self.list(frame, ledger).map(Tags::Listed)
        } else {
            self.frame(&self.plain, frame, ledger).map(Tags::Whole)
        };
        let Some(plain) = plain else { return };
        ledger.shares.voxel_grids += 1;
        let cells = self.sides().into_iter().map(|side| side as u64).product();
        count(&plain, cells, &mut ledger.shares.voxels);
        let filled = self.filled.as_ref().and_then(|filled| self.frame(filled, frame, ledger));
        if let (Some(filled), Tags::Whole(plain)) = (filled, &plain) {
            let pairs = plain.iter().zip(&filled).filter(|(plain, _)| **plain != 0);
            let lost = pairs.filter(|(plain, filled)| plain != filled).count() as u64;
            let kept = plain.iter().filter(|tag| **tag != 0).count() as u64 - lost;
            count(&Tags::Whole(filled), cells, &mut ledger.shares.filled);
            ledger.fine(Rule::VoxelFill, kept);
            ledger.all_off(Rule::VoxelFill, lost, "", || {
                format!("frame {frame}: {lost} voxels have another tag when filled")
            });
        }
        let grid = Grid { config: &self.config, sides: self.sides(), tags: &plain };
        let mount = Motion::of_angles([0.0, 0.0, self.config.mount_z_m], [0.0; 3]);
        let world_from_grid = world_from_agent.then(&mount);
        self.cells.check(scene, &grid, (&world_from_grid, own), boxes, frame, ledger);
        if !self.config.full_sweep {
            ledger.skip(Rule::VoxelPoints, "sweeps find what they meet first, returns come from more");
            return;
        }
        for cloud in clouds {
            let ranger = cloud.ranger;
            if ranger.noise_m > 0.0 {
                if ranger.kind != Kind::Radar {
                    ledger.skip(Rule::VoxelPoints, format!("{}: it has noise", ranger.name));
                }
                continue;
            }
            grid.check(scene, cloud, (&world_from_grid, own), frame, ledger);
        }
    }
}

/// Adds the cells of each tag, of so many in all.
fn count(tags: &Tags, cells: u64, counts: &mut [u64; Tag::COUNT]) {
    let mut free = cells;
    for (_, tag) in tags.occupied() {
        counts[usize::from(tag)] += 1;
        free -= 1;
    }
    counts[Tag::Unlabeled as usize] += free;
}

impl Grid<'_> {
    fn check(
        &self,
        scene: &Scene,
        cloud: &Cloud<'_>,
        (world_from_grid, own): (&Motion, u16),
        frame: usize,
        ledger: &mut Ledger,
    ) {
        let GridConfig { range_m, voxel_m, lower_m, ignore_self, .. } = *self.config;
        let low = [-range_m, -range_m, lower_m];
        for OfSurface { point, id, tag, around_m, behind_glass } in cloud.surfaces() {
            if behind_glass && VEHICLES.contains(&tag) {
                let why = "from behind glass: no voxel has seats and who sits there";
                ledger.skip(Rule::VoxelPoints, format!("{}: {why}", cloud.ranger.name));
                continue;
            }
            if cloud.rolls && scene.actors.get(&id).is_none_or(|actor| !actor.fixed) {
                let why = "of what moves: its rays are fired over the frame, and wheels and limbs go on by themselves";
                ledger.skip(Rule::VoxelPoints, format!("{}: {why}", cloud.ranger.name));
                continue;
            }
            let place = world_from_grid.inward(point);
            let edge_m = EDGE_M + around_m;
            let cell = |edge: f64| [0, 1, 2].map(|axis| ((place[axis] + edge - low[axis]) / voxel_m).floor());
            let (first, last) = (cell(-edge_m), cell(edge_m));
            let is_inside = (0..3).all(|a| first[a] >= 0.0 && last[a] < self.sides[a] as f64);
            if !is_inside || (id == own && ignore_self) {
                continue;
            }
            let (first, last) = (first.map(|c| c as usize), last.map(|c| c as usize));
            let holds = (first[0]..=last[0]).any(|i| {
                (first[1]..=last[1]).any(|j| (first[2]..=last[2]).any(|k| stands_for(self.tag(i, j, k), tag)))
            });
            ledger.expect(Rule::VoxelPoints, holds, || {
                let there = self.tag(first[0], first[1], first[2]);
                format!(
                    "frame {frame}: a return of {} from object {id} with tag {tag} lies in voxel {first:?}, which has {there}",
                    cloud.ranger.name
                )
            });
        }
    }
}

/// Tags of what has panes with something behind them.
const VEHICLES: [u8; 3] = [Tag::Car as u8, Tag::Truck as u8, Tag::Bus as u8];

/// Whether a voxel with a tag may hold a surface of another tag: the one that goes before is written.
fn stands_for(voxel: u8, surface: u8) -> bool {
    let before = |tag: u8| Tag::from_u8(tag).map_or(0, Tag::voxel_priority);
    voxel != 0 && (voxel == surface || before(voxel) >= before(surface))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn listed_cells_are_those_of_the_whole_grid() {
        let (whole, listed) = (Tags::Whole(vec![0, 7, 0, 0, 14, 0]), Tags::Listed(vec![(1, 7), (4, 14)]));
        assert!(whole.occupied().eq(listed.occupied()));
        assert!((0..6).all(|cell| whole.at(cell) == listed.at(cell)));
        for tags in [whole, listed] {
            let mut counts = [0; Tag::COUNT];
            count(&tags, 6, &mut counts);
            assert_eq!((counts[0], counts[7], counts[14]), (4, 1, 1));
        }
        assert_eq!(number([1, 0, 1], [2, 3, 2]), 7);
    }

    #[test]
    fn a_voxel_has_the_tag_that_goes_before() {
        let tag = |tag: Tag| tag as u8;
        assert!(stands_for(tag(Tag::Car), tag(Tag::Car)));
        assert!(stands_for(tag(Tag::RoadLine), tag(Tag::Road)), "a line on the road");
        assert!(!stands_for(tag(Tag::Terrain), tag(Tag::Road)));
        assert!(!stands_for(0, tag(Tag::Building)));
    }
}
