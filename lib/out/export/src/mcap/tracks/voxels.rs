//! Voxel grids near an agent, cells joined to larger ones.

use codecs::Array;
use scene::ArrayReader;
use schema::arrays::{ArrayKind, VOXEL_CELLS, VOXEL_GRIDS};
use schema::{AgentId, Tag};
use serde::Deserialize;

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::messages::{Pose, Quaternion, Timestamp, Vector3, VoxelGrid};
use crate::mcap::packed::{Packed, Values, pack};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// What an archive of grids says of itself.
#[derive(Debug, Deserialize)]
struct Description {
    range_m: f64,
    voxel_m: f64,
    lower_m: f64,
    upper_m: f64,
    mount_z_m: f64,
    every_n_frames: u32,
}

/// The cells that are kept: `block` cells along each axis become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Crop {
    /// Cells of the whole grid along x and y, and along z.
    side: usize,
    height: usize,
    /// First cell along x and y.
    first: usize,
    block: usize,
    /// Kept cells along x and y, and along z: the last along z may reach beyond the grid.
    kept: usize,
    slices: usize,
}

impl Crop {
    fn new(about: &Description, range_m: f64, block: u32) -> Self {
        let side = (2.0 * about.range_m / about.voxel_m).round() as usize;
        let height = ((about.upper_m - about.lower_m) / about.voxel_m).round() as usize;
        let block = block.max(1) as usize;
        let wanted = (range_m / (about.voxel_m * block as f64)).ceil() as usize;
        let half = wanted.min(side / 2 / block);
        let first = (side - 2 * half * block) / 2;
        Self { side, height, first, block, kept: 2 * half, slices: height.div_ceil(block) }
    }
}

/// An agent's voxel grids.
pub(crate) struct VoxelTrack {
    grids: ArrayReader,
    is_sparse: bool,
    about: Description,
    crop: Crop,
    topic: Topic<VoxelGrid>,
    scene: u32,
    agent: AgentId,
}

impl VoxelTrack {
    /// Of an agent that has them; those of sparse archives are looked for, too.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        (range_m, block): (f64, u32),
        topics: &mut Topics,
    ) -> Result<Option<Self>, ExportError> {
        let has = |kind: &&ArrayKind| scene.has_arrays(kind, agent);
        let Some(kind) = [&VOXEL_GRIDS, &VOXEL_CELLS].into_iter().find(has) else { return Ok(None) };
        let about: Description = scene::described(scene.reader(), kind, agent)?;
        let facts = [("every_n_frames", about.every_n_frames.to_string())];
        let topic = topics.add(format!("/{agent}/occupancy"), &facts)?;
        let crop = Crop::new(&about, range_m, block);
        let (grids, is_sparse) = (scene.arrays(kind, agent)?, *kind == VOXEL_CELLS);
        Ok(Some(Self { grids, is_sparse, about, crop, topic, scene: scene.number(), agent }))
    }
}

impl Track for VoxelTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        if !schema::rate::is_due(frame, self.about.every_n_frames) {
            return Ok(());
        }
        let array = self.grids.read(frame)?;
        let Crop { side, height, first, block, kept, slices } = self.crop;
        let tags = if self.is_sparse { of_cells(&array, self.crop) } else { of_grid(&array, self.crop) };
        let Some(Packed { fields, stride, data }) = tags.and_then(|tags| coloured(&tags)) else {
            let problem = format!(
                "{}: has shape {:?}, not that of {side} x {side} x {height} cells (run {} again with --force)",
                self.grids.path(),
                array.shape,
                VOXEL_GRIDS.stage,
            );
            let agent = Some(self.agent.to_string());
            return Err(ExportError::Content { scene: self.scene, frame: Some(frame), agent, problem });
        };
        debug_assert_eq!(data.len(), kept * kept * slices * stride as usize);
        let corner_m = first as f64 * self.about.voxel_m - self.about.range_m;
        let size_m = self.about.voxel_m * block as f64;
        let grid = VoxelGrid {
            timestamp: Timestamp::at(frame),
            frame_id: self.agent.to_string(),
            pose: Pose {
                position: [corner_m, corner_m, self.about.lower_m + self.about.mount_z_m].into(),
                orientation: Quaternion::from_wxyz([1.0, 0.0, 0.0, 0.0]),
            },
            row_count: kept as u32,
            column_count: kept as u32,
            cell_size: Vector3 { x: size_m, y: size_m, z: size_m },
            slice_stride: stride * (kept * kept) as u32,
            row_stride: stride * kept as u32,
            cell_stride: stride,
            fields,
            data,
        };
        self.topic.send(frame, &grid, out);
        Ok(())
    }
}

