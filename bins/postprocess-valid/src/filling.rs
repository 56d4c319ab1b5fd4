//! Filled voxel grids.

use std::error::Error;

use counts::PartialCounts;
use fill::Filler;
use formats::{Array, DEFAULT_LEVEL, NpzError, NpzReader, Scalar, encode_member, frame_member};
use pipeline::{At, Place, StageError};
use replay::{BufferPool, archive_frames};
use schema::AgentId;
use schema::settings::OccupancySettings;
use store::{ShardStream, StoreError, keys};
use voxelgrid::{Filling, VoxelGrid};

use crate::error::InputError;
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
    let open = || grids.open(store.stream_output(&manifest, &key)?);
    let frames = open()?.members().len() as u32;

    let progress = job.progress();
    let Some(mut unit) = job.unit(&format!("occupancy.{name}"))? else { return Ok(()) };
    let pool = BufferPool::default();
    let one = |frame: u32| {
        let (mut reader, mut filler) = pool.take(|| Ok::<_, StageError>((open()?, Filler::default())))?;
        let mut grid = grids.read(&mut reader, frame)?;
        filler.fill(&mut grid, settings.voxel_m).map_err(|e| grids.broken(Some(frame), e))?;
        pool.give((reader, filler));
        let mut counts = PartialCounts::new();
        grid.add_to(&mut counts, &name, Filling::Filled);
        let member = frame_member(frame);
        let encoded = encode_member(&member, Scalar::U8, &grid.shape, &grid.data, DEFAULT_LEVEL)
            .at(|| grids.place(Some(frame)))?;
        Ok((encoded, counts))
    };
    let mut counts = PartialCounts::new();
    let filled = keys::occupancy_filled(scene, agent);
    archive_frames(&mut unit, &filled, frames, &progress, one, |of_frame| counts.merge(of_frame))?;
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
    fn open(&self, stream: ShardStream) -> Result<NpzReader<ShardStream>, StageError> {
        let reader = NpzReader::new(stream).map_err(|e| self.unreadable(None, e))?;
        Ok(reader.with_max_bytes(MAX_MEMBER_BYTES))
    }

    fn read(&self, reader: &mut NpzReader<ShardStream>, frame: u32) -> Result<VoxelGrid, StageError> {
        let member = frame_member(frame);
        let array = reader.read(&member).map_err(|e| self.unreadable(Some(frame), e))?;
        grid_of(array).ok_or_else(|| self.broken(Some(frame), InputError::NoGrid { member }))
    }

    /// A failing disk is not a broken archive.
    fn unreadable(&self, frame: Option<u32>, error: NpzError) -> StageError {
        match error {
            NpzError::Io(source) => StoreError::read(&self.path, "read", source).into(),
            error => self.broken(frame, error),
        }
    }

    /// What is wrong with which frame, and what to do about it.
    fn broken(&self, frame: Option<u32>, cause: impl Error + Send + Sync + 'static) -> StageError {
        let source = InputError::Grids(cause.into()).into();
        StageError::Failed { place: Box::new(self.place(frame)), source }
    }

    fn place(&self, frame: Option<u32>) -> Place {
        Place { frame, ..Place::scene(self.scene).agent(self.agent).in_file(&self.path) }
    }
}

fn grid_of(array: Array) -> Option<VoxelGrid> {
    let shape: [usize; 3] = array.shape.as_slice().try_into().ok()?;
    let whole = shape.iter().product::<usize>() == array.bytes.len();
    whole.then_some(VoxelGrid { shape, data: array.bytes })
}
