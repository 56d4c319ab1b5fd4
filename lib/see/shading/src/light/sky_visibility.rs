//! What houses leave of the sky around an agent.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use render::{RenderError, Scene};
use simd::{F32x8, Vec3x8};

use super::lens::{HOUSES, Lens};
use super::still::StillMaps;
use super::walls::{Facing, Walls};

/// [`Walls`] around a place, in its local frame.
#[derive(Clone, Debug)]
pub(crate) struct SkyVisibility {
    walls: Arc<Walls>,
    /// Its south-west corner, and the height that its heights are over.
    corner_local: Vec3,
}

impl SkyVisibility {
    /// Around a place of a scene.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn around(
        scene: &dyn Scene,
        still: Option<&StillMaps<'_>>,
        centre_local: Vec3,
    ) -> Result<Self, RenderError> {
        let origin = scene.snapshot().origin;
        let place_m = DVec3::from_array(origin.world_xyz()) + centre_local.as_dvec3();
        let (lens, _) = Lens::at(place_m, Vec3::Z, &HOUSES);
        let walls = match still {
            Some(still) => still.walls(&lens)?,
            None => Arc::new(Walls::new(scene, &lens)?),
        };
        let half_m = 0.5 * walls.side as f32 * walls.cell_m;
        let centre = origin.local_from_world(walls.centre_m.to_array());
        Ok(Self { walls, corner_local: centre - Vec3::new(half_m, half_m, 0.0) })
    }

    /// The share of the sky's light that reaches a place of a surface, of what would without houses.
    #[inline]
    pub(crate) fn open(&self, position_local: Vec3, facing: &Facing) -> f32 {
        self.walls.open(position_local - self.corner_local, facing)
    }

    /// The same at eight places.
    #[inline]
    pub(crate) fn open_all(&self, positions: &Vec3x8, facing: &Facing) -> F32x8 {
        if self.walls.side == 0 {
            return F32x8::ONE;
        }
        F32x8::from(std::array::from_fn(|i| self.open(positions.lane(i), facing)))
    }
}
