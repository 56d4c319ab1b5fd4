//! The light of a frame: sky, sun or moon with shadows, lamps, fog, and how the film is exposed.
//!
//! Light is in kilolux (illuminance) and kilocandela per square metre (radiance, as the eye weighs it), linear
//! sRGB.

mod atmosphere;
mod fog;
mod lamps;
mod math;
mod shadow;
mod sky;

use glam::Vec3;
use schema::tables::Weather;
use visibility::Scene;

pub(crate) use fog::Fog;
pub(crate) use lamps::Lamps;
pub(crate) use math::exp_neg;
pub(crate) use shadow::{Lit, Overhead, Shadows};
pub use sky::Sky;

use crate::look::Surroundings;

/// The light around one agent at one frame, for all its cameras.
#[derive(Clone, Debug)]
pub struct Lighting<'a> {
    pub(crate) sky: &'a Sky,
    pub(crate) shadows: Shadows,
    pub(crate) overhead: Overhead,
    pub(crate) lamps: Lamps,
    pub(crate) fog: Fog,
    pub(crate) around: Surroundings,
    /// Rain, 0 to 1.
    pub(crate) rain: f32,
}

impl<'a> Lighting<'a> {
    /// Works out the light around a place in a scene (the agent's origin, in the snapshot's local frame): shadow
    /// maps from the sun or moon and from above, and the lamps that burn near by.
    #[must_use]
    pub fn new(scene: &Scene<'_>, sky: &'a Sky, weather: &Weather, centre_local: Vec3) -> Self {
        let world = scene.snapshot().origin.world_xyz();
        let wrapped = world.map(|w| w.rem_euclid(Surroundings::WRAP_M) as f32);
        let share = |percent: f64| (percent / 100.0).clamp(0.0, 1.0) as f32;
        let (shadows, (overhead, lamps)) = rayon::join(
            || Shadows::new(scene, sky.key_direction, sky.key_casts_shadows(), centre_local),
            || {
                rayon::join(
                    || Overhead::new(scene, centre_local),
                    || Lamps::new(scene, sky.lamps_matter(), centre_local),
                )
            },
        );
        Self {
            sky,
            shadows,
            overhead,
            lamps,
            fog: Fog::new(weather, sky, centre_local.z),
            around: Surroundings {
                wetness: share(weather.wetness.max(weather.precipitation * 0.8)),
                puddles: share(weather.precipitation_deposits),
                world_from_local_m: wrapped.into(),
            },
            rain: share(weather.precipitation),
        }
    }
}
