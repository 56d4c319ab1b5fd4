//! Data-collection vehicles and RSUs.

use serde::Serialize;

/// How data-collection vehicles are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SpawnMode {
    /// Around a pivot.
    Clustered,
    /// Each near one that is placed already.
    Chained,
    /// A coin flip per scene.
    #[default]
    Both,
}

impl SpawnMode {
    /// Name in configuration and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clustered => "clustered",
            Self::Chained => "chained",
            Self::Both => "both",
        }
    }
}

/// A place where data-collection vehicles may start, given by the user.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GivenStart {
    /// Name of the map, as in the scene counts.
    pub map: String,
    /// In the world, metres; the nearest driving lane that runs its way is meant.
    pub xyz_m: [f64; 3],
    /// Heading, radians from east, counter-clockwise.
    pub yaw_rad: f64,
}

/// Data-collection vehicles and RSUs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgentSettings {
    /// Fewest vehicles (2).
    pub min_vehicles: u32,
    /// Most vehicles (8).
    pub max_vehicles: u32,
    /// How they are spread.
    pub spawn_mode: SpawnMode,
    /// Spacing of a cluster, metres (48).
    pub clustered_spawn_distance_m: f64,
    /// Reach of a link of a chain, metres (64).
    pub chained_spawn_distance_m: f64,
    /// Fewest RSUs (0).
    pub min_rsus: u32,
    /// Most RSUs (4).
    pub max_rsus: u32,
    /// Models, taken in turn.
    pub vehicle_models: Vec<String>,
    /// Colours (sRGB), taken in turn.
    pub vehicle_colors: Vec<[u8; 3]>,
    /// Spacing of the pool of spawn points along lanes, metres (24).
    pub spawn_separation_m: f64,
    /// On maps that have some, agents start at these places instead of the pool's.
    pub starts: Vec<GivenStart>,
    /// Share of a scene's vehicles that collect data, 0 to 1: then [`TrafficSettings::vehicles`] counts all vehicles,
    /// and `min_vehicles` and `max_vehicles` have no say.
    pub penetration: Option<f64>,
}

impl Default for AgentSettings {
    fn default() -> Self {
        Self {
            min_vehicles: 2,
            max_vehicles: 8,
            spawn_mode: SpawnMode::Both,
            clustered_spawn_distance_m: 48.0,
            chained_spawn_distance_m: 64.0,
            min_rsus: 0,
            max_rsus: 4,
            vehicle_models: ["car.coupe", "car.sedan", "car.hatchback", "car.sports"]
                .map(String::from)
                .to_vec(),
            vehicle_colors: vec![
                [0, 0, 0],
                [255, 0, 0],
                [0, 255, 0],
                [0, 0, 255],
                [255, 255, 0],
                [255, 0, 255],
                [0, 255, 255],
                [255, 255, 255],
            ],
            spawn_separation_m: 24.0,
            starts: Vec::new(),
            penetration: None,
        }
    }
}
