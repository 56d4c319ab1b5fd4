//! The light of a frame: sky, sun or moon with shadows, lamps, fog, and how the film is exposed.
//!
//! Light is in kilolux (illuminance) and kilocandela per square metre (radiance, as the eye weighs it), linear
//! sRGB.

mod atmosphere;
mod enclosed;
mod exposure;
mod fog;
mod headlight;
mod lamps;
mod lens;
mod lighting;
mod map;
mod math;
mod ramp;
mod scene_lights;
mod seen;
mod shadow;
mod sky;
mod skyline;
mod still;
mod street;
mod walls;

pub use fog::fog_extinction_per_m;
pub use lighting::{FrameWeather, Lighting};
pub(crate) use map::Lit;
pub(crate) use ramp::Ramp;
pub(crate) use scene_lights::SceneLights;
pub use sky::Sky;
pub(crate) use skyline::Skyline;
pub use still::StillWorld;
pub(crate) use walls::Facing;
