//! The lights of a whole scene.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use glam::Vec3;
use render::{RenderError, Renderer, Scene};

use super::lighting::{FrameWeather, Lighting};
use super::sky::Sky;
use super::still::{StillMaps, StillWorld};

/// Skies kept at most: 3 MiB each.
const MOST_SKIES: usize = 48;

/// Owns the light of one scene's frames: skies belong to a frame, shadow maps and lamps to a place at a
/// frame, but maps of static objects to a place and a direction of the light. Agents ask for what they
/// stand in.
#[derive(Debug, Default)]
pub(crate) struct SceneLights<'a> {
    still: Option<StillMaps<'a>>,
    skies: Mutex<BTreeMap<u32, Arc<Sky>>>,
}

impl<'a> SceneLights<'a> {
    /// The lights of a scene of whose world the static objects are known.
    pub(crate) fn over(renderer: &'a dyn Renderer, world: &'a dyn StillWorld) -> Self {
        Self { still: Some(StillMaps::new(renderer, world)), skies: Mutex::default() }
    }

    /// The light around a place (in the scene's local frame) at a frame.
    ///
    /// # Errors
    /// The renderer failed.
    pub(crate) fn around(
        &self,
        scene: &dyn Scene,
        when: &FrameWeather,
        centre_local: Vec3,
    ) -> Result<Lighting, RenderError> {
        Lighting::over(scene, self.still.as_ref(), self.sky(when), when, centre_local)
    }

    /// The sky of a frame. Of a long scene the first frames' are kept: agents come by one after the other,
    /// each from the first frame to the last.
    fn sky(&self, when: &FrameWeather) -> Arc<Sky> {
        let known = self.skies.lock().ok().and_then(|skies| skies.get(&when.frame).cloned());
        known.unwrap_or_else(|| {
            // Computed outside the lock, so that others need not wait: two threads may compute a sky twice,
            // with equal results.
            let sky = Arc::new(Sky::new(&when.weather, when.time_s));
            if let Ok(mut skies) = self.skies.lock()
                && skies.len() < MOST_SKIES
            {
                skies.insert(when.frame, Arc::clone(&sky));
            }
            sky
        })
    }
}

#[cfg(test)]
mod tests {
    use schema::tables::Weather;

    use super::*;

    #[test]
    fn a_frames_sky_is_made_once_and_memory_is_bounded() {
        let lights = SceneLights::default();
        let at = |frame| FrameWeather {
            frame,
            time_s: f64::from(frame),
            weather: Weather::default(),
            is_steady: true,
        };
        let first = lights.sky(&at(0));
        assert!(Arc::ptr_eq(&first, &lights.sky(&at(0))));
        assert!(!Arc::ptr_eq(&first, &lights.sky(&at(1))));
        let full: BTreeMap<u32, Arc<Sky>> = (0..MOST_SKIES as u32).map(|f| (f, Arc::clone(&first))).collect();
        *lights.skies.lock().expect("nobody panicked") = full;
        let beyond = at(MOST_SKIES as u32);
        assert!(!Arc::ptr_eq(&lights.sky(&beyond), &lights.sky(&beyond)));
        assert_eq!(lights.skies.lock().expect("nobody panicked").len(), MOST_SKIES);
    }
}
