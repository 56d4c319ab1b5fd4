//! What `spawn-planner` sees.

use serde::Serialize;

use crate::{
    AgentSettings, HazardSettings, LightSettings, ModelSettings, SceneCount, TimingSettings, TrafficSettings,
    WalkerSettings, WeatherSettings,
};

/// What scenes are planned from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanSettings {
    /// Seed of every random stream.
    pub seed: u64,
    /// How many scenes on which map, in split order.
    pub scenes: Vec<SceneCount>,
    /// Scenes to draw anew, by number: which further draw is meant, from 1.
    pub redraw: Vec<(u32, u32)>,
    /// Data-collection vehicles and RSUs.
    pub agents: AgentSettings,
    /// Models besides the built-in ones.
    #[serde(skip_serializing_if = "ModelSettings::is_built_in")]
    pub models: ModelSettings,
    /// Warm-up and durations.
    pub timing: TimingSettings,
    /// Background vehicles and drivers.
    pub traffic: TrafficSettings,
    /// Pedestrians.
    pub walkers: WalkerSettings,
    /// Weather draws and overrides.
    pub weather: WeatherSettings,
    /// Street lamps and lit windows.
    pub lights: LightSettings,
    /// Accidents and road works.
    pub hazards: HazardSettings,
}

impl PlanSettings {
    /// The published settings for some scenes.
    #[must_use]
    pub fn with_scenes(scenes: Vec<SceneCount>) -> Self {
        Self {
            seed: 27,
            scenes,
            redraw: Vec::new(),
            agents: AgentSettings::default(),
            models: ModelSettings::default(),
            timing: TimingSettings::default(),
            traffic: TrafficSettings::default(),
            walkers: WalkerSettings::default(),
            weather: WeatherSettings::default(),
            lights: LightSettings::default(),
            hazards: HazardSettings::default(),
        }
    }
}
