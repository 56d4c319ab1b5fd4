//! What is told of each occupied voxel: whose it is, and how it moves.

use std::collections::BTreeMap;
use std::path::Path;

use schema::{FRAME_PERIOD_S, Tag};

use super::boxes::{AROUND_M, DOOR_M, Labelled, is_part};
use super::grid::Grid;
use crate::config::GridConfig;
use crate::files::{Npz, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{Motion, V3, add, apart, norm, scale, sub};

/// The greatest difference from the motion of a rigid object, m/s, and as a share of its speed...
const RIGID: [f64; 2] = [0.05, 0.01];
/// ...and of wheels and limbs, which turn: m/s, and as a share.
const LOOSE: [f64; 2] = [10.0, 1.1];
/// Objects with fewer cells are only held to the latter: those of a bicycle may all be of wheels and limbs.
const FEW: u64 = 24;
/// The greatest difference of the mean over a walker's cells, m/s, and as a share of its speed: all of it
/// sways, but to both sides.
const SWAY: [f64; 2] = [0.5, 0.4];

/// The arrays that have a row for each occupied cell.
pub(crate) struct CellArrays {
    ids: Option<Npz>,
    flow: Option<Npz>,
}

/// An object's cells: its boxes, its motion, how many there are, how many do not move with it, and what they
/// differ by in all.
struct Object<'a> {
    labelled: Option<&'a Labelled>,
    /// Where it is and where it was a frame before; none for objects at rest.
    moved: Option<[Motion; 2]>,
    is_walker: bool,
    cells: u64,
    unlike: u64,
    /// Sums of differences and of speeds, m/s.
    off: V3,
    speed: f64,
}

impl CellArrays {
    /// Opens those of an agent that its configuration asks for.
    pub(crate) fn open(folder: &Path, agent: &str, config: &GridConfig, ledger: &mut Ledger) -> Self {
        let mut open = |wanted: bool, name: &str| {
            wanted.then(|| ledger.read(Npz::open(&folder.join(format!("{name}/{agent}.npz"))))).flatten()
        };
        let arrays =
            Self { ids: open(config.ids, "occupancy_ids"), flow: open(config.flow, "occupancy_flow") };
        if !config.ids {
            ledger.skip(Rule::Cells, format!("{agent}: cells have no ids"));
        }
        if config.flow && !config.ids {
            ledger.skip(Rule::CellFlow, format!("{agent}: without ids nobody knows whose it is"));
        } else if !config.flow {
            ledger.skip(Rule::CellFlow, format!("{agent}: cells have no flow"));
        }
        arrays
    }

