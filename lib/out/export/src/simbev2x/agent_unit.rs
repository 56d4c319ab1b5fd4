//! The unit of an agent: its sensors, grids and masks.

use codecs::{DType, Scalar};
use scene::{ArrayReader, SensorEntry};
use schema::arrays::{ArrayKind, BEV_MASKS, FILLED_VOXEL_GRIDS, VOXEL_GRIDS};
use schema::table::Row;
use schema::tables::{AgentRow, CameraRow};
use schema::{AgentId, BevClass, ImageKind};
use serde::{Deserialize, Serialize};

use super::masks::{Palette, picture};
use super::names::{self, FILLED_VOXELS, LIDAR, SEMANTIC_LIDAR, VOXELS};
use super::readings::{ReadingError, Readings, repacked};
use super::rig::{Rigs, Voxels, place_of};
use crate::{ExportError, Omission, SceneSource, UnitFiles};

/// What a unit leaves for the infos.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct AgentFacts {
    /// Its sensors that have files, in the order of writing.
    pub(super) sensors: Vec<String>,
    /// Whether it has masks.
    pub(super) has_masks: bool,
    /// Where its sensors are.
    pub(super) rigs: Rigs,
    /// Time, s, position, m, and orientation (w, x, y, z) of each frame, as texts that read back exactly.
    pub(super) frames: Vec<String>,
}

