//! Filled voxel grids.

use codecs::{Array, Scalar};
use labels::fill::Filler;
use labels::voxel_grid::{Filling, VoxelGrid};
use runner::frames::{FrameArray, FrameArrays, Labelled, write_labels};
use runner::{At, Job, Place, StageError};
use scene::{ArrayReader, SceneReader};
use schema::AgentId;
use schema::arrays::{ArrayKind, FILLED_VOXEL_GRIDS, VOXEL_GRIDS};
use schema::measures::counts::PartialCounts;
use settings::OccupancySettings;
use settings::stages::ValiditySettings;
use store::keys;

use crate::error::InputError;

/// Fills every grid of some agents, those at the frames of `0..frames` that have one.
///
/// # Errors
/// The grids are missing or broken, or the store cannot be written.
pub(crate) fn fill_agents(
    job: &Job<'_, ValiditySettings>,
    scene: &SceneReader,
    agents: &[AgentId],
    frames: u32,
) -> Result<(), StageError> {
    let number = scene.scene();
    let labels = agents.iter().filter_map(|&agent| {
        let label = FilledGrids { scene, agent, settings: job.settings().occupancy.of(agent) };
        let stats = format!("{}.{agent}", FILLED_VOXEL_GRIDS.stage);
        let counted = Some(keys::partial_stats(number, &stats));
        let unit = job.unit(&format!("occupancy.{agent}")).transpose()?;
        Some(unit.map(|unit| Labelled { unit, scene: number, agent, counted, label }))
    });
    write_labels(labels, frames, &job.progress())
}

/// Room for the largest grid and its header.
const MAX_MEMBER_BYTES: u64 = 2 * OccupancySettings::MAX_CELLS;

/// The filled grids of an agent.
struct FilledGrids<'a> {
    scene: &'a SceneReader,
    agent: AgentId,
    settings: &'a OccupancySettings,
}

impl FilledGrids<'_> {
    fn place(&self) -> Place {
        Place::scene(self.scene.scene()).agent(self.agent)
    }

    fn open(&self) -> Result<ArrayReader, StageError> {
        ArrayReader::open_whole(self.scene, &VOXEL_GRIDS, self.agent, MAX_MEMBER_BYTES).at(|| self.place())
    }
}

impl FrameArrays for FilledGrids<'_> {
    type Memory = (ArrayReader, Filler, VoxelGrid);

    fn every_n_frames(&self) -> u32 {
        self.settings.every_n_frames
    }

    fn comment(&self) -> Result<String, StageError> {
        self.settings.describe().at(|| self.place())
    }

    fn memory(&self) -> Result<Self::Memory, StageError> {
        Ok((self.open()?, Filler::default(), VoxelGrid::default()))
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        vec![&FILLED_VOXEL_GRIDS]
    }

    /// `[x, y, z]` tags.
    fn arrays<'m>(
        &self,
        (reader, filler, grid): &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        let path = reader.path().to_owned();
        let memory = std::mem::take(&mut grid.data);
        let array = reader.read_into(frame, memory).at(|| self.place())?;
        *grid = grid_of(array).ok_or(InputError::NoGrid { path: path.clone(), frame }).at(|| self.place())?;
        filler
            .fill(grid, self.settings.voxel_m, self.settings.fill_rule)
            .map_err(|source| InputError::Fill { path, frame, source })
            .at(|| self.place())?;
        grid.add_to(counts, &self.agent.to_string(), Filling::Filled);
        Ok(vec![FrameArray { scalar: Scalar::U8, shape: grid.shape.to_vec(), bytes: (&grid.data).into() }])
    }
}

fn grid_of(array: Array) -> Option<VoxelGrid> {
    let shape: [usize; 3] = array.shape.as_slice().try_into().ok()?;
    let whole = shape.iter().product::<usize>() == array.bytes.len();
    whole.then_some(VoxelGrid { shape, data: array.bytes })
}
