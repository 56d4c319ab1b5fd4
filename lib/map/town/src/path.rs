//! Reference lines in plan: chains of lines, arcs and clothoids, tangent to one another.

use frames::math::{atan2, sin_cos, tan};
use frames::wrap_pi;
use opendrive::{Curve, Geometry, Road};
use std::f64::consts::PI;

/// Pieces shorter than this are left out (the gap stays far below any drawing accuracy).
const SHORTEST_M: f64 = 1e-6;
/// Turns up to this many radians take two arcs instead of one of a radius smaller than this, metres.
const SLIGHT_RAD: f64 = 0.6;
const ABRUPT_M: f64 = 12.0;

/// Streets keep so far straight at their ends, metres.
pub(crate) const STRAIGHT_M: f64 = 1.0;

/// A place and a direction in plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose2 {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    /// Radians from east, counter-clockwise.
    pub(crate) heading_rad: f64,
}

impl Pose2 {
    /// The pose `ahead_m` along the heading and `left_m` to its left, same heading.
    pub(crate) fn moved(self, ahead_m: f64, left_m: f64) -> Self {
        let (sin, cos) = sin_cos(self.heading_rad);
        Self {
            x_m: self.x_m + cos * ahead_m - sin * left_m,
            y_m: self.y_m + sin * ahead_m + cos * left_m,
            ..self
        }
    }

    /// The same place, turned counter-clockwise.
    pub(crate) fn turned(self, angle_rad: f64) -> Self {
        Self { heading_rad: wrap_pi(self.heading_rad + angle_rad), ..self }
    }

    /// Where another pose's place lies: metres ahead and to the left.
    pub(crate) fn locate(self, other: Self) -> (f64, f64) {
        let (sin, cos) = sin_cos(self.heading_rad);
        let (dx, dy) = (other.x_m - self.x_m, other.y_m - self.y_m);
        (cos * dx + sin * dy, cos * dy - sin * dx)
    }
}

/// How a path may turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bend {
    /// Largest radius, metres; infinite takes all the room there is.
    pub(crate) radius_m: f64,
    /// Length of the clothoid at each end of the arc, metres.
    pub(crate) ease_m: f64,
    /// Straight metres kept at the beginning.
    pub(crate) lead_in_m: f64,
    /// Straight metres kept at the end.
    pub(crate) lead_out_m: f64,
}

/// A corner that a path rounds: where its two tangents meet, and how it turns there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Via {
    /// Metres east and north.
    pub(crate) at_m: [f64; 2],
    /// Radius of the arc, metres; shrinks where there is no room for it.
    pub(crate) radius_m: f64,
    /// Length of the clothoid at each end of the arc, metres; shrinks with the radius.
    pub(crate) ease_m: f64,
}

/// One piece of a path that is given as it is; it begins where the one before ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Piece {
    /// Straight for so many metres.
    Line(f64),
    /// Curvature in 1/m (positive turns left) and length in metres.
    Arc(f64, f64),
}

/// A reference line that grows at its end.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(crate) pieces: Vec<Geometry>,
    pub(crate) length_m: f64,
    end: Pose2,
}

impl Path {
    /// A path of no length yet.
    pub(crate) fn from_pose(start: Pose2) -> Self {
        Self { pieces: Vec::new(), length_m: 0.0, end: start }
    }

