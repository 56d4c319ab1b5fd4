//! What a layout leaves out of scenes, whether it can hold them, and what they will come to.

use std::collections::{BTreeMap, BTreeSet};

use scene::SensorKind;
use schema::arrays::{BEV_MASKS, FILLED_VOXEL_GRIDS, VOXEL_GRIDS};
use schema::tables::{BOXES_2D_TABLE, VISIBLE_TABLE};
use schema::{AgentId, ImageKind};

use super::boxes::{has_table, is_annotated};
use super::clouds::{LIDAR_POINT_BYTES, RADAR_POINT_BYTES, Returns, Sweep};
use super::finish::elements;
use super::mask::{WAY_MARGIN_M, bounds, merge, widened};
use super::options::NuScenesOptions;
use super::options::plain;
use super::rig::{Rig, is_labelled, sample_step};
use super::vocabulary::Modality;
use crate::{Cost, ExportError, Omission, SceneSource, Source, UnitName};

/// Bytes of a row of annotations, of a reading, and of a sample with its pose.
const ROW_BYTES: [u64; 3] = [470, 420, 420];
/// Boxes further apart in time than this have no velocity for devkits, in frames.
const MOST_STEP: u32 = 30;

/// What is left out, and why.
pub(crate) fn preflight(source: &Source, options: &NuScenesOptions) -> Result<Vec<Omission>, ExportError> {
    let mut omissions = BTreeSet::from([
        Omission::new(
            "velocities and turn rates of boxes",
            "devkits take them from the boxes of other samples",
        ),
        Omission::new("states of traffic lights", "the layout has no place for them"),
        Omission::new("tags and ids of points", "lidarseg has categories alone"),
        Omission::new("vector maps", "the layout's map expansion is not written"),
    ]);
    let seen = if options.empty_boxes { String::new() } else { ", and those without a point".to_owned() };
    omissions.insert(Omission::new(
        format!("boxes farther than {} m{seen}", options.radius_m),
        "tables grow large; choose with --radius and --empty-boxes",
    ));
    if !options.lidarseg {
        omissions.insert(Omission::new("lidarseg", "it is switched off"));
    }
    if !options.map_mask {
        omissions.insert(Omission::new("map masks", "they are switched off: blank pictures stand for them"));
    }
    let (mut grounds, mut named) = (BTreeMap::<&str, [f64; 4]>::new(), BTreeMap::<String, &str>::new());
    for scene in &source.scenes {
        let map = scene.info().map.as_str();
        if let Some(other) = named.insert(plain(map), map).filter(|other| *other != map) {
            return Err(ExportError::Refused(format!(
                "maps {other} and {map} would both be {} (export their scenes into two folders, by --scenes)",
                plain(map)
            )));
        }
        let ways = scene.agent_rows()?;
        let ways = bounds(ways.iter().flatten().map(|pose| [pose.xyz_m[0], pose.xyz_m[1]]));
        let ground = widened(ways.unwrap_or_default(), WAY_MARGIN_M);
        grounds.entry(map).and_modify(|all| *all = merge(*all, ground)).or_insert(ground);
        of_scene(scene, options, &mut omissions)?;
    }
    for (map, ground) in grounds {
        options.mask_of(map, ground)?;
        if options.map_mask {
            elements(source, map)?;
        }
    }
    Ok(omissions.into_iter().collect())
}

