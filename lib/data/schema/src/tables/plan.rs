//! The plan: what the dataset will hold.

use super::weather::Weather;
use crate::{AgentId, HazardKind, table};

table! {
    /// One row per scene: everything the simulation needs to know besides the agents.
    PlanSceneRow in "plan/scenes" by "spawn-planner" {
        /// Scene number, from 0, over all splits.
        scene: u32,
        /// `train`, `val` or `test`.
        split: String,
        /// Map name.
        map: String,
        /// BLAKE3 of the map's OpenDRIVE text.
        map_hash: String,
        /// Seed of the scene's random streams.
        seed: u64,
        /// Recorded time, s.
        duration_s: f64,
        /// Recorded frames, 20 per second.
        frames: u32,
        /// Simulated time before frame 0, s.
        warmup_s: f64,
        /// `clustered` or `chained`.
        spawn_mode: String,
        /// Whether the weather moves from initial to final.
        dynamic_weather: bool,
        /// Weather before frame 0: fields named as the weather columns of `log/frames`.
        initial_weather: Weather,
        /// Weather of the last frame, likewise.
        final_weather: Weather,
        /// Background vehicles and walkers start within this distance of any vehicle agent, m.
        spawn_radius_m: f64,
        /// Spacing of the spawn points of background vehicles along lanes, m of s.
        spawn_separation_m: f64,
        /// Background vehicles wanted; null: as many as drawn by the simulation from the free spawn points.
        background_vehicles: Option<i32>,
        /// Walkers wanted.
        walkers: u32,
        /// Share of walkers who may cross roads anywhere, 0 to 1.
        walker_cross_factor: f64,
        /// Added to the flux of every street lamp, lm; 0 where the sun stays up.
        street_light_change_lm: f64,
        /// Whether each building's windows have a colour of their own.
        random_building_colors: bool,
        /// Hazards tried; those that found room are rows of `plan/hazards`.
        hazard_attempts: u32,
        /// Clustered: the point around which the vehicle agents were drawn; chained: the first one's spawn
        /// point, m.
        pivot_xyz_m: [f64; 3],
    }
}

table! {
    /// One row per accident or road works of a scene: one lane from back (upstream) to front.
    PlanHazardRow in "plan/hazards" by "spawn-planner" {
        /// Scene number.
        scene: u32,
        /// Number within the scene, from 0.
        hazard: u32,
        /// `accident` or `road_works`.
        kind: HazardKind,
        /// Accident: models of the front vehicle, the rear vehicle and the emergency vehicle, if one came.
        models: Vec<String>,
        /// Road works: things and workers between the two barriers.
        items: u32,
        /// Back end on the centre line of its lane, m.
        back_xyz_m: [f64; 3],
        /// OpenDRIVE id of its road.
        back_road: String,
        /// OpenDRIVE id of its lane.
        back_lane: i32,
        /// Road coordinate s, m.
        back_s_m: f64,
        /// Front end on the centre line of its lane, m.
        front_xyz_m: [f64; 3],
        /// OpenDRIVE id of its road.
        front_road: String,
        /// OpenDRIVE id of its lane.
        front_lane: i32,
        /// Road coordinate s, m.
        front_s_m: f64,
    }
}

table! {
    /// One row per agent of a scene: data-collection vehicles, then RSUs.
    PlanAgentRow in "plan/agents" by "spawn-planner" {
        /// Scene number.
        scene: u32,
        /// `vehicle_0`, `rsu_1`, ...
        agent: AgentId,
        /// Model of the body.
        model: String,
        /// Body colour, sRGB red, green, blue.
        color: Vec<u8>,
        /// Start position in the world, m (RSU: foot of the pole).
        xyz_m: [f64; 3],
        /// Start orientation in the world: roll, pitch, yaw, rad.
        rpy_rad: [f64; 3],
        /// The driver ignores lights, signs, vehicles and walkers.
        reckless: bool,
        /// The driver ignores lights and signs.
        distracted: bool,
        /// Driver's speed below the limit as a share of it (negative: faster).
        speed_difference: f64,
        /// Driver's gap to a standing leader, m.
        standstill_gap_m: f64,
        /// RSU: OpenDRIVE id of the signal whose pole it stands at; null where the user says where it stands.
        signal: Option<String>,
    }
}
