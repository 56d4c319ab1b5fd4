//! The scenes to watch.

use std::ops::{ControlFlow, RangeInclusive};

use land::tiles::TileMaker;
use opendrive::{LaneInfo, LanePos, Map};
use schema::HazardKind;
use schema::tables::{ActorRow, PlanAgentRow, PlanHazardRow};
use settings::{SceneryRules, WalkerSettings};
use traffic::{SceneInput, SimulationLog, simulate};

use crate::common::{
    agent, agents_on, as_planned, crossing, hazard, lights, queues_at_roundabout, roundabout, scene, settings,
};

/// Seconds that are watched, unless told otherwise.
pub(crate) const DURATION_S: f64 = 90.0;
/// Background vehicles and walkers wished for.
const VEHICLES: i32 = 120;
const WALKERS: u32 = 100;
/// Scenery stands within this distance of an agent, metres.
const SCENERY_M: f64 = 300.0;
/// Maps to look at: our towns, then real ones that may be absent, then places with full queues.
const MAPS: [&str; 8] =
    ["convoy/01", "convoy/03", "convoy/05", "convoy/06", "Town03", "Town10HD", "crossing", "roundabout"];
/// Radius of the roundabout's lane and length of its arms, metres; vehicles in each queue, and metres from
/// one to the next.
const ROUNDABOUT_M: [f64; 2] = [18.0, 500.0];
const QUEUE: usize = 20;
const QUEUED_M: f64 = 10.0;

/// One seed in so many has accidents and road works, so many of them; they are as long as this, metres, and
/// keep as far off the ends of their lanes and off agents.
const HAZARD_SEEDS: u64 = 4;
const HAZARDS: usize = 8;
const HAZARD_M: f64 = 26.0;
const HAZARD_CLEAR_M: f64 = 30.0;

/// A scene to simulate and watch.
pub(crate) struct Plan {
    map: String,
    seed: u64,
    duration_s: f64,
}

pub(crate) fn plans(wanted: &[String], seeds: &RangeInclusive<u64>, duration_s: f64) -> Vec<Plan> {
    let names = MAPS.iter().map(|m| (*m).to_owned());
    let names: Vec<String> = if wanted.is_empty() { names.collect() } else { wanted.to_vec() };
    let known = names.into_iter().filter(|name| load(name).is_some());
    known.flat_map(|map| seeds.clone().map(move |seed| Plan { map: map.clone(), seed, duration_s })).collect()
}

fn load(name: &str) -> Option<Map> {
    match name {
        "crossing" => return Some(crossing(true)),
        "roundabout" => return Some(roundabout(ROUNDABOUT_M[0], ROUNDABOUT_M[1])),
        _ => {}
    }
    match town::named(name) {
        Some(parameters) => town::generate(&parameters).ok().map(Map::new),
        None => testkit::real_map(name),
    }
}

/// Queues of eight on all arms of the crossing.
fn queues(seed: u64) -> Vec<PlanAgentRow> {
    let mut agents = Vec::new();
    for (arm, (cos, sin)) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].into_iter().enumerate() {
        for k in 0..8 {
            let d = 24.0 + 20.0 * f64::from(k);
            let at = [d * cos - 1.75 * sin, d * sin + 1.75 * cos, 0.0];
            let index = 8 * arm + k as usize;
            agents.push(as_planned(agent(index, at, frames::math::atan2(-sin, -cos)), seed, index));
        }
    }
    agents
}

/// The objects beside the roads around the agents, as in a dataset, and the lights that are farther off.
fn scenery(map: &Map, seed: u64, agents: &[PlanAgentRow]) -> Vec<ActorRow> {
    let centres: Vec<[f64; 3]> = agents.iter().map(|a| a.xyz_m).collect();
    let rules = SceneryRules { seed, ..SceneryRules::default() };
    let around = TileMaker::new(map, &rules, catalogue::Catalogue::built_in()).around(&centres, SCENERY_M, 1);
    let mut fixed = around.map(|around| around.actors).unwrap_or_default();
    let mut missing = lights(map);
    missing.retain(|light| fixed.iter().all(|a| a.opendrive_id != light.opendrive_id));
    fixed.extend(missing);
    for (id, actor) in (1..).zip(&mut fixed) {
        actor.id = id;
    }
    fixed
}