fn of_scene(
    scene: &SceneSource,
    options: &NuScenesOptions,
    omissions: &mut BTreeSet<Omission>,
) -> Result<(), ExportError> {
    let step = sample_step(scene, options)?;
    let between =
        if options.sweeps.is_empty() { "readings" } else { "boxes, and readings without --sweeps," };
    omissions.insert(Omission::new(
        format!("{between} between samples, which stand every {step} frames"),
        "choose with --sample-every and --sweeps",
    ));
    if step > MOST_STEP {
        omissions.insert(Omission::new(
            "velocities that devkits work out",
            format!(
                "samples stand {} s apart, as rates of sensors and labels have it",
                f64::from(step) * 0.05
            ),
        ));
    }
    for agent in scene.agents() {
        let Rig { channels, left_out } = Rig::of(scene, *agent)?;
        for channel in channels.iter().filter(|channel| options.lidarseg && channel.name == "LIDAR_TOP") {
            if !is_labelled(scene, *agent, channel, options)? {
                omissions
                    .insert(Omission::new("lidarseg", "nobody knows the tags of points of imported scenes"));
            }
        }
        for (sensor, why) in left_out {
            // Of pictures in colour one camera is left out, of others the kind.
            let is_rgb = sensor.kind == SensorKind::Image(ImageKind::Rgb);
            omissions.insert(match is_rgb {
                true => Omission::new(sensor.name.clone(), why),
                false => Omission::sensor(&sensor, why),
            });
        }
        if !has_table(scene, *agent, BOXES_2D_TABLE) {
            let why = match has_table(scene, *agent, VISIBLE_TABLE) {
                true => "there is no boxes_2d of it: what is in a picture counts as seen, all else as hidden",
                false => "there are neither boxes_2d nor instance images of it: all counts as seen",
            };
            let what = format!("shares of objects that are visible to {agent}");
            omissions.insert(Omission::new(what, why));
        }
        let arrays = [
            (&BEV_MASKS, "BEV masks"),
            (&VOXEL_GRIDS, "voxel grids"),
            (&FILLED_VOXEL_GRIDS, "filled voxel grids"),
        ];
        for (kind, what) in arrays {
            if scene.has_arrays(kind, *agent) {
                omissions.insert(Omission::new(what, "the layout has no place for them"));
            }
        }
    }
    Ok(())
}

/// What an agent of a scene will come to: its first readings and boxes, times their number.
pub(crate) fn cost(
    scene: &SceneSource,
    unit: UnitName,
    options: &NuScenesOptions,
) -> Result<Cost, ExportError> {
    let Some(agent) = unit.agent else { return Ok(Cost::default()) };
    let step = sample_step(scene, options)?;
    let samples = scene.frames().filter(|frame| frame % step == 0).count() as u64;
    let mut cost = Cost { agent_frames: samples, bytes: samples * ROW_BYTES[2], cpu_s: 0.0 };
    for channel in Rig::of(scene, agent)?.channels {
        let every = channel.sensor.about.every_n_frames;
        let readings = match options.sweeps.contains(&channel.modality) {
            true => scene.frames().filter(|frame| schema::rate::is_due(*frame, every)).count() as u64,
            false => samples,
        };
        let rows = u64::from(schema::rate::count(scene.info().frames, every)).max(1);
        let is_labelled = is_labelled(scene, agent, &channel, options)?;
        let each = match channel.modality {
            Modality::Camera => channel.sensor.bytes / rows,
            Modality::Lidar => {
                let first = scene.readings::<Sweep>(agent, &channel.sensor)?.at(0)?;
                let points = first.map_or(0, |sweep| sweep.x.len() as u64);
                cost.bytes += samples * points * u64::from(is_labelled);
                points * LIDAR_POINT_BYTES
            }
            Modality::Radar => {
                let first = scene.readings::<Returns>(agent, &channel.sensor)?.at(0)?;
                first.map_or(0, |returns| returns.depth.len() as u64) * RADAR_POINT_BYTES
            }
        };
        cost.bytes += readings * (each + ROW_BYTES[1]);
        cost.cpu_s += readings as f64 * cpu_s(channel.modality, each);
    }
    let boxes = boxes_of_first(scene, agent, options)?;
    cost.bytes += samples * boxes * ROW_BYTES[0];
    cost.cpu_s += (samples * boxes) as f64 * 2e-5 + samples as f64 * 1e-3;
    Ok(cost)
}

/// Seconds of a core that a reading of so many bytes takes, about: less than it was on the demo dataset
/// (docs/performance.md).
fn cpu_s(modality: Modality, bytes: u64) -> f64 {
    let per_byte = match modality {
        Modality::Camera => 2e-9,
        Modality::Lidar => 6e-9,
        Modality::Radar => 4e-9,
    };
    2e-4 + bytes as f64 * per_byte
}

fn boxes_of_first(
    scene: &SceneSource,
    agent: AgentId,
    options: &NuScenesOptions,
) -> Result<u64, ExportError> {
    let place = scene.agents().iter().position(|a| *a == agent).unwrap_or_default();
    let poses = scene.agent_rows()?.swap_remove(place);
    let Some(pose) = poses.first() else { return Ok(0) };
    let boxes = scene.boxes(agent)?.at(0)?;
    Ok(boxes.iter().filter(|found| is_annotated(found, pose, options)).count() as u64)
}