/// The kept cells of a whole grid `[x, y, z]`, x fastest; none if it has another shape.
fn of_grid(array: &Array, crop: Crop) -> Option<Vec<u8>> {
    let Crop { side, height, first, block, kept, slices } = crop;
    if array.shape != [side, side, height] || array.bytes.len() != side * side * height {
        return None;
    }
    let mut tags = Vec::with_capacity(kept * kept * slices);
    for k in 0..slices {
        let z = k * block..((k + 1) * block).min(height);
        for j in 0..kept {
            for i in 0..kept {
                let mut counts = [0_u32; Tag::COUNT];
                for x in (first + i * block)..(first + (i + 1) * block) {
                    for y in (first + j * block)..(first + (j + 1) * block) {
                        let column = (x * side + y) * height;
                        for tag in &array.bytes[column + z.start..column + z.end] {
                            counts[usize::from(*tag).min(Tag::COUNT - 1)] += 1;
                        }
                    }
                }
                tags.push(joined(&counts));
            }
        }
    }
    Some(tags)
}

/// The kept cells of a list `[n, 4]` of x, y, z and tag, x fastest; none if it is no such list.
fn of_cells(array: &Array, crop: Crop) -> Option<Vec<u8>> {
    let Crop { first, block, kept, slices, .. } = crop;
    if array.shape.len() != 2 || array.shape[1] != 4 || array.bytes.len() != array.shape[0] * 8 {
        return None;
    }
    let mut counts = vec![[0_u16; Tag::COUNT]; kept * kept * slices];
    for cell in array.bytes.chunks_exact(8) {
        let [x, y, z, tag] = [0, 2, 4, 6].map(|at| usize::from(u16::from_le_bytes([cell[at], cell[at + 1]])));
        let place = |at: usize| at.checked_sub(first).map(|at| at / block).filter(|at| *at < kept);
        if let (Some(i), Some(j), k) = (place(x), place(y), z / block)
            && k < slices
        {
            let counts = &mut counts[(k * kept + j) * kept + i][tag.min(Tag::COUNT - 1)];
            *counts = counts.saturating_add(1);
        }
    }
    Some(counts.iter().map(|counts| joined(&counts.map(u32::from))).collect())
}

/// The tag of cells that become one: the rule by which a voxel takes its label, then the most frequent, then
/// the first.
fn joined(counts: &[u32; Tag::COUNT]) -> u8 {
    let occupied = Tag::ALL.into_iter().filter(|tag| *tag as u8 != 0 && counts[*tag as usize] > 0);
    let rank = |tag: Tag| (tag.voxel_priority(), counts[tag as usize], std::cmp::Reverse(tag as u8));
    occupied.max_by_key(|tag| rank(*tag)).map_or(0, |tag| tag as u8)
}

