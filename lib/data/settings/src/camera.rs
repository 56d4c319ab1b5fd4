//! Cameras.

use serde::Serialize;

use super::mount::Mount;
use super::optics::Optics;
use schema::ImageSet;

/// What all cameras of a rig share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSettings {
    /// Aperture of the RGB images (1.8).
    pub f_stop: f64,
    /// Share of the light that RGB images lose in their corners (0.2).
    pub vignetting: f64,
    /// How far the colour of the light is taken out of RGB images, 0 to 1 (0.6).
    pub white_balance: f64,
    /// Share of the light beyond white that the lens scatters over RGB images (0.03).
    pub bloom: f64,
    /// Noise of RGB images, times that of a usual chip (1).
    pub noise: f64,
    /// How long the shutter of RGB images is open, seconds; it closes at the frame's time. 0: nothing is smeared (0).
    pub exposure_time_s: f64,
    /// Width of the lens's opening that blurs RGB images, millimetres. 0: all is sharp (0).
    pub aperture_mm: f64,
    /// What is so far away is sharp, metres (20).
    pub focus_m: f64,
    /// Drops of rain on the glass before the lens in RGB images, times a usual number. 0: it stays dry (0).
    pub lens_drops: f64,
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
            f_stop: 1.8,
            vignetting: 0.2,
            white_balance: 0.6,
            bloom: 0.03,
            noise: 1.0,
            exposure_time_s: 0.0,
            aperture_mm: 0.0,
            focus_m: 20.0,
            lens_drops: 0.0,
            jpeg_quality: 80,
            boxes_2d: false,
            flow_half: false,
            every_n_frames: 1,
            images: ImageSet::default(),
        }
    }
}

/// One camera.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraSpec {
    /// `CAM_FRONT` and so on.
    pub name: String,
    /// Where it sits (FLU; it looks along the mount's x axis).
    pub mount: Mount,
    /// Size and intrinsics of its pictures (1600 x 900, 80 degrees).
    pub optics: Optics,
}
