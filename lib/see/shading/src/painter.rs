//! The interface of painters, and the painter on the CPU.

use glam::Vec3;
use render::{CameraView, RenderError, Renderer, Scene};

use crate::light::{FrameWeather, SceneLights, StillWorld};
use crate::picture::{Picture, Shot, compose};
use crate::sight::{Sight, wants_colour};

/// Paints colour pictures of one scene from what a renderer saw: the second seam.
///
/// A painter owns the lights of its scene (skies by frame, shadow maps by frame and place). All painters give
/// the same pictures, bit for bit, so that one scene may be painted by several.
pub trait Painter: Send + Sync {
    /// A picture for each shot, in their order. All were taken near `place_local` (the agent's origin, in the
    /// snapshot's local frame, metres) at one frame.
    ///
    /// # Errors
    /// The renderer or the painter's device failed.
    fn paint(
        &self,
        scene: &dyn Scene,
        when: &FrameWeather,
        place_local: Vec3,
        shots: &[Shot<'_>],
    ) -> Result<Vec<Picture>, RenderError>;

    /// What cameras near `place_local` see, in their order, with pictures where [`wants_colour`] says so. A
    /// painter whose device looks as well answers this whole: what was seen need not leave the device to be
    /// painted.
    ///
    /// # Errors
    /// As [`Painter::paint`].
    fn see(
        &self,
        scene: &dyn Scene,
        when: &FrameWeather,
        place_local: Vec3,
        views: Vec<CameraView>,
    ) -> Result<Vec<Sight>, RenderError> {
        let mut sights = Sight::all(scene, views)?;
        let in_colour = sights.iter().filter(|sight| wants_colour(&sight.view));
        let shots: Vec<Shot<'_>> = in_colour.map(|Sight { view, seen, .. }| Shot { view, seen }).collect();
        if !shots.is_empty() {
            let pictures = self.paint(scene, when, place_local, &shots)?;
            let in_colour = sights.iter_mut().filter(|sight| wants_colour(&sight.view));
            in_colour.zip(pictures).for_each(|(sight, picture)| sight.picture = Some(picture));
        }
        Ok(sights)
    }
}

/// Paints on the processor's cores.
#[derive(Debug, Default)]
pub struct CpuPainter<'a> {
    lights: SceneLights<'a>,
}

impl<'a> CpuPainter<'a> {
    /// A painter that keeps what lights see of static objects; the renderer has the world's meshes. (The
    /// default keeps nothing: its scenes may be of any world.)
    #[must_use]
    pub fn new(renderer: &'a dyn Renderer, world: &'a dyn StillWorld) -> Self {
        Self { lights: SceneLights::over(renderer, world) }
    }
}

impl Painter for CpuPainter<'_> {
    fn paint(
        &self,
        scene: &dyn Scene,
        when: &FrameWeather,
        place_local: Vec3,
        shots: &[Shot<'_>],
    ) -> Result<Vec<Picture>, RenderError> {
        let lighting = self.lights.around(scene, when, place_local)?;
        compose(scene, shots, &lighting)
    }
}
