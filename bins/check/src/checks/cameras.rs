//! Images of labels: what they show, and where.

use std::collections::BTreeMap;

use schema::Tag;

use super::boxes::{DOOR_M, Labelled, is_part};
use crate::config::{AgentConfig, Mounted};
use crate::files::{Picture, Table, Unreadable, jpeg_size};
use crate::ledger::Ledger;
use crate::optics::Optics;
use crate::rules::Rule;
use crate::scene::Scene;
use crate::space::{Motion, V3, add, apart, scale, sub, within};

/// Greatest difference of a calibration from the configuration.
const CALIBRATION: f64 = 1e-9;
/// Pixels may lie this far outside a projected box.
const AROUND_PX: f64 = 2.0;
/// Boxes are cut off this near the camera, m.
const NEAR_M: f64 = 0.01;
/// Pieces of an edge that a lens bends.
const BENT: u32 = 256;
/// Edges of a box as pairs of corners.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 6], [5, 7], [6, 7]];

/// A camera and the tables of its images.
pub(crate) struct Camera {
    pub(crate) name: String,
    pub(crate) optics: Optics,
    /// It has pictures at frames 0, n, 2 n, ...
    every: usize,
    /// Whether flow is kept as half floats.
    pub(crate) flow_half: bool,
    agent_from_optical: Motion,
    rgb: Option<Table>,
    semantic: Option<Table>,
    instance: Option<Table>,
    depth: Option<Table>,
    pub(crate) flow: Option<Table>,
}

/// Pixels of an object with a tag in an image: how many, and their bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    pub(crate) pixels: u64,
    pub(crate) low: [usize; 2],
    pub(crate) high: [usize; 2],
}

/// What a camera's label images show at a frame.
pub(crate) struct Sight<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) world_from_optical: Motion,
    pub(crate) instance: Option<Picture>,
    pub(crate) depth: Option<Picture>,
    pub(crate) parts: BTreeMap<(u16, u8), Patch>,
}

/// Opens the tables of all cameras of an agent.
pub(crate) fn open(scene: &Scene, config: &AgentConfig, agent: &str, ledger: &mut Ledger) -> Vec<Camera> {
    let every = config.camera_every();
    let flu_from_optical =
        Motion { rows: [[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]], origin: [0.0; 3] };
    let mut cameras = Vec::new();
    for (mounted, optics) in config.cameras() {
        let optical = mounted.agent_from_sensor.then(&flu_from_optical);
        let about = Mounted { name: mounted.name.clone(), agent_from_sensor: optical };
        let mut table = |taken: &str, kind: &str| {
            let path = scene.file(&format!("sensors/{agent}/{kind}-{}.parquet", mounted.name));
            let table = config.takes(taken).then(|| ledger.read(Table::open(&path))).flatten()?;
            expect_mount(&table, &about, ("optical", every), ledger);
            expect_lens(&table, &optics, ledger);
            Some(table)
        };
        cameras.push(Camera {
            rgb: table("rgb", "RGB"),
            semantic: table("semantic", "SEG"),
            instance: table("instance", "IST"),
            depth: table("depth", "DPT"),
            flow: table("flow", "FLW"),
            name: mounted.name,
            optics,
            every: every as usize,
            flow_half: config.takes("flow_half"),
            agent_from_optical: optical,
        });
    }
    cameras
}

