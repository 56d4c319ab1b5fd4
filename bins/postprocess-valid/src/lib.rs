//! The post-processing stage: points per box, valid flag, difficulty; filled voxel grids.

mod clouds;
mod error;
mod filling;

use std::collections::BTreeMap;

use pipeline::{At, Job, Stage, StageError};
use scene::{SceneLog, SceneReader};
use schema::AgentId;
use schema::settings::stages::{RangeRig, ValiditySettings};
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
    let occupied: Vec<&AgentId> = agents.iter().filter(|a| settings.occupancy.of(**a).enabled).collect();
    let passes = (agents.len() + occupied.len()) as u64;
    job.progress().set_total(u64::from(log.frame_count()) * passes);

    for agent in &occupied {
        filling::fill_agent(job, &scene, **agent, settings.occupancy.of(**agent))?;
    }
    let valid = validate_all(job, &scene, &log, &settings)?;
    if let Some(mut unit) = job.unit("boxes")? {
        unit.rows(&keys::scene(scene.scene(), "boxes_valid.parquet"), &valid)?;
        unit.finish()?;
    }
    Ok(())
}

/// One row per row of the boxes, in the same order.
fn validate_all(
    job: &Job<'_, ValiditySettings>,
    scene: &SceneReader,
    log: &SceneLog,
    settings: &ValiditySettings,
) -> Result<Vec<ValidBoxRow>, StageError> {
    let progress = job.progress();
    let boxes: Vec<BoxRow> = scene.rows().at(|| job.place())?;
    let mut valid: Vec<Option<ValidBoxRow>> = vec![None; boxes.len()];
    for (position, &agent) in log.agent_ids().iter().enumerate() {
        let place = || job.place().agent(agent);
        let name = agent.to_string();
        let rig = settings.rigs.of(agent);
        let mut by_frame: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (row, _) in boxes.iter().enumerate().filter(|(_, b)| b.agent == name) {
            by_frame.entry(boxes[row].frame).or_default().push(row);
        }
        let pixels = visible_of(scene, agent, rig).at(place)?;
        let none = BTreeMap::new();
        let mut clouds = Clouds::open(scene, agent, rig, log.frame_count()).at(place)?;
        for frame in 0..log.frame_count() {
            let readings = clouds.next_frame().at(|| place().frame(frame))?;
            let rows = by_frame.get(&frame).map_or(&[][..], Vec::as_slice);
            let of_frame: Vec<BoxRow> = rows.iter().map(|&r| boxes[r].clone()).collect();
            let (lidars, radars) = readings.in_world(&log.world_from_agent(position, frame));
            let evidence = Evidence {
                lidars: &lidars,
                radars: &radars,
                num_pixels: pixels.get(&frame).unwrap_or(&none),
                valid_by_image: settings.valid_by_image,
            };
            for (&row, judged) in rows.iter().zip(validity::validate(&of_frame, &evidence)) {
                valid[row] = Some(judged);
            }
            progress.advance(1)?;
        }
    }
    let judged: Option<Vec<ValidBoxRow>> = valid.into_iter().collect();
    judged.ok_or(InputError::Boxes).at(|| job.place().in_file(scene.location("boxes.parquet")))
}

/// Pixels per object and tag, by frame.
fn visible_of(
    scene: &SceneReader,
    agent: AgentId,
    rig: &RangeRig,
) -> Result<BTreeMap<u32, PixelCounts>, InputError> {
    let mut visible: BTreeMap<u32, PixelCounts> = BTreeMap::new();
    if rig.instance {
        let rows: Vec<VisibleRow> = scene::agent_rows(scene, agent, VISIBLE_TABLE)?;
        for row in rows {
            visible.entry(row.frame).or_default().insert((row.id, row.tag), row.pixels);
        }
    }
    Ok(visible)
}
