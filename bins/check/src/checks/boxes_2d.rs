//! Boxes in the pictures against instance images and projected boxes.

use std::collections::BTreeMap;

use schema::{DetectionClass, Tag};

use super::boxes::{AROUND_M, DOOR_M, Labelled};
use super::cameras::{Patch, Sight};
use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;
use crate::rules::Rule;
use crate::scene::Scene;

/// An amodal box may reach this far over the projected box, pixels.
const AROUND_PX: f64 = 2.0;
/// Where the whole box is before the camera, farther than this (m), ...
const AHEAD_M: f64 = 1.0;
/// ...an object is at least so large a part of its projected box, each way: people stand with room around
/// them.
const LEAST: f64 = 0.3;
/// Greatest difference of a truncated share from that of the box's areas.
const SHARE: f64 = 1e-3;

/// A row.
#[derive(Clone, Debug)]
struct Flat {
    class: String,
    pixels: u64,
    visible: [f64; 4],
    amodal: [f64; 4],
    occlusion: f64,
    truncation: f64,
}

/// The rows of an agent, by frame and camera, then id.
pub(crate) struct FlatBoxes(BTreeMap<(i64, String), BTreeMap<u16, Flat>>);

impl FlatBoxes {
    /// Reads the table of an agent.
    pub(crate) fn read(scene: &Scene, agent: &str, ledger: &mut Ledger) -> Result<Self, Unreadable> {
        let mut found: BTreeMap<(i64, String), BTreeMap<u16, Flat>> = BTreeMap::new();
        for rows in Table::open(&scene.file(&format!("sensors/{agent}/boxes_2d.parquet")))?.batches()? {
            let (frames, cameras) = (rows.ints("frame")?, rows.texts("camera")?);
            let (ids, classes) = (rows.ints("id")?, rows.texts("class")?);
            let pixels = rows.ints("pixels")?;
            let (visible, amodal) = (rows.vectors::<4>("visible_px")?, rows.vectors::<4>("amodal_px")?);
            let (occlusion, truncation) = (rows.reals("occlusion")?, rows.reals("truncation")?);
            for (k, camera) in cameras.into_iter().enumerate() {
                let row = Flat {
                    class: classes[k].clone(),
                    pixels: pixels[k].unsigned_abs(),
                    visible: visible[k],
                    amodal: amodal[k],
                    occlusion: occlusion[k],
                    truncation: truncation[k],
                };
                let id = u16::try_from(ids[k]).unwrap_or(0);
                let place = found.entry((frames[k], camera)).or_default();
                ledger.expect(Rule::FlatBoxes, place.insert(id, row).is_none(), || {
                    format!("boxes_2d: frame {}: object {id} is there twice", frames[k])
                });
            }
        }
        Ok(Self(found))
    }

    /// Checks the rows of a camera that has a picture. `own`: the agent's own object, within which its
    /// cameras may be.
    pub(crate) fn check(
        &self,
        scene: &Scene,
        sight: &Sight<'_>,
        (boxes, own): (&[Labelled], u16),
        frame: usize,
        ledger: &mut Ledger,
    ) {
        if sight.instance.is_none() {
            ledger.skip(Rule::FlatBoxes, "no instance images are kept");
            return;
        }
        let name = &sight.camera.name;
        let none = BTreeMap::new();
        let rows = self.0.get(&(frame as i64, name.clone())).unwrap_or(&none);
        let shown = shown(sight);
        for (&id, patch) in &shown {
            let class = scene.actors.get(&id).and_then(|actor| DetectionClass::from_tags(&actor.tags));
            let Some(class) = class else { continue };
            let labelled = boxes.iter().find(|b| b.id == id && id != own);
            let wrong = match rows.get(&id) {
                None => Some("there is no row".into()),
                Some(row) => row.unlike(class, patch, sight, labelled),
            };
            ledger.expect(Rule::FlatBoxes, wrong.is_none(), || {
                format!(
                    "frame {frame}: {name}: object {id} ({}): {}",
                    class.name(),
                    wrong.unwrap_or_default()
                )
            });
        }
        for id in rows.keys().filter(|id| !shown.contains_key(id)) {
            ledger.off(Rule::FlatBoxes, || {
                format!("frame {frame}: {name}: a row of object {id}, which it does not show")
            });
        }
    }
}

/// Pixels of each object that belong to a class, and those of riders.
fn shown(sight: &Sight<'_>) -> BTreeMap<u16, Patch> {
    let mut shown: BTreeMap<u16, Patch> = BTreeMap::new();
    for (&(id, tag), patch) in &sight.parts {
        if id == 0 || !(tag == Tag::Rider as u8 || DetectionClass::from_tags(&[tag]).is_some()) {
            continue;
        }
        let whole = shown.entry(id).or_insert(Patch { pixels: 0, ..*patch });
        whole.pixels += patch.pixels;
        for axis in 0..2 {
            whole.low[axis] = whole.low[axis].min(patch.low[axis]);
            whole.high[axis] = whole.high[axis].max(patch.high[axis]);
        }
    }
    shown
}

