//! The plan of a dataset, scene by scene.

use std::collections::{BTreeMap, BTreeSet};

use catalogue::Catalogue;
use opendrive::Map;
use random::Stream;
use schema::tables::{
    PlanAgentRow, PlanHazardRow, PlanRouteRow, PlanSceneRow, PlanTrajectoryRow, PlanWeatherRow,
};
use settings::SpawnMode;
use settings::stages::PlanSettings;

use crate::PlanError;
use crate::agents::{place_rsus, place_vehicles, vehicle_models, vehicle_rows};
use crate::given_rsus::oddities;
use crate::given_ways::GivenWays;
use crate::hazards::{Surroundings, plan_hazards};
use crate::lights::plan_lights;
use crate::pool::SpawnPool;
use crate::roster::{SceneSlot, scene_slots};
use crate::sources::PlanSources;
use crate::timing::{background_radius_m, draw_duration_s, frame_count};
use crate::tracks::TrackFiles;
use crate::weather::plan_weather;

/// A map to plan on.
#[derive(Debug)]
pub struct PlanMap {
    /// The road network.
    pub map: Map,
    /// BLAKE3 of its OpenDRIVE text, hexadecimal.
    pub hash: String,
}

/// What a dataset will hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// One row per scene, by scene number.
    pub scenes: Vec<PlanSceneRow>,
    /// One row per agent: by scene, vehicles before RSUs.
    pub agents: Vec<PlanAgentRow>,
    /// One row per accident or road works, by scene.
    pub hazards: Vec<PlanHazardRow>,
    /// One row per keyframe of the weather within a scene, by scene and time.
    pub weather: Vec<PlanWeatherRow>,
    /// One row per place of a given route, by scene and agent.
    pub routes: Vec<PlanRouteRow>,
    /// One row per actor on a given trajectory and frame, by scene.
    pub trajectories: Vec<PlanTrajectoryRow>,
    /// What could not be had as wished, with scene and map.
    pub warnings: Vec<String>,
}

/// One scene of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedScene {
    /// The scene.
    pub scene: PlanSceneRow,
    /// Its agents, vehicles before RSUs.
    pub agents: Vec<PlanAgentRow>,
    /// Its accidents and road works.
    pub hazards: Vec<PlanHazardRow>,
    /// Keyframes of its weather, by time.
    pub weather: Vec<PlanWeatherRow>,
    /// Places of given routes, by agent.
    pub routes: Vec<PlanRouteRow>,
    /// Actors on given trajectories, agents first, frame by frame.
    pub trajectories: Vec<PlanTrajectoryRow>,
    /// What could not be had as wished.
    pub warnings: Vec<String>,
}

/// Plans a new dataset with the built-in models and no trajectories.
///
/// # Errors
/// When a map is missing or has no place for vehicles, or a setting cannot be followed.
pub fn plan(settings: &PlanSettings, maps: &BTreeMap<String, PlanMap>) -> Result<Plan, PlanError> {
    let sources = PlanSources { catalogue: Catalogue::built_in(), tracks: &TrackFiles::new() };
    plan_slots(settings, &scene_slots(settings)?, maps, &sources)
}

/// Plans the scenes of a roster, each by the settings of its edition and group.
///
/// # Errors
/// As [`plan`].
pub fn plan_slots(
    settings: &PlanSettings,
    slots: &[SceneSlot],
    maps: &BTreeMap<String, PlanMap>,
    sources: &PlanSources<'_>,
) -> Result<Plan, PlanError> {
    // By map and spacing, as its bits.
    let mut pools: BTreeMap<(&str, u64), SpawnPool> = BTreeMap::new();
    let mut plan = Plan::default();
    plan.warnings.extend(unused_tracks(settings, slots, sources.tracks));
    for slot in slots {
        let Some((name, map)) = maps.get_key_value(&slot.map) else {
            let known = maps.keys().cloned().collect::<Vec<_>>().join(", ");
            return Err(PlanError::UnknownMap { map: slot.map.clone(), known });
        };
        let Some(settings) = settings.of_group(slot.edition, &slot.group) else {
            let (scene, group) = (slot.scene, slot.group.clone());
            return Err(PlanError::UnknownGroup { scene, edition: slot.edition, group });
        };
        let separation_m = settings.agents.spawn_separation_m;
        let pool = pools
            .entry((name, separation_m.to_bits()))
            .or_insert_with(|| SpawnPool::new(&map.map, separation_m));
        let planned = plan_scene(settings, slot, map, pool, sources)?;
        plan.scenes.push(planned.scene);
        plan.agents.extend(planned.agents);
        plan.hazards.extend(planned.hazards);
        plan.weather.extend(planned.weather);
        plan.routes.extend(planned.routes);
        plan.trajectories.extend(planned.trajectories);
        plan.warnings.extend(planned.warnings);
    }
    Ok(plan)
}

