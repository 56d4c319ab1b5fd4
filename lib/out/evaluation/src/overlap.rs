//! How much boxes overlap, seen from above.

use frames::math;

use crate::boxes::Solid;

type Point = [f64; 2];

/// The corners of a box from above, counter-clockwise, about a point of the plane.
fn corners(solid: &Solid, about: Point) -> [Point; 4] {
    let (sin, cos) = math::sin_cos(solid.yaw_rad);
    let (a, b) = (0.5 * solid.size_m[0], 0.5 * solid.size_m[1]);
    let middle = [0, 1].map(|axis| solid.center_m[axis] - about[axis]);
    [[a, b], [-a, b], [-a, -b], [a, -b]]
        .map(|[x, y]| [middle[0] + cos * x - sin * y, middle[1] + sin * x + cos * y])
}

/// How far a point is to the left of a line, times the line's length.
fn left_of(point: Point, [from, to]: [Point; 2]) -> f64 {
    (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0])
}

/// The part of a convex polygon that is to the left of a line (Sutherland and Hodgman 1974).
fn cut(polygon: &[Point], line: [Point; 2], kept: &mut Vec<Point>) {
    kept.clear();
    for (i, &here) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (a, b) = (left_of(here, line), left_of(next, line));
        if a >= 0.0 {
            kept.push(here);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let share = a / (a - b);
            kept.push([0, 1].map(|axis| here[axis] + share * (next[axis] - here[axis])));
        }
    }
}

