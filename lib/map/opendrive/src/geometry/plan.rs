//! The reference line in plan.

use frames::math::{atan2, sin_cos};
use nalgebra::Point2;

use super::{between, record_at};
use crate::model::{Curve, Geometry};

/// Nodes and weights of the 8-point Gauss-Legendre rule on [-1, 1] (symmetric half). Its error on a panel
/// that turns by one radian is below 1e-15 of the panel's length.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// A clothoid is integrated over panels that turn by at most this many radians.
const PANEL_TURN_RAD: f64 = 1.0;
/// Cap on panels of one clothoid; absurd curvatures only lose accuracy.
const MAX_PANELS: f64 = 4096.0;
/// Intervals of the arc-length table of a polynomial piece.
const ARC_TABLE: usize = 32;

/// A place on the reference line in plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlanPoint {
    pub(crate) position: Point2<f64>,
    /// Cosine and sine of the heading.
    pub(crate) direction: [f64; 2],
    /// 1/m, positive turning left.
    pub(crate) curvature: f64,
}

/// The reference line of a road.
#[derive(Debug)]
pub(crate) struct Plan {
    pieces: Vec<Piece>,
}

#[derive(Debug)]
struct Piece {
    s: f64,
    length_m: f64,
    x_m: f64,
    y_m: f64,
    /// Cosine and sine of the start heading.
    direction: [f64; 2],
    form: Form,
}

#[derive(Debug)]
enum Form {
    Line,
    Arc { curvature: f64 },
    Spiral(Spiral),
    Poly(Box<Poly>),
}

/// A clothoid in its own coordinates, tabulated at the ends of equal panels.
#[derive(Debug)]
struct Spiral {
    curvature: f64,
    /// Change of curvature per metre.
    rate: f64,
    panel_m: f64,
    ends: Vec<[f64; 2]>,
}

/// A parametric cubic, tabulated by arc length.
#[derive(Debug)]
struct Poly {
    u: [f64; 4],
    v: [f64; 4],
    /// Arc length at `p = i * p_step`.
    arc: [f64; ARC_TABLE + 1],
    p_step: f64,
    /// Arc length per metre of s: 1 where the stated length is the true one.
    arc_per_s: f64,
}

impl Plan {
    /// `pieces` in order of s; each is moved by `place` (position, heading) first.
    pub(crate) fn new(pieces: &[Geometry], place: impl Fn(f64, f64, f64) -> (f64, f64, f64)) -> Self {
        let pieces = pieces
            .iter()
            .map(|g| {
                let (x_m, y_m, hdg) = place(g.x_m, g.y_m, g.hdg_rad);
                let (sin, cos) = sin_cos(hdg);
                Piece { s: g.s, length_m: g.length_m, x_m, y_m, direction: [cos, sin], form: Form::new(g) }
            })
            .collect();
        Self { pieces }
    }

    /// Starts of the pieces between two places.
    pub(crate) fn breaks(&self, from: f64, to: f64) -> impl Iterator<Item = f64> {
        between(&self.pieces, from, to, |p| p.s)
    }

    /// The point at `s`; before the first piece, its start.
    pub(crate) fn at(&self, s: f64) -> PlanPoint {
        match record_at(&self.pieces, s, |p| p.s).or(self.pieces.first()) {
            Some(piece) => piece.at((s - piece.s).max(0.0)),
            None => PlanPoint { position: Point2::origin(), direction: [1.0, 0.0], curvature: 0.0 },
        }
    }

    /// For each seam between two pieces: its s, the distance between the two ends in metres, and the kink in
    /// radians.
    pub(crate) fn seams(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        self.pieces.windows(2).map(|pair| {
            let (a, b) = (pair[0].at(pair[0].length_m), pair[1].at(0.0));
            let cross = a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0];
            let dot = a.direction[0] * b.direction[0] + a.direction[1] * b.direction[1];
            (pair[1].s, (a.position - b.position).norm(), atan2(cross, dot).abs())
        })
    }
}

impl Piece {
    fn at(&self, d: f64) -> PlanPoint {
        let (uv, direction, curvature) = self.form.at(d);
        let [cos, sin] = self.direction;
        PlanPoint {
            position: Point2::new(self.x_m + cos * uv[0] - sin * uv[1], self.y_m + sin * uv[0] + cos * uv[1]),
            direction: [cos * direction[0] - sin * direction[1], sin * direction[0] + cos * direction[1]],
            curvature,
        }
    }
}

