//! The configuration's language: what can be said of a dataset, and how it is read from TOML or from YAML of
//! SimBEV2X.
//!
//! Settings are plain, validated values, in SI units and radians; each stage sees the parts that it uses
//! ([`stages`]). Default values are those of the published dataset unless a field says otherwise. Each
//! section is a file of its own.

mod agents;
mod annotation;
mod bev;
mod camera;
mod card;
mod config_key;
mod dataset;
mod difference;
mod document;
mod groups;
mod hazards;
mod inertial;
mod json_schema;
mod key;
mod lidar;
mod lights;
mod load;
mod map_name;
mod models;
mod mount;
mod occupancy;
mod optics;
mod per_agent;
mod pictures;
mod radar;
mod reader;
mod rig;
mod rig_keys;
mod scenario;
mod scenes;
mod shipped;
pub mod stages;
mod store;
mod suspicions;
mod table_names;
mod timing;
mod tracks;
mod traffic;
mod walkers;
mod weather;
mod world;
mod yaml;

pub use agents::{AgentSettings, GivenRoute, GivenRsu, GivenStart, SpawnMode};
pub use annotation::AnnotationSettings;
pub use bev::{BevRule, BevSettings};
pub use camera::{CameraSettings, CameraSpec};
pub use card::CardSettings;
pub use config_key::{Absent, ConfigKey, Kind};
pub use dataset::{DatasetSettings, config_keys};
pub use difference::{KeyChange, change_lines, key_changes};
pub use document::Fault;
pub use groups::Group;
pub use hazards::HazardSettings;
pub use inertial::{GnssSpec, ImuSpec};
pub use json_schema::{json_schema, rig_json_schema};
pub use lidar::{BeamSpec, LidarSpec, Returned, RollingScan, ScanPattern, WeatherSpec};
pub use lights::LightSettings;
pub use load::{load, parse, rigs_named_in, suspicions_in};
pub use map_name::{MAP_ENDINGS, map_name};
pub use models::ModelSettings;
pub use mount::Mount;
pub use occupancy::{FillingRule, OccupancySettings, SweepSettings, ZFill};
pub use optics::Optics;
pub use per_agent::PerAgent;
pub use radar::RadarSpec;
pub use rig::*;
pub use scenario::Scenario;
pub use scenes::{SceneCount, Split};
pub use schema::lens::{Lens, LensModel};
pub use shipped::{Shipped, text_at};
pub use store::StoreSettings;
pub use suspicions::Suspicion;
pub use timing::TimingSettings;
pub use tracks::TrackSettings;
pub use traffic::TrafficSettings;
pub use walkers::WalkerSettings;
pub use weather::{WeatherKeyframe, WeatherSettings, WeatherValue};
pub use world::{SceneryRules, Season, WorldSettings};
pub use yaml::simbev2x_keys;
