//! The BEV stage: 14 classes around every agent at every frame.

use bev::{Areas, BevRasterizer};
use counts::PartialCounts;
use formats::{DEFAULT_LEVEL, Scalar, encode_member, frame_member};
use nalgebra::Point3;
use pipeline::{At, Job, Place, Progress, Stage, StageError};
use replay::{BufferPool, Replay, archive_frames};
use schema::BevClass;
use schema::settings::BevSettings;
use store::{Unit, keys};

/// The stage.
pub const STAGE: Stage<BevSettings> = Stage::new(run);
/// Its name.
const NAME: &str = Stage::<BevSettings>::NAME;

fn run(job: &mut Job<'_, BevSettings>) -> Result<(), StageError> {
    let (settings, scene) = (job.settings().clone(), job.scene());
    if !settings.enabled {
        return Ok(());
    }
    let replay = Replay::open(job)?;
    let crosswalks: Vec<_> = replay.map.crosswalks().iter().map(|c| c.polygon.clone()).collect();
    let hazards: Vec<Vec<Point3<f64>>> =
        replay.log.info.hazards.iter().map(|h| h.area_m.iter().map(|&p| p.into()).collect()).collect();
    let areas = Areas { crosswalks: &crosswalks, hazards: &hazards };
    let agents = replay.log.agent_ids().to_vec();
    let frames = replay.log.frame_count();
    let progress = job.progress();
    progress.set_total(u64::from(frames) * agents.len() as u64);

    for (position, agent) in agents.iter().enumerate() {
        let name = agent.to_string();
        let Some(mut unit) = job.unit(&name)? else { continue };
        let work = Work { replay: &replay, position, settings: &settings, areas };
        let counts = work.masks(&mut unit, &keys::bev(scene, *agent), &name, &progress)?;
        unit.rows(&keys::partial_stats(scene, &format!("{}.{name}", NAME)), &counts.rows())?;
        unit.finish()?;
    }
    Ok(())
}

struct Work<'a> {
    replay: &'a Replay,
    position: usize,
    settings: &'a BevSettings,
    areas: Areas<'a>,
}

impl Work<'_> {
    fn place(&self, frame: u32) -> Place {
        let log = &self.replay.log;
        Place::scene(log.info.scene).frame(frame).agent(log.agent_ids()[self.position])
    }

    /// One member per frame, `[14, rows, columns]` booleans.
    fn masks(
        &self,
        unit: &mut Unit<'_>,
        key: &str,
        name: &str,
        progress: &Progress,
    ) -> Result<PartialCounts, StageError> {
        let frames = self.replay.log.frame_count();
        let cells = self.settings.cells as usize;
        // Half the diagonal, and the size of the largest object.
        let radius_m = self.settings.half_extent_m() * std::f64::consts::SQRT_2 + 10.0;
        let pool = BufferPool::default();
        let one = |frame: u32| {
            let pose = self.replay.log.world_from_agent(self.position, frame);
            let snapshot = self.replay.snapshot(frame, pose.xyz(), radius_m);
            let mut rasterizer = pool.take(|| BevRasterizer::new(self.settings)).at(|| self.place(frame))?;
            let mask = rasterizer.rasterize(&snapshot, &pose, self.areas);
            pool.give(rasterizer);
            let shape = [BevClass::COUNT, cells, cells];
            let member =
                encode_member(&frame_member(frame), Scalar::Bool, &shape, &mask.to_bytes(), DEFAULT_LEVEL)
                    .at(|| self.place(frame))?;
            let mut counts = PartialCounts::new();
            mask.add_to(&mut counts, name);
            Ok((member, counts))
        };
        let mut counts = PartialCounts::new();
        archive_frames(unit, key, frames, progress, one, |of_frame| counts.merge(of_frame))?;
        Ok(counts)
    }
}
