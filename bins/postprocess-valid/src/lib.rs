//! The post-processing stage: points per box, valid flag, difficulty; filled voxel grids, and what lidars saw of them.

mod clouds;
mod error;
mod filling;
mod observing;
mod sightings;

use frames::{Agent, Pose, World};
use pipeline::{At, Job, Stage, StageError};
use scene::{FrameRanges, SceneError, SceneLog, SceneReader};
use schema::AgentId;
use schema::settings::stages::{RangeRig, ValiditySettings};
use schema::table::Row;
use schema::tables::{BoxRow, VISIBLE_TABLE, ValidBoxRow, VisibleRow};
use store::keys;
use validity::{Evidence, PixelCounts};

use crate::clouds::Clouds;
use crate::error::InputError;

/// The stage.
pub const STAGE: Stage<ValiditySettings> = Stage::new(run);

fn run(job: &mut Job<'_, ValiditySettings>) -> Result<(), StageError> {
    let (settings, place) = (job.settings().clone(), job.place());
    let scene = SceneReader::new(job.store(), job.scene(), job.inputs());
    let log = SceneLog::read(&scene).at(|| place.clone())?;
    let agents = log.agent_ids();
    let has_grid = |agent: &&AgentId| {
        let grid = settings.occupancy.of(**agent);
        grid.enabled && grid.is_filled()
    };
    let occupied: Vec<&AgentId> = agents.iter().filter(has_grid).collect();
    let has_sight = |agent: &&AgentId| {
        let grid = settings.occupancy.of(**agent);
        grid.enabled && grid.observed
    };
    let observing: Vec<&AgentId> = agents.iter().filter(has_sight).collect();
    let passes = (agents.len() + occupied.len() + observing.len()) as u64;
    job.progress().set_total(u64::from(log.frame_count()) * passes);

    for agent in &occupied {
        let grid = settings.occupancy.of(**agent);
        filling::fill_agent(job, &scene, **agent, (grid, log.frame_count()))?;
    }
    for agent in observing {
        let (grid, rig) = (settings.occupancy.of(*agent), settings.rigs.of(*agent));
        observing::observe_agent(job, &scene, *agent, (grid, rig), log.frame_count())?;
    }
    let valid = validate_all(job, &scene, &log, &settings)?;
    if let Some(mut unit) = job.unit("boxes")? {
        unit.rows(&keys::scene(scene.scene(), "boxes_valid.parquet"), &valid)?;
        let stats = format!("{}.boxes", ValidBoxRow::STAGE);
        unit.rows(&keys::partial_stats(scene.scene(), &stats), &sightings::count(&valid).rows())?;
        unit.finish()?;
    }
    Ok(())
}

/// One row per row of the boxes, in the same order: by frame, then agent.
fn validate_all(
    job: &Job<'_, ValiditySettings>,
    scene: &SceneReader,
    log: &SceneLog,
    settings: &ValiditySettings,
) -> Result<Vec<ValidBoxRow>, StageError> {
    let (progress, frames) = (job.progress(), log.frame_count());
    let boxes: Vec<BoxRow> = scene.rows().at(|| job.place())?;
    let odd = || Err(InputError::Boxes).at(|| job.place().in_file(scene.location("boxes.parquet")));
    let Ok(ranges) = FrameRanges::new(&boxes, 0, frames) else { return odd() };
    let mut witnesses = Vec::new();
    for &agent in log.agent_ids() {
        let rig = settings.rigs.of(agent);
        witnesses.push(Witness::open(scene, agent, rig, frames).at(|| job.place().agent(agent))?);
    }
    let mut valid = Vec::with_capacity(boxes.len());
    for frame in 0..frames {
        let mut rest = &boxes[ranges.of(frame.into())];
        for (position, witness) in witnesses.iter_mut().enumerate() {
            let own = rest.partition_point(|b| b.agent == witness.name);
            let at = log.world_from_agent(position, frame);
            let agent = witness.agent;
            let place = || job.place().agent(agent).frame(frame);
            valid.extend(witness.judge(frame, &rest[..own], &at, settings.valid_by_image).at(place)?);
            rest = &rest[own..];
            progress.advance(1)?;
        }
    }
    if valid.len() == boxes.len() { Ok(valid) } else { odd() }
}

/// What an agent's sensors saw, frame by frame.
struct Witness {
    agent: AgentId,
    name: String,
    clouds: Clouds,
    /// Pixels by object and tag, by frame.
    visible: Vec<VisibleRow>,
    frames: FrameRanges,
}

impl Witness {
    fn open(scene: &SceneReader, agent: AgentId, rig: &RangeRig, frames: u32) -> Result<Self, InputError> {
        let visible: Vec<VisibleRow> =
            if rig.instance { scene::agent_rows(scene, agent, VISIBLE_TABLE)? } else { Vec::new() };
        let ranges = FrameRanges::new(&visible, 0, frames).map_err(|row| InputError::Visible { row })?;
        let clouds = Clouds::open(scene, agent, rig, frames)?;
        Ok(Self { agent, name: agent.to_string(), clouds, visible, frames: ranges })
    }

    /// Judges the agent's boxes of the next frame.
    fn judge(
        &mut self,
        frame: u32,
        boxes: &[BoxRow],
        world_from_agent: &Pose<World, Agent>,
        valid_by_image: bool,
    ) -> Result<Vec<ValidBoxRow>, SceneError> {
        let readings = self.clouds.next_frame(frame)?;
        let (lidars, radars) = readings.in_world(world_from_agent);
        let seen = &self.visible[self.frames.of(frame.into())];
        let num_pixels: PixelCounts = seen.iter().map(|row| ((row.id, row.tag), row.pixels)).collect();
        let evidence = Evidence { lidars: &lidars, radars: &radars, num_pixels: &num_pixels, valid_by_image };
        Ok(validity::validate(boxes, &evidence))
    }
}
