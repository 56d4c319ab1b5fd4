//! Filled voxel grids.

use formats::{Array, DEFAULT_LEVEL, NpzReader, NpzWriter, Scalar, encode_member, frame_member};
use pipeline::{Job, StageError};
use replay::{Spare, in_frame_order};
use schema::AgentId;
use schema::settings::OccupancySettings;
use store::keys;
use truth::counts::{Counts, Filling};
use truth::fill::Filler;
use truth::voxels::VoxelGrid;

use crate::{OCCUPANCY, STAGE};

/// Fills every grid of an agent.
///
/// # Errors
/// The grids are missing or broken, or the store cannot be written.
pub(crate) fn fill_agent(
    job: &mut Job<'_>,
    agent: AgentId,
    settings: &OccupancySettings,
) -> Result<(), StageError> {
    let (scene, name) = (job.scene(), agent.to_string());
    let key = keys::occupancy(scene, agent);
    let (store, manifest) = (job.store().clone(), job.input(OCCUPANCY)?.clone());
    let path = store.location(&key);
    let broken = |e: &dyn std::error::Error| StageError::Failed(format!("{path}: {e}"));
    let open = || {
        let stream = store.open_output(&manifest, &key)?.into_stream();
        NpzReader::new(stream).map_err(|e| broken(&e))
    };
    let frames = open()?.members().len() as u32;

    let Some((mut unit, pulse)) = job.unit_and_pulse(&format!("occupancy.{name}"))? else { return Ok(()) };
    let spare = Spare::default();
    let one = |frame: u32| {
        let (mut reader, mut filler) = spare.take(|| Ok::<_, StageError>((open()?, Filler::default())))?;
        let member = frame_member(frame);
        let array = reader.read(&member).map_err(|e| broken(&e))?;
        let mut grid = grid_of(array).ok_or_else(|| {
            StageError::Failed(format!("{path}: member {member} is no three-dimensional array of bytes"))
        })?;
        filler.fill(&mut grid, settings.voxel_m).map_err(|e| broken(&e))?;
        spare.give((reader, filler));
        let mut counts = Counts::new();
        counts.add_voxels(&name, &grid, Filling::Filled);
        let encoded = encode_member(&member, Scalar::U8, &grid.shape, &grid.data, DEFAULT_LEVEL)
            .map_err(|e| StageError::failed(&e))?;
        Ok((encoded, counts))
    };
    let mut counts = Counts::new();
    let mut writer = NpzWriter::new(unit.file(&keys::occupancy_filled(scene, agent))?);
    in_frame_order(frames, pulse, one, |_, (encoded, of_frame)| {
        counts.merge(of_frame);
        writer.append(encoded).map_err(|e| StageError::failed(&e))
    })?;
    let file = writer.finish().map_err(|e| StageError::failed(&e))?;
    unit.add(file.finish(frames.into())?);
    unit.rows(&keys::partial_stats(scene, &format!("{}.{name}", STAGE.name)), &counts.rows())?;
    unit.finish()?;
    Ok(())
}

fn grid_of(array: Array) -> Option<VoxelGrid> {
    let shape: [usize; 3] = array.shape.as_slice().try_into().ok()?;
    let whole = shape.iter().product::<usize>() == array.bytes.len();
    whole.then_some(VoxelGrid { shape, data: array.bytes })
}