/// Tags with their colours; free cells are clear.
fn coloured(tags: &[u8]) -> Option<Packed> {
    let rgb = |tag: &u8| Tag::from_u8(*tag).filter(|tag| *tag as u8 != 0).map(Tag::viewer_rgb);
    let channel = |at: usize| tags.iter().map(|tag| rgb(tag).map_or(0, |rgb| rgb[at])).collect::<Vec<u8>>();
    let alpha: Vec<u8> = tags.iter().map(|tag| if *tag == 0 { 0 } else { u8::MAX }).collect();
    let [red, green, blue] = [channel(0), channel(1), channel(2)];
    pack(&[
        ("red", Values::U8(&red)),
        ("green", Values::U8(&green)),
        ("blue", Values::U8(&blue)),
        ("alpha", Values::U8(&alpha)),
        ("tag", Values::U8(tags)),
    ])
}

#[cfg(test)]
mod tests {
    use codecs::{DType, Scalar};

    use super::*;

    /// Two by two by one and a half blocks of two cells: 8 x 8 x 3 cells, of which the middle 4 x 4 are kept.
    fn crop() -> Crop {
        let about = Description {
            range_m: 4.0,
            voxel_m: 1.0,
            lower_m: 0.0,
            upper_m: 3.0,
            mount_z_m: 0.0,
            every_n_frames: 1,
        };
        Crop::new(&about, 2.0, 2)
    }

    #[test]
    fn grids_and_lists_are_cropped_alike() {
        let crop = crop();
        assert_eq!(crop, Crop { side: 8, height: 3, first: 2, block: 2, kept: 2, slices: 2 });
        let mut grid = vec![0_u8; 8 * 8 * 3];
        let mut list = Vec::new();
        let (car, road, wall, fence) = (Tag::Car as u8, Tag::Road as u8, Tag::Wall as u8, Tag::Fence as u8);
        let cells = [
            // Ahead right (x 4..6, y 2..4), lower block: a road under two of a car.
            ([4, 2, 0], road),
            ([4, 3, 1], car),
            ([5, 3, 1], car),
            // Behind left, upper block: two of a fence, one of a wall.
            ([2, 4, 2], wall),
            ([3, 4, 2], fence),
            ([3, 5, 2], fence),
            // Outside of the crop.
            ([0, 0, 0], car),
            ([6, 4, 0], car),
        ];
        for ([x, y, z], tag) in cells {
            grid[(x * 8 + y) * 3 + z] = tag;
            for value in [x as u16, y as u16, z as u16, u16::from(tag)] {
                list.extend(value.to_le_bytes());
            }
        }
        let dtype = |scalar: Scalar| DType::from(scalar);
        let whole = Array { dtype: dtype(Scalar::U8), shape: vec![8, 8, 3], bytes: grid };
        let cells = Array { dtype: dtype(Scalar::U16), shape: vec![cells.len(), 4], bytes: list };
        // x fastest, then y, then z: [behind right, ahead right, behind left, ahead left].
        let want = [0, road, 0, 0, 0, 0, fence, 0];
        assert_eq!(of_grid(&whole, crop).expect("fits"), want);
        assert_eq!(of_cells(&cells, crop).expect("fits"), want);
        assert_eq!(of_grid(&cells, crop), None);
        assert_eq!(of_cells(&whole, crop), None);
    }

    #[test]
    fn a_crop_stays_within_the_grid() {
        let about = Description {
            range_m: 4.0,
            voxel_m: 0.5,
            lower_m: -1.0,
            upper_m: 1.0,
            mount_z_m: 0.0,
            every_n_frames: 1,
        };
        assert_eq!(
            Crop::new(&about, 100.0, 3),
            Crop { side: 16, height: 4, first: 2, block: 3, kept: 4, slices: 2 }
        );
        assert_eq!(Crop::new(&about, 1.1, 1).kept, 6);
    }

    #[test]
    fn free_cells_are_clear() {
        let packed = coloured(&[0, Tag::Car as u8]).expect("fits");
        assert_eq!(packed.stride, 8);
        assert_eq!(packed.data[..8], [0; 8]);
        assert_eq!(packed.data[8..13], [0, 0, 142, 255, 14]);
    }
}
