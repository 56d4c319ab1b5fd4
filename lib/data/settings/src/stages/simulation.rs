//! What `simulate-and-log` sees. Seeds, counts and weather reach it through the plan.

use serde::Serialize;

use crate::{
    AnnotationSettings, HazardSettings, LightSettings, SceneryRules, TrafficSettings, WalkerSettings,
    WorldSettings,
};

/// What a scene is simulated and logged from, besides its plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulationSettings {
    /// Background vehicles and drivers.
    pub traffic: TrafficSettings,
    /// Pedestrians.
    pub walkers: WalkerSettings,
    /// Street lamps and lit windows.
    pub lights: LightSettings,
    /// Accidents and road works.
    pub hazards: HazardSettings,
    /// How the land beside the roads is built up.
    pub scenery: SceneryRules,
    /// The static world is there within this distance of every agent at every frame, metres: as it is asked
    /// for, and what boxes and grids reach.
    pub reach_m: f64,
    /// Boxes within this 3-D distance of an agent are collected, metres.
    pub box_radius_m: f64,
    /// Boxes and map records are written at frames 0, n, 2 n, ...
    pub label_every_n_frames: u32,
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self {
            traffic: TrafficSettings::default(),
            walkers: WalkerSettings::default(),
            lights: LightSettings::default(),
            hazards: HazardSettings::default(),
            scenery: SceneryRules::default(),
            reach_m: WorldSettings::default().radius_m,
            box_radius_m: AnnotationSettings::default().box_radius_m,
            label_every_n_frames: AnnotationSettings::default().every_n_frames,
        }
    }
}
