//! The tables of boxes, agents and lanes, and those of the log: what the lists say.

use std::collections::BTreeMap;

use frames::{Object, Pose, World};
use rayon::prelude::*;
use schema::measures::counts::PartialCounts;
use schema::measures::simulation::AGENT_FRAMES;
use schema::scene_info::{LOG_STAGE, SCENE_FILE};
use schema::table::Row;
use schema::tables::{
    ActorRow, AgentRow, BoxRow, FrameRow, HdMapRow, LampRow, SignalRow, StateRow, VISIBLE_TABLE, ValidBoxRow,
    VisibleRow,
};
use schema::{AgentId, FRAME_PERIOD_S};
use store::{Scope, TableOptions, TableWriter, Unit, keys};

use crate::cast::{BATCH, SceneObjects, read_boxes};
use crate::error::{ImportError, SourceFault};
use crate::names::LANES;
use crate::record::Labelled;
use crate::work::Work;
use crate::{facts, json, lanes};

/// Most bytes of the record of a lane.
const MAX_LANE_BYTES: u64 = 1 << 20;

/// What is read of a frame: by agent its boxes, and its lane where there is one.
struct FrameLabels {
    boxes: Vec<Vec<Labelled>>,
    lanes: Vec<HdMapRow>,
}

/// Tables that grow frame by frame.
struct Tables {
    boxes: TableWriter<BoxRow>,
    agents: TableWriter<AgentRow>,
    lanes: TableWriter<HdMapRow>,
    states: TableWriter<StateRow>,
    signals: TableWriter<SignalRow>,
}

/// Writes boxes, agents, lanes and log into a unit.
pub(crate) fn write_log(work: &Work<'_>, unit: &mut Unit<'_>) -> Result<(), ImportError> {
    let mut tables = Tables {
        boxes: open(work, unit)?,
        agents: open(work, unit)?,
        lanes: open(work, unit)?,
        states: open(work, unit)?,
        signals: open(work, unit)?,
    };
    let frames: Vec<u32> = (0..work.scene.frames()).collect();
    for batch in frames.chunks(BATCH) {
        let read: Vec<Result<FrameLabels, ImportError>> =
            batch.par_iter().map(|&frame| read_frame(work, frame)).collect();
        for (&frame, labels) in batch.iter().zip(read) {
            tables.push(work, frame, &labels?)?;
        }
        work.advance(0)?;
    }
    let Tables { boxes, agents, lanes, states, signals } = tables;
    for shard in [boxes.finish()?, agents.finish()?, lanes.finish()?, states.finish()?, signals.finish()?] {
        unit.add(shard);
    }
    write_facts(work, unit)
}

fn open<R: Row>(work: &Work<'_>, unit: &Unit<'_>) -> Result<TableWriter<R>, ImportError> {
    Ok(unit.table(&key::<R>(work), TableOptions::default())?)
}

fn key<R: Row>(work: &Work<'_>) -> String {
    keys::table::<R>(work.order.entry.number)
}

/// What is said once of a scene.
fn write_facts(work: &Work<'_>, unit: &mut Unit<'_>) -> Result<(), ImportError> {
    let number = work.order.entry.number;
    let wrong = |problem: SourceFault| ImportError::source(work.order.entry.path(), problem);
    let info = facts::scene_info(work.order.entry, work.scene, Some(work.cast)).map_err(wrong)?;
    unit.rows::<ActorRow>(&key::<ActorRow>(work), &work.cast.actors(work.scene))?;
    unit.rows::<FrameRow>(&key::<FrameRow>(work), &facts::frame_rows(&info))?;
    // Lamps and windows are not told.
    unit.rows::<LampRow>(&key::<LampRow>(work), &[])?;
    let mut said = serde_json::to_value(&info).map_err(|e| wrong(SourceFault::Content(e.to_string())))?;
    said["imported"] = true.into();
    let text = serde_json::to_vec_pretty(&said).map_err(|e| wrong(SourceFault::Content(e.to_string())))?;
    unit.bytes(&keys::scene(number, SCENE_FILE), &text, 1)?;
    let mut counts = PartialCounts::new();
    for (agent, records) in &work.scene.agents {
        counts.add(&agent.to_string(), AGENT_FRAMES, "", 0, records.len() as u64);
    }
    unit.rows(&keys::partial_stats(number, LOG_STAGE), &counts.rows())?;
    Ok(())
}

