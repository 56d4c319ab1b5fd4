//! The views that point clouds and boxes are shown in: from above, and from behind and above.

use nalgebra::Point3;

use crate::Camera;

/// How far a view reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reach {
    /// 40 m by 40 m, 64 pixels a metre.
    Near,
    /// 160 m by 160 m, 16 pixels a metre.
    Far,
}

impl Reach {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Near, Self::Far];

    /// Its name in the names of pictures.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Near => "NEAR",
            Self::Far => "FAR",
        }
    }

    /// Side of the square that is seen from above, metres, and pixels a metre.
    #[must_use]
    pub fn scale(self) -> (f64, f64) {
        match self {
            Self::Near => (40.0, 64.0),
            Self::Far => (160.0, 16.0),
        }
    }

    /// Where the camera of the view from behind is in the lidar's frame, metres.
    #[must_use]
    pub fn camera_xyz_m(self) -> [f64; 3] {
        match self {
            Self::Near => [-15.0, 0.0, 4.5],
            Self::Far => [-60.0, 0.0, 18.0],
        }
    }
}

/// Optical axes of the view from behind in the lidar's frame, w, x, y, z: ahead, 18 degrees down.
const VIEW_WXYZ: [f64; 4] = [0.415_627, -0.572_061, 0.572_061, -0.415_627];
/// Its picture, pixels, and focal length: the default vehicle's cameras.
const VIEW_PX: [u32; 2] = [1600, 900];
const VIEW_FOCAL_PX: f64 = 953.402_874_075_368_1;

/// How space is put on a picture.
#[derive(Clone, Debug)]
pub enum View {
    /// From above: x of space up, y to the left.
    Above {
        /// What is in the middle of the picture, x and y, metres.
        centre_m: [f64; 2],
        /// Width and height of the picture, pixels.
        size: [u32; 2],
        /// Pixels a metre.
        px_per_m: f64,
    },
    /// By a camera.
    Through(Camera),
}

impl View {
    /// From above a lidar (space is its frame), whose x axis points up.
    #[must_use]
    pub fn above(reach: Reach) -> Self {
        let (side_m, px_per_m) = reach.scale();
        let side = (side_m * px_per_m).round() as u32;
        Self::Above { centre_m: [0.0; 2], size: [side; 2], px_per_m }
    }

    /// From behind and above a lidar (space is its frame).
    #[must_use]
    pub fn behind(reach: Reach) -> Self {
        let middle = VIEW_PX.map(|side| 0.5 * f64::from(side));
        let focal = [VIEW_FOCAL_PX, VIEW_FOCAL_PX, middle[0], middle[1]];
        Self::Through(Camera::at(reach.camera_xyz_m(), VIEW_WXYZ, VIEW_PX, focal))
    }

    /// Width and height of the picture, pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Above { size, .. } => *size,
            Self::Through(camera) => camera.size(),
        }
    }

    /// Place of a point on the picture, pixels, and how far it is: what is nearer covers what is farther.
    #[must_use]
    pub fn project(&self, point: Point3<f64>) -> Option<([f64; 2], f64)> {
        match self {
            Self::Above { centre_m, size, px_per_m } => {
                let [w, h] = size.map(f64::from);
                let u = 0.5 * w - (point.y - centre_m[1]) * px_per_m;
                let v = 0.5 * h - (point.x - centre_m[0]) * px_per_m;
                Some(([u, v], -point.z))
            }
            Self::Through(camera) => camera.project(point),
        }
    }

    /// The line between two points as chains of places on the picture.
    #[must_use]
    pub fn line(&self, from: Point3<f64>, to: Point3<f64>) -> Vec<Vec<[f64; 2]>> {
        match self {
            Self::Above { .. } => {
                vec![[from, to].into_iter().filter_map(|p| self.project(p)).map(|(at, _)| at).collect()]
            }
            Self::Through(camera) => camera.line(from, to),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_above_ahead_is_up_and_left_is_left() {
        let near = View::above(Reach::Near);
        assert_eq!(near.size(), [2560; 2]);
        let at = |view: &View, x: f64, y: f64| view.project(Point3::new(x, y, 0.0)).map(|(at, _)| at);
        assert_eq!(at(&near, 0.0, 0.0), Some([1280.0, 1280.0]));
        assert_eq!(at(&near, 10.0, 0.0), Some([1280.0, 640.0]));
        assert_eq!(at(&near, 0.0, 10.0), Some([640.0, 1280.0]));
        let far = View::above(Reach::Far);
        assert_eq!((far.size(), at(&far, 80.0, 80.0)), ([2560; 2], Some([0.0, 0.0])));
    }

    #[test]
    fn from_behind_the_axis_meets_the_ground_where_18_degrees_say() {
        // 4.5 m above a plane, 18 degrees down: 4.5 / tan(18 deg) = 13.8496 m ahead.
        for (reach, height_m, behind_m) in [(Reach::Near, 4.5, 15.0), (Reach::Far, 18.0, 60.0)] {
            let view = View::behind(reach);
            assert_eq!(view.size(), [1600, 900]);
            let ahead_m = height_m / frames::math::tan(frames::deg(18.0)) - behind_m;
            let ([u, v], _) = view.project(Point3::new(ahead_m, 0.0, 0.0)).expect("is shown");
            assert!((u - 800.0).abs() < 1e-6 && (v - 450.0).abs() < 0.01, "{u} {v}");
            let ([u, _], _) = view.project(Point3::new(ahead_m, 1.0, 0.0)).expect("is shown");
            assert!(u < 800.0, "left is left");
        }
    }
}
