//! The records of all scenes, split by split.

use std::collections::BTreeMap;

use schema::AgentId;

use super::agent_unit::AgentFacts;
use super::names::{self, FILLED_VOXELS};
use super::options::{Options, State};
use super::pytext::{self, Node};
use super::rig::Rigs;
use super::scene_unit::{INFO_LEVEL, SceneFacts};
use crate::{ExportError, UnitFiles, UnitName};

/// Units of the layout's clock in a second.
const TICKS_PER_S: f64 = 1e7;

/// A scene of the destination.
struct Scene {
    number: u32,
    facts: SceneFacts,
    agents: Vec<(AgentId, AgentFacts)>,
}

/// Writes infos, folders and console logs.
pub(super) fn write(
    options: &Options,
    units: &[(UnitName, Vec<u8>)],
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let scenes = scenes_of(units)?;
    let mut rigs = Rigs::default();
    for (_, facts) in scenes.iter().flat_map(|scene| &scene.agents) {
        rigs.merge(&facts.rigs)?;
    }
    let metadata = rigs.metadata();
    let mut splits: Vec<&str> = scenes.iter().map(|scene| scene.facts.split.as_str()).collect();
    splits.sort_unstable();
    splits.dedup();
    for split in splits {
        let of_split: Vec<&Scene> = scenes.iter().filter(|scene| scene.facts.split == split).collect();
        let is_processed = options.state == State::Processed;
        write_split(options, &names::infos(split, ""), &of_split, &metadata, is_processed, files)?;
        if is_processed {
            write_split(options, &names::infos(split, "_unprocessed"), &of_split, &metadata, false, files)?;
        }
    }
    make_folders(options, &scenes, files)?;
    write_console(&scenes, files)
}

/// The scenes of which every unit is there.
fn scenes_of(units: &[(UnitName, Vec<u8>)]) -> Result<Vec<Scene>, ExportError> {
    let damaged = |unit: &UnitName, e: serde_json::Error| {
        ExportError::Refused(format!("what was kept of {unit} cannot be read ({e}): run again with --force"))
    };
    let mut facts: BTreeMap<u32, SceneFacts> = BTreeMap::new();
    let mut agents: BTreeMap<u32, Vec<(AgentId, AgentFacts)>> = BTreeMap::new();
    for (unit, fragment) in units {
        match unit.agent {
            None => {
                facts.insert(unit.scene, serde_json::from_slice(fragment).map_err(|e| damaged(unit, e))?);
            }
            Some(agent) => {
                let own = serde_json::from_slice(fragment).map_err(|e| damaged(unit, e))?;
                agents.entry(unit.scene).or_default().push((agent, own));
            }
        }
    }
    let mut scenes = Vec::new();
    for (number, facts) in facts {
        let agents = agents.remove(&number).unwrap_or_default();
        if agents.len() == facts.agents.len() {
            scenes.push(Scene { number, facts, agents });
        }
    }
    Ok(scenes)
}

fn write_split(
    options: &Options,
    name: &str,
    scenes: &[&Scene],
    metadata: &Node,
    is_combined: bool,
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let mut file = files.create(name)?;
    let mut text = String::from("{\n    \"metadata\": ");
    pytext::write(&mut text, metadata, 1);
    text.push_str(",\n    \"data\": {");
    for (i, scene) in scenes.iter().enumerate() {
        text.push_str(if i == 0 { "\n" } else { ",\n" });
        text.push_str(&format!(
            "        \"scene_{:04}\": {{\n            \"scene_info\": {{\n",
            scene.number
        ));
        text.push_str(&scene.facts.info);
        for (key, path, end) in
            [("log", names::log(scene.number), ",\n"), ("config", names::config(scene.number), "\n")]
        {
            pytext::indent(&mut text, INFO_LEVEL);
            pytext::quote(&mut text, key);
            text.push_str(": ");
            pytext::quote(&mut text, &options.path(&path));
            text.push_str(end);
        }
        text.push_str("            },\n            \"scene_data\": {");
        for (k, (agent, facts)) in scene.agents.iter().enumerate() {
            text.push_str(if k == 0 { "\n" } else { ",\n" });
            text.push_str(&format!("                \"{agent}\": ["));
            for (frame, place) in (0..).zip(&facts.frames) {
                text.push_str(if frame == 0 { "\n" } else { ",\n" });
                pytext::indent(&mut text, 5);
                let record = record(options, scene.number, frame, *agent, facts, place, is_combined)?;
                pytext::write(&mut text, &record, 5);
                file.write_all(text.as_bytes())?;
                text.clear();
            }
            text.push_str("\n                ]");
        }
        text.push_str("\n            }\n        }");
    }
    text.push_str("\n    }\n}");
    file.write_all(text.as_bytes())?;
    files.add(file)
}

