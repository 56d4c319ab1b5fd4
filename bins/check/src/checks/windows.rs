//! Windows of the past and the future of moving objects, against boxes and states.

use std::collections::BTreeSet;

use schema::DetectionClass;

use super::boxes::annotated;
use super::tracks::Merges;
use crate::config::WindowConfig;
use crate::files::{Batch, Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{V3, apart, within, wrapped};

/// Greatest difference of places and headings, m and rad.
const PLACE: f64 = 1e-5;
/// Greatest difference of velocities (32 bits), m/s.
const VELOCITY: f64 = 1e-4;

/// An object at a moment, as boxes and the log have it.
struct ObjectAt {
    center_m: V3,
    yaw_rad: f64,
    is_valid: bool,
}

/// Checks `tracks_windows` of a scene against the lists of all agents.
pub(crate) fn check(scene: &Scene, merged: &Merges, config: Option<WindowConfig>, ledger: &mut Ledger) {
    match config {
        None => ledger.skip(Rule::Windows, "not asked for"),
        Some(_) if !scene.done.contains("merge-tracks") => {
            ledger.skip(Rule::Windows, "boxes are not merged yet");
        }
        Some(config) => {
            let checked = check_table(scene, merged, config, ledger);
            ledger.read(checked);
        }
    }
}

/// Whether objects of a class have windows.
fn may_move(class: DetectionClass) -> bool {
    use DetectionClass::*;
    matches!(class, Car | Truck | Bus | Motorcycle | Bicycle | Pedestrian)
}

fn check_table(
    scene: &Scene,
    merged: &Merges,
    config: WindowConfig,
    ledger: &mut Ledger,
) -> Result<(), Unreadable> {
    let wanted =
        merged.iter().filter(|((frame, _), object)| frame % config.every == 0 && may_move(object.class));
    let mut missing: BTreeSet<(i64, u16)> = wanted.map(|(key, _)| *key).collect();
    for rows in Table::open(&scene.file("tracks_windows.parquet"))?.batches()? {
        let windows = Windows::of(&rows)?;
        for (k, (&frame, &id)) in windows.frames.iter().zip(&windows.ids).enumerate() {
            let id = u16::try_from(id).unwrap_or(0);
            if !missing.remove(&(frame, id)) {
                ledger.off(Rule::Windows, || {
                    format!("frame {frame}: a window of object {id}, which has none now or two")
                });
                continue;
            }
            let wrong = windows.unlike(k, (frame, id), scene, merged, config);
            ledger.expect(Rule::Windows, wrong.is_none(), || {
                format!(
                    "frame {frame}: {} of object {id} is not that of its boxes",
                    wrong.unwrap_or_default()
                )
            });
        }
    }
    ledger.all_off(Rule::Windows, missing.len() as u64, "missing", || {
        let (frame, id) = missing.first().copied().unwrap_or_default();
        format!("frame {frame}: object {id} has no window")
    });
    Ok(())
}

/// Columns of the table.
struct Windows {
    frames: Vec<i64>,
    ids: Vec<i64>,
    classes: Vec<String>,
    valid: Vec<bool>,
    centers: Vec<V3>,
    yaws: Vec<f64>,
    sizes: Vec<V3>,
    velocities: Vec<V3>,
    /// Of the past and of the future.
    ways: [WayColumns; 2],
}

/// Columns of the places of a window.
struct WayColumns {
    centers: Vec<Vec<f64>>,
    yaws: Vec<Vec<f64>>,
    masks: Vec<Vec<i64>>,
    valid: Vec<Vec<i64>>,
}

impl WayColumns {
    fn of(rows: &Batch, when: &str) -> Result<Self, Unreadable> {
        Ok(Self {
            centers: rows.real_lists(&format!("{when}_center_m"))?,
            yaws: rows.real_lists(&format!("{when}_yaw_rad"))?,
            masks: rows.int_lists(&format!("{when}_mask"))?,
            valid: rows.int_lists(&format!("{when}_valid"))?,
        })
    }
}

impl Windows {
    fn of(rows: &Batch) -> Result<Self, Unreadable> {
        Ok(Self {
            frames: rows.ints("frame")?,
            ids: rows.ints("id")?,
            classes: rows.texts("class")?,
            valid: rows.flags("valid_flag")?,
            centers: rows.vectors("center_m")?,
            yaws: rows.reals("yaw_rad")?,
            sizes: rows.vectors("size_m")?,
            velocities: rows.vectors("velocity_mps")?,
            ways: [WayColumns::of(rows, "past")?, WayColumns::of(rows, "future")?],
        })
    }

    /// The column of a row that differs, if any does.
    fn unlike(
        &self,
        k: usize,
        (frame, id): (i64, u16),
        scene: &Scene,
        merged: &Merges,
        config: WindowConfig,
    ) -> Option<String> {
        let (object, now) = (&merged[&(frame, id)], place(scene, merged, frame, id)?);
        let velocity = scene.state(id, frame).map_or([0.0; 3], |state| state.velocity_mps);
        let standing = annotated(scene.actors.get(&id)?, None);
        let size = standing.map_or([f64::NAN; 3], |(_, half)| half.map(|h| 2.0 * h));
        let columns = [
            ("class", self.classes[k] == object.class.name()),
            ("valid_flag", self.valid[k] == now.is_valid),
            ("center_m", within(apart(self.centers[k], now.center_m), PLACE)),
            ("yaw_rad", within(wrapped(self.yaws[k] - now.yaw_rad), PLACE)),
            ("size_m", within(apart(self.sizes[k], size), PLACE)),
            ("velocity_mps", within(apart(self.velocities[k], velocity), VELOCITY)),
        ];
        if let Some((name, _)) = columns.into_iter().find(|(_, same)| !same) {
            return Some(name.to_owned());
        }
        let WindowConfig { step, past, future, .. } = config;
        let steps = [(-past..0).collect::<Vec<_>>(), (1..=future).collect()];
        for ((when, way), steps) in ["past", "future"].into_iter().zip(&self.ways).zip(steps) {
            let lengths =
                [way.centers[k].len() / 3, way.yaws[k].len(), way.masks[k].len(), way.valid[k].len()];
            if lengths != [steps.len(); 4] || way.centers[k].len() % 3 != 0 {
                return Some(format!("the length of {when}"));
            }
            for (at, number) in steps.into_iter().enumerate() {
                let wanted = place(scene, merged, frame + number * step, id);
                let center = [0, 1, 2].map(|i| way.centers[k][3 * at + i]);
                let (is_there, is_valid) = (way.masks[k][at] == 1, way.valid[k][at] == 1);
                let same = match &wanted {
                    Some(wanted) => {
                        is_there
                            && is_valid == wanted.is_valid
                            && within(apart(center, wanted.center_m), PLACE)
                            && within(wrapped(way.yaws[k][at] - wanted.yaw_rad), PLACE)
                    }
                    None => !is_there && !is_valid && center == [0.0; 3] && way.yaws[k][at] == 0.0,
                };
                if !same {
                    return Some(format!("place {number} of {when}"));
                }
            }
        }
        None
    }
}

/// Where an object is at a frame at which it is in some agent's list.
fn place(scene: &Scene, merged: &Merges, frame: i64, id: u16) -> Option<ObjectAt> {
    let object = merged.get(&(frame, id))?;
    let ahead = scene.pose(id, frame)?.ahead();
    let yaw_rad = libm::atan2(ahead[1], ahead[0]);
    Some(ObjectAt { center_m: object.center_m, yaw_rad, is_valid: !object.seen_by.is_empty() })
}
