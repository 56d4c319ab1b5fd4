//! Voxel grids against returns, and filled against unfilled ones.

use schema::Tag;

use super::clouds::{Cloud, Kind, OfSurface};
use crate::config::GridConfig;
use crate::files::{Array, Npz, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::Motion;

/// A return this near to a voxel's face may lie on its other side, m.
const EDGE_M: f64 = 5e-3;

/// The grids of an agent.
pub(crate) struct Grids {
    config: GridConfig,
    plain: Npz,
    filled: Option<Npz>,
}

/// A grid of tags at one frame.
struct Grid<'a> {
    config: &'a GridConfig,
    sides: [usize; 3],
    tags: &'a [u8],
}

impl Grids {
    pub(crate) fn new(config: GridConfig, plain: Npz, filled: Option<Npz>) -> Self {
        Self { config, plain, filled }
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

    fn frame(&self, archive: &Npz, frame: usize, ledger: &mut Ledger) -> Option<Array> {
        let read = archive.frame(frame as u32).and_then(|array| {
            if array.shape == self.sides() && array.descr == "|u1" {
                Ok(array)
            } else {
                Err(Unreadable(format!("frame {frame}: a grid is {:?} of {}", array.shape, array.descr)))
            }
        });
        let array = ledger.read(read)?;
        let most = array.bytes.iter().max().copied().unwrap_or(0);
        ledger.expect(Rule::Units, usize::from(most) < Tag::COUNT, || {
            format!("frame {frame}: a voxel has tag {most}")
        });
        (usize::from(most) < Tag::COUNT).then_some(array)
    }

    /// Checks the grids of a frame.
    pub(crate) fn check(
        &self,
        scene: &Scene,
        frame: usize,
        (world_from_agent, own): (&Motion, u16),
        clouds: &[Cloud<'_>],
        ledger: &mut Ledger,
    ) {
        let Some(plain) = self.frame(&self.plain, frame, ledger) else { return };
        ledger.shares.voxel_grids += 1;
        count(&plain.bytes, &mut ledger.shares.voxels);
        if let Some(filled) = self.filled.as_ref().and_then(|filled| self.frame(filled, frame, ledger)) {
            count(&filled.bytes, &mut ledger.shares.filled);
            let pairs = plain.bytes.iter().zip(&filled.bytes).filter(|(plain, _)| **plain != 0);
            let lost = pairs.filter(|(plain, filled)| plain != filled).count() as u64;
            let kept = plain.bytes.iter().filter(|tag| **tag != 0).count() as u64 - lost;
            ledger.fine(Rule::VoxelFill, kept);
            ledger.all_off(Rule::VoxelFill, lost, "", || {
                format!("frame {frame}: {lost} voxels have another tag when filled")
            });
        }
        let grid = Grid { config: &self.config, sides: self.sides(), tags: &plain.bytes };
        let mount = Motion::of_angles([0.0, 0.0, self.config.mount_z_m], [0.0; 3]);
        let world_from_grid = world_from_agent.then(&mount);
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

fn count(tags: &[u8], counts: &mut [u64; Tag::COUNT]) {
    for &tag in tags {
        counts[usize::from(tag) % Tag::COUNT] += 1;
    }
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
        for OfSurface { point, id, tag, around_m } in cloud.surfaces() {
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

    fn tag(&self, i: usize, j: usize, k: usize) -> u8 {
        self.tags[(i * self.sides[1] + j) * self.sides[2] + k]
    }
}

/// Whether a voxel with a tag may hold a surface of another tag: the one that goes before is written.
fn stands_for(voxel: u8, surface: u8) -> bool {
    let before = |tag: u8| Tag::from_u8(tag).map_or(0, Tag::voxel_priority);
    voxel != 0 && (voxel == surface || before(voxel) >= before(surface))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voxel_has_the_tag_that_goes_before() {
        let tag = |tag: Tag| tag as u8;
        assert!(stands_for(tag(Tag::Car), tag(Tag::Car)));
        assert!(stands_for(tag(Tag::RoadLine), tag(Tag::Road)), "a line on the road");
        assert!(!stands_for(tag(Tag::Terrain), tag(Tag::Road)));
        assert!(!stands_for(0, tag(Tag::Building)));
    }
}