    /// Checks the rows of a frame. `own`: the agent's object.
    pub(crate) fn check(
        &self,
        scene: &Scene,
        grid: &Grid<'_>,
        (world_from_grid, own): (&Motion, u16),
        boxes: &[Labelled],
        frame: usize,
        ledger: &mut Ledger,
    ) {
        let cells: Vec<(u64, u8)> = grid.tags.occupied().collect();
        let ids = self.ids.as_ref().and_then(|archive| ledger.read(ids_of(archive, frame, cells.len())));
        let flow = self.flow.as_ref().and_then(|archive| ledger.read(flow_of(archive, frame, cells.len())));
        let is_real = flow.iter().flatten().flatten().all(|part| part.is_finite());
        ledger.expect(Rule::Numbers, is_real, || format!("frame {frame}: flow of voxels is no number"));
        let Some(ids) = ids else { return };
        let by_id: BTreeMap<u16, &Labelled> = boxes.iter().map(|b| (b.id, b)).collect();
        let mut objects: BTreeMap<u16, Object<'_>> = BTreeMap::new();
        let around = 0.5 * 3.0_f64.sqrt() * grid.config.voxel_m + AROUND_M;
        let mut fine = 0;
        for (row, (&(cell, tag), &id)) in cells.iter().zip(&ids).enumerate() {
            let Some(actor) = scene.actors.get(&id).filter(|actor| actor.tags.contains(&tag)) else {
                ledger.all_off(Rule::Cells, 1, &format!("whose {tag}"), || {
                    format!("frame {frame}: a voxel with tag {tag} is object {id}'s, which is not in the log or has other tags")
                });
                continue;
            };
            if id == own && grid.config.ignore_self {
                ledger.off(Rule::Cells, || {
                    format!("frame {frame}: a voxel is the agent's own, who is left out")
                });
                continue;
            }
            let object = objects.entry(id).or_insert_with(|| Object {
                labelled: by_id.get(&id).copied(),
                moved: (!actor.fixed)
                    .then(|| Some([scene.pose(id, frame as i64)?, scene.pose(id, frame as i64 - 1)?]))
                    .flatten(),
                is_walker: tag == Tag::Pedestrian as u8,
                cells: 0,
                unlike: 0,
                off: [0.0; 3],
                speed: 0.0,
            });
            let middle = grid.middle(cell);
            let place = world_from_grid.outward(middle);
            let doors = |b: &Labelled| if b.open_door { DOOR_M } else { 0.0 };
            let is_inside =
                object.labelled.is_none_or(|b| !is_part(b, tag) || b.holds(place, around + doors(b)));
            if is_inside {
                fine += 1;
            } else {
                ledger.off(Rule::Cells, || {
                    format!(
                        "frame {frame}: a voxel at {middle:.2?} is object {id}'s ({}), beyond its box",
                        actor.model
                    )
                });
            }
            if let Some(flow) = &flow {
                object.hold(flow[row], place, world_from_grid, (id, frame), ledger);
            }
        }
        ledger.fine(Rule::Cells, fine);
        for (id, object) in objects.iter().filter(|(_, object)| object.cells >= FEW) {
            let Object { cells, unlike, .. } = object;
            if object.is_walker {
                let [off, speed] = [norm(object.off), object.speed].map(|sum| sum / *cells as f64);
                ledger.expect(Rule::CellFlow, off <= SWAY[0] + SWAY[1] * speed, || {
                    format!("frame {frame}: the {cells} voxels of walker {id} at {speed:.2} m/s are {off:.2} m/s off it in the mean")
                });
                continue;
            }
            ledger.expect(Rule::CellFlow, 4 * unlike <= 3 * cells, || {
                format!("frame {frame}: {unlike} of {cells} voxels of object {id} do not move as it does")
            });
        }
    }
}

impl Object<'_> {
    /// Holds the flow of one of its cells against its motion.
    fn hold(
        &mut self,
        flow: V3,
        place: V3,
        world_from_grid: &Motion,
        (id, frame): (u16, usize),
        ledger: &mut Ledger,
    ) {
        let wanted = self.moved.map_or([0.0; 3], |[now, before]| {
            let was = before.outward(now.inward(place));
            world_from_grid.turn_back(scale(sub(place, was), 1.0 / FRAME_PERIOD_S))
        });
        let (off, speed) = (apart(flow, wanted), norm(wanted));
        let is_rigid = off <= RIGID[0] + RIGID[1] * speed;
        self.cells += 1;
        self.unlike += u64::from(!is_rigid);
        self.off = add(self.off, sub(flow, wanted));
        self.speed += speed;
        // An object at rest has cells at rest.
        let holds = is_rigid || (self.moved.is_some() && off <= LOOSE[0] + LOOSE[1] * speed);
        ledger.expect(Rule::CellFlow, holds, || {
            format!("frame {frame}: a voxel of object {id} moves at {flow:.2?} m/s, the object there at {wanted:.2?}")
        });
    }
}

fn ids_of(archive: &Npz, frame: usize, cells: usize) -> Result<Vec<u16>, Unreadable> {
    archive.frame_of(frame as u32, "<u2", &[0]).and_then(|array| one_each(array.words(), cells, frame))
}

fn flow_of(archive: &Npz, frame: usize, cells: usize) -> Result<Vec<V3>, Unreadable> {
    let array = archive.frame_of(frame as u32, "<f4", &[0, 3])?;
    let rows = array.floats().as_chunks::<3>().0.iter().map(|row| row.map(f64::from)).collect();
    one_each(rows, cells, frame)
}

/// Rows, if there is one for each occupied cell.
fn one_each<T>(rows: Vec<T>, cells: usize, frame: usize) -> Result<Vec<T>, Unreadable> {
    if rows.len() == cells {
        return Ok(rows);
    }
    Err(Unreadable(format!("frame {frame}: there are {} rows for {cells} occupied voxels", rows.len())))
}
