//! Records that occur in several places: cubics, pieces of a curve, speeds.

use super::{RoadSide, SpeedUnit};

/// A stated speed limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Speed {
    /// The number, in `unit`; infinite where the file says `no limit`.
    pub max: f64,
    /// Its unit.
    pub unit: SpeedUnit,
}

impl Speed {
    /// In metres a second.
    #[must_use]
    pub fn mps(self) -> f64 {
        self.max * self.unit.metres_per_second()
    }
}

/// A cubic `a + b d + c d^2 + d d^3` of `d = s - start`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic {
    /// Where it begins: road s, or the offset from the lane section's start for records of a lane.
    pub s: f64,
    /// Constant.
    pub a: f64,
    /// Linear.
    pub b: f64,
    /// Quadratic.
    pub c: f64,
    /// Cubic.
    pub d: f64,
}

impl Cubic {
    /// The same value everywhere.
    #[must_use]
    pub fn constant(a: f64) -> Self {
        Self { a, ..Self::default() }
    }
}

/// Inclination of the surface to the outside, as an angle from the t axis: positive where the surface falls
/// from the reference line outwards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossfall {
    /// Where it applies.
    pub side: RoadSide,
    /// Radians, by s.
    pub angle_rad: Cubic,
}

/// Height profile across the road: a cubic of t from `t` on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Road s.
    pub s: f64,
    /// Where the cubic begins, metres to the left.
    pub cubic_of_t: Cubic,
}

/// One piece of the reference line in plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Geometry {
    /// Start, metres along the road.
    pub s: f64,
    /// Start, metres east.
    pub x_m: f64,
    /// Start, metres north.
    pub y_m: f64,
    /// Heading at the start, radians from east, counter-clockwise.
    pub hdg_rad: f64,
    /// Length, metres.
    pub length_m: f64,
    /// Its curve.
    pub curve: Curve,
}

/// The curve of a piece, in its own coordinates: u along the start heading, v to the left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Curve {
    /// Straight.
    #[default]
    Line,
    /// Of constant curvature, 1/m; positive turns left.
    Arc {
        /// 1/m.
        curvature: f64,
    },
    /// Of curvature linear in length (clothoid).
    Spiral {
        /// At the start, 1/m.
        curvature_start: f64,
        /// At the end, 1/m.
        curvature_end: f64,
    },
    /// `v = a + b u + c u^2 + d u^3`.
    Poly3 {
        /// `a, b, c, d`.
        v: [f64; 4],
    },
    /// `u(p), v(p)`, both cubic.
    ParamPoly3 {
        /// Coefficients of u.
        u: [f64; 4],
        /// Coefficients of v.
        v: [f64; 4],
        /// Whether p runs to 1 instead of to the piece's length.
        normalised: bool,
    },
}
