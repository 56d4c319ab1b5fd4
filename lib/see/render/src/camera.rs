//! Pinhole cameras.

use glam::{Affine3A, Vec3};

/// A pinhole camera without distortion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinholeCamera {
    /// Optical frame (x right, y down, z forward) to the snapshot's local frame. Rigid.
    pub local_from_optical: Affine3A,
    /// Columns, pixels.
    pub width: u32,
    /// Rows, pixels.
    pub height: u32,
    /// Focal length in columns, pixels; positive.
    pub fx: f32,
    /// Focal length in rows, pixels; positive.
    pub fy: f32,
    /// Column of the optical axis; the centre of pixel (0, 0) is at (0.5, 0.5).
    pub cx: f32,
    /// Row of the optical axis.
    pub cy: f32,
    /// Nearest planar depth seen, metres; positive.
    pub near_m: f32,
    /// Farthest planar depth seen, metres.
    pub far_m: f32,
}

impl PinholeCamera {
    /// Nearest depth of [`PinholeCamera::centred`], metres.
    pub const NEAR_M: f32 = 0.05;
    /// Farthest depth of [`PinholeCamera::centred`], metres.
    pub const FAR_M: f32 = 1000.0;

    /// A camera with square pixels, its axis through the middle of the picture and this horizontal field of
    /// view.
    #[must_use]
    pub fn centred(local_from_optical: Affine3A, width: u32, height: u32, horizontal_fov_rad: f32) -> Self {
        let focal = 0.5 * width as f32 / frames::math::f32::tan(0.5 * horizontal_fov_rad);
        Self {
            local_from_optical,
            width,
            height,
            fx: focal,
            fy: focal,
            cx: 0.5 * width as f32,
            cy: 0.5 * height as f32,
            near_m: Self::NEAR_M,
            far_m: Self::FAR_M,
        }
    }

    /// The direction in the optical frame through a point of the picture, scaled to z = 1.
    ///
    /// The centre of pixel `(u, v)` is the point `(u + 0.5, v + 0.5)`. A surface at planar depth `z` along it
    /// is at `z * direction`.
    #[must_use]
    pub fn direction_optical(&self, column: f32, row: f32) -> Vec3 {
        Vec3::new((column - self.cx) / self.fx, (row - self.cy) / self.fy, 1.0)
    }
}
