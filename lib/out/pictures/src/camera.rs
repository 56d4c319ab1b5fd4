//! From space to pixels.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use schema::calibration::Calibration;
use settings::LensModel;

/// What is nearer than this to a camera is not shown, metres along its axis.
const NEAR_M: f64 = 0.1;
/// Pieces into which a line is cut before a lens bends it.
const PIECES: u32 = 24;

/// A camera somewhere in a frame of reference ("space").
#[derive(Clone, Debug)]
pub struct Camera {
    /// From space to the optical frame: x right, y down, z forward.
    optical_from_space: Isometry3<f64>,
    /// fx, fy, cx, cy, pixels.
    focal: [f64; 4],
    lens: Option<LensModel>,
    size: [u32; 2],
}

impl Camera {
    /// A pinhole camera at a place of space, with the rotation that takes optical directions to space's, w,
    /// x, y, z.
    #[must_use]
    pub fn at(xyz_m: [f64; 3], wxyz: [f64; 4], size: [u32; 2], focal: [f64; 4]) -> Self {
        let [w, x, y, z] = wxyz;
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let space_from_optical = Isometry3::from_parts(Translation3::from(xyz_m), turn);
        Self { optical_from_space: space_from_optical.inverse(), focal, lens: None, size }
    }

    /// The camera that a calibration describes, on an agent at a pose in space; none of what is no camera.
    #[must_use]
    pub fn of(about: &Calibration, space_from_agent: &Isometry3<f64>) -> Option<Self> {
        let size = [about.width?, about.height?];
        let k = about.intrinsics?;
        let mounted = about.agent_from_sensor.agent_from_sensor::<frames::Optical>();
        let space_from_optical = space_from_agent * mounted.isometry();
        Some(Self {
            optical_from_space: space_from_optical.inverse(),
            focal: [k[0][0], k[1][1], k[0][2], k[1][2]],
            lens: about.lens.as_ref().and_then(LensModel::of),
            size,
        })
    }

    /// Width and height of its pictures, pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Where it is in space.
    #[must_use]
    pub fn position(&self) -> Point3<f64> {
        self.optical_from_space.inverse() * Point3::origin()
    }

    /// Its focal length along rows, pixels.
    pub(crate) fn focal_px(&self) -> f64 {
        self.focal[0]
    }

    /// The direction in space (not of length 1) that a place of the picture looks in, of pinholes.
    pub(crate) fn direction(&self, [u, v]: [f64; 2]) -> nalgebra::Vector3<f64> {
        let [fx, fy, cx, cy] = self.focal;
        self.optical_from_space.rotation.inverse() * nalgebra::Vector3::new((u - cx) / fx, (v - cy) / fy, 1.0)
    }

    /// Place of a point on the picture, pixels, and its distance along the axis (of lenses: from the camera),
    /// metres; none for what is behind it or not shown by its lens.
    #[must_use]
    pub fn project(&self, point: Point3<f64>) -> Option<([f64; 2], f64)> {
        self.place(self.optical_from_space * point)
    }

    fn place(&self, p: Point3<f64>) -> Option<([f64; 2], f64)> {
        let [fx, fy, cx, cy] = self.focal;
        match &self.lens {
            None if p.z < NEAR_M => None,
            None => Some(([fx * p.x / p.z + cx, fy * p.y / p.z + cy], p.z)),
            Some(lens) => {
                let ([x, y], is_shown) = lens.project([p.x, p.y, p.z]);
                let distance = p.coords.norm();
                (is_shown && distance >= NEAR_M).then_some(([fx * x + cx, fy * y + cy], distance))
            }
        }
    }

    /// The line between two points as chains of places on the picture: none where nothing of it is before the
    /// camera.
    #[must_use]
    pub fn line(&self, from: Point3<f64>, to: Point3<f64>) -> Vec<Vec<[f64; 2]>> {
        let ends = [from, to].map(|p| self.optical_from_space * p);
        if self.lens.is_some() {
            return self.bent_line(ends);
        }
        let [mut a, mut b] = ends;
        if a.z > b.z {
            std::mem::swap(&mut a, &mut b);
        }
        if b.z <= NEAR_M {
            return Vec::new();
        }
        if a.z < NEAR_M {
            a += (b - a) * ((NEAR_M - a.z) / (b.z - a.z));
            a.z = NEAR_M;
        }
        let places = [a, b].map(|p| self.place(p).map(|(at, _)| at));
        let [Some(a), Some(b)] = places else { return Vec::new() };
        self.cut([a, b]).into_iter().collect()
    }

