//! The unit of a scene: boxes, lanes, configuration, log and the picture from above.

use std::collections::BTreeMap;

use codecs::{EncodedMember, NpzWriter};
use scene::BoxFrames;
use schema::scene_info::{LOG_STAGE, SceneInfo};
use schema::table::Row;
use schema::tables::{HdMapRow, PlanSceneRow, Weather};
use schema::{AgentId, AgentKind};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use store::{Scope, keys};

use super::detection::{Combined, SceneObjects, processed};
use super::lane::LaneNumbers;
use super::pickle::{Record, object_file};
use super::pytext::{self, Node};
use super::{names, overview, yaml};
use crate::{ExportError, SceneSource, UnitFiles};

/// What a unit leaves for the infos.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct SceneFacts {
    pub(super) split: String,
    /// The agents of the export, in order.
    pub(super) agents: Vec<String>,
    /// How many vehicles and RSUs a scene of the dataset may have.
    pub(super) most: [u32; 2],
    /// The entries of `scene_info` but for the last two, which are paths: as they stand in the file.
    pub(super) info: String,
}

/// How deep the entries of `scene_info` stand in the file.
pub(super) const INFO_LEVEL: usize = 4;

/// Writes the files of a scene but for its boxes.
pub(super) fn write(
    scene: &SceneSource,
    config: &Value,
    files: &mut UnitFiles<'_>,
) -> Result<SceneFacts, ExportError> {
    write_lanes(scene, files)?;
    let number = scene.number();
    files.put(&names::config(number), yaml::document(config).as_bytes())?;
    files.put(&names::log(number), &log(scene)?)?;
    let rows = scene.agent_rows()?;
    if let Some(first) = rows.first().and_then(|rows| rows.first())
        && scene.has_map()?
    {
        files.put(&names::overview(number), &overview::picture(scene, first)?)?;
    }
    let most = |kind: AgentKind| {
        let key = format!("/agents/max_{}s", names::word(kind));
        let planned = config.pointer(&key).and_then(Value::as_u64).unwrap_or(0) as u32;
        let here = scene.agents().iter().filter(|agent| agent.kind == kind);
        here.map(|agent| u32::from(agent.index) + 1).max().unwrap_or(0).max(planned)
    };
    let mut info = String::new();
    for (key, value) in info_entries(scene.info(), scene.agents()) {
        pytext::indent(&mut info, INFO_LEVEL);
        pytext::quote(&mut info, &key);
        info.push_str(": ");
        pytext::write(&mut info, &value, INFO_LEVEL);
        info.push_str(",\n");
    }
    Ok(SceneFacts {
        split: scene.info().split.clone(),
        agents: scene.agents().iter().map(AgentId::to_string).collect(),
        most: [most(AgentKind::Vehicle), most(AgentKind::Rsu)],
        info,
    })
}

/// Writes the boxes of a scene.
pub(super) fn write_boxes(
    scene: &SceneSource,
    is_processed: bool,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let number = scene.number();
    let cast = SceneObjects::new(scene.reader().rows()?);
    let mut boxes = BoxFrames::open_all(scene.reader(), is_processed)?;
    let names: Vec<String> = scene.agents().iter().map(AgentId::to_string).collect();
    for (to, from) in (0..).zip(scene.frames()) {
        let mut raw: Vec<Vec<Record>> = vec![Vec::new(); names.len()];
        let mut seen: Vec<Vec<Record>> = vec![Vec::new(); names.len()];
        let mut combined = Combined::default();
        for row in boxes.at(from)? {
            let Some(agent) = names.iter().position(|name| *name == row.raw.agent) else { continue };
            let record = cast.raw(&row.raw);
            if let Some(found) = &row.seen {
                combined.add(&record, found);
                seen[agent].push(processed(record.clone(), found));
            }
            raw[agent].push(record);
        }
        let file = |records: &[Record]| {
            object_file(records).map_err(|e| ExportError::Content {
                scene: number,
                frame: Some(from),
                agent: None,
                problem: format!("boxes: {e}"),
            })
        };
        for (i, agent) in scene.agents().iter().enumerate() {
            if is_processed {
                files.put(&names::boxes(number, to, *agent), &file(&seen[i])?)?;
                files.put(&names::old_boxes(number, to, *agent), &file(&raw[i])?)?;
            } else {
                files.put(&names::boxes(number, to, *agent), &file(&raw[i])?)?;
            }
        }
        if is_processed {
            files.put(&names::combined(number, to), &file(&combined.records())?)?;
        }
        files.advance(0)?;
    }
    Ok(())
}

