//! Everything that determines a dataset. Only the configuration and those who hand out its parts know this
//! whole: stages get the parts that they use ([`crate::stages`]).

use crate::agents::AgentSettings;
use crate::annotation::AnnotationSettings;
use crate::bev::{BevRule, BevSettings};
use crate::card::CardSettings;
use crate::config_key::ConfigKey;
use crate::hazards::HazardSettings;
use crate::key::{Settings, settings};
use crate::lights::LightSettings;
use crate::models::ModelSettings;
use crate::occupancy::OccupancySettings;
use crate::per_agent::PerAgent;
use crate::reader::{Section, describe};
use crate::rig::{OwnRig, Rig};
use crate::scenes::SceneCount;
use crate::store::StoreSettings;
use crate::timing::TimingSettings;
use crate::tracks::TrackSettings;
use crate::traffic::TrafficSettings;
use crate::walkers::WalkerSettings;
use crate::weather::WeatherSettings;
use crate::world::WorldSettings;
use crate::{rig_keys, scenes};

settings! {
    /// Everything that determines a dataset, besides maps and code.
    pub struct DatasetSettings {
        /// Name of the dataset, in reports.
        name: String = "dataset".into();
        /// How the store is kept: nothing of the dataset.
        #[serde(skip)]
        store: StoreSettings = StoreSettings::default(), table();
        /// Words of the dataset's card, README.md in the store.
        card: CardSettings = CardSettings::default(), table();
        /// Seed of every random stream but that of the scenery (`world.seed`).
        seed: u64 = 27, within(0..=i64::MAX as u64);
        /// How many scenes on which map.
        scenes: Vec<SceneCount> = Vec::new(), by(scenes::counts);
        /// Scenes to replace by other ones of the same split and map; keys are scene numbers.
        redraw: Vec<(u32, u32)> = Vec::new(), by(scenes::redraw);
        /// Data-collection vehicles and RSUs.
        agents: AgentSettings = AgentSettings::default(), table();
        /// Models besides the built-in ones.
        #[serde(skip_serializing_if = "ModelSettings::is_built_in")]
        models: ModelSettings = ModelSettings::default(), table();
        /// Warm-up and durations.
        timing: TimingSettings = TimingSettings::default(), table();
        /// Background vehicles and drivers.
        traffic: TrafficSettings = TrafficSettings::default(), table();
        /// Pedestrians.
        walkers: WalkerSettings = WalkerSettings::default(), table();
        /// Weather draws and overrides.
        weather: WeatherSettings = WeatherSettings::default(), table();
        /// Street lamps and lit windows at night.
        lights: LightSettings = LightSettings::default(), table();
        /// Accidents and road works.
        hazards: HazardSettings = HazardSettings::default(), table();
        /// The static world: scenery placed by rule on the land beside the roads.
        world: WorldSettings = WorldSettings::default(), table();
        /// Sensors of every data-collection vehicle.
        vehicle_rig: Rig = Rig::vehicle(), named("vehicle"), by(rig_keys::rig);
        /// Sensors of every RSU.
        rsu_rig: Rig = Rig::rsu(), named("rsu"), by(rig_keys::rig);
        /// Agents with sensors and voxel grid of their own; besides `agents` all keys of `vehicle` or `rsu`,
        /// with the same defaults.
        own_rigs: Vec<OwnRig> = Vec::new(), named("rigs"), by(rig_keys::own);
        /// Which objects are annotated.
        annotation: AnnotationSettings = AnnotationSettings::default(), table();
        /// Objects followed over a scene.
        tracks: TrackSettings = TrackSettings::default(), table();
        /// Bird's-eye-view masks.
        bev: BevSettings = BevSettings::default(), table();
        /// Voxel grids of vehicles.
        vehicle_occupancy: OccupancySettings = OccupancySettings::default(), named("vehicle"), by(rig_keys::grid);
        /// Voxel grids of RSUs.
        rsu_occupancy: OccupancySettings = OccupancySettings::default(), named("rsu"), by(rig_keys::grid);
    }
    rule consistent;
}

/// Every key with its type, default and meaning, in reading order: the source of `docs/configuration.md`.
#[must_use]
pub fn config_keys() -> Vec<ConfigKey> {
    describe(read)
}

/// Reads a configuration.
pub(crate) fn read(root: &Section<'_>) -> DatasetSettings {
    DatasetSettings::read(root, &DatasetSettings::default())
}

/// What keys of several tables must be together.
fn consistent(root: &Section<'_>, settings: &DatasetSettings) {
    check_rates(root, settings);
    check_observers(root, settings);
    if settings.models.is_built_in() {
        known_models(root, &settings.agents);
    }
    if settings.agents.penetration.is_some() && settings.traffic.vehicles.is_none() {
        root.fault_at(
            "agents",
            "`agents.penetration` is a share of `traffic.vehicles`: say how many vehicles there are".into(),
        );
    }
}

fn known_models(root: &Section<'_>, settings: &AgentSettings) {
    for model in &settings.vehicle_models {
        if catalogue::models::find(model).is_none_or(|m| m.wheelbase_m <= 0.0) {
            let problem = format!("`agents.vehicle_models`: no vehicle model `{model}`");
            root.section("agents", "").fault_at("vehicle_models", problem);
        }
    }
}

fn check_observers(root: &Section<'_>, settings: &DatasetSettings) {
    let check = rig_keys::check_observers;
    check(&root.section("vehicle", ""), &settings.vehicle_rig, &settings.vehicle_occupancy);
    check(&root.section("rsu", ""), &settings.rsu_rig, &settings.rsu_occupancy);
    let own = root.sections("rigs", "", "").unwrap_or_default();
    for (section, own) in own.iter().zip(&settings.own_rigs) {
        check(section, &own.rig, &own.occupancy);
    }
}

/// Labels that are made of boxes need boxes at their frames.
fn check_rates(root: &Section<'_>, settings: &DatasetSettings) {
    let boxes = settings.annotation.every_n_frames;
    let problem = |key: &str, frames: u32| {
        format!(
            "`{key}` asks for every {frames}. frame, which is no multiple of `annotation.every_n_frames` ({boxes}): there are \
             no boxes between"
        )
    };
    let (bev, tracks) = (&settings.bev, &settings.tracks);
    if bev.enabled && bev.rule == BevRule::Simbev2x && !bev.every_n_frames.is_multiple_of(boxes) {
        root.fault_at("bev", problem("bev.every_n_frames", bev.every_n_frames));
    }
    for (key, frames) in [("tracks.step_s", tracks.step_frames()), ("tracks.every_s", tracks.every_frames())]
    {
        if tracks.windows && !frames.is_multiple_of(boxes) {
            root.fault_at_any(&["tracks", "annotation"], problem(key, frames));
        }
    }
}
impl DatasetSettings {
    /// The published settings for some scenes.
    #[must_use]
    pub fn with_scenes(scenes: Vec<SceneCount>) -> Self {
        Self { scenes, ..Self::default() }
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