    /// The reference line of a road.
    pub(crate) fn of(road: &Road) -> Self {
        let mut path = Self::from_pose(Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 });
        (path.pieces, path.length_m) = (road.plan_view.clone(), road.length_m);
        path.end = path.pose_at(road.length_m);
        path
    }

    /// The pieces one after the other.
    pub(crate) fn chain(start: Pose2, pieces: &[Piece]) -> Self {
        let mut path = Self::from_pose(start);
        for piece in pieces {
            match *piece {
                Piece::Line(length_m) => path.line(length_m),
                Piece::Arc(curvature, length_m) => path.arc(curvature, length_m),
            }
        }
        path
    }

    /// A smooth path between two poses: line, (clothoid,) arc(, clothoid), line where the two tangents meet
    /// between them; else two arcs that meet halfway, as for a change of lane.
    pub(crate) fn between(from: Pose2, to: Pose2, bend: &Bend) -> Self {
        let mut path = Self::from_pose(from);
        let (ahead, left) = from.locate(to);
        let turn = wrap_pi(to.heading_rad - from.heading_rad);
        let (sin, cos) = sin_cos(turn);
        if turn.abs() < 1e-9 && left.abs() < 1e-6 && ahead > 0.0 {
            path.line(ahead);
            return path;
        }
        // Distances to where the tangents meet.
        let (leg_out, leg_in) =
            if sin.abs() > 1e-6 { (left / sin, ahead - cos * left / sin) } else { (-1.0, -1.0) };
        let room = (leg_in - bend.lead_in_m).min(leg_out - bend.lead_out_m);
        // Nearly straight ways whose tangents meet close to one end would bend there all at once.
        let half = tan(0.5 * turn.abs());
        let abrupt = turn.abs() < SLIGHT_RAD && room < ABRUPT_M.min(bend.radius_m) * half;
        if room > SHORTEST_M && !abrupt {
            let fillet = Fillet::new(turn, bend.radius_m.min(room / half), bend.ease_m);
            let fillet = fillet.scaled((room / fillet.tangent_m).min(1.0));
            path.line(leg_in - fillet.tangent_m);
            path.fillet(&fillet);
            path.line(leg_out - fillet.tangent_m);
        } else {
            path.line(bend.lead_in_m);
            path.two_arcs(to.moved(-bend.lead_out_m, 0.0));
            path.line(bend.lead_out_m);
        }
        path
    }

    /// A path from one pose to another round the corners between them. The first leg leads along `from`'s
    /// heading and the last one along `to`'s; where a corner has no room for its radius it gets what there
    /// is.
    pub(crate) fn through(from: Pose2, vias: &[Via], to: Pose2) -> Self {
        let mut points = vec![[from.x_m, from.y_m]];
        points.extend(vias.iter().map(|v| v.at_m));
        points.push([to.x_m, to.y_m]);
        let legs: Vec<(f64, f64)> = points
            .windows(2)
            .map(|p| {
                let (dx, dy) = (p[1][0] - p[0][0], p[1][1] - p[0][1]);
                ((dx * dx + dy * dy).sqrt(), atan2(dy, dx))
            })
            .collect();
        let mut fillets: Vec<Fillet> = vias
            .iter()
            .zip(legs.windows(2))
            .map(|(via, leg)| Fillet::new(wrap_pi(leg[1].1 - leg[0].1), via.radius_m, via.ease_m))
            .collect();
        let wished: Vec<f64> = fillets.iter().map(|f| f.tangent_m).collect();
        let last = legs.len() - 1;
        // Both ends stay straight, so that objects beside them face along the lanes.
        let room = |leg: usize| {
            let ends = usize::from(leg == 0) + usize::from(leg == last);
            legs[leg].0 - ends as f64 * STRAIGHT_M.min(0.2 * legs[leg].0)
        };
        for (i, fillet) in fillets.iter_mut().enumerate() {
            let before = if i == 0 { 0.0 } else { wished[i - 1] };
            let after = wished.get(i + 1).copied().unwrap_or(0.0);
            let share = |leg: f64, other: f64| leg / (wished[i] + other).max(SHORTEST_M);
            *fillet = fillet.scaled(share(room(i), before).min(share(room(i + 1), after)).min(1.0));
        }
        let mut path = Self::from_pose(from);
        for (i, (length, _)) in legs.iter().enumerate() {
            let before = if i == 0 { 0.0 } else { fillets[i - 1].tangent_m };
            let after = fillets.get(i).map_or(0.0, |f| f.tangent_m);
            path.line(length - before - after);
            if let Some(fillet) = fillets.get(i) {
                path.fillet(fillet);
            }
        }
        path
    }

    /// Smallest radius in it, metres; infinite where it is straight.
    pub(crate) fn tightest_m(&self) -> f64 {
        let most = |piece: &Geometry| match piece.curve {
            Curve::Arc { curvature } => curvature.abs(),
            Curve::Spiral { curvature_start, curvature_end } => {
                curvature_start.abs().max(curvature_end.abs())
            }
            _ => 0.0,
        };
        1.0 / self.pieces.iter().map(most).fold(0.0, f64::max)
    }

    /// The pose at a distance from its start.
    pub(crate) fn pose_at(&self, s: f64) -> Pose2 {
        let after = self.pieces.partition_point(|p| p.s <= s);
        let Some(piece) = self.pieces.get(after.saturating_sub(1)) else { return self.end };
        let start = Pose2 { x_m: piece.x_m, y_m: piece.y_m, heading_rad: piece.hdg_rad };
        let mut part = Self::from_pose(start);
        let d = (s - piece.s).clamp(0.0, piece.length_m);
        match piece.curve {
            Curve::Arc { curvature } => part.arc(curvature, d),
            Curve::Spiral { curvature_start: 0.0, curvature_end } => {
                part.clothoid(0.0, curvature_end * d / piece.length_m, d);
            }
            Curve::Spiral { curvature_start, .. } => {
                // Seen backwards from its end it begins straight.
                part.clothoid(curvature_start, 0.0, piece.length_m);
                let mut back = Self::from_pose(part.end.turned(PI));
                let rest = piece.length_m - d;
                back.clothoid(0.0, -curvature_start * rest / piece.length_m, rest);
                return back.end.turned(PI);
            }
            _ => part.line(d),
        }
        part.end
    }

    /// The s nearest to a point of the plan, by samples a metre or so apart.
    pub(crate) fn nearest_s(&self, [x, y]: [f64; 2]) -> f64 {
        let count = (self.length_m / 1.0).ceil().clamp(1.0, 20_000.0) as u32;
        let at = |i: u32| self.length_m * f64::from(i) / f64::from(count);
        let distance = |s: f64| {
            let p = self.pose_at(s);
            (p.x_m - x) * (p.x_m - x) + (p.y_m - y) * (p.y_m - y)
        };
        (0..=count).map(at).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0.0)
    }

    /// The pose at its end.
    pub(crate) fn end(&self) -> Pose2 {
        self.end
    }

    fn fillet(&mut self, fillet: &Fillet) {
        if fillet.turn == 0.0 {
            return;
        }
        let curvature = fillet.turn.signum() / fillet.radius_m;
        self.clothoid(0.0, curvature, fillet.ease_m);
        self.arc(curvature, fillet.turn.abs() * fillet.radius_m - fillet.ease_m);
        self.clothoid(curvature, 0.0, fillet.ease_m);
    }

    /// Two arcs with equal tangents (the biarc of Bolton, 1975).
    fn two_arcs(&mut self, to: Pose2) {
        let from = self.end;
        let (sin0, cos0) = sin_cos(from.heading_rad);
        let (sin1, cos1) = sin_cos(to.heading_rad);
        let v = [to.x_m - from.x_m, to.y_m - from.y_m];
        let sum = [cos0 + cos1, sin0 + sin1];
        // |v - d (t0 + t1)| = 2 d, for d > 0.
        let a = 4.0 - (sum[0] * sum[0] + sum[1] * sum[1]);
        let b = v[0] * sum[0] + v[1] * sum[1];
        let c = v[0] * v[0] + v[1] * v[1];
        let root = (b * b + a * c).max(0.0).sqrt();
        // The form that stays exact when `a` goes to 0 (parallel ends).
        let d = if b > 0.0 { c / (b + root) } else { (root - b) / a.max(1e-12) };
        let middle = [
            0.5 * (from.x_m + d * cos0 + to.x_m - d * cos1),
            0.5 * (from.y_m + d * sin0 + to.y_m - d * sin1),
        ];
        for target in [middle, [to.x_m, to.y_m]] {
            let (ahead, left) = self.end.locate(Pose2 { x_m: target[0], y_m: target[1], heading_rad: 0.0 });
            let turn = 2.0 * atan2(left, ahead);
            let chord = (ahead * ahead + left * left).sqrt();
            if turn.abs() < 1e-9 {
                self.line(chord);
            } else {
                let curvature = 2.0 * sin_cos(0.5 * turn).0 / chord;
                self.arc(curvature, turn / curvature);
            }
        }
    }

    fn line(&mut self, length_m: f64) {
        self.push(Curve::Line, length_m, self.end.moved(length_m, 0.0));
    }

    fn arc(&mut self, curvature: f64, length_m: f64) {
        let turn = curvature * length_m;
        let (sin, cos) = sin_cos(turn);
        let end = self.end.moved(sin / curvature, (1.0 - cos) / curvature).turned(turn);
        self.push(Curve::Arc { curvature }, length_m, end);
    }

    /// A clothoid that begins or ends straight.
    fn clothoid(&mut self, curvature_start: f64, curvature_end: f64, length_m: f64) {
        let curvature = curvature_start + curvature_end;
        let turn = 0.5 * curvature * length_m;
        let (x, y) = clothoid_end(length_m, turn.abs());
        let end = if curvature_start == 0.0 {
            self.end.moved(x, y * turn.signum()).turned(turn)
        } else {
            // Seen backwards from its end it is the other kind.
            self.end.turned(turn).moved(x, -y * turn.signum())
        };
        self.push(Curve::Spiral { curvature_start, curvature_end }, length_m, end);
    }

    fn push(&mut self, curve: Curve, length_m: f64, end: Pose2) {
        if length_m <= SHORTEST_M {
            return;
        }
        let Pose2 { x_m, y_m, heading_rad } = self.end;
        self.pieces.push(Geometry { s: self.length_m, x_m, y_m, hdg_rad: heading_rad, length_m, curve });
        self.length_m += length_m;
        self.end = end;
    }
}

