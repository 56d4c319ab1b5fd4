//! What makes the pictures of a camera.

use frames::math;
use serde::Serialize;

/// Size and intrinsics of a camera's pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Optics {
    /// Columns, pixels.
    pub width: u32,
    /// Rows, pixels.
    pub height: u32,
    /// Focal length in columns, pixels.
    pub fx: f64,
    /// Focal length in rows, pixels.
    pub fy: f64,
    /// Column of the optical axis; the middle of the first pixel is at 0.5.
    pub cx: f64,
    /// Row of the optical axis.
    pub cy: f64,
}

impl Optics {
    /// Square pixels, the axis through the middle and this horizontal field of view: `f = width / (2 tan(fov / 2))`. Of angles
    /// that no pinhole camera has (0, half a turn and beyond) the focal length is no number.
    #[must_use]
    pub fn pinhole(width: u32, height: u32, horizontal_fov_rad: f64) -> Self {
        let is_one = horizontal_fov_rad > 0.0 && horizontal_fov_rad < std::f64::consts::PI;
        let focal =
            if is_one { f64::from(width) / (2.0 * math::tan(0.5 * horizontal_fov_rad)) } else { f64::NAN };
        let middle = |side: u32| 0.5 * f64::from(side);
        Self { width, height, fx: focal, fy: focal, cx: middle(width), cy: middle(height) }
    }

    /// The 3 x 3 matrix that takes directions in the optical frame to pixels.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        [[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_angle_is_as_far_ahead_as_to_the_side() {
        let optics = Optics::pinhole(640, 360, frames::deg(90.0));
        assert!((optics.fx - 320.0).abs() < 1e-9 && optics.fy == optics.fx);
        assert_eq!([optics.cx, optics.cy], [320.0, 180.0]);
        // Published: 1600 pixels of 80 degrees.
        assert!((Optics::pinhole(1600, 900, frames::deg(80.0)).fx - 953.402_874_075_368_1).abs() < 1e-9);
        assert!(Optics::pinhole(640, 360, std::f64::consts::PI).fx.is_nan());
    }
}
