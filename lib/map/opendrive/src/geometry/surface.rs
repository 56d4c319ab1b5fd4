//! The road surface over the reference line: elevation, superelevation, and what lies across.

use frames::math::sin_cos;
use frames::{Object as ObjectFrame, Pose, World};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::Plan;
use super::cubic::{between, value_and_derivatives, value_and_slope};
use super::lateral::Lateral;
use crate::model::{Cubic, HeaderOffset, Road};

/// Half the step of numerical derivatives where the surface is no ruled one, metres.
const STEP_M: f64 = 1e-4;

/// The surface of one road: (s, t) to the world.
#[derive(Debug)]
pub(crate) struct Surface {
    plan: Plan,
    elevation: Vec<Cubic>,
    superelevation: Vec<Cubic>,
    lateral: Lateral,
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

/// How the surface lies at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    /// d point / ds at a constant t.
    pub(crate) along: Vector3<f64>,
    /// d point / dt.
    pub(crate) across: Vector3<f64>,
}

impl RoadFrame {
    /// The point t metres to the left.
    pub(crate) fn point(&self, t: f64) -> Point3<f64> {
        self.origin + self.left * t
    }

    /// d point / ds along a line in the superelevated plane whose t changes by `t_slope` per metre.
    pub(crate) fn tangent(&self, t: f64, t_slope: f64) -> Vector3<f64> {
        self.tangent + self.left_rate * t + self.left * t_slope
    }

    /// Unit normal of the superelevated plane.
    fn up(&self) -> Vector3<f64> {
        self.tangent.cross(&self.left).normalize()
    }

    /// Unit vector to the left, horizontal.
    fn side(&self) -> Vector3<f64> {
        // The tangent's horizontal part is of length 1.
        Vector3::new(-self.tangent.y, self.tangent.x, 0.0)
    }
}

impl HeaderOffset {
    /// A point of the file's inertial frame in the world: translated, then turned about the new origin.
    pub(crate) fn apply(&self, xyz_m: [f64; 3]) -> Point3<f64> {
        let (sin, cos) = sin_cos(self.hdg_rad);
        let (x, y) = (xyz_m[0] + self.x_m, xyz_m[1] + self.y_m);
        Point3::new(cos * x - sin * y, sin * x + cos * y, xyz_m[2] + self.z_m)
    }
}

impl Surface {
    /// The road, moved by the header's offset: first translated, then turned about the new origin.
    pub(crate) fn new(road: &Road, offset: &HeaderOffset) -> Self {
        let moved = *offset != HeaderOffset::default();
        let plan = Plan::new(&road.plan_view, |x, y, hdg| {
            // Untouched coordinates keep their bits.
            if !moved {
                return (x, y, hdg);
            }
            let at = offset.apply([x, y, 0.0]);
            (at.x, at.y, hdg + offset.hdg_rad)
        });
        // "Record present" does not mean "banked": all-zero records are common.
        let banked = !road.superelevation.iter().all(Cubic::is_zero);
        Self {
            plan,
            elevation: road.elevation.clone(),
            superelevation: if banked { road.superelevation.clone() } else { Vec::new() },
            lateral: Lateral::new(road, banked),
            z_m: offset.z_m,
            length_m: road.length_m,
        }
    }

