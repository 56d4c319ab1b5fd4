//! Cameras.

use frames::deg;
use serde::Serialize;

use super::mount::Mount;
use crate::ImageSet;

/// What all cameras of a rig share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSettings {
    /// Image width, pixels (1600).
    pub width: u32,
    /// Image height, pixels (900).
    pub height: u32,
    /// Horizontal field of view, radians (80 degrees).
    pub horizontal_fov_rad: f64,
    /// Aperture of the RGB images (1.8).
    pub f_stop: f64,
    /// JPEG quality of the RGB images, 1 to 100 (80).
    pub jpeg_quality: u8,
    /// Write the boxes of objects in the pictures (false).
    pub boxes_2d: bool,
    /// Keep flow as half floats (false).
    pub flow_half: bool,
    /// Pictures are taken at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
    /// Which images are written: a flag a kind.
    #[serde(flatten)]
    pub images: ImageSet,
}

impl Default for CameraSettings {
    fn default() -> Self {
        Self {
            width: 1600,
            height: 900,
            horizontal_fov_rad: deg(80.0),
            f_stop: 1.8,
            jpeg_quality: 80,
            boxes_2d: false,
            flow_half: false,
            every_n_frames: 1,
            images: ImageSet::default(),
        }
    }
}

impl CameraSettings {
    /// Focal length in pixels: `width / (2 tan(fov / 2))`; pixels are square, the principal point is the centre.
    #[must_use]
    pub fn focal_px(&self) -> f64 {
        f64::from(self.width) / (2.0 * frames::math::tan(0.5 * self.horizontal_fov_rad))
    }
}

/// One camera position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSpec {
    /// `CAM_FRONT` and so on.
    pub name: String,
    /// Where it sits (FLU; it looks along the mount's x axis).
    pub mount: Mount,
}
