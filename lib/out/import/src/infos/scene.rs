//! A scene's part of the infos.

use std::collections::BTreeMap;

use schema::{AgentId, AgentKind};

use crate::error::SourceFault;
use crate::value::Value;

/// Most frames of a scene, and most agents.
const MAX_FRAMES: usize = 1_000_000;
const MAX_AGENTS: usize = 1000;
/// Units of the layout's clock in a frame's period, 0.05 s.
const TICKS_PER_FRAME: i128 = 500_000;

/// What infos say of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// `scene_info`: facts about it.
    pub info: Value,
    /// The agents, vehicles first, each with its records by frame.
    pub agents: Vec<(AgentId, Vec<Record>)>,
}

/// What infos say of an agent at a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Where it is in the world, m.
    pub xyz_m: [f64; 3],
    /// Its orientation, w, x, y, z.
    pub quaternion: [f64; 4],
    /// Its files, by their keys.
    pub files: BTreeMap<String, String>,
}

impl Scene {
    /// Of a scene's part.
    ///
    /// # Errors
    /// What is missing or out of order, with agent and frame.
    pub fn of(part: Value, number: u32) -> Result<Self, SourceFault> {
        let Value::Dict(entries) = part else { return Err("is no object".into()) };
        let (mut info, mut data) = (None, None);
        for (key, value) in entries {
            match key.as_str() {
                "scene_info" => info = Some(value),
                "scene_data" => data = Some(value),
                _ => {}
            }
        }
        let info = info.filter(|info| matches!(info, Value::Dict(_))).ok_or("has no `scene_info`")?;
        let Some(Value::Dict(lists)) = data else { return Err("has no `scene_data`".into()) };
        if lists.len() > MAX_AGENTS {
            return Err(format!("has {} agents, at most {MAX_AGENTS} are possible", lists.len()).into());
        }
        let mut agents = Vec::with_capacity(lists.len());
        for (name, list) in lists {
            let agent: AgentId = name.parse().map_err(|e| format!("scene_data: {e}"))?;
            let Value::List(items) = list else {
                return Err(format!("{agent}: is no list of frames").into());
            };
            if items.is_empty() || items.len() > MAX_FRAMES {
                return Err(format!("{agent}: has {} frames", items.len()).into());
            }
            agents.push((agent, records(items, number).map_err(|fault| fault.at(agent))?));
        }
        agents.sort_by_key(|(agent, _)| *agent);
        check_agents(&agents)?;
        Ok(Self { info, agents })
    }

    /// How many frames it has.
    #[must_use]
    pub fn frames(&self) -> u32 {
        self.agents.first().map_or(0, |(_, records)| records.len() as u32)
    }
}

/// The records of an agent: scene and frame as they are counted, one after another, and each with the files
/// of the first.
fn records(items: Vec<Value>, scene: u32) -> Result<Vec<Record>, SourceFault> {
    let mut found: Vec<Record> = Vec::with_capacity(items.len());
    let mut times = Vec::with_capacity(items.len());
    for (frame, item) in items.into_iter().enumerate() {
        times.push(item.get("timestamp").and_then(Value::whole::<i128>));
        let record = record(item, scene, frame).map_err(|fault| fault.at(format_args!("frame {frame}")))?;
        if let Some(first) = found.first()
            && !first.files.keys().eq(record.files.keys())
        {
            let unlike = first.files.keys().find(|key| !record.files.contains_key(*key));
            let unlike = unlike.or_else(|| record.files.keys().find(|key| !first.files.contains_key(*key)));
            let key = unlike.map_or("", String::as_str);
            return Err(
                format!("frame {frame}: `{key}` is not in all frames, and a store has all or none").into()
            );
        }
        found.push(record);
    }
    check_step(&times)?;
    Ok(found)
}

/// Datasets of the original have clocks of their own. Where all times are those of every n-th frame, frames
/// are missing between.
fn check_step(times: &[Option<i128>]) -> Result<(), SourceFault> {
    let &[Some(0), Some(second), ..] = times else { return Ok(()) };
    let is_even = times.iter().zip(0..).all(|(time, k): (_, i128)| *time == Some(k * second));
    if is_even && second > TICKS_PER_FRAME && second % TICKS_PER_FRAME == 0 {
        let step = second / TICKS_PER_FRAME;
        return Err(format!(
            "its timestamps are those of every {step}. frame of 20 a second, and poses of a store are there at each of them: \
             export all frames"
        ).into());
    }
    Ok(())
}