    /// Length of the reference line, metres.
    pub(crate) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Every s between two places at which some record of the surface begins.
    pub(crate) fn breaks(&self, from: f64, to: f64) -> impl Iterator<Item = f64> {
        let elevation = between(&self.elevation, from, to, |c| c.s);
        let superelevation = between(&self.superelevation, from, to, |c| c.s);
        let across = self.lateral.breaks(from, to);
        self.plan.breaks(from, to).chain(elevation).chain(superelevation).chain(across)
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

    /// The surface point at (s, t).
    pub(crate) fn point(&self, s: f64, t: f64) -> Point3<f64> {
        self.point_in(&self.frame(s), s, t)
    }

    /// The surface point at (s, t), with the frame at s at hand.
    pub(crate) fn point_in(&self, frame: &RoadFrame, s: f64, t: f64) -> Point3<f64> {
        if self.lateral.is_flat() {
            return frame.point(t);
        }
        let shaped = |t: f64| frame.point(t) + frame.up() * self.lateral.height(s, t);
        match self.lateral.level_from(s, t) {
            // Level lanes go on horizontally from the border of the last lane that is not level.
            Some(border) => shaped(border) + frame.side() * (t - border),
            None => shaped(t),
        }
    }

    /// How the surface lies at (s, t), with the frame at s at hand.
    pub(crate) fn axes(&self, frame: &RoadFrame, s: f64, t: f64) -> Axes {
        if self.lateral.is_flat() {
            return Axes { along: frame.tangent(t, 0.0), across: frame.left };
        }
        let [low, high] = [s - STEP_M, s + STEP_M].map(|s| s.clamp(0.0, self.length_m));
        let along = if high > low {
            (self.point(high, t) - self.point(low, t)) / (high - low)
        } else {
            frame.tangent
        };
        let [right, left] = [t - STEP_M, t + STEP_M].map(|t| self.point_in(frame, s, t));
        Axes { along, across: (left - right) / (2.0 * STEP_M) }
    }

    /// The pose at (s, t), `h` metres above the surface: x along s, y left, z normal to the surface.
    pub(crate) fn pose(&self, s: f64, t: f64, h: f64) -> Pose<World, ObjectFrame> {
        let s = s.clamp(0.0, self.length_m);
        let frame = self.frame(s);
        let axes = self.axes(&frame, s, t);
        // Where the road turns its roll, lines beside the reference line turn off it a little: x follows the
        // road.
        let along = if self.lateral.is_flat() { frame.tangent } else { axes.along };
        let left = axes.across.normalize();
        let up = along.cross(&left).normalize();
        let axes = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[left.cross(&up), left, up]));
        let at = self.point_in(&frame, s, t) + up * h;
        Pose::from_isometry(Isometry3::from_parts(
            Translation3::from(at.coords),
            UnitQuaternion::from_rotation_matrix(&axes),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Crossfall, Curve, Geometry, Lane, LaneSection, RoadSide, Shape};
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

    fn crossfall(side: RoadSide, s: f64, angle: f64) -> Crossfall {
        Crossfall { side, angle_rad: Cubic { s, a: angle, ..Cubic::default() } }
    }

    #[test]
    fn crossfall_falls_to_the_outside_of_its_side() {
        let road = Road {
            length_m: 30.0,
            plan_view: vec![Geometry { length_m: 30.0, ..Geometry::default() }],
            superelevation: vec![Cubic { s: 20.0, a: 0.05, ..Cubic::default() }],
            crossfall: vec![crossfall(RoadSide::Both, 0.0, 0.02), crossfall(RoadSide::Left, 10.0, -0.03)],
            ..Road::default()
        };
        let surface = Surface::new(&road, &HeaderOffset::default());
        let fall = |angle: f64| 5.0 * frames::math::tan(angle);
        let cases = [
            (5.0, 5.0, -fall(0.02)),
            (5.0, -5.0, -fall(0.02)),
            (15.0, 5.0, fall(0.03)),
            (15.0, -5.0, -fall(0.02)),
        ];
        for (s, t, z) in cases {
            assert!((surface.point(s, t) - Point3::new(s, t, z)).norm() < 1e-12, "{s} {t}");
        }
        // Over a superelevated road the fall counts from the tilted t axis, along its normal.
        let (sin, cos) = sin_cos(0.05);
        let at = surface.point(25.0, -5.0);
        let want = Point3::new(25.0, -5.0 * cos + fall(0.02) * sin, -5.0 * sin - fall(0.02) * cos);
        assert!((at - want).norm() < 1e-12, "{at} {want}");
    }

    #[test]
    fn level_lanes_go_on_horizontally() {
        let lane = |id: i16, width: f64, level: bool| Lane {
            id,
            level,
            widths: vec![Cubic { s: 0.0, a: width, b: 0.01, ..Cubic::default() }],
            ..Lane::default()
        };
        let section = LaneSection {
            left: vec![lane(1, 4.0, false)],
            right: vec![lane(-1, 4.0, false), lane(-2, 2.0, true), lane(-3, 1.0, true)],
            ..LaneSection::default()
        };
        let road = Road {
            length_m: 30.0,
            plan_view: vec![Geometry { length_m: 30.0, ..Geometry::default() }],
            superelevation: vec![Cubic::constant(0.1)],
            lane_offset: vec![Cubic::constant(0.5)],
            sections: vec![section],
            ..Road::default()
        };
        let surface = Surface::new(&road, &HeaderOffset::default());
        let (sin, cos) = sin_cos(0.1);
        // At s = 10 the lanes are 4.1, 2.1 and 1.1 m wide: lane -2 begins at t = -3.6.
        for (t, y, z) in [
            (4.6, 4.6 * cos, 4.6 * sin),
            (-3.6, -3.6 * cos, -3.6 * sin),
            (-5.7, -3.6 * cos - 2.1, -3.6 * sin),
            (-6.8, -3.6 * cos - 3.2, -3.6 * sin),
        ] {
            let at = surface.point(10.0, t);
            assert!((at - Point3::new(10.0, y, z)).norm() < 1e-12, "{t}: {at}");
        }
        let axes = surface.axes(&surface.frame(10.0), 10.0, -5.0);
        assert!((axes.across - Vector3::y()).norm() < 1e-9, "{}", axes.across);
        // The border moves out by 0.01 a metre, and falls by that much of the slope.
        assert!(
            (axes.along - Vector3::new(1.0, 0.01 * (1.0 - cos), -0.01 * sin)).norm() < 1e-6,
            "{}",
            axes.along
        );
    }

    proptest! {
        #[test]
        fn tangents_agree_with_differences(roll in -0.6..0.6f64, slope in -0.3..0.3f64, s in 1.0..99.0f64,
                                           t in -8.0..8.0f64, t_slope in -0.2..0.2f64) {
            let surface = banked(roll, slope);
            let h = 1e-5;
            let at = |d: f64| surface.point(s + d, t + t_slope * d);
            let difference = (at(h) - at(-h)) / (2.0 * h);
            let axes = surface.axes(&surface.frame(s), s, t);
            prop_assert!((axes.along + axes.across * t_slope - difference).norm() < 1e-7);
        }

        #[test]
        fn poses_are_rotations_with_left_in_the_surface(roll in -0.6..0.6f64, slope in -0.3..0.3f64, s in 0.0..100.0f64) {
            let surface = banked(roll, slope);
            let frame = surface.frame(s);
            let pose = surface.pose(s, 1.5, 0.25);
            prop_assert!((pose.rotate(Vector3::y()) - frame.left).norm() < 1e-12);
            prop_assert!((pose.forward() - frame.tangent.normalize()).norm() < 1e-12);
            prop_assert!((pose * Point3::new(0.0, 0.0, -0.25) - frame.point(1.5)).norm() < 1e-12);
        }
    }
}
