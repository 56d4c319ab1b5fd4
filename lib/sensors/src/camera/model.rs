//! How a camera makes a picture of what is before it.

use glam::{Affine3A, Vec2, Vec3};
use renderer::PinholeCamera;
use schema::settings::Optics;

use crate::error::{MAX_SIDE_PX, SensorError};

/// Parts of a pixel that an axis may lie at: crops of a picture then have the same rays, bit for bit.
const AXIS_STEPS: f64 = 1024.0;

/// How a camera makes a picture of what is before it.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraModel {
    optics: Optics,
}

impl CameraModel {
    /// Of size and intrinsics.
    ///
    /// # Errors
    /// The picture has no pixels or too many, or the intrinsics are not those of a camera.
    pub fn new(optics: &Optics) -> Result<Self, SensorError> {
        let Optics { width, height, fx, fy, cx, cy } = *optics;
        if !(1..=MAX_SIDE_PX).contains(&width) || !(1..=MAX_SIDE_PX).contains(&height) {
            return Err(SensorError::PictureSize { width, height });
        }
        let is_length = |f: f64| (f as f32).is_finite() && f as f32 > 0.0;
        if !(is_length(fx) && is_length(fy) && (cx as f32).is_finite() && (cy as f32).is_finite()) {
            return Err(SensorError::Intrinsics { fx, fy, cx, cy });
        }
        Ok(Self { optics: optics.clone() })
    }

    /// Size and intrinsics.
    #[must_use]
    pub fn optics(&self) -> &Optics {
        &self.optics
    }

    /// The camera as renderers know it, at a place.
    #[must_use]
    pub fn pinhole(&self, local_from_optical: Affine3A) -> PinholeCamera {
        let Optics { width, height, fx, fy, cx, cy } = self.optics;
        let axis = |at: f64| ((at * AXIS_STEPS).round() / AXIS_STEPS) as f32;
        PinholeCamera {
            local_from_optical,
            width,
            height,
            fx: fx as f32,
            fy: fy as f32,
            cx: axis(cx),
            cy: axis(cy),
            near_m: PinholeCamera::NEAR_M,
            far_m: PinholeCamera::FAR_M,
        }
    }
}

/// Position in the picture of a point in the optical frame, pixels; what is nearer than the near plane (or behind)
/// is moved onto it.
pub(crate) fn project(camera: &PinholeCamera, point: Vec3) -> Vec2 {
    let z = point.z.max(camera.near_m);
    Vec2::new(camera.fx * point.x / z + camera.cx, camera.fy * point.y / z + camera.cy)
}