    fn bent_line(&self, [a, b]: [Point3<f64>; 2]) -> Vec<Vec<[f64; 2]>> {
        let mut chains: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
        for i in 0..=PIECES {
            let p = a + (b - a) * (f64::from(i) / f64::from(PIECES));
            match (self.place(p), chains.last_mut()) {
                (Some((at, _)), Some(chain)) => chain.push(at),
                _ => chains.push(Vec::new()),
            }
        }
        chains.retain(|chain| chain.len() > 1);
        chains
    }

    /// The part of a line within a frame around the picture, one picture wide on each side (Liang and Barsky,
    /// "A new concept and method for line clipping", 1984): lines are not endless when they come close to the
    /// camera.
    fn cut(&self, [a, b]: [[f64; 2]; 2]) -> Option<Vec<[f64; 2]>> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let side = f64::from(self.size[axis]);
            let (low, high, step) = (-side, 2.0 * side, b[axis] - a[axis]);
            for (gap, along) in [(a[axis] - low, -step), (high - a[axis], step)] {
                if along == 0.0 {
                    if gap < 0.0 {
                        return None;
                    }
                } else if along < 0.0 {
                    enter = enter.max(gap / along);
                } else {
                    leave = leave.min(gap / along);
                }
            }
        }
        let at = |t: f64| [0, 1].map(|k| a[k] + (b[k] - a[k]) * t);
        (enter < leave).then(|| vec![at(enter), at(leave)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks along x of space: optical z is forward, x to the right.
    const AHEAD: [f64; 4] = [0.5, -0.5, 0.5, -0.5];

    fn camera() -> Camera {
        Camera::at([0.0, 0.0, 1.0], AHEAD, [200, 100], [100.0, 100.0, 100.0, 50.0])
    }

    #[test]
    fn what_is_left_is_left_and_what_is_high_is_high() {
        let project = |x: f64, y: f64, z: f64| camera().project(Point3::new(x, y, z));
        let near = |got: Option<([f64; 2], f64)>, want: [f64; 3]| {
            let ([u, v], depth) = got.expect("is shown");
            let off = (u - want[0]).abs() + (v - want[1]).abs() + (depth - want[2]).abs();
            assert!(off < 1e-9, "{u} {v} {depth}");
        };
        near(project(10.0, 0.0, 1.0), [100.0, 50.0, 10.0]);
        near(project(10.0, 2.0, 1.0), [80.0, 50.0, 10.0]);
        near(project(10.0, 0.0, 3.0), [100.0, 30.0, 10.0]);
        assert!(project(-10.0, 0.0, 1.0).is_none());
    }

    #[test]
    fn lines_end_at_the_camera() {
        // From ahead to behind, one metre to the left: it leaves the picture on the left.
        let line = camera().line(Point3::new(10.0, 1.0, 1.0), Point3::new(-10.0, 1.0, 1.0));
        let [a, b] = [line[0][0], line[0][1]];
        let (left, right) = if a[0] < b[0] { (a, b) } else { (b, a) };
        assert!((right[0] - 90.0).abs() < 1e-9 && (left[0] + 200.0).abs() < 1e-9, "{line:?}");
        assert!(camera().line(Point3::new(-1.0, 0.0, 0.0), Point3::new(-2.0, 0.0, 0.0)).is_empty());
    }

    #[test]
    fn directions_are_those_of_what_falls_there() {
        let at = [37.5, 81.25];
        let direction = camera().direction(at);
        let point = camera().position() + direction * 7.0;
        let (back, _) = camera().project(point).expect("is ahead");
        assert!((back[0] - at[0]).abs() + (back[1] - at[1]).abs() < 1e-9);
    }

    #[test]
    fn lenses_bend_lines() {
        let lens = settings::Lens::Fisheye { k: [0.0; 4] };
        let bent = Camera { lens: LensModel::of(&lens), ..camera() };
        // 45 degrees to the left of an equidistant lens: pi / 4 focal lengths.
        let ([u, v], _) = bent.project(Point3::new(5.0, 5.0, 1.0)).expect("is shown");
        assert!((u - (100.0 - 25.0 * std::f64::consts::PI)).abs() < 1e-9 && (v - 50.0).abs() < 1e-9);
        // It sees what is beside it.
        assert!(bent.project(Point3::new(0.0, 5.0, 1.0)).is_some());
        let line = bent.line(Point3::new(4.0, -3.0, 4.0), Point3::new(4.0, 3.0, 4.0));
        let (end, middle) = (line[0][0], line[0][12]);
        assert!(middle[1] < end[1] - 1.0, "straight lines bow: {line:?}");
    }
}
