//! What happens in a scene.

use serde::{Deserialize, Serialize};

/// Part of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs)] // The names are their own documentation.
pub enum Split {
    Train,
    Val,
    Test,
}

impl Split {
    /// All splits, in planning order.
    pub const ALL: [Self; 3] = [Self::Train, Self::Val, Self::Test];

    /// Name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
            Self::Test => "test",
        }
    }
}

/// A wish for some scenes of a split on a map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneCount {
    /// The split.
    pub split: Split,
    /// The map: `convoy/...` for our own towns, the path of an OpenDRIVE file, or the stem of one in the maps folder.
    pub map: String,
    /// Scenes wanted.
    pub count: u32,
}

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

/// Warm-up and durations. The frame period is fixed: [`crate::FRAME_PERIOD_S`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimingSettings {
    /// Simulated before the first frame, seconds (2).
    pub warmup_s: f64,
    /// Shortest scene, seconds (8).
    pub min_duration_s: f64,
    /// Longest scene, seconds (32).
    pub max_duration_s: f64,
}

impl Default for TimingSettings {
    fn default() -> Self {
        Self { warmup_s: 2.0, min_duration_s: 8.0, max_duration_s: 32.0 }
    }
}

/// Background vehicles and drivers. Probabilities are 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrafficSettings {
    /// Background vehicles per scene; drawn when absent.
    pub vehicles: Option<u32>,
    /// Speed below the limit as a share of it, for every driver; drawn per driver from -0.4..0.2 when absent.
    pub speed_difference: Option<f64>,
    /// Gap to a standing leader, metres; drawn per driver from N(4.2, 1) when absent.
    pub standstill_gap_m: Option<f64>,
    /// Green time of every signal, seconds; drawn per signal from 4..28 when absent.
    pub green_time_s: Option<f64>,
    /// Yellow time, seconds (3).
    pub yellow_time_s: f64,
    /// All-red time between two greens, seconds (2).
    pub all_red_time_s: f64,
    /// Chance that a data-collection driver is reckless (0.01): sees no lights, signs, vehicles, walkers.
    pub reckless_agent: f64,
    /// The same for background drivers (0.01).
    pub reckless_background: f64,
    /// Chance that a data-collection driver who is not reckless is distracted (0.02): sees no lights, signs.
    pub distracted_agent: f64,
    /// The same for background drivers (0.02).
    pub distracted_background: f64,
    /// Chances that a driver overlooks, drawn anew in every step of 50 ms: lights (0.001),
    pub ignore_lights: f64,
    /// signs and lines without lights (0.001),
    pub ignore_signs: f64,
    /// vehicles (0.001),
    pub ignore_vehicles: f64,
    /// walkers (0.001). What asks for hard braking is seen, and no line passed, until it has been overlooked for a second.
    pub ignore_walkers: f64,
    /// Chance that an emergency vehicle in traffic has its lights flashing (0.5).
    pub emergency_lights: f64,
    /// Chance that a background vehicle that comes to a stop opens a door (0.1).
    pub door_open: f64,
    /// Actors are placed within this distance of any agent, metres; from the duration when absent.
    pub spawn_radius_m: Option<f64>,
    /// Background vehicles and walkers farther than this from every agent vehicle sleep, metres (1600).
    pub active_distance_m: f64,
}

impl Default for TrafficSettings {
    fn default() -> Self {
        Self {
            vehicles: None,
            speed_difference: None,
            standstill_gap_m: None,
            green_time_s: None,
            yellow_time_s: 3.0,
            all_red_time_s: 2.0,
            reckless_agent: 0.01,
            reckless_background: 0.01,
            distracted_agent: 0.02,
            distracted_background: 0.02,
            ignore_lights: 0.001,
            ignore_signs: 0.001,
            ignore_vehicles: 0.001,
            ignore_walkers: 0.001,
            emergency_lights: 0.5,
            door_open: 0.1,
            spawn_radius_m: None,
            active_distance_m: 1600.0,
        }
    }
}

