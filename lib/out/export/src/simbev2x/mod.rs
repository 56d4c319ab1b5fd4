//! The layout of SimBEV2X, as its post-processor, visualisers, statistics scripts and data loader read it.
//!
//! A scene is a unit of its own (boxes of all agents, lanes, configuration, log, the picture from above)
//! beside one for each agent (sensors, grids, masks). Infos are made at the end from what the units left.

mod agent_unit;
mod detection;
mod infos;
mod lane;
mod masks;
mod names;
mod options;
mod overview;
mod pickle;
mod pytext;
mod readings;
mod rig;
mod scene_unit;
mod yaml;

use std::collections::BTreeMap;

use schema::scene_info::LOG_STAGE;
use schema::table::Row;
use schema::tables::{BoxRow, TrackRow, ValidBoxRow};
use schema::{AgentId, AgentKind};
use serde_json::Value;
use store::keys;

pub use masks::Palette;
pub use options::{Options, State};

use self::agent_unit::{Holding, check_rate};
use self::rig::{Rigs, Voxels};
use crate::asked::by_option;
use crate::source::NO_MAP;
use crate::{Cost, ExportError, Layout, Omission, SceneSource, Source, UnitFiles, UnitName};

/// The layout with its options, for a store.
#[derive(Clone, Debug)]
pub struct SimBev2x {
    options: Options,
}

impl SimBev2x {
    /// With some options.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self { options }
    }

    fn is_processed(&self) -> bool {
        self.options.state == State::Processed
    }

    fn holding(&self, scene: &SceneSource, agent: AgentId, config: &Value) -> Result<Holding, ExportError> {
        Holding::of(scene, agent, &voxels_of(config, agent), self.is_processed())
    }
}

/// The resolved configuration of the store that a scene is in.
fn config_of(scene: &SceneSource) -> Result<Value, ExportError> {
    let store = scene.reader().store();
    let path = store.location(keys::DATASET);
    let bytes = store.read(keys::DATASET)?;
    let bytes = bytes.ok_or_else(|| ExportError::Refused(format!("{path}: is missing")))?;
    let mut dataset: Value =
        serde_json::from_slice(&bytes).map_err(|e| ExportError::Refused(format!("{path}: {e}")))?;
    Ok(dataset["config"].take())
}

/// Bounds of an agent's grids, as configured.
fn voxels_of(config: &Value, agent: AgentId) -> Voxels {
    let name = agent.to_string();
    let is_its = |own: &&Value| own["agents"].as_array().is_some_and(|all| all.iter().any(|a| *a == name));
    let own = config["own_rigs"].as_array().and_then(|all| all.iter().find(is_its));
    let kind = match agent.kind {
        AgentKind::Vehicle => &config["vehicle_occupancy"],
        AgentKind::Rsu => &config["rsu_occupancy"],
    };
    let settings = own.map_or(kind, |own| &own["occupancy"]);
    let usual = Voxels::default();
    let number = |key: &str, usual: f64| settings[key].as_f64().unwrap_or(usual);
    Voxels {
        range_m: number("range_m", usual.range_m),
        voxel_m: number("voxel_m", usual.voxel_m),
        upper_m: number("upper_m", usual.upper_m),
        lower_m: number("lower_m", usual.lower_m),
        mount_z_m: number("mount_z_m", usual.mount_z_m),
    }
}

/// Readers count agents from 0 until one is missing.
fn check_agents(scene: &SceneSource) -> Result<(), ExportError> {
    for kind in [AgentKind::Vehicle, AgentKind::Rsu] {
        let found = scene.agents().iter().filter(|agent| agent.kind == kind);
        if let Some((i, agent)) = (0..).zip(found).find(|(i, agent)| *i != agent.index) {
            let (number, word) = (scene.number(), names::word(kind));
            return Err(ExportError::Refused(format!(
                "scene {number}: readers of the layout count {word}s from 0 without gaps, and {agent} would stand in the place of \
                 {word}_{i}: choose the first ones with --agents"
            )));
        }
    }
    if scene.agents().iter().all(|agent| *agent != AgentId::vehicle(0)) {
        let number = scene.number();
        return Err(ExportError::Refused(format!(
            "scene {number}: readers of the layout want vehicle_0: choose it, too, with --agents"
        )));
    }
    Ok(())
}

