//! The occupancy stage: a voxel grid around every agent at every frame.

use counts::PartialCounts;
use formats::Scalar;
use framewise::{FrameArray, FrameArrays, label_agents};
use pipeline::{At, Job, Place, Stage, StageError};
use renderer::VoxelRenderer;
use replay::Replay;
use scene::SceneReader;
use schema::arrays::{ArrayKind, VOXEL_GRIDS};
use schema::settings::{OccupancySettings, PerAgent};
use schema::{AgentId, ObjectId};
use voxelgrid::{Filling, VoxelGrid};
use voxels::{CpuVoxelRenderer, GridPlacement};

/// The stage.
pub const STAGE: Stage<Seen> = Stage::new(run);
/// What it sees of the configuration: the grid of each agent.
type Seen = PerAgent<OccupancySettings>;

fn run(job: &mut Job<'_, Seen>) -> Result<(), StageError> {
    let settings = job.settings().clone();
    let scene = SceneReader::new(job.store(), job.scene(), job.inputs());
    let replay = Replay::open(&scene).at(|| job.place())?;
    let mut renderer = CpuVoxelRenderer::default();
    renderer.prepare(&replay.meshes()).at(|| job.place())?;
    let grids = |position, agent| {
        let settings = settings.of(agent);
        let grids = Grids { replay: &replay, renderer: &renderer, position, agent, settings };
        settings.enabled.then_some(grids)
    };
    label_agents(job, &replay.log, grids)
}

/// The grids of an agent.
struct Grids<'a> {
    replay: &'a Replay,
    renderer: &'a dyn VoxelRenderer,
    position: usize,
    agent: AgentId,
    settings: &'a OccupancySettings,
}

impl Grids<'_> {
    fn place(&self) -> Place {
        Place::scene(self.replay.log.info.scene).agent(self.agent)
    }
}

impl FrameArrays for Grids<'_> {
    type Memory = (GridPlacement, VoxelGrid);

    fn memory(&self) -> Result<Self::Memory, StageError> {
        let placement = GridPlacement::new(self.settings).at(|| self.place())?;
        Ok((placement, VoxelGrid::default()))
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        vec![&VOXEL_GRIDS]
    }

    /// `[x, y, z]` tags.
    fn arrays<'m>(
        &self,
        (placement, grid): &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        let log = &self.replay.log;
        let pose = log.world_from_agent(self.position, frame);
        let own: Option<ObjectId> = self.settings.ignore_self.then(|| log.agent(self.position, frame).id);
        let height_m = self.settings.upper_m.abs().max(self.settings.lower_m.abs());
        let radius_m = self.settings.range_m * std::f64::consts::SQRT_2 + height_m;
        let snapshot = self.replay.snapshot(frame, pose.xyz(), radius_m);
        let place = || self.place().frame(frame);
        placement.voxelize(self.renderer, &snapshot, &pose, own, grid).at(place)?;
        grid.add_to(counts, &self.agent.to_string(), Filling::Hollow);
        Ok(vec![FrameArray { scalar: Scalar::U8, shape: grid.shape.to_vec(), bytes: (&grid.data).into() }])
    }
}