/// Scenes of files of trajectories that nobody plans by them.
fn unused_tracks(settings: &PlanSettings, slots: &[SceneSlot], tracks: &TrackFiles) -> Vec<String> {
    let mut unused = Vec::new();
    for (file, tracks) in tracks {
        let uses = |slot: &&SceneSlot| {
            let own = settings.of_group(slot.edition, &slot.group);
            own.is_some_and(|own| own.agents.trajectories.as_ref() == Some(file))
        };
        let used: BTreeSet<u32> = slots.iter().filter(uses).map(|slot| slot.scene).collect();
        let named: BTreeSet<u32> = tracks.iter().filter_map(|track| track.scene).collect();
        let other: Vec<String> = named.difference(&used).map(u32::to_string).collect();
        if !other.is_empty() {
            unused.push(format!(
                "{file} (agents.trajectories) has rows of scenes that are not planned by it: {}",
                other.join(", ")
            ));
        }
        let is_of_all = tracks.iter().any(|track| track.scene.is_none());
        let without: Vec<String> = used.difference(&named).map(u32::to_string).collect();
        if !is_of_all && !without.is_empty() {
            unused.push(format!("{file} (agents.trajectories) has no rows of scenes {}", without.join(", ")));
        }
    }
    unused
}

/// How many agents, and how they are spread.
struct AgentCounts {
    vehicles: usize,
    rsus: usize,
    mode: SpawnMode,
}

fn draw_counts(settings: &PlanSettings, stream: &mut Stream) -> Result<AgentCounts, PlanError> {
    let agents = &settings.agents;
    let mut between = |low: u32, high: u32| stream.int_inclusive(i64::from(low), i64::from(high)) as usize;
    let drawn = between(agents.min_vehicles, agents.max_vehicles);
    let rsus = between(agents.min_rsus, agents.max_rsus);
    let vehicles = match (agents.penetration, settings.traffic.vehicles) {
        (Some(share), Some(all)) => (share * f64::from(all)).round_ties_even().max(1.0) as usize,
        _ => drawn,
    };
    let heads = stream.chance(0.5);
    let mode = match agents.spawn_mode {
        SpawnMode::Both if heads => SpawnMode::Clustered,
        SpawnMode::Both => SpawnMode::Chained,
        fixed => fixed,
    };
    if vehicles + rsus > usize::from(u16::MAX) {
        return Err(PlanError::BadSetting {
            setting: "agents.max_vehicles",
            problem: "too many agents".into(),
        });
    }
    Ok(AgentCounts { vehicles, rsus, mode })
}

/// Refuses a map without places for vehicles.
fn check_pool(pool: &SpawnPool, map: &str) -> Result<(), PlanError> {
    if pool.lanes == 0 {
        return Err(PlanError::NoDrivingLanes { map: map.into() });
    }
    if pool.points.is_empty() {
        return Err(PlanError::NoSpawnPoints { map: map.into(), lanes: pool.lanes });
    }
    Ok(())
}

