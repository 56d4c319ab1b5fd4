//! The interface of painters, and the painter on the CPU.

use glam::Vec3;
use render::{RenderError, Renderer, Scene};

use crate::light::{FrameWeather, SceneLights, StillWorld};
use crate::picture::{Picture, Shot, compose};

/// Paints colour pictures of one scene from what a renderer saw: the second seam, which a renderer need not
/// fill.
///
/// A painter owns the lights of its scene (skies by frame, shadow maps by frame and place). Pictures of two
/// painters may differ by two levels a channel; a dataset is painted by one.
pub trait Painter: Send + Sync {
    /// A picture for each shot, in their order. All were taken near `place_local` (the agent's origin, in the
    /// snapshot's local frame) at one frame.
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