/// The record of an agent's frame.
fn record(
    options: &Options,
    scene: u32,
    frame: u32,
    agent: AgentId,
    facts: &AgentFacts,
    place: &str,
    is_combined: bool,
) -> Result<Node, ExportError> {
    let numbers: Vec<f64> = place.split(' ').filter_map(|word| word.parse().ok()).collect();
    let &[time_s, x, y, z, a, b, c, d] = numbers.as_slice() else {
        return Err(ExportError::Refused(format!(
            "what was kept of scene {scene} {agent} cannot be read: run again with --force"
        )));
    };
    let mut entries = vec![
        ("ego2global_translation".to_owned(), Node::floats(&[x, y, z])),
        ("ego2global_rotation".to_owned(), Node::floats(&[a, b, c, d])),
        ("timestamp".to_owned(), Node::Int((time_s * TICKS_PER_S).round() as i128)),
    ];
    let mut say = |key: &str, path: String| entries.push((key.to_owned(), Node::Text(options.path(&path))));
    for sensor in &facts.sensors {
        say(sensor, names::sweep(scene, frame, agent, sensor));
    }
    // Stands there before there are such files, too.
    say(FILLED_VOXELS, names::sweep(scene, frame, agent, FILLED_VOXELS));
    if facts.has_masks {
        say("GT_SEG", names::masks(scene, frame, agent));
        say("GT_SEG_VIZ", names::mask_picture(scene, frame, agent));
    }
    say("GT_DET", names::boxes(scene, frame, agent));
    say("HD_MAP", names::lane(scene, frame, agent));
    entries.push(("scene".to_owned(), Node::from(scene)));
    entries.push(("frame".to_owned(), Node::from(frame)));
    if is_combined {
        let path = options.path(&names::combined(scene, frame));
        entries.push(("GT_DET_COMBINED".to_owned(), Node::Text(path)));
    }
    Ok(Node::Object(entries))
}

/// Folders for all agents that a scene of the dataset may have: readers count them.
fn make_folders(options: &Options, scenes: &[Scene], files: &mut UnitFiles<'_>) -> Result<(), ExportError> {
    let most = |k: usize| scenes.iter().map(|scene| scene.facts.most[k]).max().unwrap_or(0);
    let all = [("vehicle", most(0)), ("rsu", most(1))];
    for (word, index) in all.into_iter().flat_map(|(word, count)| (0..count).map(move |i| (word, i))) {
        for kind in ["det", "seg", "seg_viz", "hd_map"] {
            files.folder(&format!("simbev2x/ground-truth/{word}-{index}/{kind}"))?;
        }
        if options.state == State::Processed {
            files.folder(&format!("simbev2x/ground-truth/{word}-{index}/old_det"))?;
        }
        files.folder(&format!("simbev2x/sweeps/{word}-{index}"))?;
    }
    Ok(())
}

/// What the original's generator says as it goes; without its clock, as equal exports are of equal bytes.
fn write_console(scenes: &[Scene], files: &mut UnitFiles<'_>) -> Result<(), ExportError> {
    let mut text = String::new();
    for scene in scenes {
        let (number, split) = (scene.number, &scene.facts.split);
        let frames = scene.agents.first().map_or(0, |(_, facts)| facts.frames.len());
        let agents = scene.facts.agents.join(", ");
        text.push_str(&format!(
            "1970-01-01 00:00:00.000 | INFO     | scene {number:04} ({split}): {frames} frames of {agents}\n"
        ));
    }
    files.put("simbev2x/console_logs/SimBEV2X_19700101000000.log", text.as_bytes())?;
    files.put("simbev2x/console_logs/SimBEV2X_Errors_19700101000000.log", b"")
}
