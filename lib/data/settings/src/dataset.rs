//! Everything that determines a dataset. Only the configuration and those who hand out its parts know this whole: stages
//! get the parts that they use ([`super::stages`]).

use serde::Serialize;

use super::{
    AgentSettings, AnnotationSettings, BevSettings, CardSettings, HazardSettings, LightSettings,
    ModelSettings, OccupancySettings, PerAgent, Rig, SceneCount, TimingSettings, TrackSettings,
    TrafficSettings, WalkerSettings, WeatherSettings, WorldSettings,
};
/// Everything that determines a dataset, besides maps and code.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DatasetSettings {
    /// Name of the dataset, in reports.
    pub name: String,
    /// Words of its card.
    pub card: CardSettings,
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
    /// Scenery placed by rule.
    pub world: WorldSettings,
    /// Sensors of every data-collection vehicle.
    pub vehicle_rig: Rig,
    /// Sensors of every RSU.
    pub rsu_rig: Rig,
    /// Agents that carry something else.
    pub own_rigs: Vec<OwnRig>,
    /// Which objects are annotated.
    pub annotation: AnnotationSettings,
    /// Objects followed over a scene.
    pub tracks: TrackSettings,
    /// BEV masks.
    pub bev: BevSettings,
    /// Voxel grids of vehicles.
    pub vehicle_occupancy: OccupancySettings,
    /// Voxel grids of RSUs.
    pub rsu_occupancy: OccupancySettings,
}

impl DatasetSettings {
    /// The published settings for some scenes.
    #[must_use]
    pub fn with_scenes(scenes: Vec<SceneCount>) -> Self {
        Self {
            name: "dataset".into(),
            card: CardSettings::default(),
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
            world: WorldSettings::default(),
            vehicle_rig: Rig::vehicle(),
            rsu_rig: Rig::rsu(),
            own_rigs: Vec::new(),
            annotation: AnnotationSettings::default(),
            tracks: TrackSettings::default(),
            bev: BevSettings::default(),
            vehicle_occupancy: OccupancySettings::default(),
            rsu_occupancy: OccupancySettings::default(),
        }
    }

    /// Sensors of each agent.
    #[must_use]
    pub fn rigs(&self) -> PerAgent<Rig> {
        let own = self.own_rigs.iter().map(|own| (own.agents.clone(), own.rig.clone()));
        PerAgent { vehicle: self.vehicle_rig.clone(), rsu: self.rsu_rig.clone(), own: own.collect() }
    }

    /// Voxel grid of each agent.
    #[must_use]
    pub fn occupancy(&self) -> PerAgent<OccupancySettings> {
        let own = self.own_rigs.iter().map(|own| (own.agents.clone(), own.occupancy.clone()));
        PerAgent {
            vehicle: self.vehicle_occupancy.clone(),
            rsu: self.rsu_occupancy.clone(),
            own: own.collect(),
        }
    }
}

/// Sensors and voxel grid of some agents, instead of those of their kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OwnRig {
    /// `vehicle_1`, `rsu_0`, ...; all of one kind.
    pub agents: Vec<String>,
    /// Sensors.
    pub rig: Rig,
    /// Voxel grid.
    pub occupancy: OccupancySettings,
}