/// Accidents and road works in turn, on lanes spread over the map.
fn hazards(map: &Map, agents: &[PlanAgentRow]) -> Vec<PlanHazardRow> {
    let clear = |lane: &&LaneInfo| {
        let at = map.lane_point(lane.id, 0.5 * (lane.s_start + lane.s_end), 0.0);
        let off = |p: &opendrive::LanePoint| {
            agents
                .iter()
                .all(|a| (p.position - nalgebra::Point3::from(a.xyz_m)).norm() > 2.0 * HAZARD_CLEAR_M)
        };
        lane.lane_type.is_drivable()
            && lane.junction.is_none()
            && lane.s_length() > HAZARD_M + 2.0 * HAZARD_CLEAR_M
            && at.as_ref().is_some_and(off)
    };
    let lanes: Vec<&LaneInfo> = map.lanes().iter().filter(clear).collect();
    let places = lanes.iter().step_by((lanes.len() / HAZARDS).max(1)).take(HAZARDS);
    let row = |(i, lane): (usize, &&LaneInfo)| {
        let road = &map.network().roads.get(lane.id.road as usize)?.id;
        let along_m = 0.5 * (lane.s_length() - HAZARD_M);
        let s = |along_m| map.s_of(LanePos { lane: lane.id, along_m });
        let between_m = [s(along_m)?, s(along_m + HAZARD_M)?];
        let kind = if i % 2 == 0 { HazardKind::Accident } else { HazardKind::RoadWorks };
        let models = ["van.delivery", "car.sedan", "van.ambulance"].map(String::from).to_vec();
        Some(PlanHazardRow {
            hazard: i as u32,
            models: if i % 2 == 0 { models } else { Vec::new() },
            items: if i % 2 == 0 { 0 } else { 18 },
            ..hazard(kind, road, lane.id.lane.into(), between_m)
        })
    };
    places.enumerate().filter_map(row).collect()
}

impl Plan {
    pub(crate) fn name(&self) -> String {
        format!("{} {}", self.map, self.seed)
    }

    /// The map, the objects on it, and what happens.
    pub(crate) fn simulate(&self) -> (Map, Vec<ActorRow>, SimulationLog) {
        let map = load(&self.map).unwrap_or_else(|| crossing(true));
        let mut scene = scene(self.duration_s);
        scene.seed = 1000 + self.seed;
        let mut settings = settings();
        let queues = match self.map.as_str() {
            "crossing" => Some(queues(scene.seed)),
            "roundabout" => Some(queues_at_roundabout(ROUNDABOUT_M[0], QUEUE, QUEUED_M, scene.seed)),
            _ => None,
        };
        let full = queues.is_some();
        let agents = queues.unwrap_or_else(|| agents_on(&map, 4, 7));
        if full {
            settings.traffic.green_time_s = Some(25.0);
        } else {
            settings.traffic.reckless_background = 0.01;
            settings.traffic.distracted_background = 0.02;
            scene.background_vehicles = Some(VEHICLES);
            scene.walkers = WALKERS;
            settings.walkers = WalkerSettings::default();
        }
        let fixed = scenery(&map, scene.seed, &agents);
        let wanted = !full && self.seed.is_multiple_of(HAZARD_SEEDS);
        let hazards = if wanted { hazards(&map, &agents) } else { Vec::new() };
        let input = SceneInput {
            catalogue: catalogue::Catalogue::built_in(),
            map: &map,
            scene: &scene,
            agents: &agents,
            hazards: &hazards,
            weather: &[],
            routes: &[],
            trajectories: &[],
            settings: &settings,
            fixed: &fixed,
            first_id: fixed.len() as u16 + 1,
        };
        let log = simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log");
        (map, fixed, log)
    }
}
