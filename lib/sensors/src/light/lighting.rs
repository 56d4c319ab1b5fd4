//! What lights one place at one frame.

use std::sync::Arc;

use glam::Vec3;
use renderer::{RenderError, Scene};
use schema::tables::Weather;

use super::fog::Fog;
use super::lamps::Lamps;
use super::shadow::{Overhead, Shadows, shadows_at};
use super::sky::Sky;
use crate::look::Surroundings;

/// What decides the light of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameWeather {
    /// Number of the frame.
    pub frame: u32,
    /// Seconds after frame 0: clouds drift with the wind.
    pub time_s: f64,
    /// The weather then.
    pub weather: Weather,
}

/// The light around one place at one frame, for all cameras there.
#[derive(Clone, Debug)]
pub struct Lighting {
    pub(crate) sky: Arc<Sky>,
    pub(crate) shadows: Shadows,
    pub(crate) overhead: Overhead,
    pub(crate) lamps: Lamps,
    pub(crate) fog: Fog,
    pub(crate) around: Surroundings,
    /// Rain, 0 to 1.
    pub(crate) rain: f32,
}

impl Lighting {
    /// Works out the light around a place in a scene (in the snapshot's local frame): shadow maps from the sun or moon
    /// and from above, and the lamps that burn near by.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn new(
        scene: &dyn Scene,
        sky: Arc<Sky>,
        weather: &Weather,
        centre_local: Vec3,
    ) -> Result<Self, RenderError> {
        let snapshot = scene.snapshot();
        let world = snapshot.origin.world_xyz();
        let wrapped = world.map(|w| w.rem_euclid(Surroundings::WRAP_M) as f32);
        let share = |percent: f64| (percent / 100.0).clamp(0.0, 1.0) as f32;
        let (shadows, lamps) = rayon::join(
            || shadows_at(scene, sky.key_direction, sky.key_casts_shadows(), centre_local),
            || Lamps::new(snapshot, sky.lamps_matter(), centre_local),
        );
        let (shadows, overhead) = shadows?;
        Ok(Self {
            shadows,
            overhead,
            lamps,
            fog: Fog::new(weather, &sky, centre_local.z),
            around: Surroundings {
                wetness: share(weather.wetness.max(weather.precipitation * 0.8)),
                puddles: share(weather.precipitation_deposits),
                world_from_local_m: wrapped.into(),
            },
            rain: share(weather.precipitation),
            sky,
        })
    }
}
