//! Facts about a scene: `scene_info` of infos.

use std::collections::BTreeMap;

use frames::{Agent, Pose, World};
use schema::AgentKind;
use schema::scene_info::{AgentInfo, SceneInfo};
use schema::tables::{FrameRow, Weather};

use crate::cast::SceneObjects;
use crate::error::SourceFault;
use crate::infos::{Entry, Scene};
use crate::value::Value;

/// The facts of a scene as a store has them, its agents where its objects are known. What the layout does not
/// say is empty or 0.
///
/// # Errors
/// Weather or map are missing.
pub(crate) fn scene_info(
    entry: &Entry,
    scene: &Scene,
    cast: Option<&SceneObjects>,
) -> Result<SceneInfo, SourceFault> {
    let info = &scene.info;
    let count = |key: &str| info.get(key).and_then(Value::whole::<u32>).unwrap_or(0);
    let number = |of: &Value, key: &str| of.get(key).and_then(Value::number).filter(|v| v.is_finite());
    let map = info.get("map").and_then(Value::text).ok_or("scene_info: has no `map`")?;
    let initial = weather(info, "initial_weather_parameters")?;
    let dynamic_weather = info.get("dynamic_weather").and_then(Value::flag).unwrap_or(false);
    let last = if dynamic_weather { weather(info, "final_weather_parameters")? } else { initial };
    let traffic = info.get("traffic_parameters").cloned().unwrap_or(Value::None);
    let named = |weather: Weather| {
        let values = Weather::NAMES.iter().map(|name| (*name).to_owned()).zip(weather.to_array());
        values.collect::<BTreeMap<_, _>>()
    };
    let frames = scene.frames();
    let pivot = scene.agents.first().map_or([0.0; 3], |(_, records)| records[0].xyz_m);
    Ok(SceneInfo {
        scene: entry.number,
        split: entry.split.name().to_owned(),
        map: map.to_owned(),
        seed: info.get("seed").and_then(Value::whole).unwrap_or(0),
        duration_s: f64::from(frames) * schema::FRAME_PERIOD_S,
        frames,
        label_every_n_frames: 1,
        dynamic_weather,
        initial_weather: named(initial),
        final_weather: named(last),
        pivot_xyz_m: pivot,
        street_light_intensity_change_lm: number(info, "street_light_intensity_change").unwrap_or(0.0),
        street_lights_on: info.get("street_lights_on").and_then(Value::flag),
        building_lights_on: info.get("building_lights_on").and_then(Value::flag),
        agents: cast.map(|cast| agents(scene, cast)).unwrap_or_default(),
        n_vehicles: count("n_vehicles"),
        n_walkers: count("n_walkers"),
        n_accident_hazards: count("n_accident_hazards"),
        n_road_work_hazards: count("n_road_work_hazards"),
        n_hazard_attempts: count("n_accident_hazards").saturating_add(count("n_road_work_hazards")),
        n_reckless_vehicles: count("n_reckless_vehicles"),
        n_distracted_vehicles: count("n_distracted_vehicles"),
        walker_cross_factor: number(&traffic, "walker_cross_factor").unwrap_or(0.0),
        // Percent there, a share here.
        speed_difference: number(&traffic, "speed_difference").map(|percent| percent / 100.0),
        standstill_gap_m: number(&traffic, "distance_to_leading"),
        green_time_s: number(&traffic, "green_time"),
        ..SceneInfo::default()
    })
}

/// The weather; parameters that the layout has not are as on a clear noon.
fn weather(info: &Value, key: &str) -> Result<Weather, SourceFault> {
    let said = info.get(key).ok_or_else(|| format!("scene_info: has no `{key}`"))?;
    let mut values = Weather::default().to_array();
    for (name, own) in Weather::PUBLISHED_NAMES {
        let value = said.get(name).and_then(Value::number).filter(|v| v.is_finite());
        let value = value.ok_or_else(|| format!("scene_info: `{key}` has no number `{name}`"))?;
        if let Some(place) = Weather::NAMES.iter().position(|known| *known == own) {
            values[place] = value;
        }
    }
    Ok(Weather::from_array(values))
}

fn agents(scene: &Scene, cast: &SceneObjects) -> Vec<AgentInfo> {
    let info = |(position, (agent, records)): (usize, &(schema::AgentId, Vec<crate::infos::Record>))| {
        let said = scene.info.get(&agent.to_string());
        let flag = |key: &str| said.and_then(|said| said.get(key)).and_then(Value::flag).unwrap_or(false);
        let (model, color) = cast.body(position).unwrap_or_default();
        let told = said.and_then(|said| said.get("vehicle")).and_then(Value::text).unwrap_or_default();
        let told = told.strip_prefix("vehicle.").unwrap_or(told);
        let pose = Pose::<World, Agent>::from_xyz_wxyz(records[0].xyz_m, records[0].quaternion);
        AgentInfo {
            agent: agent.to_string(),
            id: cast.agent_ids[position],
            model: if agent.kind == AgentKind::Rsu || model.is_empty() { told } else { model }.to_owned(),
            color: color.to_vec(),
            start_xyz_m: records[0].xyz_m,
            start_rpy_rad: pose.rpy(),
            reckless: flag("reckless_ego"),
            distracted: flag("distracted_ego"),
            ..AgentInfo::default()
        }
    };
    scene.agents.iter().enumerate().map(info).collect()
}

/// Time and weather by frame: the weather moves evenly, and is the last one at the last frame.
pub(crate) fn frame_rows(info: &SceneInfo) -> Vec<FrameRow> {
    let of =
        |named: &BTreeMap<String, f64>| Weather::NAMES.map(|name| named.get(name).copied().unwrap_or(0.0));
    let (first, last) = (of(&info.initial_weather), of(&info.final_weather));
    let row = |frame: u32| {
        let share = f64::from(frame + 1) / f64::from(info.frames.max(1));
        let now = std::array::from_fn(|i| first[i] + (last[i] - first[i]) * share);
        let lights = (info.street_lights_on.unwrap_or(false), info.building_lights_on.unwrap_or(false));
        FrameRow::new(frame, &Weather::from_array(now), lights.0, lights.1)
    };
    (0..info.frames).map(row).collect()
}