fn read_frame(work: &Work<'_>, frame: u32) -> Result<FrameLabels, ImportError> {
    let mut found = FrameLabels { boxes: Vec::new(), lanes: Vec::new() };
    for (position, (agent, records)) in work.scene.agents.iter().enumerate() {
        let at = frame as usize;
        found.boxes.push(read_boxes(work.order.folder, work.scene, (position, at), work.order.is_processed)?);
        let record = &records[at];
        let Some(said) = record.files.get(LANES) else { continue };
        let place = |e: ImportError| e.within(format!("{agent} frame {frame}"));
        let (path, bytes) = work.order.folder.read(said, MAX_LANE_BYTES).map_err(place)?;
        let value = json::parse(&bytes).map_err(SourceFault::from);
        let row = value.and_then(|value| lanes::row(&value, (frame, &agent.to_string()), record.xyz_m));
        found.lanes.push(row.map_err(|problem| place(ImportError::source(&path, problem)))?);
    }
    Ok(found)
}

impl Tables {
    fn push(&mut self, work: &Work<'_>, frame: u32, labels: &FrameLabels) -> Result<(), ImportError> {
        let mut states: BTreeMap<u16, StateRow> = BTreeMap::new();
        let mut signals: BTreeMap<u16, SignalRow> = BTreeMap::new();
        let (mut boxes, mut agents) = (Vec::new(), Vec::new());
        for (position, (agent, list)) in
            work.scene.agents.iter().map(|(agent, _)| *agent).zip(&labels.boxes).enumerate()
        {
            agents.push(agent_row(work, position, frame, list));
            for labelled in list {
                let id = work.cast.id(labelled.id);
                boxes.push(box_row(frame, agent, id, labelled));
                if !SceneObjects::is_fixed(labelled) {
                    states.entry(id).or_insert_with(|| state_row(frame, id, labelled));
                }
                if let Some(state) = labelled.signal_state {
                    let opendrive_id = labelled.opendrive_id.clone().unwrap_or_default();
                    signals.entry(id).or_insert(SignalRow { frame: frame as i32, id, state, opendrive_id });
                }
            }
        }
        self.boxes.push(&boxes)?;
        self.agents.push(&agents)?;
        self.lanes.push(&labels.lanes)?;
        self.states.push(&states.into_values().collect::<Vec<_>>())?;
        self.signals.push(&signals.into_values().collect::<Vec<_>>())?;
        Ok(())
    }
}

/// Where an agent is; how it moves says its own box.
fn agent_row(work: &Work<'_>, position: usize, frame: u32, list: &[Labelled]) -> AgentRow {
    let (agent, records) = &work.scene.agents[position];
    let (id, record) = (work.cast.agent_ids[position], &records[frame as usize]);
    let own = list.iter().find(|labelled| work.cast.id(labelled.id) == id);
    AgentRow {
        frame,
        time_s: f64::from(frame) * FRAME_PERIOD_S,
        agent: agent.to_string(),
        id,
        xyz_m: record.xyz_m,
        quaternion: record.quaternion,
        velocity_mps: own.map_or([0.0; 3], |own| own.velocity_mps.map(f64::from)),
        angular_velocity_radps: own.map_or([0.0; 3], |own| own.angular_velocity_radps.map(f64::from)),
    }
}

fn box_row(frame: u32, agent: AgentId, id: u16, labelled: &Labelled) -> BoxRow {
    BoxRow {
        frame,
        agent: agent.to_string(),
        id,
        is_ego: labelled.angle_rad.is_none(),
        class: labelled.class.name().to_owned(),
        model: labelled.model.clone(),
        semantic_tags: labelled.tags.clone(),
        corners_m: labelled.corners_m,
        center_m: labelled.center_m(),
        size_m: labelled.size_m(),
        rpy_rad: labelled.rpy_rad,
        velocity_mps: labelled.velocity_mps,
        angular_velocity_radps: labelled.angular_velocity_radps,
        distance_m: labelled.distance_m,
        angle_rad: labelled.angle_rad,
        signal_state: labelled.signal_state,
        is_alive: labelled.is_alive,
        is_active: labelled.is_active,
        is_dormant: labelled.is_dormant,
        opendrive_id: labelled.opendrive_id.clone(),
        attributes: labelled.attributes.clone(),
    }
}