/// Area of a polygon, counter-clockwise.
fn area(polygon: &[Point]) -> f64 {
    let pairs = polygon.iter().enumerate().map(|(i, a)| (a, polygon[(i + 1) % polygon.len()]));
    0.5 * pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

/// Overlap over union of two boxes from above, 0 to 1.
#[must_use]
pub fn bev_iou(one: &Solid, other: &Solid) -> f64 {
    let (areas, common) = (areas_m2(one, other), common_area_m2(one, other));
    common / (areas[0] + areas[1] - common)
}

/// Overlap over union of two boxes in space, 0 to 1. Both stand upright.
#[must_use]
pub fn volume_iou(one: &Solid, other: &Solid) -> f64 {
    let areas = areas_m2(one, other);
    let ends = |solid: &Solid| [-0.5, 0.5].map(|half| solid.center_m[2] + half * solid.size_m[2]);
    let ([low_a, high_a], [low_b, high_b]) = (ends(one), ends(other));
    let common = common_area_m2(one, other) * (high_a.min(high_b) - low_a.max(low_b)).max(0.0);
    common / (areas[0] * one.size_m[2] + areas[1] * other.size_m[2] - common)
}

/// The areas of two boxes from above.
fn areas_m2(one: &Solid, other: &Solid) -> [f64; 2] {
    [one, other].map(|solid| solid.size_m[0] * solid.size_m[1])
}

/// The area that two boxes have in common from above.
fn common_area_m2(one: &Solid, other: &Solid) -> f64 {
    let areas = areas_m2(one, other);
    let reach = |solid: &Solid| 0.5 * (solid.size_m[0] + solid.size_m[1]);
    if one.planar_distance_m(other) > reach(one) + reach(other) {
        return 0.0;
    }
    // Near zero: the world's coordinates are large.
    let about = [one.center_m[0], one.center_m[1]];
    let frame = corners(other, about);
    let (mut polygon, mut kept) = (corners(one, about).to_vec(), Vec::with_capacity(8));
    for side in 0..4 {
        cut(&polygon, [frame[side], frame[(side + 1) % 4]], &mut kept);
        std::mem::swap(&mut polygon, &mut kept);
    }
    area(&polygon).clamp(0.0, areas[0].min(areas[1]))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use super::*;

    fn solid(x: f64, y: f64, length: f64, width: f64, yaw_rad: f64) -> Solid {
        Solid { center_m: [x, y, 0.0], size_m: [length, width, 1.0], yaw_rad, ..Solid::default() }
    }

    #[track_caller]
    fn check(one: &Solid, other: &Solid, want: f64) {
        for (a, b) in [(one, other), (other, one)] {
            let found = bev_iou(a, b);
            assert!((found - want).abs() < 1e-9, "{found}, expected {want}");
        }
    }

    #[test]
    fn closed_forms() {
        let one = solid(5000.0, -7000.0, 4.0, 2.0, 0.3);
        check(&one, &one, 1.0);
        check(&one, &Solid { yaw_rad: 0.3 + PI, ..one }, 1.0);
        // A cross of two bars: 2 x 2 of 8 + 8 - 4.
        check(&one, &Solid { yaw_rad: 0.3 + FRAC_PI_2, ..one }, 4.0 / 12.0);
        // Half a length on along its own axis.
        let on = solid(5000.0 + 2.0 * math::cos(0.3), -7000.0 + 2.0 * math::sin(0.3), 4.0, 2.0, 0.3);
        check(&one, &on, 4.0 / 12.0);
        // One within the other.
        check(&one, &Solid { size_m: [2.0, 1.0, 9.0], yaw_rad: 0.9, ..one }, 2.0 / 8.0);
        // Squares turned by an eighth: a regular octagon, 8 (sqrt 2 - 1) of a half side of 1.
        let octagon = 8.0 * (2.0_f64.sqrt() - 1.0);
        let square = solid(1.0, 2.0, 2.0, 2.0, 0.1);
        check(&square, &Solid { yaw_rad: 0.1 + FRAC_PI_4, ..square }, octagon / (8.0 - octagon));
        // Side by side, corner to corner, and far apart.
        check(&solid(0.0, 0.0, 2.0, 2.0, 0.0), &solid(2.0, 0.0, 2.0, 2.0, 0.0), 0.0);
        check(&solid(0.0, 0.0, 2.0, 2.0, 0.0), &solid(2.0, 2.0, 2.0, 2.0, 0.0), 0.0);
        check(&one, &solid(0.0, 0.0, 4.0, 2.0, 0.0), 0.0);
    }

    #[test]
    fn in_space_heights_count() {
        let one =
            Solid { center_m: [0.0, 0.0, 1.0], size_m: [4.0, 2.0, 2.0], ..solid(0.0, 0.0, 4.0, 2.0, 0.4) };
        let at = |x: f64, z_m: f64, height_m: f64| Solid {
            center_m: [x * math::cos(0.4), x * math::sin(0.4), z_m],
            size_m: [4.0, 2.0, height_m],
            ..one
        };
        // Half a length on and half a height up: a quarter of each. A lower one within. One above the other.
        for (other, want) in
            [(at(2.0, 2.0, 2.0), 4.0 / 28.0), (at(0.0, 0.5, 1.0), 0.5), (at(0.0, 3.0, 2.0), 0.0), (one, 1.0)]
        {
            for (a, b) in [(&one, &other), (&other, &one)] {
                assert!((volume_iou(a, b) - want).abs() < 1e-9, "{} {want}", volume_iou(a, b));
            }
        }
    }

    #[test]
    fn a_fine_grid_counts_the_same() {
        let mut seed = 7_u64;
        let mut draw = |from: f64, to: f64| {
            // Numerical Recipes' generator: any will do.
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            from + (to - from) * (seed >> 40) as f64 / f64::from(1 << 24)
        };
        let mut overlapping = 0;
        for _ in 0..40 {
            let mut one =
                || solid(draw(-2.0, 2.0), draw(-2.0, 2.0), draw(1.0, 5.0), draw(1.0, 3.0), draw(-4.0, 4.0));
            let (a, b) = (one(), one());
            let is_in = |solid: &Solid, x: f64, y: f64| {
                let (dx, dy) = (x - solid.center_m[0], y - solid.center_m[1]);
                let (sin, cos) = math::sin_cos(solid.yaw_rad);
                (cos * dx + sin * dy).abs() <= 0.5 * solid.size_m[0]
                    && (cos * dy - sin * dx).abs() <= 0.5 * solid.size_m[1]
            };
            let (mut both, mut any) = (0, 0);
            for i in 0..600 {
                for j in 0..600 {
                    let (x, y) = (0.02 * (f64::from(i) - 299.5), 0.02 * (f64::from(j) - 299.5));
                    let (in_a, in_b) = (is_in(&a, x, y), is_in(&b, x, y));
                    both += u32::from(in_a && in_b);
                    any += u32::from(in_a || in_b);
                }
            }
            let counted = f64::from(both) / f64::from(any);
            overlapping += u32::from(both > 0);
            assert!((bev_iou(&a, &b) - counted).abs() < 0.01, "{a:?} {b:?}: {} {counted}", bev_iou(&a, &b));
        }
        assert!(overlapping > 20, "{overlapping}");
    }
}
