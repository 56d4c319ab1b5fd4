//! Rectangles of the plan, turned any way.

use crate::math::sin_cos;

/// A rectangle of the plan (x east, y north, metres), turned any way.
///
/// By hand and in `f64`: parry3d would be the crate for it, but it is built for `f32` here (rapier3d's), and
/// every crate that places things would compile all of it for these few lines.
///
/// ```
/// use frames::OrientedRect;
///
/// let car = OrientedRect::new([0.0, 0.0], 0.0, [2.3, 0.9]);
/// let across = |x_m| OrientedRect::new([x_m, 0.0], frames::deg(90.0), [2.3, 0.9]);
/// assert!(car.meets(&across(3.1)) && !car.meets(&across(3.3)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedRect {
    /// Its middle, metres.
    pub centre_m: [f64; 2],
    /// Direction of its first side, of length 1.
    pub axis: [f64; 2],
    /// Half the lengths of its sides, metres.
    pub half_m: [f64; 2],
}

impl OrientedRect {
    /// A rectangle whose first side leads along a direction, radians from east.
    #[must_use]
    pub fn new(centre_m: [f64; 2], yaw_rad: f64, half_m: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(yaw_rad);
        Self { centre_m, axis: [cos, sin], half_m }
    }

    /// A square along the axes.
    #[must_use]
    pub fn square(centre_m: [f64; 2], half_m: f64) -> Self {
        Self { centre_m, axis: [1.0, 0.0], half_m: [half_m; 2] }
    }

    /// The rectangle with a margin on all sides.
    #[must_use]
    pub fn grown(&self, by_m: f64) -> Self {
        Self { half_m: self.half_m.map(|h| h + by_m), ..*self }
    }

    /// The point at shares -1 to 1 of the half sides.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> [f64; 2] {
        let (a, b) = (u * self.half_m[0], v * self.half_m[1]);
        [
            self.centre_m[0] + a * self.axis[0] - b * self.axis[1],
            self.centre_m[1] + a * self.axis[1] + b * self.axis[0],
        ]
    }

    /// How far it reaches from its middle along a direction of length 1 and against it, metres.
    #[must_use]
    pub fn reach_m(&self, direction: [f64; 2]) -> f64 {
        let along = (direction[0] * self.axis[0] + direction[1] * self.axis[1]).abs();
        let across = (direction[1] * self.axis[0] - direction[0] * self.axis[1]).abs();
        along * self.half_m[0] + across * self.half_m[1]
    }

    /// Half the sides of the upright box around it, metres.
    #[must_use]
    pub fn extent_m(&self) -> [f64; 2] {
        [self.reach_m([1.0, 0.0]), self.reach_m([0.0, 1.0])]
    }

    /// Whether the two share a point: no side of either separates them.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        let apart = [other.centre_m[0] - self.centre_m[0], other.centre_m[1] - self.centre_m[1]];
        let across = |axis: [f64; 2]| [-axis[1], axis[0]];
        [self.axis, across(self.axis), other.axis, across(other.axis)]
            .iter()
            .all(|n| (n[0] * apart[0] + n[1] * apart[1]).abs() <= self.reach_m(*n) + other.reach_m(*n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn corners(rect: &OrientedRect) -> [[f64; 2]; 4] {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| rect.at(u, v))
    }

    /// Which side of the line from `a` to `b` a point is on.
    fn side(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    }

    /// Another way to the same answer: a corner of one lies in the other, or two sides cross.
    fn meet(a: &OrientedRect, b: &OrientedRect) -> bool {
        let (p, q) = (corners(a), corners(b));
        let holds =
            |ring: [[f64; 2]; 4], x: [f64; 2]| (0..4).all(|i| side(ring[i], ring[(i + 1) % 4], x) >= 0.0);
        let cross = (0..4).any(|i| {
            (0..4).any(|k| {
                let ([a, b], [c, d]) = ([p[i], p[(i + 1) % 4]], [q[k], q[(k + 1) % 4]]);
                side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
            })
        });
        cross || p.iter().any(|x| holds(q, *x)) || q.iter().any(|x| holds(p, *x))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        #[test]
        fn rectangles_meet_where_their_borders_do_or_one_holds_the_other(
            x in -9.0..9.0f64, y in -9.0..9.0f64, yaws in prop::array::uniform2(-4.0..4.0f64),
            half_a in prop::array::uniform2(0.1..5.0f64), half_b in prop::array::uniform2(0.1..5.0f64),
        ) {
            let a = OrientedRect::new([3.0, -2.0], yaws[0], half_a);
            let b = OrientedRect::new([3.0 + x, y - 2.0], yaws[1], half_b);
            // Where a hair's breadth decides, both may be right.
            if a.grown(-1e-9).meets(&b) == a.grown(1e-9).meets(&b) {
                prop_assert_eq!(a.meets(&b), meet(&a, &b));
                prop_assert_eq!(b.meets(&a), a.meets(&b));
            }
        }

        #[test]
        fn the_reach_is_that_of_the_farthest_corner(yaw in -4.0..4.0f64, towards in -4.0..4.0f64) {
            let rect = OrientedRect::new([7.0, 1.0], yaw, [2.5, 0.4]);
            let (sin, cos) = sin_cos(towards);
            let far = corners(&rect).map(|p| (p[0] - 7.0) * cos + (p[1] - 1.0) * sin);
            let farthest = far.into_iter().fold(f64::NEG_INFINITY, f64::max);
            prop_assert!((rect.reach_m([cos, sin]) - farthest).abs() < 1e-12);
            let east = corners(&rect).map(|p| p[0] - 7.0).into_iter().fold(f64::NEG_INFINITY, f64::max);
            prop_assert!((rect.extent_m()[0] - east).abs() < 1e-12);
        }
    }
}
