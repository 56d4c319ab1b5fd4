//! What is the same for all pixels of a picture.

use glam::Vec3;
use render::{CameraView, VisibilityBuffer};
use simd::{F32x8, Vec3x8};

use super::film::Film;
use super::mirror::Mirror;
use super::vignette::Vignette;
use crate::light::Lighting;
use crate::materials::PatternSet;

/// What a wall that hides the sky sends in its place, of what the sky gives: walls reflect some four tenths,
/// and half of what the ground has reaches them.
const WALLS: Vec3 = Vec3::new(0.27, 0.24, 0.20);

pub(super) struct Shader<'a> {
    pub(super) buffer: &'a VisibilityBuffer,
    pub(super) lighting: &'a Lighting,
    pub(super) patterns: PatternSet,
    /// Film value per radiance.
    pub(super) exposure: f32,
    /// Width of a pixel at a depth of a metre.
    pub(super) per_focal: f32,
    pub(super) camera: Vec3,
    pub(super) film: Film,
    pub(super) vignette: Vignette,
    /// What makes white things white.
    pub(super) balance: Vec3,
    pub(super) hazy: bool,
    /// Film value of fog.
    pub(super) veil: Vec3,
    /// Film value of a white surface, by the sky's ambient terms.
    pub(super) ambient: [Vec3; 4],
    /// Film value of a white surface by sunlight that comes back from what it falls on.
    pub(super) bounced: Vec3,
    /// Film value of a white surface that faces the sun.
    pub(super) key: Vec3,
    /// What wet ground mirrors, when the rest is painted.
    pub(super) mirror: Option<Mirror>,
}

impl<'a> Shader<'a> {
    pub(super) fn new(view: &CameraView, buffer: &'a VisibilityBuffer, lighting: &'a Lighting) -> Self {
        let exposure = lighting.exposure.per_radiance(view.settings.f_stop);
        let of_white = exposure / std::f32::consts::PI;
        Self {
            buffer,
            lighting,
            patterns: PatternSet::get(),
            exposure,
            per_focal: 1.0 / buffer.camera.fx,
            camera: Vec3::from(buffer.camera.local_from_optical.translation),
            film: Film::new(),
            vignette: Vignette::new(buffer.width, buffer.height, view.settings.vignetting as f32),
            balance: lighting.exposure.balance(view.settings.white_balance),
            hazy: !lighting.fog.is_clear(),
            veil: lighting.fog.rgb * exposure,
            ambient: lighting.sky.ambient.map(|a| a * of_white),
            bounced: lighting.sky.bounced_klx() * of_white,
            key: lighting.sky.key_klx * of_white,
            mirror: None,
        }
    }

    /// The light of sky and ground where houses leave such a share of the sky.
    #[inline]
    pub(super) fn between_houses(&self, ambient: Vec3x8, left: F32x8) -> Vec3x8 {
        let walls = 1.0 - left;
        let left = |wall: f32| walls * (wall - 1.0) + 1.0;
        ambient * Vec3x8::new(left(WALLS.x), left(WALLS.y), left(WALLS.z)) + Vec3x8::splat(self.bounced)
    }
}