impl Form {
    fn new(geometry: &Geometry) -> Self {
        let length = geometry.length_m;
        match geometry.curve {
            Curve::Line => Self::Line,
            Curve::Arc { curvature } => Self::Arc { curvature },
            Curve::Spiral { curvature_start, curvature_end } => {
                // A clothoid without length has no rate; as an arc it is exact.
                let rate = if length > 0.0 { (curvature_end - curvature_start) / length } else { 0.0 };
                if rate == 0.0 || !rate.is_finite() {
                    Self::Arc { curvature: curvature_start }
                } else {
                    Self::Spiral(Spiral::new(curvature_start, rate, length))
                }
            }
            // A function v(u) is the parametric curve (p, v(p)), as far as its arc length reaches.
            Curve::Poly3 { v } => Self::Poly(Box::new(Poly::until_arc([0.0, 1.0, 0.0, 0.0], v, length))),
            Curve::ParamPoly3 { u, v, normalised } => {
                Self::Poly(Box::new(Poly::new(u, v, if normalised { 1.0 } else { length }, length)))
            }
        }
    }

    /// Position, direction and curvature, `d` metres after the piece's start, in its own coordinates.
    fn at(&self, d: f64) -> ([f64; 2], [f64; 2], f64) {
        match self {
            Self::Line => ([d, 0.0], [1.0, 0.0], 0.0),
            Self::Arc { curvature } => {
                let (uv, direction) = arc(*curvature, d);
                (uv, direction, *curvature)
            }
            Self::Spiral(spiral) => spiral.at(d),
            Self::Poly(poly) => poly.at(d),
        }
    }
}

/// `d` metres along a circle: chord `d sinc(k d / 2)` at the mean heading; exact also for `k` near or at 0.
fn arc(curvature: f64, d: f64) -> ([f64; 2], [f64; 2]) {
    let half = 0.5 * curvature * d;
    let (sin, cos) = sin_cos(half);
    // Below this the next term of sin(x) / x is under one unit in the last place.
    let sinc = if half.abs() < 1e-8 { 1.0 } else { sin / half };
    let chord = d * sinc;
    ([chord * cos, chord * sin], [cos * cos - sin * sin, 2.0 * sin * cos])
}

impl Spiral {
    fn new(curvature: f64, rate: f64, length: f64) -> Self {
        let steepest = curvature.abs().max((curvature + rate * length).abs());
        let panels = (steepest * length / PANEL_TURN_RAD).ceil().clamp(1.0, MAX_PANELS);
        let mut spiral = Self { curvature, rate, panel_m: length / panels, ends: vec![[0.0; 2]] };
        for i in 0..panels as usize {
            let from = i as f64 * spiral.panel_m;
            let step = spiral.integral(from, from + spiral.panel_m);
            let last = spiral.ends[i];
            spiral.ends.push([last[0] + step[0], last[1] + step[1]]);
        }
        spiral
    }

    fn turn(&self, d: f64) -> f64 {
        d * (self.curvature + 0.5 * self.rate * d)
    }

    /// Displacement between two places, by Gauss-Legendre quadrature of the direction.
    fn integral(&self, from: f64, to: f64) -> [f64; 2] {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let mut sum = [0.0; 2];
        for (node, weight) in GAUSS {
            for d in [middle - half * node, middle + half * node] {
                let (sin, cos) = sin_cos(self.turn(d));
                sum[0] += weight * cos;
                sum[1] += weight * sin;
            }
        }
        sum.map(|x| x * half)
    }

    fn at(&self, d: f64) -> ([f64; 2], [f64; 2], f64) {
        let panel = ((d / self.panel_m) as usize).min(self.ends.len() - 1);
        let base = self.ends[panel];
        let step = self.integral(panel as f64 * self.panel_m, d);
        let (sin, cos) = sin_cos(self.turn(d));
        ([base[0] + step[0], base[1] + step[1]], [cos, sin], self.curvature + self.rate * d)
    }
}

