//! The BEV stage: 14 classes around every agent at every frame.

use bev::{Areas, BevRasterizer};
use counts::PartialCounts;
use formats::Scalar;
use framewise::{FrameArray, FrameArrays, label_agents};
use nalgebra::Point3;
use pipeline::{At, Job, Stage, StageError};
use replay::Replay;
use scene::SceneReader;
use schema::arrays::BEV_MASKS;
use schema::settings::BevSettings;
use schema::{AgentId, BevClass};

/// The stage.
pub const STAGE: Stage<BevSettings> = Stage::new(run);

fn run(job: &mut Job<'_, BevSettings>) -> Result<(), StageError> {
    let settings = job.settings().clone();
    if !settings.enabled {
        return Ok(());
    }
    let scene = SceneReader::new(job.store(), job.scene(), job.inputs());
    let replay = Replay::open(&scene).at(|| job.place())?;
    let crosswalks: Vec<_> = replay.map.crosswalks().iter().map(|c| c.polygon.clone()).collect();
    let hazards: Vec<Vec<Point3<f64>>> =
        replay.log.info.hazards.iter().map(|h| h.area_m.iter().map(|&p| p.into()).collect()).collect();
    let areas = Areas { crosswalks: &crosswalks, hazards: &hazards };
    let masks =
        |position, agent| Some(Masks { replay: &replay, position, agent, settings: &settings, areas });
    label_agents(job, &replay.log, &BEV_MASKS, masks)
}

/// The masks of an agent.
struct Masks<'a> {
    replay: &'a Replay,
    position: usize,
    agent: AgentId,
    settings: &'a BevSettings,
    areas: Areas<'a>,
}

impl FrameArrays for Masks<'_> {
    type Memory = BevRasterizer;

    fn memory(&self) -> Result<BevRasterizer, StageError> {
        BevRasterizer::new(self.settings).at(|| pipeline::Place::default().agent(self.agent))
    }

    /// `[14, rows, columns]` booleans.
    fn array<'m>(
        &self,
        rasterizer: &'m mut BevRasterizer,
        frame: u32,
        counts: &mut PartialCounts,
    ) -> Result<FrameArray<'m>, StageError> {
        // Half the diagonal, and the size of the largest object.
        let radius_m = self.settings.half_extent_m() * std::f64::consts::SQRT_2 + 10.0;
        let pose = self.replay.log.world_from_agent(self.position, frame);
        let snapshot = self.replay.snapshot(frame, pose.xyz(), radius_m);
        let mask = rasterizer.rasterize(&snapshot, &pose, self.areas);
        mask.add_to(counts, &self.agent.to_string());
        let cells = self.settings.cells as usize;
        let shape = vec![BevClass::COUNT, cells, cells];
        Ok(FrameArray { scalar: Scalar::Bool, shape, bytes: mask.to_bytes().into() })
    }
}
