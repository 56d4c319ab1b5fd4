//! The words that every crate shares: ids, tags, classes, palettes, table rows and meshes.
//!
//! Nothing here reads or writes files. Numbers that other tools know (tag ids, palettes, corner order,
//! channel order) are fixed here once and nowhere else.

mod actor_kind;
mod actor_role;
pub mod agent;
pub mod arrays;
mod attributes;
pub mod bev;
pub mod calibration;
pub mod class;
pub mod difficulty;
pub mod footprint;
mod format;
pub mod geometry;
mod hazard_kind;
mod ids;
pub mod images;
mod imported;
mod joined;
mod lamp_kind;
mod layer;
pub mod lens;
pub mod lights;
pub mod measures;
pub mod mesh_textures;
mod normals;
mod nuscenes;
pub mod older;
pub mod palette;
mod published;
pub mod rate;
mod return_kind;
pub mod scene_info;
mod sensor_kind;
mod sign_type;
mod signal_state;
pub mod table;
pub mod tables;
mod tag;
pub mod text;
pub mod tile;

pub use actor_kind::ActorKind;
pub use actor_role::ActorRole;
pub use agent::{AgentId, AgentKind, ParseAgentError};
pub use attributes::{Attribute, Attributes, FactKind, OTHER_FACTS};
pub use bev::BevClass;
pub use class::DetectionClass;
pub use difficulty::Difficulty;
pub use format::{FORMAT_VERSION, FRAME_PERIOD_S, SCENE_COLUMN, is_read};
pub use hazard_kind::HazardKind;
pub use ids::ObjectId;
pub use images::{ImageKind, ImageSet};
pub use imported::{IMPORTED, ZERO_COLUMNS, is_imported};
pub use joined::Joined;
pub use lamp_kind::LampKind;
pub use layer::Layer;
pub use normals::Normal;
pub use nuscenes::{NUSCENES_ATTRIBUTES, STANDING_MPS, is_trailer, nuscenes_attribute, nuscenes_class};
pub use published::{Published, SceneBins};
pub use return_kind::ReturnKind;
pub use sensor_kind::SensorKind;
pub use sign_type::{SIGN_TYPES, SignFace, speed_limit_type};
pub use signal_state::SignalState;
pub use tag::Tag;
