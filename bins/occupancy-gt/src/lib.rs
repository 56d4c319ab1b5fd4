//! The occupancy stage: a voxel grid around every agent at every frame.

use counts::PartialCounts;
use formats::Scalar;
use framewise::{FrameArray, FrameArrays, label_agents};
use pipeline::{At, Job, Place, Stage, StageError};
use replay::Replay;
use scene::SceneReader;
use schema::arrays::VOXEL_GRIDS;
use schema::settings::{OccupancySettings, PerAgent};
use schema::{AgentId, ObjectId};
use voxelgrid::{Filling, VoxelGrid};
use voxels::Voxelizer;

/// The stage.
pub const STAGE: Stage<Seen> = Stage::new(run);
/// What it sees of the configuration: the grid of each agent.
type Seen = PerAgent<OccupancySettings>;

fn run(job: &mut Job<'_, Seen>) -> Result<(), StageError> {
    let settings = job.settings().clone();
    let scene = SceneReader::new(job.store(), job.scene(), job.inputs());
    let replay = Replay::open(&scene).at(|| job.place())?;
    let grids = |position, agent| {
        let settings = settings.of(agent);
        settings.enabled.then_some(Grids { replay: &replay, position, agent, settings })
    };
    label_agents(job, &replay.log, &VOXEL_GRIDS, grids)
}

/// The grids of an agent.
struct Grids<'a> {
    replay: &'a Replay,
    position: usize,
    agent: AgentId,
    settings: &'a OccupancySettings,
}

impl FrameArrays for Grids<'_> {
    type Memory = (Voxelizer, VoxelGrid);

    fn memory(&self) -> Result<Self::Memory, StageError> {
        let voxelizer = Voxelizer::new(self.settings).at(|| Place::default().agent(self.agent))?;
        Ok((voxelizer, VoxelGrid::default()))
    }

    /// `[x, y, z]` tags.
    fn array<'m>(
        &self,
        (voxelizer, grid): &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<FrameArray<'m>, StageError> {
        let log = &self.replay.log;
        let pose = log.world_from_agent(self.position, frame);
        let own: Option<ObjectId> = self.settings.ignore_self.then(|| log.agent(self.position, frame).id);
        let height_m = self.settings.upper_m.abs().max(self.settings.lower_m.abs());
        let radius_m = self.settings.range_m * std::f64::consts::SQRT_2 + height_m;
        let snapshot = self.replay.snapshot(frame, pose.xyz(), radius_m);
        voxelizer.voxelize(&snapshot, &pose, own, grid);
        grid.add_to(counts, &self.agent.to_string(), Filling::Hollow);
        Ok(FrameArray { scalar: Scalar::U8, shape: grid.shape.to_vec(), bytes: (&grid.data).into() })
    }
}