impl Poly {
    /// The curve for p in `[0, p_end]`, spread over `length` metres of s in proportion to arc length: s is
    /// the way along the curve, and the end is reached also where the stated length is not the true one.
    fn new(u: [f64; 4], v: [f64; 4], p_end: f64, length: f64) -> Self {
        let mut poly =
            Self { u, v, arc: [0.0; ARC_TABLE + 1], p_step: p_end / ARC_TABLE as f64, arc_per_s: 1.0 };
        for i in 0..ARC_TABLE {
            let from = i as f64 * poly.p_step;
            poly.arc[i + 1] = poly.arc[i] + poly.arc_between(from, from + poly.p_step);
        }
        if length > 0.0 && poly.arc[ARC_TABLE] > 0.0 {
            poly.arc_per_s = poly.arc[ARC_TABLE] / length;
        }
        poly
    }

    /// The curve from p = 0 as far as `length` metres of arc, for curves whose arc grows at least as fast as
    /// p.
    fn until_arc(u: [f64; 4], v: [f64; 4], length: f64) -> Self {
        // The arc of a p interval is at least as long as the interval, so p lies between 0 and `length`.
        let whole = Self::new(u, v, length, length);
        let p_end = whole.p_at_arc(length);
        Self::new(u, v, p_end, length)
    }

    fn derivative(&self, p: f64) -> [f64; 2] {
        [&self.u, &self.v].map(|c| c[1] + p * (2.0 * c[2] + p * 3.0 * c[3]))
    }

    fn arc_between(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let speed = |p: f64| {
            let [du, dv] = self.derivative(p);
            (du * du + dv * dv).sqrt()
        };
        let sum: f64 =
            GAUSS.iter().map(|(n, w)| w * (speed(middle - half * n) + speed(middle + half * n))).sum();
        sum * half
    }

    /// The parameter where the curve is `arc` metres long: table, then Newton kept inside the interval.
    fn p_at_arc(&self, arc: f64) -> f64 {
        let i = (self.arc.partition_point(|a| *a <= arc)).clamp(1, ARC_TABLE) - 1;
        let (low, high) = (i as f64 * self.p_step, (i + 1) as f64 * self.p_step);
        let (arc_low, arc_high) = (self.arc[i], self.arc[i + 1]);
        if arc_high <= arc_low {
            return low;
        }
        let mut p = low + (high - low) * ((arc - arc_low) / (arc_high - arc_low)).clamp(0.0, 1.0);
        for _ in 0..4 {
            let [du, dv] = self.derivative(p);
            let speed = (du * du + dv * dv).sqrt();
            if speed <= 0.0 {
                break;
            }
            p = (p - (arc_low + self.arc_between(low, p) - arc) / speed).clamp(low, high);
        }
        p
    }

