//! The post-processing stage: points per box, valid flag, difficulty; filled voxel grids.

mod clouds;
mod error;
mod filling;

use std::collections::BTreeMap;

use pipeline::{At, Job, Stage, StageError};
use replay::SIMULATE;
use schema::AgentId;
use schema::scene_info::SceneInfo;
use schema::settings::stages::{RangeRig, ValiditySettings};
use schema::tables::{AgentRow, BoxRow, VISIBLE_TABLE, ValidBoxRow, VisibleRow};
use store::{StoreError, keys};
use validity::{Evidence, PixelCounts};

use crate::clouds::Clouds;
use crate::error::InputError;

/// The stage.
pub const STAGE: Stage<ValiditySettings> = Stage::new(run);
/// Its name.
pub(crate) const NAME: &str = Stage::<ValiditySettings>::NAME;
/// A piece of its work.
pub(crate) type Work<'a> = Job<'a, ValiditySettings>;

pub(crate) const RENDER: &str = "render-sensors";
pub(crate) const OCCUPANCY: &str = "occupancy-gt";

fn run(job: &mut Work<'_>) -> Result<(), StageError> {
    let (settings, scene) = (job.settings().clone(), job.scene());
    let agents = agents_of(job)?;
    let occupied: Vec<&AgentId> = agents.iter().filter(|a| settings.occupancy.of(**a).enabled).collect();
    let frames = frames_of(job)?;
    job.progress().set_total(u64::from(frames) * (agents.len() + occupied.len()) as u64);

    for agent in &occupied {
        filling::fill_agent(job, **agent, settings.occupancy.of(**agent))?;
    }
    let boxes: Vec<BoxRow> =
        job.store().read_rows(job.input(SIMULATE)?, &keys::scene(scene, "boxes.parquet"))?;
    let valid = validate_all(job, &settings, &agents, &boxes)?;
    if let Some(mut unit) = job.unit("boxes")? {
        unit.rows(&keys::scene(scene, "boxes_valid.parquet"), &valid)?;
        unit.finish()?;
    }
    Ok(())
}

fn scene_info(job: &Work<'_>) -> Result<SceneInfo, StageError> {
    let key = keys::scene(job.scene(), "log/scene.json");
    let missing = || StoreError::Missing { path: job.store().location(&key) };
    Ok(job.store().read_json(&key)?.ok_or_else(missing)?)
}

fn agents_of(job: &Work<'_>) -> Result<Vec<AgentId>, StageError> {
    let parse = |a: &schema::scene_info::AgentInfo| a.agent.parse::<AgentId>().at(|| job.place());
    scene_info(job)?.agents.iter().map(parse).collect()
}

fn frames_of(job: &Work<'_>) -> Result<u32, StageError> {
    Ok(scene_info(job)?.frames)
}

/// One row per row of `boxes`, in the same order.
fn validate_all(
    job: &Work<'_>,
    settings: &ValiditySettings,
    agents: &[AgentId],
    boxes: &[BoxRow],
) -> Result<Vec<ValidBoxRow>, StageError> {
    let (scene, progress) = (job.scene(), job.progress());
    let agent_rows: Vec<AgentRow> =
        job.store().read_rows(job.input(SIMULATE)?, &keys::scene(scene, "agents.parquet"))?;
    let mut valid: Vec<Option<ValidBoxRow>> = vec![None; boxes.len()];
    for agent in agents {
        let name = agent.to_string();
        let rig = settings.rigs.of(*agent);
        let mut by_frame: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (row, _) in boxes.iter().enumerate().filter(|(_, b)| b.agent == name) {
            by_frame.entry(boxes[row].frame).or_default().push(row);
        }
        let pixels = visible_of(job, *agent, rig)?;
        let none = BTreeMap::new();
        let mut clouds = Clouds::open(job, *agent, rig)?;
        for pose in agent_rows.iter().filter(|a| a.agent == name) {
            let readings = clouds.next_frame(pose.frame)?;
            let rows = by_frame.get(&pose.frame).map_or(&[][..], Vec::as_slice);
            let of_frame: Vec<BoxRow> = rows.iter().map(|&r| boxes[r].clone()).collect();
            let world_from_agent = frames::Pose::from_xyz_wxyz(pose.xyz_m, pose.quaternion);
            let (lidars, radars) = readings.in_world(&world_from_agent);
            let evidence = Evidence {
                lidars: &lidars,
                radars: &radars,
                num_pixels: pixels.get(&pose.frame).unwrap_or(&none),
                valid_by_image: settings.valid_by_image,
            };
            for (&row, judged) in rows.iter().zip(validity::validate(&of_frame, &evidence)) {
                valid[row] = Some(judged);
            }
            progress.advance(1)?;
        }
    }
    let judged: Option<Vec<ValidBoxRow>> = valid.into_iter().collect();
    judged
        .ok_or(InputError::Boxes)
        .at(|| job.place().in_file(job.store().location(&keys::scene(scene, "boxes.parquet"))))
}

/// Pixels per object and tag, by frame.
fn visible_of(
    job: &Work<'_>,
    agent: AgentId,
    rig: &RangeRig,
) -> Result<BTreeMap<u32, PixelCounts>, StageError> {
    let mut visible: BTreeMap<u32, PixelCounts> = BTreeMap::new();
    if rig.instance {
        let key = keys::sensor(job.scene(), agent, VISIBLE_TABLE);
        let rows: Vec<VisibleRow> = job.store().read_rows(job.input(RENDER)?, &key)?;
        for row in rows {
            visible.entry(row.frame).or_default().insert((row.id, row.tag), row.pixels);
        }
    }
    Ok(visible)
}
