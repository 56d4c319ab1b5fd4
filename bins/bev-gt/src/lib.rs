//! The BEV stage: masks around every agent at every frame.

mod masks;
mod sources;

use std::ffi::OsString;
use std::process::ExitCode;

use labels::bev_map::LaneCollector;
use replay::Replay;
use runner::frames::label_agents;
use runner::{At, Job, Stage, StageError};
use scene::SceneReader;
use settings::BevRule;
use settings::stages::MaskSettings;

use masks::{Masks, Rule};
use sources::{AgentLanes, SceneAreas, footprints};

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    arguments::stage::run(words, STAGE, build_stamp::STAMP)
}

/// The stage.
const STAGE: Stage<MaskSettings> = Stage::new(run);

fn run(job: &mut Job<'_, MaskSettings>) -> Result<(), StageError> {
    let MaskSettings { bev: settings, warmup_s } = job.settings().clone();
    if !settings.enabled {
        return Ok(());
    }
    let scene = SceneReader::new(job.store(), job.scene(), job.inputs());
    let replay = Replay::open(&scene).at(|| job.place())?;
    let areas = SceneAreas::of(&replay, &settings);
    let by_lanes = settings.rule == BevRule::Simbev2x;
    let mut footprints = if by_lanes { footprints(&scene).at(|| job.place())? } else { Default::default() };
    let mut collector = by_lanes.then(|| LaneCollector::new(&replay.map, settings.lane_step_m));
    label_agents(job, &replay.log, |position, agent| {
        let rule = match &mut collector {
            Some(collector) => {
                let boxes = footprints.remove(&agent).unwrap_or_default();
                let radius_m =
                    settings.lane_radius_m.unwrap_or(35.0 * (replay.log.info.duration_s + warmup_s));
                Rule::Simbev2x(AgentLanes::of(&replay, collector, position, agent, radius_m, boxes))
            }
            None => Rule::Exact,
        };
        Some(Masks { replay: &replay, position, agent, settings: &settings, areas: &areas, rule })
    })
}
