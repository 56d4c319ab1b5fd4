//! What lights one place at one frame.

use std::sync::Arc;

use glam::Vec3;
use render::{RenderError, Scene};
use schema::tables::Weather;

use super::environment_map::{EnvironmentMap, LitSurroundings};
use super::exposure::Exposure;
use super::fog::Fog;
use super::lamps::Lamps;
use super::shadow::{Caster, Shadows, SkyOcclusionMap, shadows_at};
use super::sky::Sky;
use super::sky_visibility::SkyVisibility;
use super::still::StillMaps;
use crate::materials::Surroundings;

/// What decides the light of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameWeather {
    /// Number of the frame.
    pub frame: u32,
    /// Seconds after frame 0: clouds drift with the wind.
    pub time_s: f64,
    /// The weather then.
    pub weather: Weather,
    /// Whether the sun stands nearly still from frame to frame, so that what it sees of things that stand
    /// still may be kept.
    pub is_steady: bool,
}

impl FrameWeather {
    /// Most that a steady sun turns from a frame to the next, radians: some maps serve four frames then.
    pub const STEADY_RAD: f64 = 1.0 / 1024.0;
}

/// The light around one place at one frame, for all cameras there.
#[derive(Clone, Debug)]
pub struct Lighting {
    pub(crate) sky: Arc<Sky>,
    pub(crate) shadows: Shadows,
    pub(crate) overhead: SkyOcclusionMap,
    pub(crate) walls: SkyVisibility,
    pub(crate) lamps: Lamps,
    pub(crate) exposure: Exposure,
    pub(crate) fog: Fog,
    pub(crate) environment_map: EnvironmentMap,
    pub(crate) around: Surroundings,
    /// Rain, 0 to 1.
    pub(crate) rain: f32,
    /// Number of the frame.
    pub(crate) frame: u32,
}

impl Lighting {
    /// Works out the light around a place in a scene (in the snapshot's local frame): shadow maps from the
    /// sun or moon and from above, and the lamps that burn near by.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn new(
        scene: &dyn Scene,
        sky: Arc<Sky>,
        weather: &Weather,
        centre_local: Vec3,
    ) -> Result<Self, RenderError> {
        let when = FrameWeather { frame: 0, time_s: 0.0, weather: *weather, is_steady: false };
        Self::over(scene, None, sky, &when, centre_local)
    }

    /// The same where maps of static objects may be kept.
    pub(crate) fn over(
        scene: &dyn Scene,
        still: Option<&StillMaps<'_>>,
        sky: Arc<Sky>,
        when: &FrameWeather,
        centre_local: Vec3,
    ) -> Result<Self, RenderError> {
        let (snapshot, weather) = (scene.snapshot(), &when.weather);
        let world = snapshot.origin.world_xyz();
        let wrapped = world.map(|w| w.rem_euclid(Surroundings::WRAP_M) as f32);
        let share = |percent: f64| (percent / 100.0).clamp(0.0, 1.0) as f32;
        let caster = sky
            .key_casts_shadows()
            .then_some(Caster { to_light: sky.key_direction, is_steady: when.is_steady });
        let (shadows, (lamps, walls)) = rayon::join(
            || shadows_at(scene, still, caster, centre_local),
            || {
                let walls = SkyVisibility::around(scene, still, centre_local);
                (Lamps::new(scene, sky.lamps_matter(), centre_local), walls)
            },
        );
        let ((shadows, overhead), lamps, walls) = (shadows?, lamps?, walls?);
        let exposure = Exposure::new(sky.around_klx, lamps.on_the_ground(centre_local));
        let fog = Fog::new(weather, sky.horizon, centre_local.z);
        let seen = LitSurroundings { sky: &sky, shadows: &shadows, lamps: &lamps, fog: &fog };
        let environment_map = EnvironmentMap::new(scene, seen, centre_local)?;
        Ok(Self {
            shadows,
            overhead,
            walls,
            lamps,
            exposure,
            fog,
            environment_map,
            around: Surroundings {
                wetness: share(weather.wetness.max(weather.precipitation * 0.8)),
                puddles: share(weather.precipitation_deposits),
                rain: share(weather.precipitation),
                frame: when.frame,
                world_from_local_m: wrapped.into(),
            },
            rain: share(weather.precipitation),
            frame: when.frame,
            sky,
        })
    }
}