/// A table says where its sensor is, and how often it is read, as the configuration does.
pub(crate) fn expect_mount(
    table: &Table,
    mounted: &Mounted,
    (frame, every): (&str, u32),
    ledger: &mut Ledger,
) {
    let path = table.path().display();
    let about: Option<serde_json::Value> =
        table.note("sensor").and_then(|text| serde_json::from_str(text).ok());
    let Some(about) = about else {
        ledger.off(Rule::Calibration, || format!("{path}: says nothing of its sensor"));
        return;
    };
    let numbers = |key: &str, at: usize| about["agent_from_sensor"][key][at].as_f64().unwrap_or(f64::NAN);
    let place = [0, 1, 2].map(|i| numbers("translation", i));
    let found = Motion::of_quaternion(place, [0, 1, 2, 3].map(|i| numbers("quaternion", i)));
    let (way, turn) =
        (apart(place, mounted.agent_from_sensor.origin), found.turned_from(&mounted.agent_from_sensor));
    let same = within(way, CALIBRATION) && within(turn, CALIBRATION) && about["frame"] == frame;
    ledger.expect(Rule::Calibration, same && about["name"] == *mounted.name, || {
        format!("{path}: {} in {} is {way:.6} m and {turn:.6} rad off", about["name"], about["frame"])
    });
    let said = &about["every_n_frames"];
    ledger.expect(Rule::Calibration, said.as_u64() == Some(every.into()), || {
        format!("{path}: says every_n_frames is {said}, the configuration {every}")
    });
}

fn expect_lens(table: &Table, optics: &Optics, ledger: &mut Ledger) {
    let about: Option<serde_json::Value> =
        table.note("sensor").and_then(|text| serde_json::from_str(text).ok());
    let Some(about) = about else { return };
    let wanted = optics.matrix();
    let entry = |i: usize, j: usize| about["intrinsics"][i][j].as_f64().unwrap_or(f64::NAN);
    let off =
        (0..9).map(|k| (entry(k / 3, k % 3) - wanted[k / 3][k % 3]).abs()).fold(0.0, crate::space::worse);
    let size = (about["width"].as_u64(), about["height"].as_u64());
    let wanted_size = (Some(optics.width as u64), Some(optics.height as u64));
    let same = size == wanted_size && within(off, CALIBRATION * wanted[0][0]);
    ledger.expect(Rule::Calibration, same, || {
        format!("{}: intrinsics are off by {off:.6} pixels, or the size is {size:?}", table.path().display())
    });
    ledger.expect(Rule::Calibration, about["lens"] == optics.lens_written, || {
        let (said, wanted) = (&about["lens"], &optics.lens_written);
        format!("{}: the lens is {said}, the configuration says {wanted}", table.path().display())
    });
}

fn picture(table: &Table, row_number: usize) -> Result<Picture, Unreadable> {
    let row = table.row(row_number)?;
    Picture::of_png(row.first_bytes("image")?)
        .map_err(|why| Unreadable::new(table.path(), format!("row {row_number}: the image {why}")))
}

impl Camera {
    /// The row of a frame in its tables; none where it has no picture.
    pub(crate) fn row_of(&self, frame: usize) -> Option<usize> {
        frame.is_multiple_of(self.every).then(|| frame / self.every)
    }

    /// What its label images show at a frame; nothing where it has no picture.
    pub(crate) fn sight(&self, frame: usize, world_from_agent: &Motion, ledger: &mut Ledger) -> Sight<'_> {
        let mut read = |table: &Option<Table>| {
            let picture = ledger.read(picture(table.as_ref()?, self.row_of(frame)?))?;
            let (size, told) = ((picture.width, picture.height), self.size());
            ledger.expect(Rule::Pictures, size == told, || {
                format!("frame {frame}: {} has a picture of {size:?} pixels", self.name)
            });
            (size == told).then_some(picture)
        };
        let (instance, depth) = (read(&self.instance), read(&self.depth));
        let parts = instance.as_ref().map(parts).unwrap_or_default();
        let world_from_optical = world_from_agent.then(&self.agent_from_optical);
        Sight { camera: self, world_from_optical, instance, depth, parts }
    }

    /// Where it is, without a picture.
    pub(crate) fn blind(&self, world_from_agent: &Motion) -> Sight<'_> {
        let world_from_optical = world_from_agent.then(&self.agent_from_optical);
        Sight { camera: self, world_from_optical, instance: None, depth: None, parts: BTreeMap::new() }
    }

    /// The size of the RGB image; the semantic image against the instance image.
    pub(crate) fn check_others(&self, sight: &Sight<'_>, frame: usize, ledger: &mut Ledger) {
        let Some(at) = self.row_of(frame) else { return };
        if let Some(row) = self.rgb.as_ref().and_then(|table| ledger.read(table.row(at))) {
            let size = ledger.read(row.first_bytes("image").map(jpeg_size)).flatten();
            ledger.expect(Rule::Pictures, size == Some(self.size()), || {
                format!("frame {frame}: the colour image of {} has size {size:?}", self.name)
            });
        }
        let semantic = self.semantic.as_ref().and_then(|table| ledger.read(picture(table, at)));
        let (Some(semantic), Some(instance)) = (semantic, &sight.instance) else { return };
        let unlike =
            semantic.pixels().iter().zip(instance.pixels()).filter(|(shown, label)| {
                Tag::from_u8(label[0]).is_none_or(|tag| tag.camera_rgb() != **shown)
            });
        let unlike = unlike.count();
        ledger.expect(Rule::Semantic, unlike == 0 && semantic.rgb.len() == instance.rgb.len(), || {
            format!(
                "frame {frame}: {unlike} pixels of {} have another tag than the instance image",
                self.name
            )
        });
    }

    /// Columns and rows of its pictures.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.optics.width, self.optics.height)
    }
}