    fn at(&self, d: f64) -> ([f64; 2], [f64; 2], f64) {
        let p = self.p_at_arc(d * self.arc_per_s);
        let position = [&self.u, &self.v].map(|c| c[0] + p * (c[1] + p * (c[2] + p * c[3])));
        let [du, dv] = self.derivative(p);
        let [ddu, ddv] = [&self.u, &self.v].map(|c| 2.0 * c[2] + 6.0 * c[3] * p);
        let speed = (du * du + dv * dv).sqrt();
        if speed <= 0.0 {
            return (position, [1.0, 0.0], 0.0);
        }
        (position, [du / speed, dv / speed], (du * ddv - dv * ddu) / (speed * speed * speed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn piece(length_m: f64, curve: Curve) -> Plan {
        let geometry = Geometry { s: 0.0, x_m: 3.0, y_m: -2.0, hdg_rad: 0.4, length_m, curve };
        Plan::new(&[geometry], |x, y, h| (x, y, h))
    }

    /// Walks a heading function in tiny midpoint steps.
    fn walk(length: f64, turn: impl Fn(f64) -> f64) -> Point2<f64> {
        let n = 400_000;
        let h = length / f64::from(n);
        let mut at = Point2::new(3.0, -2.0);
        for i in 0..n {
            let (sin, cos) = sin_cos(0.4 + turn((f64::from(i) + 0.5) * h));
            at.x += h * cos;
            at.y += h * sin;
        }
        at
    }

    #[test]
    fn spirals_agree_with_fine_integration() {
        for (k0, k1, length) in
            [(0.0, 0.05, 80.0), (0.1, -0.1, 60.0), (-0.5, 0.2, 30.0), (0.01, 0.010_000_1, 200.0)]
        {
            let plan = piece(length, Curve::Spiral { curvature_start: k0, curvature_end: k1 });
            for part in [0.13, 0.5, 1.0] {
                let d = part * length;
                let want = walk(d, |x| x * k0 + 0.5 * (k1 - k0) / length * x * x);
                assert!((plan.at(d).position - want).norm() < 1e-6, "{k0} {k1} {length} at {d}");
            }
        }
    }

    #[test]
    fn a_spiral_of_equal_ends_is_an_arc() {
        let spiral = piece(30.0, Curve::Spiral { curvature_start: 0.02, curvature_end: 0.02 }).at(21.0);
        let arc = piece(30.0, Curve::Arc { curvature: 0.02 }).at(21.0);
        assert_eq!(spiral, arc);
    }

    #[test]
    fn a_straight_parametric_cubic_is_a_line() {
        let line = piece(20.0, Curve::Line).at(7.5);
        for normalised in [true, false] {
            let scale = if normalised { 20.0 } else { 1.0 };
            let poly =
                piece(20.0, Curve::ParamPoly3 { u: [0.0, scale, 0.0, 0.0], v: [0.0; 4], normalised }).at(7.5);
            assert!((poly.position - line.position).norm() < 1e-12);
        }
    }

    #[test]
    fn polynomials_run_by_arc_length() {
        // The parabola v = u^2 / 20 has arc length (x sqrt(1 + x^2) + asinh x) * 5 with x = u / 10.
        let arc_of = |u: f64| {
            let x = u / 10.0;
            5.0 * (x * (1.0 + x * x).sqrt() + libm_asinh(x))
        };
        let length = arc_of(12.0);
        let forms = [
            Curve::Poly3 { v: [0.0, 0.0, 0.05, 0.0] },
            Curve::ParamPoly3 { u: [0.0, 12.0, 0.0, 0.0], v: [0.0, 0.0, 7.2, 0.0], normalised: true },
        ];
        for curve in forms {
            let plan = piece(length, curve);
            for u in [0.0, 3.0, 8.5, 12.0] {
                let got = plan.at(arc_of(u)).position;
                let (sin, cos) = sin_cos(0.4);
                let v = 0.05 * u * u;
                let want = Point2::new(3.0 + cos * u - sin * v, -2.0 + sin * u + cos * v);
                assert!((got - want).norm() < 1e-9, "{curve:?} u {u}: {got} {want}");
            }
        }
    }

    fn libm_asinh(x: f64) -> f64 {
        frames::math::ln(x + (x * x + 1.0).sqrt())
    }

    proptest! {
        #[test]
        fn arcs_stay_on_their_circle(k in prop::sample::select(vec![-2.0, -0.1, -1e-5, 1e-9, 0.0, 1e-4, 0.05, 3.0]),
                                     d in 0.0..40.0f64) {
            let at = piece(40.0, Curve::Arc { curvature: k }).at(d);
            let turn = atan2(at.direction[1], at.direction[0]) - 0.4 - k * d;
            prop_assert!(frames::wrap_pi(turn).abs() < 1e-9);
            if k.abs() > 1e-3 {
                let (sin, cos) = sin_cos(0.4);
                let centre = Point2::new(3.0 - sin / k, -2.0 + cos / k);
                prop_assert!(((at.position - centre).norm() - 1.0 / k.abs()).abs() < 1e-9);
            } else {
                // Almost straight: the sagitta to second order.
                let (sin, cos) = sin_cos(0.4);
                let v = 0.5 * k * d * d;
                let want = Point2::new(3.0 + cos * d - sin * v, -2.0 + sin * d + cos * v);
                prop_assert!((at.position - want).norm() < 1e-2 * v.abs() + 1e-9);
            }
        }

        #[test]
        fn every_curve_moves_a_metre_per_metre(kind in 0..4usize, d in 0.0..19.0f64) {
            let curve = [
                Curve::Arc { curvature: 0.1 },
                Curve::Spiral { curvature_start: -0.1, curvature_end: 0.2 },
                Curve::Poly3 { v: [0.0, 0.1, -0.02, 0.001] },
                Curve::Line,
            ][kind];
            let plan = piece(20.0, curve);
            let (a, b) = (plan.at(d), plan.at(d + 1e-4));
            let step = b.position - a.position;
            prop_assert!((step.norm() - 1e-4).abs() < 1e-9);
            prop_assert!((step.x * a.direction[1] - step.y * a.direction[0]).abs() < 1e-7);
            let turn = a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0];
            prop_assert!((turn - 1e-4 * a.curvature).abs() < 1e-7);
        }
    }
}