/// What of an agent the layout has a place for.
pub(super) struct Holding {
    /// In the order of writing.
    pub(super) sensors: Vec<SensorEntry>,
    /// The kinds of grids that it has, by the names of the layout.
    pub(super) grids: Vec<(&'static str, ArrayKind)>,
    pub(super) has_masks: bool,
    pub(super) rigs: Rigs,
    pub(super) omissions: Vec<Omission>,
}

impl Holding {
    /// Looks through an agent's sensors, grids and masks.
    pub(super) fn of(
        scene: &SceneSource,
        agent: AgentId,
        voxels: &Voxels,
        filled: bool,
    ) -> Result<Self, ExportError> {
        let who = format!("scene {} {agent}", scene.number());
        let (mut rigs, mut omissions, mut sensors) = (Rigs::default(), Vec::new(), Vec::new());
        if scene.has(CameraRow::STAGE) {
            for sensor in scene.sensors(agent)? {
                match place_of(agent, &sensor) {
                    Ok(place) => {
                        check_rate(scene, &who, &sensor.name, sensor.about.every_n_frames)?;
                        rigs.add(&who, agent.kind, place, &sensor.about)?;
                        sensors.push(sensor);
                    }
                    Err(why) => {
                        omissions.push(Omission::new(format!("{} of {agent}", sensor.name), why));
                    }
                }
            }
        }
        sensors.sort_by_key(rank);
        let mut grids = Vec::new();
        for (name, kind) in [(VOXELS, VOXEL_GRIDS), (FILLED_VOXELS, FILLED_VOXEL_GRIDS)] {
            let wanted = scene.selection().has_sensor(name) && (name == VOXELS || filled);
            if wanted && scene.has_arrays(&kind, agent) {
                check_frames(scene, &who, name, &scene.arrays(&kind, agent)?)?;
                rigs.add_voxels(&who, agent.kind, voxels)?;
                grids.push((name, kind));
            }
        }
        let has_masks = scene.has_arrays(&BEV_MASKS, agent) && {
            let mut masks = scene.arrays(&BEV_MASKS, agent)?;
            check_frames(scene, &who, "GT_SEG", &masks)?;
            let fits = masks.read_packed(0)?.shape.first() == Some(&BevClass::COUNT);
            if !fits {
                let why = "the layout has all 14 classes or none";
                omissions.push(Omission::new(format!("masks of {agent}"), why));
            }
            fits
        };
        Ok(Self { sensors, grids, has_masks, rigs, omissions })
    }
}

/// Each frame has every file in the layout.
pub(super) fn check_rate(
    scene: &SceneSource,
    who: &str,
    what: &str,
    every_n_frames: u32,
) -> Result<(), ExportError> {
    let step = scene.selection().every_n_frames.max(1);
    if step.is_multiple_of(every_n_frames.max(1)) {
        return Ok(());
    }
    Err(ExportError::Refused(format!(
        "{who}: {what} is there at every {every_n_frames} frames, and the layout has every file of every frame: choose --every \
         {}, or leave it out",
        least_common(step, every_n_frames)
    )))
}

/// The same of arrays: which frames they have stands in the archive.
fn check_frames(scene: &SceneSource, who: &str, what: &str, arrays: &ArrayReader) -> Result<(), ExportError> {
    let mut found: Vec<u32> = arrays.frames().collect();
    found.sort_unstable();
    let rate = found.get(1).copied().unwrap_or(1);
    check_rate(scene, who, what, rate)
}

fn least_common(a: u32, b: u32) -> u32 {
    let (mut x, mut y) = (a.max(1), b.max(1));
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a.max(1) / x * b.max(1)
}

/// The order of keys in the records: camera by camera its images, radars, lidars, receivers.
fn rank(sensor: &SensorEntry) -> (usize, usize, usize) {
    let name = sensor.name.as_str();
    if let Some(camera) = sensor.camera() {
        let place = names::CAMERAS.iter().position(|known| *known == camera).unwrap_or_default();
        let kinds =
            [ImageKind::Rgb, ImageKind::Semantic, ImageKind::Instance, ImageKind::Depth, ImageKind::Flow];
        let prefix = name.split('-').next().unwrap_or_default();
        let kind = kinds.iter().position(|kind| kind.spec().prefix == prefix).unwrap_or_default();
        return (0, place, kind);
    }
    match name {
        LIDAR => (2, 0, 0),
        SEMANTIC_LIDAR => (2, 1, 0),
        "GNSS" => (3, 0, 0),
        "IMU" => (3, 1, 0),
        radar => (1, names::RADARS.iter().position(|known| *known == radar).unwrap_or_default(), 0),
    }
}

/// Frames of a piece: few enough that threads end at about the same time, and enough that opening tables is
/// little beside them.
const FRAMES_A_PIECE: u32 = 16;

/// In how many pieces an agent is written.
pub(super) fn pieces(scene: &SceneSource) -> u32 {
    scene.frame_count().div_ceil(FRAMES_A_PIECE)
}

/// Writes the files of some frames of an agent.
pub(super) fn write(
    scene: &SceneSource,
    agent: AgentId,
    (holding, piece): (&Holding, u32),
    palette: Palette,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let number = scene.number();
    let mut sensors = Vec::new();
    for sensor in &holding.sensors {
        sensors.push((sensor.name.as_str(), Readings::open(scene, agent, sensor)?));
    }
    let mut grids = Vec::new();
    for (name, kind) in &holding.grids {
        grids.push((*name, scene.arrays(kind, agent)?));
    }
    let mut masks = if holding.has_masks { Some(scene.arrays(&BEV_MASKS, agent)?) } else { None };
    // Frames are numbered anew: readers want them without gaps.
    let first = piece * FRAMES_A_PIECE;
    for (to, from) in (0..).zip(scene.frames()).skip(first as usize).take(FRAMES_A_PIECE as usize) {
        let fault = |what: &str, problem: &dyn std::fmt::Display| content(number, from, agent, what, problem);
        for (name, readings) in &mut sensors {
            let file = readings.file(from).map_err(|e| match e {
                ReadingError::Store(e) => e,
                ReadingError::Content(problem) => fault(name, &problem),
            })?;
            let file = file.ok_or_else(|| fault(name, &"has no reading"))?;
            files.put(&names::sweep(number, to, agent, name), &file)?;
        }
        for (name, grid) in &mut grids {
            let packed = grid.read_packed(from)?;
            if packed.dtype != DType::Scalar(Scalar::U8) || packed.shape.len() != 3 {
                return Err(fault(name, &format!("is no grid of bytes but {:?}", packed.shape)));
            }
            let file = repacked(packed.member).map_err(|e| fault(name, &e))?;
            files.put(&names::sweep(number, to, agent, name), &file)?;
        }
        if let Some(masks) = &mut masks {
            let array = masks.read(from)?;
            let (&[_, cells, width], true) = (array.shape.as_slice(), array.dtype == Scalar::Bool.into())
            else {
                return Err(fault("GT_SEG", &format!("are no masks but {:?}", array.shape)));
            };
            if cells != width {
                return Err(fault("GT_SEG", &"are no squares"));
            }
            let viz = picture(&array.bytes, cells, palette).map_err(|e| fault("GT_SEG", &e))?;
            let packed = masks.read_packed(from)?;
            let file = repacked(packed.member).map_err(|e| fault("GT_SEG", &e))?;
            files.put(&names::masks(number, to, agent), &file)?;
            files.put(&names::mask_picture(number, to, agent), &viz)?;
        }
        files.advance(1)?;
    }
    Ok(())
}

/// What an agent leaves for the infos.
pub(super) fn facts(
    scene: &SceneSource,
    agent: AgentId,
    holding: &Holding,
) -> Result<AgentFacts, ExportError> {
    let names = holding.sensors.iter().map(|sensor| sensor.name.clone());
    let grids = holding.grids.iter().map(|(name, _)| (*name).to_owned()).filter(|name| name == VOXELS);
    Ok(AgentFacts {
        sensors: names.chain(grids).collect(),
        has_masks: holding.has_masks,
        rigs: holding.rigs.clone(),
        frames: poses(scene, agent)?,
    })
}

/// Time and place of an agent at the wanted frames.
fn poses(scene: &SceneSource, agent: AgentId) -> Result<Vec<String>, ExportError> {
    let position = scene.agents().iter().position(|other| *other == agent).unwrap_or_default();
    let rows: Vec<AgentRow> = scene.agent_rows()?.swap_remove(position);
    let wanted = scene.frames().filter_map(|frame| rows.get(frame as usize));
    Ok(wanted
        .map(|row| {
            let numbers = std::iter::once(&row.time_s).chain(&row.xyz_m).chain(&row.quaternion);
            numbers.map(f64::to_string).collect::<Vec<_>>().join(" ")
        })
        .collect())
}

/// Something of a frame that the layout cannot hold.
pub(super) fn content(
    scene: u32,
    frame: u32,
    agent: AgentId,
    what: &str,
    problem: &dyn std::fmt::Display,
) -> ExportError {
    let agent = Some(agent.to_string());
    ExportError::Content { scene, frame: Some(frame), agent, problem: format!("{what} {problem}") }
}
