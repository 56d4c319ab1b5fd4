//! `log/scene.json`: facts about a scene that are no table.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Facts about one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneInfo {
    /// Scene number.
    pub scene: u32,
    /// `train`, `val` or `test`.
    pub split: String,
    /// Map name.
    pub map: String,
    /// BLAKE3 of the map's OpenDRIVE text: the map is `maps/{map_file}` in the store.
    pub map_hash: String,
    /// The map's geographic reference, as written in the map.
    pub geo_reference: String,
    /// Seed of the scene's random streams.
    pub seed: u64,
    /// Recorded time, s.
    pub duration_s: f64,
    /// Recorded frames.
    pub frames: u32,
    /// `clustered` or `chained`.
    pub spawn_mode: String,
    /// Whether the weather moves from initial to final.
    pub dynamic_weather: bool,
    /// Weather before frame 0, by parameter name.
    pub initial_weather: BTreeMap<String, f64>,
    /// Weather of the last frame.
    pub final_weather: BTreeMap<String, f64>,
    /// Background actors start within this distance of a data-collection vehicle, m.
    pub spawn_radius_m: f64,
    /// Clustered: the point around which the data-collection vehicles were drawn; chained: the first one's, m.
    pub pivot_xyz_m: [f64; 3],
    /// Added to the flux of every street lamp, lm; 0 when the lights were never switched on.
    pub street_light_intensity_change_lm: f64,
    /// Whether street lamps burn in the dark; absent when the sun stays up.
    pub street_lights_on: Option<bool>,
    /// The same for windows.
    pub building_lights_on: Option<bool>,
    /// The agents, vehicles first.
    pub agents: Vec<AgentInfo>,
    /// Background vehicles that were really placed.
    pub n_vehicles: u32,
    /// Walkers that were really placed.
    pub n_walkers: u32,
    /// Accidents that were really placed.
    pub n_accident_hazards: u32,
    /// Road works that were really placed.
    pub n_road_work_hazards: u32,
    /// The accidents and road works.
    pub hazards: Vec<HazardInfo>,
    /// Reckless background drivers.
    pub n_reckless_vehicles: u32,
    /// Distracted background drivers.
    pub n_distracted_vehicles: u32,
    /// Share of walkers who may cross roads anywhere.
    pub walker_cross_factor: f64,
    /// Speed difference of every driver, when it was configured.
    pub speed_difference: Option<f64>,
    /// Standstill gap of every driver, m, when it was configured.
    pub standstill_gap_m: Option<f64>,
    /// Green time of every signal, s, when it was configured.
    pub green_time_s: Option<f64>,
}

/// An accident or road works of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HazardInfo {
    /// Its number in `plan/hazards`.
    pub hazard: u32,
    /// `accident` or `road_works`.
    pub kind: String,
    /// The stretch of lane that it takes up, in the world, m: corners of a closed polygon, each once.
    pub area_m: Vec<[f64; 3]>,
}

/// One agent of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AgentInfo {
    /// `vehicle_0`, `rsu_1`, ...
    pub agent: String,
    /// Its object id.
    pub id: u16,
    /// Model of its body.
    pub model: String,
    /// Colour of its body, sRGB red, green, blue.
    pub color: Vec<u8>,
    /// Planned start in the world, m (RSU: foot of the pole).
    pub start_xyz_m: [f64; 3],
    /// Planned start in the world: roll, pitch, yaw, rad.
    pub start_rpy_rad: [f64; 3],
    /// Driver's speed below the limit as a share of it (negative: faster).
    pub speed_difference: f64,
    /// Driver's gap to a standing leader, m.
    pub standstill_gap_m: f64,
    /// RSU: OpenDRIVE id of the signal whose pole it stands at.
    pub signal: Option<String>,
    /// Ignores lights, signs, vehicles and walkers.
    pub reckless: bool,
    /// Ignores lights and signs.
    pub distracted: bool,
}