/// What the layout has no place for, whatever the store holds.
const NO_PLACE: [(&str, &str); 4] = [
    ("intensity, ring, time, object and tag of lidar returns", "the layout has x, y, z"),
    ("cross-section, signal to noise, object and tag of radar returns", "the layout has four columns"),
    ("2-D boxes, visible pixels, occlusion and truncation", "the layout has no place for them"),
    (
        "tracks, sightings and forecasting windows",
        "the layout has no place for them; ids stay the same over a scene",
    ),
];
/// What is there in another way.
const ELSEWHERE: [(&str, &str); 1] =
    [("log tables by frame are in logs/", "as an archive that only Convoy reads")];

impl Layout for SimBev2x {
    fn name(&self) -> &'static str {
        "simbev2x"
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!(self.options)
    }

    fn by_option(&self) -> BTreeMap<String, String> {
        by_option(&self.options)
    }

    fn needs(&self) -> Vec<&'static str> {
        if self.is_processed() { vec![LOG_STAGE, ValidBoxRow::STAGE] } else { vec![LOG_STAGE] }
    }

    fn preflight(&self, source: &Source) -> Result<Vec<Omission>, ExportError> {
        let (mut rigs, mut omissions) = (Rigs::default(), Vec::new());
        for (what, why) in NO_PLACE {
            omissions.push(Omission::new(what, why));
        }
        for (what, how) in ELSEWHERE {
            omissions.push(Omission::note(what, how));
        }
        if source.selection.every_n_frames > 1 {
            let why =
                "frames are numbered anew, and sweeps between them are not there: timestamps tell the step";
            omissions.push(Omission::new("frames between", why));
        }
        for scene in &source.scenes {
            check_agents(scene)?;
            let who = format!("scene {}", scene.number());
            check_rate(scene, &who, "boxes", scene.info().label_every_n_frames)?;
            let config = config_of(scene)?;
            let mut lacks = BTreeMap::new();
            for agent in scene.agents() {
                let holding = self.holding(scene, *agent, &config)?;
                rigs.merge(&holding.rigs)?;
                omissions.extend(holding.omissions);
                for (what, missing) in [
                    ("sensors", holding.sensors.is_empty()),
                    ("voxel grids", !holding.grids.iter().any(|(name, _)| *name == names::VOXELS)),
                    ("masks", !holding.has_masks),
                ] {
                    if missing {
                        lacks.entry(what).or_insert_with(Vec::new).push(agent.to_string());
                    }
                }
            }
            if !scene.has_map()? {
                let what = format!("the picture of scene {} from above", scene.number());
                omissions.push(Omission::new(what, NO_MAP));
            }
            for (what, agents) in lacks {
                let what = format!("{what} of scene {} {}", scene.number(), agents.join(", "));
                omissions.push(Omission::new(what, "the store has none that fit, or they are not chosen"));
            }
        }
        omissions.sort();
        omissions.dedup();
        Ok(omissions)
    }

    fn units(&self, scene: &SceneSource) -> Vec<UnitName> {
        let number = scene.number();
        let agents = scene.agents().iter().map(|agent| Some(*agent));
        std::iter::once(None).chain(agents).map(|agent| UnitName { scene: number, agent }).collect()
    }

    fn cost(&self, scene: &SceneSource, unit: UnitName) -> Result<Cost, ExportError> {
        let share = f64::from(scene.frame_count()) / f64::from(scene.info().frames.max(1));
        match unit.agent {
            None => {
                let rows = |stage: &'static str, table: &str| {
                    let key = keys::scene(scene.number(), &format!("{table}.parquet"));
                    let output = scene.reader().manifest(stage).ok().and_then(|m| m.output(&key).cloned());
                    output.map_or(0.0, |output| output.rows as f64)
                };
                let raw = rows(BoxRow::STAGE, BoxRow::TABLE);
                let merged = if self.is_processed() { rows(TrackRow::STAGE, "tracks_frames") } else { 0.0 };
                let lists = if self.is_processed() { 2.0 } else { 1.0 };
                let bytes = share * (raw * lists + merged) * BYTES_A_BOX + FIXED_BYTES;
                let cpu_s = share * (raw * lists + merged) * S_A_BOX + FIXED_S;
                Ok(Cost { agent_frames: 0, bytes: bytes as u64, cpu_s })
            }
            Some(agent) => {
                let config = config_of(scene)?;
                let holding = self.holding(scene, agent, &config)?;
                let frames = f64::from(scene.frame_count());
                let (mut bytes, mut cpu_s) = (0.0, 0.0);
                for sensor in &holding.sensors {
                    let (grows, s_a_byte) = growth(sensor);
                    bytes += share * sensor.bytes as f64 * grows;
                    cpu_s += share * sensor.bytes as f64 * s_a_byte;
                }
                for (_, kind) in &holding.grids {
                    let key = keys::array(scene.number(), kind, agent);
                    let output = scene.reader().manifest(kind.stage)?.output(&key);
                    bytes += share * output.map_or(0.0, |output| output.bytes as f64);
                }
                bytes += frames * MASK_BYTES;
                cpu_s += frames * S_A_FRAME + bytes * S_A_BYTE;
                Ok(Cost { agent_frames: u64::from(scene.frame_count()), bytes: bytes as u64, cpu_s })
            }
        }
    }

    fn pieces(&self, scene: &SceneSource, unit: UnitName) -> u32 {
        // Of a scene its boxes, then the rest.
        if unit.agent.is_some() { agent_unit::pieces(scene) } else { 2 }
    }

    fn write_piece(
        &self,
        scene: &SceneSource,
        unit: UnitName,
        piece: u32,
        files: &mut UnitFiles<'_>,
    ) -> Result<Vec<u8>, ExportError> {
        let config = config_of(scene)?;
        // The first piece of an agent and the last one of a scene leave the facts.
        let fragment = match (unit.agent, piece) {
            (None, 0) => {
                scene_unit::write_boxes(scene, self.is_processed(), files)?;
                return Ok(Vec::new());
            }
            (None, _) => serde_json::to_vec(&scene_unit::write(scene, &config, files)?),
            (Some(agent), piece) => {
                let holding = self.holding(scene, agent, &config)?;
                agent_unit::write(scene, agent, (&holding, piece), self.options.palette, files)?;
                if piece > 0 {
                    return Ok(Vec::new());
                }
                serde_json::to_vec(&agent_unit::facts(scene, agent, &holding)?)
            }
        };
        fragment.map_err(|e| ExportError::Refused(format!("{unit}: its facts cannot be kept: {e}")))
    }

    fn finish(
        &self,
        _source: &Source,
        units: &[(UnitName, Vec<u8>)],
        files: &mut UnitFiles<'_>,
    ) -> Result<(), ExportError> {
        infos::write(&self.options, units, files)
    }
}

// Rates of the demo dataset, of one core (docs/performance.md).
/// A box in its pickle, and its share of the time.
const BYTES_A_BOX: f64 = 1200.0;
const S_A_BOX: f64 = 4e-6;
/// Log, configuration and picture of a scene.
const FIXED_BYTES: f64 = 4e6;
const FIXED_S: f64 = 2.0;
/// Masks with their picture, and the lane.
const MASK_BYTES: f64 = 45_000.0;
/// Opening and naming files, painting masks.
const S_A_FRAME: f64 = 0.008;
/// Copying.
const S_A_BYTE: f64 = 1e-9;

/// How much larger a sensor's files are than its table, and how long a byte of the table takes.
fn growth(sensor: &scene::SensorEntry) -> (f64, f64) {
    use scene::SensorKind::{Gnss, Image, Imu, Lidar, Radar, SemanticLidar};
    match sensor.kind {
        Image(schema::ImageKind::Flow) => (3.4, 6.5e-8),
        Image(_) => (1.0, 1e-9),
        Lidar => (0.88, 4e-9),
        SemanticLidar => (1.45, 6e-9),
        Radar => (0.7, 2e-8),
        Gnss | Imu => (3.0, 1e-8),
    }
}