/// The rounding of a corner: clothoid, arc, clothoid.
#[derive(Clone, Copy, Debug)]
struct Fillet {
    turn: f64,
    radius_m: f64,
    ease_m: f64,
    /// From the corner to either end of the rounding, metres.
    tangent_m: f64,
}

impl Fillet {
    fn new(turn: f64, radius_m: f64, ease_m: f64) -> Self {
        if turn.abs() < 1e-9 {
            return Self { turn: 0.0, radius_m: f64::INFINITY, ease_m: 0.0, tangent_m: 0.0 };
        }
        let half = tan(0.5 * turn.abs());
        // The clothoids may take at most the whole turn.
        let ease_m = ease_m.min(0.95 * turn.abs() * radius_m);
        let mut tangent_m = radius_m * half;
        if ease_m > 0.0 {
            let angle = 0.5 * ease_m / radius_m;
            let (x, y) = clothoid_end(ease_m, angle);
            let (sin, cos) = sin_cos(angle);
            // The arc is shifted inwards by y - R (1 - cos) and begins x - R sin later.
            tangent_m = (radius_m + y - radius_m * (1.0 - cos)) * half + x - radius_m * sin;
        }
        Self { turn, radius_m, ease_m, tangent_m }
    }

    /// The same shape, larger or smaller.
    fn scaled(self, by: f64) -> Self {
        Self {
            radius_m: self.radius_m * by,
            ease_m: self.ease_m * by,
            tangent_m: self.tangent_m * by,
            ..self
        }
    }
}

