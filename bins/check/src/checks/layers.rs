//! Arrays beside masks: whose cells are, how high the ground is, what is painted on it.

use std::collections::BTreeMap;
use std::path::Path;

use schema::{BevClass, Tag};

use super::boxes::{AROUND_M, DOOR_M, Labelled};
use super::clouds::Cloud;
use super::mapped::{HEIGHT_M, Mapped, tell};
use super::mask::{Mask, tag_of};
use crate::config::Config;
use crate::files::Npz;
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{Motion, sub};

/// Returns from the ground are at most this far below and above it, m.
const RETURN_M: f64 = 0.3;
/// Returns from the ground are looked at within this distance and height, m.
const NEAR_M: [f64; 2] = [40.0, 1.0];
/// Agents stand on ground that is this near in height, m.
const STAND_M: f64 = 0.5;

/// The arrays of an agent.
#[derive(Default)]
pub(crate) struct Layers {
    ids: Option<Npz>,
    heights: Option<Npz>,
    paint: Option<Npz>,
}

impl Layers {
    /// Opens those that the configuration asks for.
    pub(crate) fn open(folder: &Path, agent: &str, config: &Config, ledger: &mut Ledger) -> Self {
        let mut open = |layer: &str, rule: Rule| {
            if !config.has_bev(layer) {
                ledger.skip(rule, "not asked for");
                return None;
            }
            ledger.read(Npz::open(&folder.join(format!("bev_{layer}/{agent}.npz"))))
        };
        Self {
            ids: open("ids", Rule::BevIds),
            heights: open("heights", Rule::BevHeights),
            paint: open("paint", Rule::BevPaint),
        }
    }

