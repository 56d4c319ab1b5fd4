//! Where on its lane a piece of road lies.

use glam::{Vec2, Vec3};
use lanes::{Lanes, Vec3s};

/// Widths of lanes that traffic keeps to, metres.
const USED_M: std::ops::Range<f32> = 2.5..4.6;

/// How a triangle of a lane lies between its borders.
///
/// Lanes are strips of quadrangles, each of two triangles with two corners on one border and one on the other: `(right, right, left)`
/// and `(right, left, left)`. What runs across is the middle one of the sides: it is shorter than the diagonal, which comes last in the
/// one and first in the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// A share of the width for each metre of the plan; and that of the origin.
    slope: Vec2,
    start: f32,
    width_m: f32,
}

impl Across {
    /// Of a triangle's corners; none if it is no piece of a lane that traffic keeps to.
    pub(super) fn new(corners_m: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = corners_m.map(Vec3::truncate);
        let (first, last) = (a.distance_squared(b), c.distance_squared(a));
        // A border, and the corner that lies on the other one; 1 is the left border.
        let (from, to, other, share) = if last > first { (a, b, c, 1.0) } else { (b, c, a, 0.0) };
        let along = to - from;
        let area = along.perp_dot(other - from);
        let width_m = area.abs() / along.length();
        if !USED_M.contains(&width_m) {
            return None;
        }
        let slope = along.perp() * ((2.0 * share - 1.0) / area);
        Some(Self { slope, start: 1.0 - share - slope.dot(from), width_m })
    }

    /// Metres from the middle of the lane to places, left and right alike.
    #[inline]
    pub(super) fn off_middle_m(&self, object_m: &Vec3s) -> Lanes {
        let share = object_m.x * self.slope.x + object_m.y * self.slope.y + self.start;
        ((share - 0.5) * self.width_m).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_triangles_of_a_piece_agree() {
        // A piece of a bend, 3.5 m wide.
        let right = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(6.0, 0.4, 0.1)];
        let left = [Vec3::new(-0.2, 3.5, 0.0), Vec3::new(5.6, 3.9, 0.1)];
        let one = Across::new([right[0], right[1], left[1]]).expect("is a lane");
        let two = Across::new([right[0], left[1], left[0]]).expect("is a lane");
        let at = |piece: &Across, p: Vec3| piece.off_middle_m(&Vec3s::splat(p)).to_array()[0];
        for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let on_diagonal = right[0].lerp(left[1], share);
            let want = (share - 0.5).abs() * 3.5;
            assert!((at(&one, on_diagonal) - want).abs() < 0.1, "{share}");
            assert!((at(&two, on_diagonal) - want).abs() < 0.1, "{share}");
        }
        assert!((at(&one, right[1]) - at(&one, right[0])).abs() < 1e-5);
        assert!((at(&two, left[1]) - at(&two, left[0])).abs() < 1e-5);
    }

    #[test]
    fn squares_and_parking_are_no_lanes() {
        let triangle = |width: f32| {
            Across::new([Vec3::ZERO, Vec3::new(8.0, 0.0, 0.0), Vec3::new(8.0, width, 0.0)]).is_some()
        };
        assert!(triangle(3.0) && !triangle(2.0) && !triangle(12.0) && !triangle(0.0));
    }
}
