//! Vectors and rigid motions, written anew: the programs that made the store have others.

/// A point or vector, x y z.
pub(crate) type V3 = [f64; 3];

pub(crate) fn add(a: V3, b: V3) -> V3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(a: V3, by: f64) -> V3 {
    a.map(|x| x * by)
}

pub(crate) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn norm(a: V3) -> f64 {
    dot(a, a).sqrt()
}

/// Distance of two points.
pub(crate) fn apart(a: V3, b: V3) -> f64 {
    norm(sub(a, b))
}

/// A rotation and a way: `outer = rotation inner + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Rows of the rotation matrix.
    pub(crate) rows: [V3; 3],
    /// Origin of the inner frame in the outer one.
    pub(crate) origin: V3,
}

impl Motion {
    /// From a position and a quaternion w, x, y, z.
    pub(crate) fn of_quaternion(origin: V3, [w, x, y, z]: [f64; 4]) -> Self {
        let rows = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Self { rows, origin }
    }

    /// From a position and roll, pitch, yaw: Rz(yaw) Ry(pitch) Rx(roll).
    pub(crate) fn of_angles(origin: V3, [roll, pitch, yaw]: V3) -> Self {
        let (sr, cr) = libm::sincos(roll);
        let (sp, cp) = libm::sincos(pitch);
        let (sy, cy) = libm::sincos(yaw);
        let rows = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Self { rows, origin }
    }

    /// A direction of the inner frame in the outer one.
    pub(crate) fn turn(&self, v: V3) -> V3 {
        self.rows.map(|row| dot(row, v))
    }

    /// A direction of the outer frame in the inner one.
    pub(crate) fn turn_back(&self, v: V3) -> V3 {
        let [a, b, c] = self.rows;
        [0, 1, 2].map(|i| a[i] * v[0] + b[i] * v[1] + c[i] * v[2])
    }

    /// A point of the inner frame in the outer one.
    pub(crate) fn outward(&self, p: V3) -> V3 {
        add(self.turn(p), self.origin)
    }

    /// A point of the outer frame in the inner one.
    pub(crate) fn inward(&self, p: V3) -> V3 {
        self.turn_back(sub(p, self.origin))
    }

    /// This one after `inner`: `a.then(b)` takes b's inner frame to a's outer one.
    pub(crate) fn then(&self, inner: &Self) -> Self {
        let column = |i: usize| self.turn(inner.rows.map(|row| row[i]));
        let (a, b, c) = (column(0), column(1), column(2));
        Self { rows: [0, 1, 2].map(|i| [a[i], b[i], c[i]]), origin: self.outward(inner.origin) }
    }

    /// This motion on its way to another one: 0 is this one, 1 the other. The origin goes straight, the
    /// rotation evenly about one axis (Rodrigues); by half a turn, which has none, it does not turn.
    pub(crate) fn towards(&self, there: &Self, share: f64) -> Self {
        let origin = add(self.origin, scale(sub(there.origin, self.origin), share));
        let turn = there.rows.map(|row| self.rows.map(|own| dot(row, own)));
        let twice = [turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1]];
        let (sine, cosine) = (0.5 * norm(twice), 0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1.0));
        if sine < 1e-12 {
            return Self { rows: self.rows, origin };
        }
        let axis = scale(twice, 0.5 / sine);
        let (sin, cos) = libm::sincos(share * libm::atan2(sine, cosine));
        let turned = |v: V3| {
            let along = scale(axis, dot(axis, v) * (1.0 - cos));
            add(add(scale(v, cos), scale(cross(axis, v), sin)), along)
        };
        let columns = [0, 1, 2].map(|i| turned(self.rows.map(|row| row[i])));
        Self { rows: [0, 1, 2].map(|i| columns.map(|column| column[i])), origin }
    }

    /// The x axis of the inner frame in the outer one.
    pub(crate) fn ahead(&self) -> V3 {
        self.rows.map(|row| row[0])
    }

    /// The greatest difference of two rotations' entries: near zero it is the angle between them, rad.
    pub(crate) fn turned_from(&self, other: &Self) -> f64 {
        let pairs = self.rows.iter().flatten().zip(other.rows.iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, worse)
    }
}

