//! What makes the pictures of a camera.

use frames::math;
use serde::{Deserialize, Serialize};

use schema::lens::{Lens, LensModel};

/// Size and intrinsics of a camera's pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// What bends its rays (nothing).
    pub lens: Lens,
}

impl Optics {
    /// Square pixels, the axis through the middle and this horizontal field of view:
    /// `f = width / (2 tan(fov / 2))`. Of angles that no pinhole camera has (0, half a turn and beyond) the
    /// focal length is no number.
    #[must_use]
    pub fn pinhole(width: u32, height: u32, horizontal_fov_rad: f64) -> Self {
        let is_one = horizontal_fov_rad > 0.0 && horizontal_fov_rad < std::f64::consts::PI;
        let focal =
            if is_one { f64::from(width) / (2.0 * math::tan(0.5 * horizontal_fov_rad)) } else { f64::NAN };
        let middle = |side: u32| 0.5 * f64::from(side);
        Self {
            width,
            height,
            fx: focal,
            fy: focal,
            cx: middle(width),
            cy: middle(height),
            lens: Lens::Pinhole,
        }
    }

    /// The same of a lens: of fisheyes the focal length is that by which half of the picture is half of the
    /// angle. Brown's distortion changes the angle that is given here.
    #[must_use]
    pub fn by_angle(width: u32, height: u32, horizontal_fov_rad: f64, lens: &Lens) -> Self {
        let mut optics = Self { lens: *lens, ..Self::pinhole(width, height, horizontal_fov_rad) };
        if let (Lens::Fisheye { .. }, Some(model)) = (lens, LensModel::of(lens)) {
            let (sin, cos) = math::sin_cos(0.5 * horizontal_fov_rad);
            let ([radius, _], _) = model.project([sin, 0.0, cos]);
            optics.fx = 0.5 * f64::from(width) / radius;
            optics.fy = optics.fx;
        }
        optics
    }

    /// Why no such lens can make the picture, if none can: each pixel must look somewhere.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let model = LensModel::of(&self.lens)?;
        // If the rim looks somewhere, so does what it surrounds: lenses are one to one up to a distance from
        // the axis.
        let (width, height) = (self.width, self.height);
        let sides = (0..height).flat_map(|y| [(0, y), (width - 1, y)]);
        let rim = (0..width).flat_map(|x| [(x, 0), (x, height - 1)]).chain(sides);
        let blind = rim.filter(|&(x, y)| model.direction(self.place(x, y)).is_none()).min()?;
        Some(format!(
            "pixel {blind:?} looks nowhere: so far from its axis the lens shows nothing, or a place twice; a longer focal \
             length or smaller pictures would do"
        ))
    }

    /// Where the middle of a pixel is on a picture of focal length 1 about its axis.
    #[must_use]
    pub fn place(&self, x: u32, y: u32) -> [f64; 2] {
        [(f64::from(x) + 0.5 - self.cx) / self.fx, (f64::from(y) + 0.5 - self.cy) / self.fy]
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

    #[test]
    fn every_pixel_must_look_somewhere() {
        let pinhole = Optics::pinhole(640, 480, frames::deg(90.0));
        assert_eq!(pinhole.problem(), None);
        // The corner is at 400 / 320 = 1.25; r - 0.1 r^3 grows up to 1.217 only, r - 0.08 r^3 up to 1.361.
        let barrel = |k1| Optics { lens: Lens::Brown { k: [k1, 0.0, 0.0], p: [0.0; 2] }, ..pinhole.clone() };
        assert!(barrel(-0.1).problem().is_some_and(|p| p.contains("pixel (0, 0) looks nowhere")));
        assert_eq!(barrel(-0.08).problem(), None);
        // 400 pixels at 127 a radian are 3.15, more than half a turn.
        let fisheye = |f| Optics { fx: f, fy: f, lens: Lens::Fisheye { k: [0.0; 4] }, ..pinhole.clone() };
        assert!(fisheye(127.0).problem().is_some() && fisheye(128.0).problem().is_none());
    }
}
