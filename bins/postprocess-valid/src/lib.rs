//! The post-processing stage: points per box, valid flag, difficulty; filled voxel grids, and what lidars saw
//! of them.

mod clouds;
mod error;
mod filling;
mod observing;
mod sightings;

use std::ffi::OsString;
use std::process::ExitCode;

use frames::{Agent, Pose, World};
use labels::validity::{Evidence, PixelCounts};
use rayon::prelude::*;
use runner::{At, Job, Stage, StageError};
use scene::{FrameRanges, SceneError, SceneLog, SceneReader};
use schema::AgentId;
use schema::table::Row;
use schema::tables::{BoxRow, VISIBLE_TABLE, ValidBoxRow, VisibleRow};
use settings::OccupancySettings;
use settings::stages::{RangeRig, ValiditySettings};
use store::keys;

use crate::clouds::Clouds;
use crate::error::InputError;

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<ValiditySettings> = Stage::new(run);

fn run(job: &mut Job<'_, ValiditySettings>) -> Result<(), StageError> {
    let (settings, place) = (job.settings().clone(), job.place());
    let scene = SceneReader::new(job.store(), job.scene(), job.inputs());
    let log = SceneLog::read(&scene).at(|| place.clone())?;
    let agents = log.agent_ids();
    let with = |wanted: &dyn Fn(&OccupancySettings) -> bool| -> Vec<AgentId> {
        let has = |agent: &&AgentId| {
            let grid = settings.occupancy.of(**agent);
            grid.enabled && wanted(grid)
        };
        agents.iter().filter(has).copied().collect()
    };
    let (occupied, observing) = (with(&OccupancySettings::is_filled), with(&|grid| grid.observed));
    let passes = (agents.len() + occupied.len() + observing.len()) as u64;
    job.progress().set_total(u64::from(log.frame_count()) * passes);

    filling::fill_agents(job, &scene, &occupied, log.frame_count())?;
    observing::observe_agents(job, &scene, &observing, log.frame_count())?;
    let valid = validate_all(job, &scene, &log, &settings)?;
    if let Some(mut unit) = job.unit("boxes")? {
        unit.put(scene.scene(), &valid)?;
        let stats = format!("{}.boxes", ValidBoxRow::STAGE);
        unit.rows(&keys::partial_stats(scene.scene(), &stats), &sightings::count(&valid).rows())?;
        unit.finish()?;
    }
    Ok(())
}

/// One row per row of the boxes, in the same order: by frame, then agent. Agents are judged side by side,
/// each frame by frame.
fn validate_all(
    job: &Job<'_, ValiditySettings>,
    scene: &SceneReader,
    log: &SceneLog,
    settings: &ValiditySettings,
) -> Result<Vec<ValidBoxRow>, StageError> {
    let (progress, frames, place) = (job.progress(), log.frame_count(), job.place());
    let boxes: Vec<BoxRow> = scene.rows().at(|| place.clone())?;
    let odd = || Err(InputError::Boxes).at(|| place.clone().in_file(scene.location("boxes.parquet")));
    let Some(of_agents) = boxes_of_agents(&boxes, log) else { return odd() };
    let judge = |(position, of_frames): (usize, Vec<&[BoxRow]>)| {
        let agent = log.agent_ids()[position];
        let here = || place.clone().agent(agent);
        let mut witness = Witness::open(scene, agent, settings.rigs.of(agent), frames).at(here)?;
        let mut judged = Vec::with_capacity(of_frames.len());
        for (frame, boxes) in (0..frames).zip(of_frames) {
            let at = log.world_from_agent(position, frame);
            let valid = witness.judge(frame, boxes, &at, settings.valid_by_image);
            judged.push(valid.at(|| here().frame(frame))?);
            progress.advance(1)?;
        }
        Ok(judged)
    };
    let agents: Vec<Result<Vec<Vec<ValidBoxRow>>, StageError>> =
        of_agents.into_par_iter().enumerate().map(judge).collect();
    let mut agents =
        agents.into_iter().map(|judged| Ok(judged?.into_iter())).collect::<Result<Vec<_>, StageError>>()?;
    let in_order =
        (0..frames).flat_map(|_| agents.iter_mut().filter_map(Iterator::next).flatten().collect::<Vec<_>>());
    Ok(in_order.collect())
}

/// The boxes of each of the log's agents, by frame; none where they are not in the order of the log.
fn boxes_of_agents<'b>(boxes: &'b [BoxRow], log: &SceneLog) -> Option<Vec<Vec<&'b [BoxRow]>>> {
    let ranges = FrameRanges::new(boxes, 0, log.frame_count()).ok()?;
    let names: Vec<String> = log.agent_ids().iter().map(ToString::to_string).collect();
    let mut of_agents = vec![Vec::new(); names.len()];
    let mut found = 0;
    for frame in 0..log.frame_count() {
        let mut rest = &boxes[ranges.of(frame.into())];
        for (name, of_frames) in names.iter().zip(&mut of_agents) {
            let (own, others) = rest.split_at(rest.partition_point(|b| b.agent == *name));
            of_frames.push(own);
            found += own.len();
            rest = others;
        }
    }
    (found == boxes.len()).then_some(of_agents)
}

/// What an agent's sensors saw, frame by frame.
struct Witness {
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
        Ok(Self { clouds, visible, frames: ranges })
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
        Ok(labels::validity::validate(boxes, &evidence))
    }
}
