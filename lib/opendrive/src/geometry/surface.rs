//! The road surface over the reference line: elevation, superelevation, lateral shape.

use frames::math::sin_cos;
use frames::{Object as ObjectFrame, Pose, World};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::cubic::{value_and_derivatives, value_and_slope};
use super::{Plan, record_at};
use crate::model::{Cubic, HeaderOffset, Road, Shape};

/// The surface of one road: (s, t) to the world.
#[derive(Debug)]
pub(crate) struct Surface {
    plan: Plan,
    elevation: Vec<Cubic>,
    superelevation: Vec<Cubic>,
    shape: Vec<Shape>,
    z_m: f64,
    length_m: f64,
}

/// Everything about a road at one s that does not depend on t.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoadFrame {
    /// On the reference line.
    pub(crate) origin: Point3<f64>,
    /// d origin / ds.
    pub(crate) tangent: Vector3<f64>,
    /// Unit vector to the left, in the surface.
    pub(crate) left: Vector3<f64>,
    /// d left / ds.
    left_rate: Vector3<f64>,
}

impl RoadFrame {
    /// The point t metres to the left.
    pub(crate) fn point(&self, t: f64) -> Point3<f64> {
        self.origin + self.left * t
    }

    /// d point / ds along a line whose t changes by `t_slope` per metre.
    pub(crate) fn tangent(&self, t: f64, t_slope: f64) -> Vector3<f64> {
        self.tangent + self.left_rate * t + self.left * t_slope
    }

    /// Unit normal of the surface at the reference line.
    pub(crate) fn up(&self) -> Vector3<f64> {
        self.tangent.cross(&self.left).normalize()
    }

    /// The pose at (t, h): x along s, y left, z normal to the surface.
    pub(crate) fn pose(&self, t: f64, h: f64) -> Pose<World, ObjectFrame> {
        let up = self.up();
        let forward = self.left.cross(&up);
        let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[forward, self.left, up]));
        let at = self.point(t) + up * h;
        Pose::from_isometry(Isometry3::from_parts(
            Translation3::from(at.coords),
            UnitQuaternion::from_rotation_matrix(&axes),
        ))
    }
}

impl Surface {
    /// The road, moved by the header's offset: first translated, then turned about the new origin.
    pub(crate) fn new(road: &Road, offset: &HeaderOffset) -> Self {
        let (sin, cos) = sin_cos(offset.hdg_rad);
        let moved = *offset != HeaderOffset::default();
        let plan = Plan::new(&road.plan_view, |x, y, hdg| {
            // Untouched coordinates keep their bits.
            if !moved {
                return (x, y, hdg);
            }
            let (x, y) = (x + offset.x_m, y + offset.y_m);
            (cos * x - sin * y, sin * x + cos * y, hdg + offset.hdg_rad)
        });
        // "Record present" does not mean "banked": all-zero records are common.
        let is_zero = |c: &Cubic| c.a == 0.0 && c.b == 0.0 && c.c == 0.0 && c.d == 0.0;
        let banked = !road.superelevation.iter().all(is_zero);
        let shaped = !road.shape.iter().all(|s| is_zero(&s.cubic_of_t));
        Self {
            plan,
            elevation: road.elevation.clone(),
            superelevation: if banked { road.superelevation.clone() } else { Vec::new() },
            shape: if shaped { road.shape.clone() } else { Vec::new() },
            z_m: offset.z_m,
            length_m: road.length_m,
        }
    }

    /// Length of the reference line, metres.
    pub(crate) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Every s at which some record of the surface begins.
    pub(crate) fn breaks(&self) -> impl Iterator<Item = f64> {
        let elevation = self.elevation.iter().map(|c| c.s);
        let superelevation = self.superelevation.iter().map(|c| c.s);
        self.plan.starts().chain(elevation).chain(superelevation).chain(self.shape.iter().map(|c| c.s))
    }

    /// The frame at `s`, which is clamped to the road.
    pub(crate) fn frame(&self, s: f64) -> RoadFrame {
        let s = s.clamp(0.0, self.length_m);
        let plan = self.plan.at(s);
        let (z, slope, bend) = value_and_derivatives(&self.elevation, s);
        let [c, d] = plan.direction;
        let (forward, side) = (Vector3::new(c, d, 0.0), Vector3::new(-d, c, 0.0));
        let origin = Point3::new(plan.position.x, plan.position.y, z + self.z_m);
        let tangent = forward + Vector3::z() * slope;
        if self.superelevation.is_empty() {
            return RoadFrame { origin, tangent, left: side, left_rate: forward * -plan.curvature };
        }
        // Roll about the sloping tangent: left = cos(roll) side + sin(roll) up, where up is normal to both.
        let (roll, roll_rate) = value_and_slope(&self.superelevation, s);
        let (sin, cos) = sin_cos(roll);
        let rise = 1.0 / (1.0 + slope * slope).sqrt();
        let (sin_pitch, cos_pitch) = (slope * rise, rise);
        let up = Vector3::z() * cos_pitch - forward * sin_pitch;
        let along = forward * cos_pitch + Vector3::z() * sin_pitch;
        let pitch_rate = bend * rise * rise;
        let up_rate = side * (-plan.curvature * sin_pitch) - along * pitch_rate;
        let left_rate = side * (-roll_rate * sin) - forward * (plan.curvature * cos)
            + up * (roll_rate * cos)
            + up_rate * sin;
        RoadFrame { origin, tangent, left: side * cos + up * sin, left_rate }
    }