fn write_lanes(scene: &SceneSource, files: &mut UnitFiles<'_>) -> Result<(), ExportError> {
    let (number, reader) = (scene.number(), scene.reader());
    let numbers = match reader.store().manifest(Scope::Plan, PlanSceneRow::STAGE)? {
        Some(plan) if plan.output(&keys::vector_map(&scene.info().map)).is_some() => {
            LaneNumbers::new(reader.store().read_rows(&plan, &keys::vector_map(&scene.info().map))?)
        }
        _ => LaneNumbers::default(),
    };
    let rows: Vec<HdMapRow> = reader.rows()?;
    let by_place: BTreeMap<(u32, &str), &HdMapRow> =
        rows.iter().map(|row| ((row.frame, row.agent.as_str()), row)).collect();
    for agent in scene.agents() {
        let name = agent.to_string();
        for (to, from) in (0..).zip(scene.frames()) {
            let Some(row) = by_place.get(&(from, name.as_str())) else {
                let problem = "has no record of its lane".to_owned();
                let (frame, agent) = (Some(from), Some(name));
                return Err(ExportError::Content { scene: number, frame, agent, problem });
            };
            let mut text = String::new();
            pytext::write(&mut text, &numbers.record(row), 0);
            files.put(&names::lane(number, to, *agent), text.as_bytes())?;
        }
    }
    Ok(())
}

/// The scene's own log: its tables and `scene.json`, one archive.
fn log(scene: &SceneSource) -> Result<Vec<u8>, ExportError> {
    let (reader, number) = (scene.reader(), scene.number());
    let folder = keys::scene(number, "log/");
    let wrong = |e: codecs::NpzError| ExportError::Content {
        scene: number,
        frame: None,
        agent: None,
        problem: format!("its log cannot be put together: {e}"),
    };
    let mut archive = NpzWriter::new(Vec::new());
    for output in &reader.manifest(LOG_STAGE)?.outputs {
        let Some(name) = output.key.strip_prefix(&folder) else { continue };
        let bytes = reader.store().read(&output.key)?.ok_or_else(|| {
            let path = reader.store().location(&output.key);
            store::StoreError::Missing { path }
        })?;
        let member = EncodedMember::stored(name, bytes).map_err(wrong)?;
        archive.append(member).map_err(wrong)?;
    }
    archive.finish().map_err(wrong)
}

/// The facts of a scene but for the paths.
fn info_entries(info: &SceneInfo, agents: &[AgentId]) -> Vec<(String, Node)> {
    let weather = |ours: &BTreeMap<String, f64>| {
        Node::object(
            Weather::PUBLISHED_NAMES
                .map(|(name, own)| (name, Node::Float(ours.get(own).copied().unwrap_or_default()))),
        )
    };
    let mut entries = vec![("map".to_owned(), Node::text(&info.map))];
    for agent in agents {
        let name = agent.to_string();
        let facts = match agent.kind {
            AgentKind::Vehicle => {
                let found = info.agents.iter().find(|facts| facts.agent == name);
                Node::object([
                    ("vehicle", Node::text(found.map_or(String::new(), |f| format!("vehicle.{}", f.model)))),
                    ("reckless_ego", Node::from(found.is_some_and(|f| f.reckless))),
                    ("distracted_ego", Node::from(found.is_some_and(|f| f.distracted))),
                ])
            }
            AgentKind::Rsu => Node::object::<&str>([]),
        };
        entries.push((name, facts));
    }
    let mut say = |key: &str, value: Node| entries.push((key.to_owned(), value));
    say("scene_duration", Node::Int(info.duration_s.round() as i128));
    say("seed", Node::Int(i128::from(info.seed)));
    if info.dynamic_weather {
        say("dynamic_weather", Node::from(true));
    }
    say("initial_weather_parameters", weather(&info.initial_weather));
    if info.dynamic_weather {
        say("final_weather_parameters", weather(&info.final_weather));
    }
    say("street_light_intensity_change", Node::Float(info.street_light_intensity_change_lm));
    for (key, on) in
        [("building_lights_on", info.building_lights_on), ("street_lights_on", info.street_lights_on)]
    {
        if let Some(on) = on {
            say(key, Node::from(on));
        }
    }
    say("n_accident_hazards", Node::from(info.n_accident_hazards));
    say("n_road_work_hazards", Node::from(info.n_road_work_hazards));
    say("n_reckless_vehicles", Node::from(info.n_reckless_vehicles));
    say("n_distracted_vehicles", Node::from(info.n_distracted_vehicles));
    say(
        "traffic_parameters",
        Node::object([
            // A share here, percent there.
            ("speed_difference", Node::from(info.speed_difference.map(|share| 100.0 * share))),
            ("distance_to_leading", Node::from(info.standstill_gap_m)),
            ("green_time", Node::from(info.green_time_s)),
            ("walker_cross_factor", Node::Float(info.walker_cross_factor)),
        ]),
    );
    say("n_vehicles", Node::from(info.n_vehicles));
    say("n_walkers", Node::from(info.n_walkers));
    entries
}