fn state_row(frame: u32, id: u16, labelled: &Labelled) -> StateRow {
    let pose = Pose::<World, Object>::from_xyz_rpy(labelled.foot_m(), labelled.rpy_rad);
    StateRow {
        frame: frame as i32,
        id,
        xyz_m: labelled.foot_m(),
        quaternion: pose.wxyz(),
        velocity_mps: labelled.velocity_mps,
        angular_velocity_radps: labelled.angular_velocity_radps,
        dormant: labelled.is_dormant,
        ..StateRow::default()
    }
}

/// Pixels of each object and tag, by agent and frame.
type PixelCounts = BTreeMap<(usize, u32), BTreeMap<(u16, u8), u32>>;

/// Writes what sensors saw of each box into a unit. The pixels are those of instance images that stand in the
/// store by now.
pub(crate) fn write_valid(work: &Work<'_>, unit: &mut Unit<'_>) -> Result<(), ImportError> {
    let pixels = pixels(work)?;
    let mut table: TableWriter<ValidBoxRow> = open(work, unit)?;
    let frames: Vec<u32> = (0..work.scene.frames()).collect();
    for batch in frames.chunks(BATCH) {
        let rows: Vec<Result<Vec<ValidBoxRow>, ImportError>> =
            batch.par_iter().map(|&frame| valid_rows(work, frame, &pixels)).collect();
        for rows in rows {
            table.push(&rows?)?;
        }
        work.advance(0)?;
    }
    unit.add(table.finish()?);
    Ok(())
}

fn pixels(work: &Work<'_>) -> Result<PixelCounts, ImportError> {
    let mut seen = PixelCounts::new();
    let Some(manifest) =
        work.order.store.manifest(Scope::Scene(work.order.entry.number), VisibleRow::STAGE)?
    else {
        return Ok(seen);
    };
    for (position, (agent, _)) in work.scene.agents.iter().enumerate() {
        let key = keys::sensor(work.order.entry.number, *agent, VISIBLE_TABLE);
        if manifest.output(&key).is_none() {
            continue;
        }
        for row in work.order.store.read_rows::<VisibleRow>(&manifest, &key)? {
            *seen.entry((position, row.frame)).or_default().entry((row.id, row.tag)).or_default() +=
                row.pixels;
        }
    }
    Ok(seen)
}

fn valid_rows(work: &Work<'_>, frame: u32, pixels: &PixelCounts) -> Result<Vec<ValidBoxRow>, ImportError> {
    let mut rows = Vec::new();
    for (position, (agent, _)) in work.scene.agents.iter().enumerate() {
        let shown = pixels.get(&(position, frame));
        for labelled in read_boxes(work.order.folder, work.scene, (position, frame as usize), true)? {
            let id = work.cast.id(labelled.id);
            let of_tag = |tag: &u8| shown.and_then(|shown| shown.get(&(id, *tag))).copied().unwrap_or(0);
            let mut tags = labelled.tags.clone();
            tags.sort_unstable();
            tags.dedup();
            let row = box_row(frame, *agent, id, &labelled);
            let Some(seen) = labelled.seen else { continue };
            rows.push(ValidBoxRow {
                frame,
                agent: row.agent,
                id,
                is_ego: row.is_ego,
                class: row.class,
                num_lidar_pts: seen.num_lidar_pts,
                num_radar_pts: seen.num_radar_pts,
                valid_flag: seen.valid_flag,
                difficulty: seen.difficulty,
                num_pixels: tags.iter().map(of_tag).sum(),
                corners_m: row.corners_m,
                velocity_mps: row.velocity_mps,
                distance_m: row.distance_m,
                angle_rad: row.angle_rad,
            });
        }
    }
    Ok(rows)
}
