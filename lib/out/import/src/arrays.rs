//! Masks and voxel grids: copied still compressed, after they have been read whole.

use std::fs::File;
use std::path::Path;

use codecs::{DType, EncodedMember, NpzError, NpzReader, NpzWriter, Scalar, frame_member};
use rayon::prelude::*;
use schema::arrays::ArrayKind;
use schema::measures::bev::{BEV_CELLS, BEV_GRIDS, BEV_HEAT, bin_of_block, heat_block, heat_blocks};
use schema::measures::counts::PartialCounts;
use schema::measures::voxels::{VOXEL_CELLS, VOXEL_CELLS_FILLED, VOXEL_GRIDS};
use schema::{BevClass, Tag};
use store::{StoreError, Unit, keys};

use crate::cast::BATCH;
use crate::error::{ImportError, SourceFault};
use crate::names::{FILLED_VOXELS, MASKS, VOXELS};
use crate::readings::DATA;
use crate::work::Work;

/// Most cells of a mask along a side.
const MAX_MASK_SIDE: usize = 4096;
/// The rule by which masks of imported datasets were drawn, as far as a store can name it.
pub(crate) const MASK_RULE: &str = "simbev2x";

/// Arrays of an agent, one a frame.
pub(crate) struct Arrays<'a> {
    /// The key of the files.
    pub(crate) key: &'static str,
    /// The archive in the store.
    pub(crate) kind: &'a ArrayKind,
    /// What the archive says of itself.
    pub(crate) comment: String,
    /// The shape of every array.
    pub(crate) shape: Vec<usize>,
}

impl Arrays<'_> {
    fn scalar(&self) -> Scalar {
        if self.key == MASKS { Scalar::Bool } else { Scalar::U8 }
    }

    /// Names of what values or channels stand for, in order.
    fn classes(&self) -> Vec<&'static str> {
        if self.key == MASKS {
            BevClass::ALL.iter().map(|class| class.name()).collect()
        } else {
            Tag::ALL.iter().map(|tag| tag.name()).collect()
        }
    }
}

/// The shape of the masks of a file: `[14, n, n]`.
pub(crate) fn mask_shape(path: &Path) -> Result<Vec<usize>, SourceFault> {
    let packed = open(path, u64::MAX)?.read_packed(DATA)?;
    match packed.shape.as_slice() {
        &[BevClass::COUNT, rows, columns] if rows == columns && (1..=MAX_MASK_SIDE).contains(&rows) => {
            Ok(packed.shape)
        }
        shape => {
            Err(format!("{DATA}: is {shape:?}, expected {} masks of n x n cells", BevClass::COUNT).into())
        }
    }
}

fn open(path: &Path, most: u64) -> Result<NpzReader<File>, SourceFault> {
    let file = File::open(path)?;
    Ok(NpzReader::new(file)?.with_max_bytes(most))
}

/// Writes the archive of an agent's arrays into a unit.
pub(crate) fn write(
    work: &Work<'_>,
    position: usize,
    arrays: &Arrays<'_>,
    unit: &mut Unit<'_>,
) -> Result<PartialCounts, ImportError> {
    let agent = work.scene.agents[position].0;
    let file = unit.file(&keys::array(work.order.entry.number, arrays.kind, agent))?;
    let location = file.location().to_owned();
    let failed = |e: NpzError| match e {
        NpzError::Io(source) => ImportError::Store(StoreError::write(location.clone(), "write", source)),
        other => ImportError::source(Path::new(&location), other),
    };
    let mut writer = NpzWriter::new(file);
    writer.set_comment(&arrays.comment).map_err(failed)?;
    let mut cells: Vec<u64> = Vec::new();
    let frames: Vec<u32> = (0..work.scene.frames()).collect();
    // A grid takes what it says it does, on each thread.
    for batch in frames.chunks(BATCH.min(rayon::current_num_threads().max(1))) {
        let read: Vec<Result<(EncodedMember, Vec<u64>), ImportError>> =
            batch.par_iter().map(|&frame| read_frame(work, position, arrays, frame)).collect();
        for read in read {
            let (member, found) = read?;
            cells.resize(found.len(), 0);
            cells.iter_mut().zip(found).for_each(|(sum, n)| *sum += n);
            writer.append(member).map_err(failed)?;
        }
        work.advance(batch.len() as u64)?;
    }
    let file = writer.finish().map_err(failed)?;
    unit.add(file.finish(frames.len() as u64)?);
    Ok(counted(&agent.to_string(), arrays, &cells, frames.len() as u64))
}

