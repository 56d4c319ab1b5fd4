//! Filled voxel grids.

use counts::PartialCounts;
use fill::Filler;
use formats::{Array, DEFAULT_LEVEL, NpzError, NpzReader, Scalar, encode_member, frame_member};
use pipeline::StageError;
use replay::{BufferPool, archive_frames};
use schema::AgentId;
use schema::settings::OccupancySettings;
use store::{ReadSeek, StoreError, keys};
use voxelgrid::{Filling, VoxelGrid};

use crate::{NAME, OCCUPANCY, Work};

/// Fills every grid of an agent.
///
/// # Errors
/// The grids are missing or broken, or the store cannot be written.
pub(crate) fn fill_agent(
    job: &mut Work<'_>,
    agent: AgentId,
    settings: &OccupancySettings,
) -> Result<(), StageError> {
    let (scene, name) = (job.scene(), agent.to_string());
    let key = keys::occupancy(scene, agent);
    let (store, manifest) = (job.store().clone(), job.input(OCCUPANCY)?.clone());
    let grids = Grids { path: store.location(&key), scene, agent };
    let open = || grids.open(store.open_output(&manifest, &key)?.into_stream());
    let frames = open()?.members().len() as u32;

    let Some((mut unit, pulse)) = job.unit_and_pulse(&format!("occupancy.{name}"))? else { return Ok(()) };
    let pool = BufferPool::default();
    let one = |frame: u32| {
        let (mut reader, mut filler) = pool.take(|| Ok::<_, StageError>((open()?, Filler::default())))?;
        let mut grid = grids.read(&mut reader, frame)?;
        filler.fill(&mut grid, settings.voxel_m).map_err(|e| grids.broken(Some(frame), &e.to_string()))?;
        pool.give((reader, filler));
        let mut counts = PartialCounts::new();
        grid.add_to(&mut counts, &name, Filling::Filled);
        let member = frame_member(frame);
        let encoded = encode_member(&member, Scalar::U8, &grid.shape, &grid.data, DEFAULT_LEVEL)
            .map_err(|e| StageError::failed(&e))?;
        Ok((encoded, counts))
    };
    let mut counts = PartialCounts::new();
    let filled = keys::occupancy_filled(scene, agent);
    archive_frames(&mut unit, &filled, frames, pulse, one, |of_frame| counts.merge(of_frame))?;
    unit.rows(&keys::partial_stats(scene, &format!("{}.{name}", NAME)), &counts.rows())?;
    unit.finish()?;
    Ok(())
}

/// Room for the largest grid and its header.
const MAX_MEMBER_BYTES: u64 = 2 * OccupancySettings::MAX_CELLS;

/// An agent's archive of grids.
struct Grids {
    path: String,
    scene: u32,
    agent: AgentId,
}

impl Grids {
    fn open(&self, stream: Box<dyn ReadSeek>) -> Result<NpzReader<Box<dyn ReadSeek>>, StageError> {
        let reader = NpzReader::new(stream).map_err(|e| self.unreadable(None, e))?;
        Ok(reader.with_max_bytes(MAX_MEMBER_BYTES))
    }

    fn read(&self, reader: &mut NpzReader<Box<dyn ReadSeek>>, frame: u32) -> Result<VoxelGrid, StageError> {
        let member = frame_member(frame);
        let array = reader.read(&member).map_err(|e| self.unreadable(Some(frame), e))?;
        grid_of(array).ok_or_else(|| {
            self.broken(Some(frame), &format!("{member}: is no three-dimensional array of bytes"))
        })
    }

    /// A failing disk is not a broken archive.
    fn unreadable(&self, frame: Option<u32>, error: NpzError) -> StageError {
        match error {
            NpzError::Io(source) => StoreError::io(&self.path, "read", source).into(),
            error => self.broken(frame, &error.to_string()),
        }
    }

    /// What is wrong with which frame, and what to do about it.
    fn broken(&self, frame: Option<u32>, problem: &str) -> StageError {
        let Self { path, scene, agent } = self;
        let frame = frame.map_or_else(String::new, |frame| format!(" frame {frame}"));
        StageError::Failed(format!(
            "{path}: {problem} (scene {scene} {agent}{frame}; run {OCCUPANCY} for this scene again with --force)"
        ))
    }
}

fn grid_of(array: Array) -> Option<VoxelGrid> {
    let shape: [usize; 3] = array.shape.as_slice().try_into().ok()?;
    let whole = shape.iter().product::<usize>() == array.bytes.len();
    whole.then_some(VoxelGrid { shape, data: array.bytes })
}
