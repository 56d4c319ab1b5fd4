//! Pictures of cameras: where points fall in them, and where pixels look.

use serde_json::Value;

use crate::space::V3;

/// Size, focal lengths and axis of a camera, as its configuration has them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Optics {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Columns and rows.
    focal: [f64; 2],
    axis: [f64; 2],
}

impl Optics {
    pub(crate) fn of(about: &Value) -> Self {
        let number = |key: &str| about[key].as_f64().unwrap_or(f64::NAN);
        let size = |key: &str| about[key].as_u64().unwrap_or(0) as usize;
        Self {
            width: size("width"),
            height: size("height"),
            focal: [number("fx"), number("fy")],
            axis: [number("cx"), number("cy")],
        }
    }

    /// The matrix that calibrations state.
    pub(crate) fn matrix(&self) -> [[f64; 3]; 3] {
        [[self.focal[0], 0.0, self.axis[0]], [0.0, self.focal[1], self.axis[1]], [0.0, 0.0, 1.0]]
    }

    /// Where a point of the optical frame falls, pixels; none where the camera does not look.
    pub(crate) fn project(&self, [x, y, z]: V3) -> Option<[f64; 2]> {
        let at = [x / z, y / z];
        (z > 0.0).then(|| [0, 1].map(|i| self.axis[i] + self.focal[i] * at[i]))
    }

    /// The direction in which a place in the picture looks: a surface of depth d is d times as far.
    pub(crate) fn ray(&self, [u, v]: [f64; 2]) -> V3 {
        [(u - self.axis[0]) / self.focal[0], (v - self.axis[1]) / self.focal[1], 1.0]
    }
}