/// Id and tag of a pixel of an instance image.
pub(crate) fn label([tag, low, high]: [u8; 3]) -> (u16, u8) {
    (u16::from_le_bytes([low, high]), tag)
}

/// What is no object: the sky, and what the horizon consists of.
const OF_NO_OBJECT: [Tag; 4] = [Tag::Sky, Tag::Terrain, Tag::Vegetation, Tag::Building];

/// Planar depth of a pixel of a depth image, m; none where it is that of the sky.
pub(crate) fn depth_m([low, middle, high]: [u8; 3]) -> Option<f64> {
    let steps = u32::from_le_bytes([low, middle, high, 0]);
    (steps < 0xff_ffff).then(|| f64::from(steps) * 1000.0 / 16_777_215.0)
}

fn parts(picture: &Picture) -> BTreeMap<(u16, u8), Patch> {
    let mut parts: BTreeMap<(u16, u8), Patch> = BTreeMap::new();
    for (y, row) in picture.pixels().chunks(picture.width.max(1)).enumerate() {
        let mut x = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let end = x + run.len() - 1;
            let patch =
                parts.entry(label(run[0])).or_insert(Patch { pixels: 0, low: [x, y], high: [end, y] });
            patch.pixels += run.len() as u64;
            patch.low = [patch.low[0].min(x), patch.low[1].min(y)];
            patch.high = [patch.high[0].max(end), patch.high[1].max(y)];
            x = end + 1;
        }
    }
    parts
}