/// Pedestrians.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WalkerSettings {
    /// Walkers per scene; drawn from 0..=`max_count` when absent.
    pub count: Option<u32>,
    /// Most walkers when drawn (480).
    pub max_count: u32,
    /// Slowest walking speed, m/s (0.8).
    pub min_speed_mps: f64,
    /// Share of walkers who may cross roads anywhere, 0 to 1; drawn per scene from Beta(2.4, 1.6) when absent.
    pub cross_factor: Option<f64>,
    /// Share of walkers who use a wheelchair, 0 to 1 (0.04).
    pub wheelchair: f64,
}

impl Default for WalkerSettings {
    fn default() -> Self {
        Self { count: None, max_count: 480, min_speed_mps: 0.8, cross_factor: None, wheelchair: 0.04 }
    }
}

/// Weather. Overrides apply to the fields of [`crate::tables::Weather`] by name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WeatherSettings {
    /// Draw a final weather and move towards it over the scene.
    pub dynamic: bool,
    /// Fixed initial values by field name.
    pub initial: Vec<(String, f64)>,
    /// Fixed final values by field name.
    pub r#final: Vec<(String, f64)>,
}

impl Default for WeatherSettings {
    fn default() -> Self {
        Self { dynamic: true, initial: Vec::new(), r#final: Vec::new() }
    }
}

/// Street lamps and lit windows at night.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightSettings {
    /// Chance that a street lamp has failed (0.1).
    pub street_lamp_failure: f64,
    /// Change the flux of all street lamps of a dark scene by a common amount.
    pub change_intensity: bool,
    /// That amount, lumens; drawn per scene within the nominal flux either way when absent.
    pub intensity_change_lm: Option<f64>,
    /// No change takes a lamp below this flux, lumens (10,000).
    pub min_intensity_lm: f64,
    /// In a dark scene each building's windows have a colour of their own (not on high ground).
    pub random_building_colors: bool,
    /// Street lamps never burn.
    pub street_lamps_off: bool,
    /// Windows are never lit.
    pub buildings_off: bool,
}

impl Default for LightSettings {
    fn default() -> Self {
        Self {
            street_lamp_failure: 0.1,
            change_intensity: true,
            intensity_change_lm: None,
            min_intensity_lm: 10_000.0,
            random_building_colors: true,
            street_lamps_off: false,
            buildings_off: false,
        }
    }
}

/// Accidents and road works. Shares are 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HazardSettings {
    /// Share of the spawn points around the agents at which a hazard is tried (0.016).
    pub share: f64,
    /// Chance that it is an accident and not road works (0.5).
    pub accident_share: f64,
    /// Chance that an emergency vehicle stands at an accident (0.5).
    pub emergency_share: f64,
    /// Chance that a cone beside a hazard is missing (0.32).
    pub missing_cone_share: f64,
}

impl Default for HazardSettings {
    fn default() -> Self {
        Self { share: 0.016, accident_share: 0.5, emergency_share: 0.5, missing_cone_share: 0.32 }
    }
}

/// Scenery placed by rule on the land beside the roads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldSettings {
    /// Buildings per free frontage, 0 to 1 (0.8).
    pub building_density: f64,
    /// Trees per free frontage, 0 to 1 (0.6).
    pub tree_density: f64,
    /// Distance between street lamps along a sidewalk, metres (28).
    pub lamp_spacing_m: f64,
    /// Share of parking spaces that are taken, 0 to 1 (0.5).
    pub parked_share: f64,
    /// Scenery is built within this distance of any agent's path start, metres (400).
    pub radius_m: f64,
}

impl Default for WorldSettings {
    fn default() -> Self {
        Self {
            building_density: 0.8,
            tree_density: 0.6,
            lamp_spacing_m: 28.0,
            parked_share: 0.5,
            radius_m: 400.0,
        }
    }
}
