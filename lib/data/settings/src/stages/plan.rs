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
    /// Number of the first scene.
    #[serde(skip_serializing_if = "crate::scenes::is_zero")]
    pub first_scene: u32,
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
    /// The same of each group of scenes, by its name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<(String, PlanSettings)>,
    /// The same of older editions, by number: their scenes are as they were planned.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub older: Vec<PlanSettings>,
}

impl PlanSettings {
    /// The published settings for some scenes.
    #[must_use]
    pub fn with_scenes(scenes: Vec<SceneCount>) -> Self {
        Self {
            seed: 27,
            scenes,
            first_scene: 0,
            redraw: Vec::new(),
            agents: AgentSettings::default(),
            models: ModelSettings::default(),
            timing: TimingSettings::default(),
            traffic: TrafficSettings::default(),
            walkers: WalkerSettings::default(),
            weather: WeatherSettings::default(),
            lights: LightSettings::default(),
            hazards: HazardSettings::default(),
            groups: Vec::new(),
            older: Vec::new(),
        }
    }

    /// The number of the newest edition: that of these settings themselves.
    #[must_use]
    pub fn edition(&self) -> u32 {
        self.older.len() as u32
    }

    /// What scenes of a group in an edition are planned from; the empty name stands for scenes of no group.
    #[must_use]
    pub fn of_group(&self, edition: u32, group: &str) -> Option<&Self> {
        let of_edition = if edition == self.edition() { self } else { self.older.get(edition as usize)? };
        match group {
            "" => Some(of_edition),
            group => of_edition.groups.iter().find(|(name, _)| name == group).map(|(_, settings)| settings),
        }
    }

    /// These settings, those of the groups, and those of older editions.
    #[must_use]
    pub fn all(&self) -> Vec<&Self> {
        let inner = self.groups.iter().map(|(_, settings)| settings).chain(&self.older);
        std::iter::once(self).chain(inner.flat_map(Self::all)).collect()
    }

    /// The same with something changed in all of them.
    pub fn change_all(&mut self, change: &impl Fn(&mut Self)) {
        change(self);
        let inner = self.groups.iter_mut().map(|(_, settings)| settings).chain(&mut self.older);
        inner.for_each(|settings| settings.change_all(change));
    }
}
