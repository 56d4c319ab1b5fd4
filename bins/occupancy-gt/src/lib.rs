//! The occupancy stage: a voxel grid around every agent at every frame.

use std::ffi::OsString;
use std::process::ExitCode;

use codecs::Scalar;
use labels::voxel_grid::{Filling, VoxelGrid, add_cells};
use labels::voxels::{CpuVoxelRenderer, GridPlacement, Wanted};
use render::VoxelRenderer;
use replay::Replay;
use runner::frames::{FrameArray, FrameArrays, label_agents};
use runner::{At, Job, Place, Stage, StageError};
use scene::SceneReader;
use schema::arrays::{ArrayKind, VOXEL_CELLS, VOXEL_FLOW, VOXEL_GRIDS, VOXEL_IDS};
use schema::measures::counts::PartialCounts;
use schema::{AgentId, ObjectId, Tag};
use settings::{OccupancySettings, PerAgent};

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<GridSettings> = Stage::new(run);
/// What it sees of the configuration: the grid of each agent.
type GridSettings = PerAgent<OccupancySettings>;

fn run(job: &mut Job<'_, GridSettings>) -> Result<(), StageError> {
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
    renderer: &'a CpuVoxelRenderer,
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

    fn every_n_frames(&self) -> u32 {
        self.settings.every_n_frames
    }

    fn kinds(&self) -> Vec<&'static ArrayKind> {
        let OccupancySettings { sparse, ids, flow, .. } = *self.settings;
        let all = [(!sparse, &VOXEL_GRIDS), (sparse, &VOXEL_CELLS), (ids, &VOXEL_IDS), (flow, &VOXEL_FLOW)];
        all.into_iter().filter(|(wanted, _)| *wanted).map(|(_, kind)| kind).collect()
    }

    fn comment(&self) -> Result<String, StageError> {
        self.settings.describe().at(|| self.place())
    }

    fn memory(&self) -> Result<Self::Memory, StageError> {
        let placement = GridPlacement::new(self.settings).at(|| self.place())?;
        Ok((placement, VoxelGrid::default()))
    }

    /// `[x, y, z]` tags or `[n, 4]` occupied cells; objects and velocities of the occupied cells.
    fn arrays<'m>(
        &self,
        (placement, grid): &'m mut Self::Memory,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<Vec<FrameArray<'m>>, StageError> {
        let (log, settings) = (&self.replay.log, self.settings);
        let pose = log.world_from_agent(self.position, frame);
        let own: Option<ObjectId> = settings.ignore_self.then(|| log.agent(self.position, frame).id);
        let height_m = settings.upper_m.abs().max(settings.lower_m.abs());
        let radius_m = settings.range_m * std::f64::consts::SQRT_2 + height_m;
        let snapshot = self.replay.snapshot(frame, pose.xyz(), radius_m);
        let place = || self.place().frame(frame);
        let agent = self.agent.to_string();
        let block = placement.block(&snapshot.origin, &pose, own);
        let OccupancySettings { sparse, ids, flow, .. } = *settings;
        let mut arrays = Vec::new();
        if !sparse {
            if settings.full_sweep {
                placement.voxelize(self.renderer, &snapshot, &pose, own, grid).at(place)?;
            } else {
                grid.shape = placement.shape();
                self.renderer.sweep(&snapshot, &block, &settings.sweeps, &mut grid.data).at(place)?;
            }
            grid.add_to(counts, &agent, Filling::Hollow);
            arrays.push(FrameArray {
                scalar: Scalar::U8,
                shape: grid.shape.to_vec(),
                bytes: (&grid.data).into(),
            });
        }
        let wanted = Wanted { places: sparse, ids, flow };
        if wanted != Wanted::default() {
            let rows = self.renderer.cell_rows(&snapshot, &block, wanted).at(place)?;
            let mut cells = rows.counts;
            let occupied: u64 = cells.iter().sum();
            let n = occupied as usize;
            if sparse {
                cells[Tag::Unlabeled as usize] = settings.cells() - occupied;
                add_cells(cells, counts, &agent, Filling::Hollow);
                arrays.push(FrameArray { scalar: Scalar::U16, shape: vec![n, 4], bytes: rows.places.into() });
            }
            if ids {
                arrays.push(FrameArray { scalar: Scalar::U16, shape: vec![n], bytes: rows.ids.into() });
            }
            if flow {
                arrays.push(FrameArray { scalar: Scalar::F32, shape: vec![n, 3], bytes: rows.flow.into() });
            }
        }
        Ok(arrays)
    }
}
