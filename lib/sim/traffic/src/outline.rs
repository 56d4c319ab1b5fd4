//! Points on the outline of a body on the ground.

use nalgebra::{Point3, Vector3};

/// They are this far apart, metres.
const STEP_M: f64 = 0.4;

/// Points around a box of a length and a width, at most [`STEP_M`] apart.
pub(crate) fn outline(
    at: Point3<f64>,
    yaw_rad: f64,
    [length, width, _]: [f64; 3],
) -> impl Iterator<Item = Point3<f64>> {
    let (sin, cos) = frames::math::sin_cos(yaw_rad);
    let corners = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]].map(|[u, v]| [u * length, v * width]);
    (0..4).flat_map(move |k| {
        let (from, to) = (corners[k], corners[(k + 1) % 4]);
        let side_m = if k % 2 == 0 { length } else { width };
        let pieces = (side_m / STEP_M).ceil().max(1.0);
        (0..pieces as u32).map(move |i| {
            let share = f64::from(i) / pieces;
            let [u, v] = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            at + Vector3::new(u * cos - v * sin, u * sin + v * cos, 0.0)
        })
    })
}