    /// Checks what there is of a frame. `mapped`: none where the map is not known.
    pub(super) fn check(
        &self,
        scene: &Scene,
        mask: &Mask,
        (agent, mapped): (&Motion, Option<&Mapped>),
        (boxes, clouds): (&[Labelled], &[Cloud<'_>]),
        frame: usize,
        ledger: &mut Ledger,
    ) {
        let (at, cells) = (frame as u32, mask.cells);
        if let Some(archive) = &self.ids
            && let Some(ids) = ledger.read(archive.frame_of(at, "<u2", &[cells, cells]))
        {
            check_ids(scene, mask, &ids.words(), boxes, frame, ledger);
        }
        if let Some(archive) = &self.heights
            && let Some(heights) = ledger.read(archive.frame_of(at, "<f4", &[cells, cells]))
        {
            check_heights(mask, (agent, mapped), &heights.floats(), clouds, frame, ledger);
        }
        if let Some(archive) = &self.paint
            && let Some(paint) = ledger.read(archive.frame_of(at, "|b1", &[3, cells, cells]))
        {
            let is_bits = paint.bytes.iter().all(|&bit| bit < 2);
            ledger.expect(Rule::BevPaint, is_bits, || format!("frame {frame}: paint has other than 0 and 1"));
            if let Some(mapped) = mapped {
                mapped.check_stop_lines(mask, &paint.bytes[..cells * cells], frame, ledger);
            }
        }
    }
}

fn check_ids(scene: &Scene, mask: &Mask, ids: &[u16], boxes: &[Labelled], frame: usize, ledger: &mut Ledger) {
    let cells = mask.cells;
    let objects =
        BevClass::ALL.into_iter().filter_map(|class| Some((mask.channel(class), tag_of(class)? as u8)));
    let objects: Vec<(&[u8], u8)> = objects.collect();
    let shows = |cell: usize| objects.iter().filter(move |(set, _)| set[cell] == 1);
    let mut by_id: BTreeMap<u16, Vec<usize>> = BTreeMap::new();
    for (cell, &id) in ids.iter().enumerate().filter(|(_, id)| **id != 0) {
        by_id.entry(id).or_default().push(cell);
    }
    if mask.is_exact {
        let same = (0..ids.len()).map(|cell| (cell, (ids[cell] != 0) == shows(cell).next().is_some()));
        tell(Rule::BevIds, same.filter(|&(cell, same)| !same || ids[cell] != 0), ledger, |cell| {
            let place = [cell / cells, cell % cells];
            format!(
                "frame {frame}: the mask's cell {place:?} shows an object, or none, and its id is {}",
                ids[cell]
            )
        });
    }
    for (id, found) in by_id {
        let tags = scene.actors.get(&id).map(|actor| actor.tags.as_slice());
        let tags: &[u8] = tags.unwrap_or_default();
        let may = |cell: usize| shows(cell).any(|(_, tag)| tags.contains(tag)) || !mask.is_exact;
        let is_object = tags.iter().any(|tag| objects.iter().any(|(_, of)| of == tag));
        tell(Rule::BevIds, found.iter().map(|&cell| (cell, is_object && may(cell))), ledger, |cell| {
            let place = [cell / cells, cell % cells];
            format!(
                "frame {frame}: the cell {place:?} is object {id}'s, which is not in the log or of another class"
            )
        });
        let Some(labelled) = boxes.iter().find(|b| b.id == id) else { continue };
        let doors = if labelled.open_door { DOOR_M } else { 0.0 };
        let allowed = mask.near(&mask.outline(labelled), 0.7072 + (AROUND_M + doors) / mask.cell_m);
        tell(Rule::BevIds, found.iter().map(|&cell| (cell, allowed.contains(&cell))), ledger, |cell| {
            let place = [cell / cells, cell % cells];
            format!("frame {frame}: the cell {place:?} is object {id}'s, beyond its box")
        });
    }
}

fn check_heights(
    mask: &Mask,
    (agent, mapped): (&Motion, Option<&Mapped>),
    heights: &[f32],
    clouds: &[Cloud<'_>],
    frame: usize,
    ledger: &mut Ledger,
) {
    let cells = mask.cells;
    let height = |cell: usize| f64::from(heights[cell]);
    let paved = [BevClass::Road, BevClass::Sidewalk].map(|class| mask.channel(class));
    let shown = (0..heights.len()).filter(|&cell| mask.is_exact && paved.iter().any(|set| set[cell] == 1));
    tell(Rule::BevHeights, shown.map(|cell| (cell, height(cell).is_finite())), ledger, |cell| {
        format!("frame {frame}: the paved cell {:?} has no height", [cell / cells, cell % cells])
    });
    let middle = (cells / 2) * cells + cells / 2;
    if cells > 0 && height(middle).is_finite() {
        ledger.expect(Rule::BevHeights, height(middle).abs() <= STAND_M, || {
            format!("frame {frame}: the agent stands {:.2} m above the ground", -height(middle))
        });
    }
    if let Some(mapped) = mapped {
        let known = mapped.known(mask).filter(|&(cell, _)| height(cell).is_finite());
        let holds = |(cell, here): (usize, usize)| {
            let (low, high) = (mapped.ground.low[here] - HEIGHT_M[0], mapped.ground.high[here] + HEIGHT_M[1]);
            (cell, (low..=high).contains(&height(cell)))
        };
        tell(Rule::BevHeights, known.map(holds), ledger, |cell| {
            let place = [cell / cells, cell % cells];
            format!("frame {frame}: the height of {place:?} is {:.2} m, the map says otherwise", height(cell))
        });
    }
    for cloud in clouds {
        for of in cloud.surfaces() {
            let is_ground = matches!(Tag::from_u8(of.tag), Some(Tag::Road | Tag::RoadLine | Tag::Sidewalk));
            let way = sub(of.point, agent.origin);
            if !is_ground || libm::hypot(way[0], way[1]) > NEAR_M[0] || way[2].abs() > NEAR_M[1] {
                continue;
            }
            let place = mask.place(of.point[0], of.point[1]).map(|at| at.round() as i64);
            let Some([row, column]) = inner(place, cells) else { continue };
            let around = (0..9).map(|k| height((row + k / 3 - 1) * cells + column + k % 3 - 1));
            let (low, high) =
                around.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
            let slack = RETURN_M + of.around_m;
            ledger.expect(Rule::BevHeights, (low - slack..=high + slack).contains(&way[2]), || {
                format!(
                    "frame {frame}: {} meets ground at {:.2} m in [{row}, {column}], where it is {low:.2} to {high:.2} m high",
                    cloud.ranger.name, way[2]
                )
            });
        }
    }
}

/// A cell that has all its neighbours.
fn inner(place: [i64; 2], cells: usize) -> Option<[usize; 2]> {
    let [row, column] = place.map(|at| usize::try_from(at).unwrap_or(0));
    ([row, column].iter().all(|&at| at >= 1 && at + 1 < cells)).then_some([row, column])
}