/// The greater number; NaN is the worst.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// Whether a deviation is within a tolerance; NaN is not.
pub(crate) fn within(deviation: f64, tolerance: f64) -> bool {
    deviation.abs() <= tolerance
}

/// An angle as its equal in (-pi, pi].
pub(crate) fn wrapped(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turns = ((angle_rad - PI) / TAU).ceil();
    angle_rad - TAU * turns
}

/// The least convex loop around points, counter-clockwise (Andrew's monotone chain).
pub(crate) fn convex_hull(mut points: [[f64; 2]; 8]) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turns_left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && !turns_left(a, b, point)
            {
                chain.pop();
            }
            chain.push(point);
        }
        // The last point begins the other chain.
        chain.pop();
        chain
    };
    let (there, back) = (chain(&mut points.into_iter()), chain(&mut points.into_iter().rev()));
    [there, back].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn close(a: V3, b: V3) -> bool {
        apart(a, b) < 1e-12
    }

    #[test]
    fn a_quarter_turn_is_the_same_by_quaternion_and_by_angle() {
        let half = 0.5_f64.sqrt();
        let yaw = Motion::of_quaternion([1.0, 2.0, 3.0], [half, 0.0, 0.0, half]);
        assert!(close(yaw.turn([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]), "left is counter-clockwise");
        assert!(close(yaw.outward([1.0, 0.0, 0.0]), [1.0, 3.0, 3.0]));
        assert!(close(yaw.inward([1.0, 3.0, 3.0]), [1.0, 0.0, 0.0]));
        assert!(yaw.turned_from(&Motion::of_angles([0.0; 3], [0.0, 0.0, FRAC_PI_2])) < 1e-12);
        let pitch = Motion::of_angles([0.0; 3], [0.0, FRAC_PI_2, 0.0]);
        assert!(close(pitch.ahead(), [0.0, 0.0, -1.0]), "positive pitch is nose down");
        let roll = Motion::of_angles([0.0; 3], [FRAC_PI_2, 0.0, 0.0]);
        assert!(close(roll.turn([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]));
    }

    #[test]
    fn motions_follow_one_another() {
        let a = Motion::of_angles([1.0, 0.0, 0.0], [0.3, -0.2, 1.1]);
        let b = Motion::of_angles([0.0, 4.0, -1.0], [-0.1, 0.4, 2.0]);
        let p = [0.3, -7.0, 2.0];
        assert!(close(a.then(&b).outward(p), a.outward(b.outward(p))));
        assert!(close(b.inward(a.inward(a.then(&b).outward(p))), p));
    }

    #[test]
    fn angles_wrap_to_half_a_turn() {
        assert!((wrapped(3.0 * PI) - PI).abs() < 1e-12);
        assert!((wrapped(-FRAC_PI_2) + FRAC_PI_2).abs() < 1e-12);
        assert!((wrapped(-PI) - PI).abs() < 1e-12);
    }

    #[test]
    fn half_way_between_two_poses_is_half_the_turn() {
        let (a, b) = ([1.0, 2.0, 3.0], [3.0, 2.0, 1.0]);
        let [from, to] =
            [0.3, 1.1].map(|yaw| Motion::of_angles(if yaw < 1.0 { a } else { b }, [0.0, 0.0, yaw]));
        let quarter = from.towards(&to, 0.25);
        let want = Motion::of_angles([1.5, 2.0, 2.5], [0.0, 0.0, 0.5]);
        assert!(quarter.turned_from(&want) < 1e-12 && apart(quarter.origin, want.origin) < 1e-12);
        assert!(from.towards(&to, 1.0).turned_from(&to) < 1e-12);
        assert_eq!(from.towards(&from, 0.7), from);
    }

    #[test]
    fn hulls_have_the_outer_points_alone() {
        // A square of 2 m, one of 1 m within it but for a corner on its edge and one beyond.
        let points =
            [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.5, 0.5], [1.0, 0.0], [3.0, 1.0], [0.5, 1.5]];
        assert_eq!(convex_hull(points), [[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [2.0, 2.0], [0.0, 2.0]]);
    }
}