/// End of a clothoid that begins straight along x and has turned left by `angle_rad` after `length_m`: the
/// Fresnel integrals as power series of the angle (Abramowitz and Stegun 7.3.11 and 7.3.13, in the angle).
fn clothoid_end(length_m: f64, angle_rad: f64) -> (f64, f64) {
    let (mut x, mut y) = (0.0, 0.0);
    // Term n is (-1)^(n / 2) angle^n / (n! (2 n + 1)), even ones in x and odd ones in y; angles stay below 2.
    let mut term = 1.0;
    for n in 0..32 {
        let n = f64::from(n);
        let value = term / (2.0 * n + 1.0);
        match (n as u32) % 4 {
            0 => x += value,
            1 => y += value,
            2 => x -= value,
            _ => y -= value,
        }
        term *= angle_rad / (n + 1.0);
    }
    (x * length_m, y * length_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose(x_m: f64, y_m: f64, heading_rad: f64) -> Pose2 {
        Pose2 { x_m, y_m, heading_rad }
    }

    /// Walks a path's curvature in midpoint steps from its first pose.
    fn walk(path: &Path, from: Pose2) -> Pose2 {
        let mut at = from;
        for piece in &path.pieces {
            let n = 20_000;
            let h = piece.length_m / f64::from(n);
            for i in 0..n {
                let part = (f64::from(i) + 0.5) / f64::from(n);
                let curvature = match piece.curve {
                    Curve::Arc { curvature } => curvature,
                    Curve::Spiral { curvature_start, curvature_end } => {
                        curvature_start + part * (curvature_end - curvature_start)
                    }
                    _ => 0.0,
                };
                at = at.turned(0.5 * h * curvature).moved(h, 0.0).turned(0.5 * h * curvature);
            }
        }
        at
    }

    fn assert_same(a: Pose2, b: Pose2, accuracy: f64) {
        let distance = ((a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m)).sqrt();
        let turn = wrap_pi(a.heading_rad - b.heading_rad).abs();
        assert!(distance < accuracy && turn < accuracy, "{a:?} {b:?}");
    }

    #[test]
    fn a_quarter_turn_is_line_arc_line() {
        let bend = Bend { radius_m: 6.0, ease_m: 0.0, lead_in_m: 1.0, lead_out_m: 1.0 };
        let path = Path::between(pose(0.0, 0.0, 0.0), pose(10.0, -9.0, -0.5 * std::f64::consts::PI), &bend);
        let lengths: Vec<f64> = path.pieces.iter().map(|p| p.length_m).collect();
        assert_eq!(lengths.len(), 3);
        assert!((lengths[0] - 4.0).abs() < 1e-12 && (lengths[2] - 3.0).abs() < 1e-12, "{lengths:?}");
        assert_eq!(path.pieces[1].curve, Curve::Arc { curvature: -1.0 / 6.0 });
    }

    #[test]
    fn a_path_rounds_its_corners() {
        let via = |x: f64, y: f64| Via { at_m: [x, y], radius_m: 30.0, ease_m: 12.0 };
        let vias = [via(100.0, 0.0), via(150.0, 80.0), via(260.0, 60.0)];
        let from = pose(0.0, 0.0, 0.0);
        let to = pose(400.0, 130.0, atan2(70.0, 140.0));
        let path = Path::through(from, &vias, to);
        let radius_m = path.tightest_m();
        assert_same(path.end(), to, 1e-9);
        assert_same(walk(&path, from), to, 1e-6);
        assert!((radius_m - 30.0).abs() < 1e-9, "{radius_m}");
        // Corners close together share the leg between them.
        let tight = [via(100.0, 0.0), via(100.0, 20.0)];
        let path = Path::through(from, &tight, pose(0.0, 20.0, PI));
        let radius_m = path.tightest_m();
        assert_same(path.end(), pose(0.0, 20.0, PI), 1e-9);
        assert!(radius_m < 10.0, "{radius_m}");
        for i in 0..=50 {
            let s = path.length_m * f64::from(i) / 50.0;
            let mut part = path.clone();
            part.pieces.retain(|p| p.s < s);
            if let Some(last) = part.pieces.last_mut() {
                let cut = (s - last.s) / last.length_m;
                if let Curve::Spiral { curvature_start: a, curvature_end: b } = last.curve {
                    last.curve = Curve::Spiral { curvature_start: a, curvature_end: a + cut * (b - a) };
                }
                last.length_m = s - last.s;
            }
            assert_same(path.pose_at(s), walk(&part, from), 1e-6);
        }
    }

    #[test]
    fn a_corner_in_line_is_no_corner() {
        let vias = [Via { at_m: [40.0, 0.0], radius_m: 30.0, ease_m: 5.0 }];
        let path = Path::through(pose(0.0, 0.0, 0.0), &vias, pose(100.0, 0.0, 0.0));
        assert!(path.pieces.iter().all(|p| p.curve == Curve::Line));
        assert!((path.length_m - 100.0).abs() < 1e-12);
    }

    #[test]
    fn ends_stay_straight_however_wide_the_corner() {
        let vias = [Via { at_m: [20.0, 0.0], radius_m: 900.0, ease_m: 0.0 }];
        let path = Path::through(pose(0.0, 0.0, 0.0), &vias, pose(20.0, 20.0, 0.5 * PI));
        let ends = [&path.pieces[0], &path.pieces[2]];
        assert_eq!(ends.map(|p| p.curve), [Curve::Line; 2]);
        assert!(ends.iter().all(|p| p.length_m >= STRAIGHT_M - 1e-9));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn paths_end_where_they_should(x in -40.0..40.0f64, y in -40.0..40.0f64, heading in -3.0..3.0f64,
                                       ease_m in prop::sample::select(vec![0.0, 4.0, 15.0]),
                                       radius_m in prop::sample::select(vec![5.0, 30.0, f64::INFINITY])) {
            prop_assume!(x * x + y * y > 25.0);
            let (from, to) = (pose(3.0, 4.0, 0.3), pose(3.0 + x, 4.0 + y, heading));
            let bend = Bend { radius_m, ease_m, lead_in_m: 0.5, lead_out_m: 1.0 };
            let path = Path::between(from, to, &bend);
            assert_same(path.end(), to, 1e-5);
            assert_same(walk(&path, from), to, 1e-5);
            let sum: f64 = path.pieces.iter().map(|p| p.length_m).sum();
            prop_assert!((sum - path.length_m).abs() < 1e-9);
        }
    }
}