/// Width times height; 0 of boxes turned inside out.
fn area([left, top, right, bottom]: [f64; 4]) -> f64 {
    (right - left).max(0.0) * (bottom - top).max(0.0)
}

impl Flat {
    /// What is wrong with a row, if anything.
    fn unlike(
        &self,
        class: DetectionClass,
        patch: &Patch,
        sight: &Sight<'_>,
        labelled: Option<&Labelled>,
    ) -> Option<String> {
        let ([left, top], [right, bottom]) = (patch.low, patch.high);
        let visible = [left, top, right + 1, bottom + 1].map(|side| side as f64);
        let (width, height) = sight.camera.size();
        let (width, height) = (width as f64, height as f64);
        let [l, t, r, b] = self.amodal;
        let inside = [l.max(0.0), t.max(0.0), r.min(width), b.min(height)];
        let truncation = 1.0 - area(inside) / area(self.amodal);
        // So many pixels of it may be hidden: those that its box touches and that do not show it.
        let window = area([inside[0].floor(), inside[1].floor(), inside[2].ceil(), inside[3].ceil()]);
        let most_hidden = 1.0 - self.pixels as f64 / window;
        if self.class != class.name() {
            Some(format!("its class is {}", self.class))
        } else if self.pixels != patch.pixels {
            Some(format!("pixels is {}, counted {}", self.pixels, patch.pixels))
        } else if self.visible != visible {
            Some(format!("visible_px is {:?}, counted {visible:?}", self.visible))
        } else if l > visible[0] || t > visible[1] || r < visible[2] || b < visible[3] {
            Some(format!("amodal_px {:?} does not hold visible_px {visible:?}", self.amodal))
        } else if l < -width || t < -height || r > 2.0 * width || b > 2.0 * height {
            Some(format!("amodal_px {:?} is farther outside than the picture is large", self.amodal))
        } else if (self.truncation - truncation.max(0.0)).abs() > SHARE {
            Some(format!("truncation is {}, by its areas {truncation}", self.truncation))
        } else if !(0.0..=most_hidden + SHARE).contains(&self.occlusion) {
            Some(format!("occlusion is {}, at most {most_hidden} may be hidden", self.occlusion))
        } else {
            self.unlike_projection(sight, labelled?)
        }
    }

    /// How the amodal box differs from the projected one, if it does.
    fn unlike_projection(&self, sight: &Sight<'_>, labelled: &Labelled) -> Option<String> {
        let doors = if labelled.open_door { DOOR_M } else { 0.0 };
        let grown = labelled.grown(AROUND_M + doors);
        let depths = || grown.iter().map(|corner| sight.world_from_optical.inward(*corner)[2]);
        let is_whole = depths().all(|depth| depth >= AHEAD_M);
        if !is_whole && !sight.camera.optics.is_straight() {
            // Edges leave the lens's view somewhere.
            return None;
        }
        let (width, height) = sight.camera.size();
        let sides = [width as f64, height as f64];
        let cut = |[low, high]: [[f64; 2]; 2]| {
            let cut = |at: f64, axis: usize| at.clamp(-sides[axis], 2.0 * sides[axis]);
            [cut(low[0], 0), cut(low[1], 1), cut(high[0], 0), cut(high[1], 1)]
        };
        let Some(around) = sight.bounds(&grown).map(cut) else {
            return Some("its box is not before the camera".into());
        };
        let over = [
            around[0] - self.amodal[0],
            around[1] - self.amodal[1],
            self.amodal[2] - around[2],
            self.amodal[3] - around[3],
        ];
        let over = over.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if over > AROUND_PX {
            return Some(format!("amodal_px goes {over:.1} pixels beyond the projected box"));
        }
        let projected = sight.bounds(&labelled.corners).map(cut).filter(|_| is_whole)?;
        let small = (0..2).find(|&axis| {
            let extent = |sides: &[f64; 4]| sides[axis + 2] - sides[axis];
            extent(&self.amodal) + AROUND_PX < LEAST * extent(&projected)
        });
        small.map(|_| format!("amodal_px {:?} is small for the projected box {projected:.1?}", self.amodal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_never_negative() {
        assert_eq!(area([1.0, 2.0, 4.0, 4.0]), 6.0);
        assert_eq!(area([5.0, 2.0, 4.0, 1.0]), 0.0);
    }
}
