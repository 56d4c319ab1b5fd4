//! The occupancy stage: a voxel grid around every agent at every frame.

use counts::PartialCounts;
use formats::{DEFAULT_LEVEL, Scalar, encode_member, frame_member};
use pipeline::{At, Job, Place, Progress, Stage, StageError};
use renderer::VoxelRenderer;
use replay::{BufferPool, Replay, archive_frames};
use schema::ObjectId;
use schema::settings::{OccupancySettings, PerAgent};
use store::{Unit, keys};
use voxelgrid::{Filling, VoxelGrid};
use voxels::{CpuVoxelRenderer, GridPlacement};

/// The stage.
pub const STAGE: Stage<Seen> = Stage::new(run);
/// What it sees of the configuration: the grid of each agent.
type Seen = PerAgent<OccupancySettings>;
/// Its name.
const NAME: &str = Stage::<Seen>::NAME;

fn run(job: &mut Job<'_, Seen>) -> Result<(), StageError> {
    let (settings, scene) = (job.settings().clone(), job.scene());
    let replay = Replay::open(job)?;
    let mut renderer = CpuVoxelRenderer::default();
    renderer.prepare(&replay.meshes()).at(|| job.place())?;
    let agents = replay.log.agent_ids().to_vec();
    let frames = replay.log.frame_count();
    let progress = job.progress();
    progress.set_total(u64::from(frames) * agents.len() as u64);

    for (position, agent) in agents.iter().enumerate() {
        let settings = settings.of(*agent);
        if !settings.enabled {
            continue;
        }
        let name = agent.to_string();
        let Some(mut unit) = job.unit(&name)? else { continue };
        let work = Work { replay: &replay, renderer: &renderer, position, settings };
        let counts = work.grids(&mut unit, &keys::occupancy(scene, *agent), &name, &progress)?;
        unit.rows(&keys::partial_stats(scene, &format!("{}.{name}", NAME)), &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}

struct Work<'a> {
    replay: &'a Replay,
    renderer: &'a dyn VoxelRenderer,
    position: usize,
    settings: &'a OccupancySettings,
}

impl Work<'_> {
    fn place(&self, frame: u32) -> Place {
        let log = &self.replay.log;
        Place::scene(log.info.scene).frame(frame).agent(log.agent_ids()[self.position])
    }

    /// One member per frame, `[x, y, z]` tags.
    fn grids(
        &self,
        unit: &mut Unit<'_>,
        key: &str,
        name: &str,
        progress: &Progress,
    ) -> Result<PartialCounts, StageError> {
        let frames = self.replay.log.frame_count();
        let placement = GridPlacement::new(self.settings).at(|| self.place(0))?;
        let pool = BufferPool::default();
        let one = |frame: u32| {
            let mut grid = pool.take(|| Ok::<_, StageError>(VoxelGrid::default()))?;
            self.voxelize(frame, &placement, &mut grid)?;
            let mut counts = PartialCounts::new();
            grid.add_to(&mut counts, name, Filling::Hollow);
            let member =
                encode_member(&frame_member(frame), Scalar::U8, &grid.shape, &grid.data, DEFAULT_LEVEL)
                    .at(|| self.place(frame))?;
            pool.give(grid);
            Ok((member, counts))
        };
        let mut counts = PartialCounts::new();
        archive_frames(unit, key, frames, progress, one, |of_frame| counts.merge(of_frame))?;
        Ok(counts)
    }

    fn voxelize(
        &self,
        frame: u32,
        placement: &GridPlacement,
        grid: &mut VoxelGrid,
    ) -> Result<(), StageError> {
        let log = &self.replay.log;
        let pose = log.world_from_agent(self.position, frame);
        let own: Option<ObjectId> = self.settings.ignore_self.then(|| log.agent(self.position, frame).id);
        let height_m = self.settings.upper_m.abs().max(self.settings.lower_m.abs());
        let radius_m = self.settings.range_m * std::f64::consts::SQRT_2 + height_m;
        let snapshot = self.replay.snapshot(frame, pose.xyz(), radius_m);
        placement.voxelize(self.renderer, &snapshot, &pose, own, grid).at(|| self.place(frame))
    }
}