fn record(item: Value, scene: u32, frame: usize) -> Result<Record, SourceFault> {
    let Value::Dict(entries) = item else { return Err("is no object".into()) };
    let (mut xyz_m, mut quaternion, mut files) = (None, None, BTreeMap::new());
    for (key, value) in entries {
        match (key.as_str(), value) {
            ("ego2global_translation", value) => xyz_m = value.numbers::<3>(),
            ("ego2global_rotation", value) => quaternion = value.numbers::<4>(),
            ("scene", value) if value.whole::<u32>() != Some(scene) => {
                return Err(format!("says that it is of another scene than {scene}").into());
            }
            ("frame", value) if value.whole::<usize>() != Some(frame) => {
                return Err("says that it is another frame".into());
            }
            (_, Value::Text(path)) => {
                files.insert(key, path);
            }
            (_, Value::List(paths)) => match paths.as_slice() {
                [Value::Text(path)] => {
                    files.insert(key, path.clone());
                }
                [Value::Text(_), ..] => {
                    return Err(format!("`{key}` has several files, and a store has one").into());
                }
                _ => {}
            },
            _ => {}
        }
    }
    let is_finite = |numbers: &[f64]| numbers.iter().all(|v| v.is_finite());
    let xyz_m = xyz_m.filter(|v| is_finite(v)).ok_or("has no `ego2global_translation` of three numbers")?;
    let quaternion = quaternion.filter(|q: &[f64; 4]| {
        let norm2: f64 = q.iter().map(|v| v * v).sum();
        is_finite(q) && (norm2 - 1.0).abs() < 1e-2
    });
    let quaternion = quaternion.ok_or("has no `ego2global_rotation` of four numbers and length 1")?;
    Ok(Record { xyz_m, quaternion, files })
}

/// Readers count agents from 0, all have the same frames, and `vehicle_0` is one.
fn check_agents(agents: &[(AgentId, Vec<Record>)]) -> Result<(), SourceFault> {
    let frames = agents.first().map_or(0, |(_, records)| records.len());
    let mut next = [0_u16; 2];
    for (agent, records) in agents {
        if records.len() != frames {
            return Err(format!("{agent}: has {} frames, others have {frames}", records.len()).into());
        }
        let place = &mut next[usize::from(agent.kind == AgentKind::Rsu)];
        if agent.index != *place {
            return Err(
                format!("{agent}: is there, and the one before it is not, or it is there twice").into()
            );
        }
        *place += 1;
    }
    if next[0] == 0 { Err("has no vehicle_0".into()) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json;

    fn frame(scene: u32, frame: u32, more: &str) -> String {
        let ticks = 500_000 * frame;
        format!(
            r#"{{"ego2global_translation": [1.5, 2, 3], "ego2global_rotation": [1.0, 0.0, 0.0, 0.0], "timestamp": {ticks},
            "LIDAR": "/d/simbev2x/l{frame}", "scene": {scene}, "frame": {frame}{more}}}"#
        )
    }

    fn scene(data: &str) -> Result<Scene, String> {
        let text = format!(r#"{{"scene_info": {{"map": "Town01"}}, "scene_data": {{{data}}}}}"#);
        Scene::of(json::parse(text.as_bytes()).expect("JSON"), 7).map_err(|fault| fault.to_string())
    }

    #[test]
    fn agents_and_frames_are_in_order() {
        let list = format!("[{}, {}]", frame(7, 0, ""), frame(7, 1, ""));
        let found =
            scene(&format!(r#""rsu_0": {list}, "vehicle_1": {list}, "vehicle_0": {list}"#)).expect("a scene");
        let names: Vec<String> = found.agents.iter().map(|(agent, _)| agent.to_string()).collect();
        assert_eq!(names, ["vehicle_0", "vehicle_1", "rsu_0"]);
        assert_eq!((found.frames(), found.agents[0].1[1].xyz_m), (2, [1.5, 2.0, 3.0]));
        assert_eq!(found.agents[0].1[1].files["LIDAR"], "/d/simbev2x/l1");
    }

    #[test]
    fn what_is_out_of_order_is_named() {
        let one = frame(7, 0, "");
        let nan = one.replace("1.5", "NaN");
        let zero = one.replace("[1.0, 0.0", "[0.0, 0.0");
        let thin = format!("{one}, {}", frame(7, 1, "").replace("500000", "2500000"));
        for (data, want) in [
            (
                format!(r#""vehicle_0": [{}]"#, frame(8, 0, "")),
                "vehicle_0: frame 0: says that it is of another scene than 7",
            ),
            (
                format!(r#""vehicle_0": [{}]"#, frame(7, 1, "")),
                "vehicle_0: frame 0: says that it is another frame",
            ),
            (format!(r#""vehicle_1": [{one}]"#), "vehicle_1: is there, and the one before it is not"),
            (format!(r#""rsu_0": [{one}]"#), "has no vehicle_0"),
            (
                format!(r#""vehicle_0": [{one}], "vehicle_1": [{one}, {}]"#, frame(7, 1, "")),
                "vehicle_1: has 2 frames, others have 1",
            ),
            (
                format!(r#""vehicle_0": [{one}, {}]"#, frame(7, 1, r#", "IMU": "simbev2x/i""#)),
                "frame 1: `IMU` is not in all frames",
            ),
            (format!(r#""vehicle_0": [{nan}]"#), "has no `ego2global_translation`"),
            (format!(r#""vehicle_0": [{zero}]"#), "has no `ego2global_rotation`"),
            (r#""vehicle_0": []"#.into(), "vehicle_0: has 0 frames"),
            (r#""bicycle_0": []"#.into(), "`bicycle_0` is no agent name"),
            (format!(r#""vehicle_0": [{thin}]"#), "those of every 5. frame"),
        ] {
            let error = scene(&data).expect_err("refused");
            assert!(error.contains(want), "{error}");
        }
    }
}