fn read_frame(
    work: &Work<'_>,
    position: usize,
    arrays: &Arrays<'_>,
    frame: u32,
) -> Result<(EncodedMember, Vec<u64>), ImportError> {
    let (agent, records) = &work.scene.agents[position];
    let place = |e: ImportError| e.within(format!("{agent} frame {frame} {}", arrays.key));
    let said = records[frame as usize].files.get(arrays.key).map(String::as_str).unwrap_or_default();
    let path = work.order.folder.find(said).map_err(place)?;
    let made = packed(&path, arrays).and_then(|(member, cells)| {
        let member = member.renamed(&frame_member(frame))?;
        Ok((member, cells))
    });
    made.map_err(|problem| place(ImportError::source(&path, problem)))
}

/// The array of a file as it lies there, once it has been read whole and all its values are such as can be.
fn packed(path: &Path, arrays: &Arrays<'_>) -> Result<(EncodedMember, Vec<u64>), SourceFault> {
    let bytes: usize = arrays.shape.iter().product();
    // Its header takes a few hundred bytes more.
    let mut reader = open(path, bytes as u64 + (1 << 16))?;
    let packed = reader.read_packed(DATA)?;
    let wanted = DType::Scalar(arrays.scalar());
    if packed.dtype != wanted || packed.shape != arrays.shape {
        return Err(format!(
            "{DATA}: is {:?} of {:?}, expected {:?} of {wanted:?}",
            packed.shape, packed.dtype, arrays.shape
        )
        .into());
    }
    let array = reader.read(DATA)?;
    let cells = if arrays.key == MASKS {
        mask_cells(&array.bytes, arrays.shape[1])?
    } else {
        voxel_cells(&array.bytes)?
    };
    Ok((packed.member, cells))
}

/// True cells of each channel, block by block, of masks with `side` rows and columns.
fn mask_cells(bytes: &[u8], side: usize) -> Result<Vec<u64>, SourceFault> {
    if let Some(at) = bytes.iter().position(|&b| b > 1) {
        return Err(format!("{DATA}: value {at} is neither true nor false").into());
    }
    let blocks = heat_blocks(side) * heat_blocks(side);
    let mut counts = vec![0; BevClass::COUNT * blocks];
    for (at, _) in bytes.iter().enumerate().filter(|(_, b)| **b == 1) {
        let (channel, row, column) = (at / (side * side), at / side % side, at % side);
        counts[channel * blocks + bin_of_block(heat_block(row, side), heat_block(column, side), side)] += 1;
    }
    Ok(counts)
}

/// Cells of each tag.
fn voxel_cells(bytes: &[u8]) -> Result<Vec<u64>, SourceFault> {
    let mut counts = [0_u64; 256];
    bytes.iter().for_each(|&b| counts[usize::from(b)] += 1);
    let known = Tag::ALL.len();
    match counts[known..].iter().position(|&n| n > 0) {
        Some(tag) => Err(format!("{DATA}: holds the tag {}", known + tag).into()),
        None => Ok(counts[..known].to_vec()),
    }
}