/// Plans one scene; `pool` is the map's, with the settings' separation.
///
/// # Errors
/// When the map has no place for vehicles, or a setting cannot be followed.
pub fn plan_scene(
    settings: &PlanSettings,
    slot: &SceneSlot,
    map: &PlanMap,
    pool: &SpawnPool,
    sources: &PlanSources<'_>,
) -> Result<PlannedScene, PlanError> {
    let catalogue = sources.catalogue;
    check_pool(pool, &slot.map)?;
    let models = vehicle_models(&settings.agents, catalogue)?;
    let number = slot.scene;
    let seed = slot.seed(settings.seed);
    let stream = |topic, entity| Stream::new(seed, u64::from(number), topic, entity);

    let duration_s = draw_duration_s(&settings.timing, &mut stream("plan/duration", 0));
    let warmup_s = settings.timing.warmup_s.max(0.0);
    let weather = plan_weather(&settings.weather, seed, number, duration_s, pool.is_high_ground());

    let AgentCounts { vehicles, rsus, mode } = draw_counts(settings, &mut stream("plan/counts", 0))?;

    let frames = frame_count(duration_s);
    let ways = GivenWays::new(settings, slot, &map.map, pool, (sources, frames))?;
    let given: Vec<_> = settings.agents.starts.iter().filter(|start| start.map == slot.map).collect();
    let given = SpawnPool::of_starts(&map.map, given.into_iter())?;
    let mut placement = place_vehicles(
        &map.map,
        if given.points.is_empty() { pool } else { &given },
        &settings.agents,
        &models,
        mode,
        (vehicles, ways.starts(), &ways.kept(catalogue)),
        &mut stream("plan/vehicles", 0),
    );
    let mut agents =
        vehicle_rows(settings, number, &models, &placement, |vehicle| stream("plan/driver", vehicle));
    ways.own_models(&mut agents);
    let given: Vec<_> = settings.agents.rsus_at.iter().filter(|rsu| rsu.map == slot.map).collect();
    agents.extend(place_rsus(&map.map, &given, &mut placement, number, rsus, &mut stream("plan/rsus", 0)));

    // A share of all vehicles collects data: the others are what is left.
    let connected = settings.agents.penetration.map_or(0, |_| placement.starts.len() as u32);
    let background = settings.traffic.vehicles.map(|all| all.saturating_sub(connected));
    let mut walkers = stream("plan/walkers", 0);
    let drawn_walkers = walkers.int_inclusive(0, i64::from(settings.walkers.max_count)) as u32;
    let drawn_factor = walkers.beta(2.4, 1.6);
    let lights = plan_lights(
        &settings.lights,
        weather.is_ever_dark(),
        pool.is_high_ground(),
        &mut stream("plan/lights", 0),
    );
    let radius = settings.traffic.spawn_radius_m.unwrap_or_else(|| background_radius_m(duration_s, warmup_s));
    let starts: Vec<_> = placement.starts.iter().map(|start| start.xyz_m).collect();
    placement.warnings.extend(oddities(&map.map, &given[..given.len().min(rsus)], &starts, radius));
    let surroundings = Surroundings {
        map: &map.map,
        pool,
        catalogue,
        agents: starts,
        radius_m: radius,
        clearance_m: 0.5 * settings.agents.spawn_separation_m,
    };
    let (hazards, hazard_attempts) =
        plan_hazards(&surroundings, &settings.hazards, number, |attempt| stream("plan/hazards", attempt));
    let scene = PlanSceneRow {
        scene: number,
        split: slot.split.name().into(),
        map: slot.map.clone(),
        map_hash: map.hash.clone(),
        seed: seed.wrapping_add(u64::from(number)),
        duration_s,
        frames,
        warmup_s,
        spawn_mode: mode.name().into(),
        dynamic_weather: weather.is_dynamic,
        initial_weather: weather.initial,
        final_weather: weather.last,
        spawn_radius_m: radius,
        spawn_separation_m: settings.agents.spawn_separation_m,
        background_vehicles: background.map(|n| n.min(i32::MAX as u32) as i32),
        walkers: settings.walkers.count.unwrap_or(drawn_walkers),
        walker_cross_factor: settings.walkers.cross_factor.unwrap_or(drawn_factor),
        street_light_change_lm: lights.change_lm,
        random_building_colors: lights.random_colors,
        hazard_attempts,
        pivot_xyz_m: placement.pivots.first().map_or([0.0; 3], |p| p.coords.into()),
    };
    let warnings = placement.warnings.iter().map(|w| format!("scene {number} ({}): {w}", slot.map)).collect();
    let between = weather.between.iter();
    let weather = between.map(|(at_s, w)| PlanWeatherRow { scene: number, at_s: *at_s, weather: *w });
    let routes = ways.route_rows(&map.map, number);
    let (weather, trajectories) = (weather.collect(), ways.trajectories.concat());
    Ok(PlannedScene { scene, agents, hazards, weather, routes, trajectories, warnings })
}