    /// Height of the lateral shape over the superelevated surface, metres along its normal.
    pub(crate) fn shape_height(&self, s: f64, t: f64) -> f64 {
        if self.shape.is_empty() {
            return 0.0;
        }
        let profile = |station: f64| {
            let from = self.shape.partition_point(|r| r.s < station);
            let to = self.shape.partition_point(|r| r.s <= station);
            let records = &self.shape[from..to];
            // Left of the first record there is no profile; its own start value continues.
            match record_at(records, t, |r| r.cubic_of_t.s).or(records.first()) {
                Some(r) => r.cubic_of_t.derivatives((t - r.cubic_of_t.s).max(0.0)).0,
                None => 0.0,
            }
        };
        let after = self.shape.partition_point(|r| r.s <= s);
        let before = after.checked_sub(1).map(|i| self.shape[i].s);
        match (before, self.shape.get(after).map(|r| r.s)) {
            (Some(a), Some(b)) => {
                let part = (s - a) / (b - a);
                profile(a) * (1.0 - part) + profile(b) * part
            }
            (Some(a), None) => profile(a),
            (None, Some(b)) => profile(b),
            (None, None) => 0.0,
        }
    }

    /// The surface point at (s, t).
    pub(crate) fn point(&self, s: f64, t: f64) -> Point3<f64> {
        self.point_in(&self.frame(s), s, t)
    }

    /// The surface point at (s, t), with the frame at s at hand.
    pub(crate) fn point_in(&self, frame: &RoadFrame, s: f64, t: f64) -> Point3<f64> {
        if self.shape.is_empty() {
            return frame.point(t);
        }
        frame.point(t) + frame.up() * self.shape_height(s, t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Curve, Geometry};
    use proptest::prelude::*;

    fn banked(roll: f64, slope: f64) -> Surface {
        let plan_view = vec![Geometry {
            length_m: 100.0,
            hdg_rad: 0.7,
            curve: Curve::Spiral { curvature_start: 0.01, curvature_end: -0.02 },
            ..Geometry::default()
        }];
        let road = Road {
            length_m: 100.0,
            plan_view,
            elevation: vec![Cubic { s: 0.0, a: 5.0, b: slope, c: 1e-3, d: -1e-5 }],
            superelevation: vec![Cubic { s: 0.0, a: roll, b: 2e-3, c: 0.0, d: 0.0 }],
            ..Road::default()
        };
        Surface::new(&road, &HeaderOffset::default())
    }

    #[test]
    fn positive_superelevation_raises_the_left_side() {
        let frame = banked(0.1, 0.0).frame(0.0);
        assert!(frame.point(2.0).z > frame.point(-2.0).z);
        assert!(((frame.point(2.0) - frame.origin).norm() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_header_offset_translates_and_then_turns() {
        let road = Road {
            length_m: 10.0,
            plan_view: vec![Geometry { x_m: 4.0, y_m: 1.0, length_m: 10.0, ..Geometry::default() }],
            ..Road::default()
        };
        let offset = HeaderOffset { x_m: -1.0, y_m: 1.0, z_m: 7.0, hdg_rad: frames::deg(90.0) };
        let at = Surface::new(&road, &offset).point(1.0, 0.0);
        assert!((at - Point3::new(-2.0, 4.0, 7.0)).norm() < 1e-12);
    }

    #[test]
    fn lateral_shape_is_linear_between_its_stations() {
        let shape = |s, t, a, b| Shape { s, cubic_of_t: Cubic { s: t, a, b, ..Cubic::default() } };
        let road = Road {
            length_m: 10.0,
            plan_view: vec![Geometry { length_m: 10.0, ..Geometry::default() }],
            shape: vec![shape(0.0, -5.0, 0.0, 0.0), shape(0.0, 0.0, 0.0, 0.1), shape(10.0, -5.0, 1.0, 0.0)],
            ..Road::default()
        };
        let surface = Surface::new(&road, &HeaderOffset::default());
        assert!((surface.point(0.0, 3.0).z - 0.3).abs() < 1e-12);
        assert!((surface.point(5.0, 3.0).z - 0.65).abs() < 1e-12);
        assert!((surface.point(5.0, -3.0).z - 0.5).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn tangents_agree_with_differences(roll in -0.6..0.6f64, slope in -0.3..0.3f64, s in 1.0..99.0f64,
                                           t in -8.0..8.0f64, t_slope in -0.2..0.2f64) {
            let surface = banked(roll, slope);
            let h = 1e-5;
            let at = |d: f64| surface.point(s + d, t + t_slope * d);
            let difference = (at(h) - at(-h)) / (2.0 * h);
            prop_assert!((surface.frame(s).tangent(t, t_slope) - difference).norm() < 1e-7);
        }

        #[test]
        fn poses_are_rotations_with_left_in_the_surface(roll in -0.6..0.6f64, slope in -0.3..0.3f64, s in 0.0..100.0f64) {
            let surface = banked(roll, slope);
            let frame = surface.frame(s);
            let pose = frame.pose(1.5, 0.25);
            prop_assert!((pose.rotate(Vector3::y()) - frame.left).norm() < 1e-12);
            prop_assert!((pose.forward() - frame.tangent.normalize()).norm() < 1e-12);
            prop_assert!((pose * Point3::new(0.0, 0.0, -0.25) - frame.point(1.5)).norm() < 1e-12);
        }
    }
}