fn counted(agent: &str, arrays: &Arrays<'_>, cells: &[u64], grids: u64) -> PartialCounts {
    let mut counts = PartialCounts::new();
    if arrays.key == MASKS {
        counts.add(agent, BEV_GRIDS, MASK_RULE, 0, grids);
        let blocks = (cells.len() / BevClass::COUNT).max(1);
        for (class, blocks) in arrays.classes().into_iter().zip(cells.chunks_exact(blocks)) {
            let all = blocks.iter().sum();
            counts.add(agent, BEV_CELLS, class, 0, all);
            if all > 0 {
                let blocks: Vec<u32> = blocks.iter().map(|&n| u32::try_from(n).unwrap_or(u32::MAX)).collect();
                counts.add_bins(agent, BEV_HEAT, class, &blocks);
            }
        }
        return counts;
    }
    let measure = if arrays.key == FILLED_VOXELS { VOXEL_CELLS_FILLED } else { VOXEL_CELLS };
    for (class, &cells) in arrays.classes().into_iter().zip(cells).filter(|(_, cells)| **cells > 0) {
        counts.add(agent, measure, class, 0, cells);
    }
    if arrays.key == VOXELS {
        counts.add(agent, VOXEL_GRIDS, "", 0, grids);
    }
    counts
}

#[cfg(test)]
mod tests {
    use codecs::{archive_of, encode_member};

    use super::*;

    fn file(scalar: Scalar, shape: &[usize], bytes: &[u8]) -> tempfile::NamedTempFile {
        let member = encode_member(DATA, scalar, shape, bytes, 2).expect("fits");
        let file = tempfile::NamedTempFile::new().expect("a file");
        std::fs::write(file.path(), archive_of(member).expect("fits")).expect("written");
        file
    }

    #[test]
    fn grids_are_counted_and_bounded() {
        let grid = |shape: &[usize]| Arrays {
            key: VOXELS,
            kind: &schema::arrays::VOXEL_GRIDS,
            comment: String::new(),
            shape: shape.to_vec(),
        };
        let good = file(Scalar::U8, &[2, 2, 1], &[0, 14, 14, 1]);
        let (member, cells) = packed(good.path(), &grid(&[2, 2, 1])).expect("a grid");
        assert_eq!((member.name(), cells[0], cells[1], cells[14]), (DATA, 1, 1, 2));
        let problem = |file: &tempfile::NamedTempFile, shape: &[usize]| {
            packed(file.path(), &grid(shape)).expect_err("refused").to_string()
        };
        assert!(problem(&good, &[2, 1, 1]).contains("expected [2, 1, 1]"));
        assert!(problem(&file(Scalar::U8, &[1, 1, 1], &[32]), &[1, 1, 1]).contains("holds the tag 32"));
        assert!(problem(&file(Scalar::I8, &[1, 1, 1], &[0]), &[1, 1, 1]).contains("expected [1, 1, 1] of"));
        // A bomb: a megabyte of zeros where four bytes are expected.
        let bomb = file(Scalar::U8, &[1 << 20, 1, 1], &vec![0; 1 << 20]);
        assert!(problem(&bomb, &[4, 1, 1]).contains("1048"), "{}", problem(&bomb, &[4, 1, 1]));
    }

    #[test]
    fn masks_are_booleans() {
        let mut cells = vec![0; 14 * 4];
        (cells[0], cells[5]) = (1, 1);
        let blocks = mask_cells(&cells, 2).expect("masks");
        assert_eq!((blocks.len(), &blocks[..6]), (14 * 4, &[1, 0, 0, 0, 0, 1][..]));
        cells[9] = 2;
        let fault = mask_cells(&cells, 2).expect_err("refused").to_string();
        assert_eq!(fault, "data.npy: value 9 is neither true nor false");
        let good = file(Scalar::Bool, &[14, 2, 2], &[0; 56]);
        assert_eq!(mask_shape(good.path()).expect("masks"), [14, 2, 2]);
        assert!(mask_shape(file(Scalar::Bool, &[13, 2, 2], &[0; 52]).path()).is_err());
    }
}
