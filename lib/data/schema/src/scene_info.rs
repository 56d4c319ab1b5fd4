//! `log/scene.json`: facts about a scene that are no table.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::HazardKind;

/// Name of the file in the scene's folder.
pub const SCENE_FILE: &str = "log/scene.json";
/// The stage that writes it.
pub const LOG_STAGE: &str = "simulate-and-log";

/// Facts about one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneInfo {
    /// Scene number.
    pub scene: u32,
    /// `train`, `val` or `test`.
    pub split: String,
    /// Map name.
    pub map: String,
    /// BLAKE3 of the map's OpenDRIVE text: the map is `maps/MAP.xodr.zst` in the store.
    pub map_hash: String,
    /// Models of packs that are in the scene, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub models: Vec<PackedModelInfo>,
    /// The map's geographic reference, as written in the map.
    pub geo_reference: String,
    /// Seed of the scene's random streams.
    pub seed: u64,
    /// Recorded time, s.
    pub duration_s: f64,
    /// Recorded frames.
    pub frames: u32,
    /// Boxes and map records stand at frames 0, n, 2 n, ...
    #[serde(default = "crate::rate::every_frame")]
    pub label_every_n_frames: u32,
    /// `clustered` or `chained`.
    pub spawn_mode: String,
    /// Whether the weather moves from initial to final.
    pub dynamic_weather: bool,
    /// Weather before frame 0, by parameter name.
    pub initial_weather: BTreeMap<String, f64>,
    /// Weather of the last frame.
    pub final_weather: BTreeMap<String, f64>,
    /// Weather between them, by time, where the configuration has keyframes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub weather_keyframes: Vec<WeatherKeyframeInfo>,
    /// Background actors start within this distance of a data-collection vehicle, m.
    pub spawn_radius_m: f64,
    /// The static world is there within this distance of every agent at every frame, m; nothing is shown
    /// beyond.
    pub world_radius_m: f64,
    /// Clustered: the point around which the data-collection vehicles were drawn; chained: the first one's,
    /// m.
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
    /// Places at which accidents and road works were tried; those that are not among `hazards` found no room.
    pub n_hazard_attempts: u32,
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
    /// The drivers of the background vehicles, by object id.
    pub drivers: Vec<DriverInfo>,
    /// The programs of the traffic lights: signals that show the same, one entry.
    pub signal_groups: Vec<SignalGroupInfo>,
}

/// A model of a pack that is in a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PackedModelInfo {
    /// Its name; its files are in `models/NAME` of the store.
    pub name: String,
    /// The file among these that describes it.
    pub page: String,
    /// BLAKE3 of its files.
    pub hash: String,
}

/// The driver of a background vehicle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DriverInfo {
    /// Object id of the vehicle.
    pub id: u16,
    /// Speed below the limit as a share of it (negative: faster).
    pub speed_difference: f64,
    /// Gap to a standing leader, m.
    pub standstill_gap_m: f64,
    /// Ignores lights, signs, vehicles and walkers.
    pub reckless: bool,
    /// Ignores lights and signs.
    pub distracted: bool,
}

/// Signals of a junction that show the same all the time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SignalGroupInfo {
    /// OpenDRIVE ids of the signals.
    pub signals: Vec<String>,
    /// Time of green in a cycle, s; yellow and red follow.
    pub green_time_s: f64,
    /// When green begins in the cycle, s.
    pub start_s: f64,
    /// Length of the junction's cycle, s; the first one begins with the warm-up.
    pub cycle_s: f64,
}

/// An accident or road works of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HazardInfo {
    /// Its number in `plan/hazards`.
    pub hazard: u32,
    /// `accident` or `road_works`.
    pub kind: HazardKind,
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
    /// RSU: OpenDRIVE id of the signal whose pole it stands at; none where the user says where it stands.
    pub signal: Option<String>,
    /// Ignores lights, signs, vehicles and walkers.
    pub reckless: bool,
    /// Ignores lights and signs.
    pub distracted: bool,
}

/// Weather at a moment of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WeatherKeyframeInfo {
    /// Seconds after the initial weather; frame k is at 0.05 (k + 1).
    pub at_s: f64,
    /// By parameter name.
    pub weather: BTreeMap<String, f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys of an object and of the objects in its lists.
    fn keys(value: &serde_json::Value, found: &mut Vec<String>) {
        match value {
            serde_json::Value::Object(map) => {
                for (key, value) in map {
                    found.push(key.clone());
                    keys(value, found);
                }
            }
            serde_json::Value::Array(list) => list.iter().for_each(|v| keys(v, found)),
            _ => {}
        }
    }

    #[test]
    fn the_page_names_every_key() {
        let info = SceneInfo {
            agents: vec![AgentInfo::default()],
            hazards: vec![HazardInfo::default()],
            drivers: vec![DriverInfo::default()],
            signal_groups: vec![SignalGroupInfo::default()],
            models: vec![PackedModelInfo::default()],
            weather_keyframes: vec![WeatherKeyframeInfo::default()],
            ..SceneInfo::default()
        };
        let mut found = Vec::new();
        keys(&serde_json::to_value(&info).expect("an object"), &mut found);
        let page = include_str!("../../../../docs/schema.md");
        let section = page.split("## Scene facts").nth(1).expect("the page has the section");
        let section = section.split("\n## ").next().expect("a section");
        for key in found {
            assert!(
                section.contains(&format!("`{key}`")),
                "docs/schema.md, Scene facts, does not name {key}"
            );
        }
    }
}
