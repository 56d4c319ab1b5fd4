//! `log/scene.json`.

use std::collections::BTreeMap;

use opendrive::Map;
use runner::{At, Place, StageError};
use schema::scene_info::{AgentInfo, PackedModelInfo, SceneInfo, WeatherKeyframeInfo};
use schema::tables::{ActorRow, PlanAgentRow, PlanModelRow, PlanSceneRow, PlanWeatherRow, Weather};
use schema::{ActorRole, HazardKind};
use settings::stages::SimulationSettings;
use traffic::SimulationLog;

use crate::error::LogError;

/// Facts about a simulated scene.
///
/// # Errors
/// An agent of the plan was not simulated.
pub(crate) fn scene_info(
    (plan, between): (&PlanSceneRow, &[PlanWeatherRow]),
    agents: &[PlanAgentRow],
    log: &SimulationLog,
    map: &Map,
    settings: &SimulationSettings,
) -> Result<SceneInfo, StageError> {
    let agents = agents
        .iter()
        .map(|agent| {
            let actor = log.actors.iter().find(|a| a.role == ActorRole::Agent(agent.agent));
            let missing = || LogError::NotSimulated { agent: agent.agent };
            let actor = actor.ok_or_else(missing).at(|| Place::scene(plan.scene))?;
            Ok(AgentInfo {
                agent: agent.agent.to_string(),
                id: actor.id,
                model: actor.model.clone(),
                color: agent.color.clone(),
                start_xyz_m: agent.xyz_m,
                start_rpy_rad: agent.rpy_rad,
                speed_difference: agent.speed_difference,
                standstill_gap_m: agent.standstill_gap_m,
                signal: agent.signal.clone(),
                reckless: agent.reckless,
                distracted: agent.distracted,
            })
        })
        .collect::<Result<_, StageError>>()?;
    let mut weathers =
        between.iter().map(|row| row.weather).chain([plan.initial_weather, plan.final_weather]);
    let hazards = |kind: HazardKind| log.hazards.iter().filter(|h| h.kind == kind).count() as u32;
    let count = |is_one: &dyn Fn(&ActorRow) -> bool| log.actors.iter().filter(|a| is_one(a)).count() as u32;
    let dark = weathers.any(|weather| weather.is_night());
    let keyframe =
        |row: &PlanWeatherRow| WeatherKeyframeInfo { at_s: row.at_s, weather: by_name(row.weather) };
    Ok(SceneInfo {
        scene: plan.scene,
        split: plan.split.clone(),
        map: plan.map.clone(),
        map_hash: plan.map_hash.clone(),
        models: Vec::new(),
        geo_reference: map.network().header.geo_reference.clone().unwrap_or_default(),
        seed: plan.seed,
        duration_s: plan.duration_s,
        frames: plan.frames,
        label_every_n_frames: settings.label_every_n_frames,
        spawn_mode: plan.spawn_mode.clone(),
        dynamic_weather: plan.dynamic_weather,
        initial_weather: by_name(plan.initial_weather),
        final_weather: by_name(plan.final_weather),
        weather_keyframes: between.iter().map(keyframe).collect(),
        spawn_radius_m: plan.spawn_radius_m,
        world_radius_m: settings.reach_m,
        pivot_xyz_m: plan.pivot_xyz_m,
        street_light_intensity_change_lm: plan.street_light_change_lm,
        street_lights_on: dark.then_some(!settings.lights.street_lamps_off),
        building_lights_on: dark.then_some(!settings.lights.buildings_off),
        agents,
        // Those on given trajectories, too; what is towed is no vehicle of its own.
        n_vehicles: count(&|a| a.role == ActorRole::Background && a.parent.is_none()),
        n_walkers: count(&|a| a.role == ActorRole::Walker),
        n_accident_hazards: hazards(HazardKind::Accident),
        n_road_work_hazards: hazards(HazardKind::RoadWorks),
        n_hazard_attempts: plan.hazard_attempts,
        hazards: log.hazards.clone(),
        n_reckless_vehicles: log.n_reckless,
        n_distracted_vehicles: log.n_distracted,
        walker_cross_factor: plan.walker_cross_factor,
        speed_difference: settings.traffic.speed_difference,
        standstill_gap_m: settings.traffic.standstill_gap_m,
        green_time_s: settings.traffic.green_time_s,
        drivers: log.drivers.clone(),
        signal_groups: log.signal_groups.clone(),
    })
}

/// The models of packs that some actor has.
pub(crate) fn models(rows: &[PlanModelRow], actors: &[ActorRow]) -> Vec<PackedModelInfo> {
    let is_here = |row: &&PlanModelRow| actors.iter().any(|actor| actor.model == row.name);
    let info = |row: &PlanModelRow| PackedModelInfo {
        name: row.name.clone(),
        page: row.page.clone(),
        hash: row.hash.clone(),
    };
    rows.iter().filter(is_here).map(info).collect()
}

fn by_name(weather: Weather) -> BTreeMap<String, f64> {
    Weather::NAMES.iter().map(|n| (*n).to_owned()).zip(weather.to_array()).collect()
}
