//! Where on its lane a piece of road lies.

use glam::{Vec2, Vec3};
use schema::geometry::{Kerbs, Surface};
use simd::{F32x8, Vec3x8};

/// Widths of lanes that traffic keeps to, metres.
const USED_M: std::ops::Range<f32> = 2.5..4.6;

/// How a triangle of a lane lies between its borders.
///
/// Lanes are strips of quadrangles, each of two triangles with two corners on one border and one on the
/// other: `(right, right, left)` and `(right, left, left)`. What runs across is the middle one of the sides:
/// it is shorter than the diagonal, which comes last in the one and first in the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Across {
    /// A share of the width for each metre of the plan; and that of the origin.
    slope: Vec2,
    start: f32,
    width_m: f32,
    /// The way its borders run.
    along: Vec2,
}

impl Across {
    /// Of a triangle's corners; none if it is no piece of a lane that traffic keeps to.
    pub(super) fn new(corners_m: [Vec3; 3]) -> Option<Self> {
        Self::of_any(corners_m).filter(|lane| USED_M.contains(&lane.width_m))
    }

    /// The same of lanes of any width; none if it has none.
    pub(super) fn of_any(corners_m: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = corners_m.map(Vec3::truncate);
        let (first, last) = (a.distance_squared(b), c.distance_squared(a));
        // A border, and the corner that lies on the other one; 1 is the left border.
        let (from, to, other, share) = if last > first { (a, b, c, 1.0) } else { (b, c, a, 0.0) };
        let along = to - from;
        let area = along.perp_dot(other - from);
        let width_m = area.abs() / along.length();
        // Not so of what is no number, either.
        if !(width_m > 0.0 && width_m.is_finite()) {
            return None;
        }
        let slope = along.perp() * ((2.0 * share - 1.0) / area);
        let along = along.normalize_or_zero();
        Some(Self { slope, start: 1.0 - share - slope.dot(from), width_m, along })
    }

    /// Metres from its right and its left border to places.
    #[inline]
    fn off_borders_m(&self, object_m: &Vec3x8) -> [F32x8; 2] {
        let from_right_m = self.share(object_m) * self.width_m;
        [from_right_m, self.width_m - from_right_m]
    }

    /// Share of its width that lies to the right of places.
    #[inline]
    fn share(&self, object_m: &Vec3x8) -> F32x8 {
        object_m.x * self.slope.x + object_m.y * self.slope.y + self.start
    }

    /// Metres from the middle of the lane to places, left and right alike.
    #[inline]
    pub(super) fn off_middle_m(&self, object_m: &Vec3x8) -> F32x8 {
        ((self.share(object_m) - 0.5) * self.width_m).abs()
    }
}

/// A piece of a lane with kerbs beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kerbed {
    lane: Across,
    kerbs: Kerbs,
}

impl Kerbed {
    /// Of a triangle; none where no kerb stands.
    pub(super) fn new(surface: Surface, corners_m: [Vec3; 3]) -> Option<Self> {
        let Surface::KerbedAsphalt(kerbs) = surface else { return None };
        Some(Self { lane: Across::of_any(corners_m)?, kerbs })
    }

    /// Metres to the nearest kerb.
    #[inline]
    pub(super) fn away_m(&self, object_m: &Vec3x8) -> F32x8 {
        let far = F32x8::splat(f32::INFINITY);
        let [right, left] = self.lane.off_borders_m(object_m);
        let [on_right, on_left] = self.kerbs.sides();
        (if on_right { right } else { far }).fast_min(if on_left { left } else { far })
    }

    /// Width of the lane, metres.
    pub(super) fn width_m(&self) -> f32 {
        self.lane.width_m
    }

    /// The way the kerbs run, of unit length.
    pub(super) fn along(&self) -> Vec2 {
        self.lane.along
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
        let at = |piece: &Across, p: Vec3| piece.off_middle_m(&Vec3x8::splat(p)).to_array()[0];
        for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let on_diagonal = right[0].lerp(left[1], share);
            let want = (share - 0.5).abs() * 3.5;
            assert!((at(&one, on_diagonal) - want).abs() < 0.1, "{share}");
            assert!((at(&two, on_diagonal) - want).abs() < 0.1, "{share}");
        }
        assert!((at(&one, right[1]) - at(&one, right[0])).abs() < 1e-5);
        assert!((at(&two, left[1]) - at(&two, left[0])).abs() < 1e-5);
        let borders =
            |piece: &Across, p: Vec3| piece.off_borders_m(&Vec3x8::splat(p)).map(|from| from.to_array()[0]);
        for piece in [&one, &two] {
            let [on_right, on_left] = [borders(piece, right[1]), borders(piece, left[1])];
            assert!(on_right[0].abs() < 0.1 && (on_right[1] - 3.5).abs() < 0.1, "{on_right:?}");
            assert!(on_left[1].abs() < 0.1 && (on_left[0] - 3.5).abs() < 0.1, "{on_left:?}");
        }
    }

    #[test]
    fn squares_and_parking_are_no_lanes() {
        let triangle = |width: f32| {
            Across::new([Vec3::ZERO, Vec3::new(8.0, 0.0, 0.0), Vec3::new(8.0, width, 0.0)]).is_some()
        };
        assert!(triangle(3.0) && !triangle(2.0) && !triangle(12.0) && !triangle(0.0));
    }
}
