//! The light of a frame: sky, sun or moon with shadows, lamps, fog, and how the film is exposed.
//!
//! Light is in kilolux (illuminance) and kilocandela per square metre (radiance, as the eye weighs it),
//! linear sRGB.

mod atmosphere;
mod corner_gradient;
mod dazzle;
mod environment_map;
mod exposure;
mod fog;
mod headlight;
mod lamp_depths;
mod lamps;
mod lens;
mod lighting;
mod map;
mod math;
mod scene_lights;
mod shadow;
mod sky;
mod sky_visibility;
mod still;
mod street;
mod walls;

pub(crate) use corner_gradient::CornerGradient;
pub(crate) use dazzle::Shining;
pub(crate) use environment_map::EnvironmentMap;
pub use fog::fog_extinction_per_m;
pub use lighting::{FrameWeather, Lighting};
pub(crate) use map::Lit;
pub(crate) use scene_lights::SceneLights;
pub use sky::Sky;
pub use still::StillWorld;
pub(crate) use walls::Facing;