impl Sight<'_> {
    /// Ids and tags are those of the log.
    pub(crate) fn check_ids(&self, scene: &Scene, frame: usize, ledger: &mut Ledger) {
        let name = &self.camera.name;
        for (&(id, tag), patch) in &self.parts {
            let holds = if id == 0 {
                OF_NO_OBJECT.iter().any(|&of_none| tag == of_none as u8)
            } else {
                scene.actors.get(&id).is_some_and(|actor| actor.tags.contains(&tag))
            };
            if holds {
                ledger.fine(Rule::ImageIds, patch.pixels);
                continue;
            }
            let pixels = patch.pixels;
            let kind = scene.actors.get(&id).map_or("none", |actor| actor.model.as_str());
            ledger.all_off(Rule::ImageIds, pixels, &format!("{kind} {tag}"), || match scene.actors.get(&id) {
                Some(actor) => format!(
                    "frame {frame}: {pixels} pixels of {name} show object {id} ({}) with tag {tag}, the log says {:?}",
                    actor.model, actor.tags
                ),
                None => format!("frame {frame}: {pixels} pixels of {name} show {id} with tag {tag}"),
            });
        }
    }

    /// Pixels of objects lie in their projected boxes. `own`: the agent's own object, within which its
    /// cameras may be.
    pub(crate) fn check_boxes(&self, boxes: &[Labelled], own: u16, frame: usize, ledger: &mut Ledger) {
        for labelled in boxes.iter().filter(|b| b.id != own) {
            let parts = labelled.tags.iter().filter(|&&tag| is_part(labelled, tag));
            let patches: Vec<&Patch> = parts.filter_map(|&tag| self.parts.get(&(labelled.id, tag))).collect();
            if patches.is_empty() {
                continue;
            }
            let grown = labelled.grown(if labelled.open_door { DOOR_M } else { 0.0 });
            let bounds = self.bounds(&grown);
            let outside = patches.iter().map(|patch| {
                let Some([low, high]) = bounds else { return f64::INFINITY };
                let over = |axis: usize| {
                    let below = low[axis] - (patch.low[axis] as f64 + 0.5);
                    let above = patch.high[axis] as f64 + 0.5 - high[axis];
                    below.max(above)
                };
                over(0).max(over(1))
            });
            let outside = outside.fold(f64::NEG_INFINITY, f64::max);
            let pixels: u64 = patches.iter().map(|patch| patch.pixels).sum();
            ledger.expect(Rule::BoxPixels, outside <= AROUND_PX, || {
                format!(
                    "frame {frame}: {}: object {} ({}) of {pixels} pixels goes {outside:.1} pixels beyond its box",
                    self.camera.name,
                    labelled.id,
                    labelled.class.name()
                )
            });
        }
    }

    /// Bounds of a box in the picture; none where it is behind the camera.
    pub(crate) fn bounds(&self, corners: &[V3; 8]) -> Option<[[f64; 2]; 2]> {
        let seen = corners.map(|corner| self.world_from_optical.inward(corner));
        let is_straight = self.camera.optics.is_straight();
        let mut ends: Vec<V3> = seen.into_iter().filter(|p| p[2] >= NEAR_M || !is_straight).collect();
        for [a, b] in EDGES {
            let (p, q) = (seen[a], seen[b]);
            if !is_straight {
                // Edges are bent: they are followed.
                ends.extend((1..BENT).map(|i| add(p, scale(sub(q, p), f64::from(i) / f64::from(BENT)))));
            } else if (p[2] < NEAR_M) != (q[2] < NEAR_M) {
                let share = (NEAR_M - p[2]) / (q[2] - p[2]);
                ends.push(add(p, scale(sub(q, p), share)));
            }
        }
        let places = ends.into_iter().filter_map(|end| self.camera.optics.project(end));
        places.fold(None, |bounds, [x, y]| {
            let [low, high] = bounds.unwrap_or([[x, y]; 2]);
            Some([[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]])
        })
    }

    /// Whether a pixel and its neighbours show one object and tag: which.
    pub(crate) fn inner(&self, x: usize, y: usize) -> Option<(u16, u8)> {
        let picture = self.instance.as_ref()?;
        if x == 0 || y == 0 || x + 1 >= picture.width || y + 1 >= picture.height {
            return None;
        }
        let here = picture.at(x, y);
        let same = (0..9).all(|k| picture.at(x + k % 3 - 1, y + k / 3 - 1) == here);
        same.then(|| label(here))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_counted_with_their_bounds() {
        let (sky, car) = ([11, 0, 0], [14, 5, 1]);
        let rgb = [sky, sky, car, car, car, sky].concat();
        let found = parts(&Picture { width: 3, height: 2, rgb });
        assert_eq!(found[&(0, 11)], Patch { pixels: 3, low: [0, 0], high: [2, 1] });
        assert_eq!(found[&(261, 14)], Patch { pixels: 3, low: [0, 0], high: [2, 1] });
    }

    #[test]
    fn depth_is_24_bits_of_a_kilometre() {
        assert_eq!(depth_m([255, 255, 255]), None);
        assert!((depth_m([0, 0, 128]).expect("is one") - 500.000_03).abs() < 1e-4);
    }
}
