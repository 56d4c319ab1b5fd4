//! Points and segments in the plan.

use frames::math::{atan2, hypot};

/// Metres east and north.
pub(super) type Point = [f64; 2];
/// From one point to another.
pub(super) type Segment = [Point; 2];

/// Distance between two points, metres.
pub(super) fn distance(a: Point, b: Point) -> f64 {
    hypot(a[0] - b[0], a[1] - b[1])
}

/// Direction from one point to another, radians from east.
pub(super) fn heading(from: Point, to: Point) -> f64 {
    atan2(to[1] - from[1], to[0] - from[0])
}

/// A point on the way from one to another.
pub(super) fn between(a: Point, b: Point, share: f64) -> Point {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

/// Distance from a point to a segment, metres.
pub(super) fn to_segment(p: Point, [a, b]: Segment) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy).max(1e-12);
    distance(p, between(a, b, along.clamp(0.0, 1.0)))
}

/// Where two segments cross, as shares of their lengths.
pub(super) fn cross([a, b]: Segment, [c, d]: Segment) -> Option<(f64, f64)> {
    let (p, q) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let area = p[0] * q[1] - p[1] * q[0];
    if area.abs() < 1e-9 {
        return None;
    }
    let w = [c[0] - a[0], c[1] - a[1]];
    let (u, v) = ((w[0] * q[1] - w[1] * q[0]) / area, (w[0] * p[1] - w[1] * p[0]) / area);
    let inside = |x: f64| (0.0..=1.0).contains(&x);
    (inside(u) && inside(v)).then_some((u, v))
}

/// Whether two segments come nearer to one another than so many metres.
pub(super) fn near(a: Segment, b: Segment, limit_m: f64) -> bool {
    let span = |s: Segment, axis: usize| (s[0][axis].min(s[1][axis]), s[0][axis].max(s[1][axis]));
    let apart = (0..2).any(|axis| {
        let ((low, high), (from, to)) = (span(a, axis), span(b, axis));
        low - limit_m > to || from - limit_m > high
    });
    !apart
        && (cross(a, b).is_some()
            || a.iter().any(|p| to_segment(*p, b) < limit_m)
            || b.iter().any(|p| to_segment(*p, a) < limit_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_cross_and_keep_apart() {
        let a = [[0.0, 0.0], [10.0, 0.0]];
        assert_eq!(cross(a, [[4.0, -2.0], [4.0, 6.0]]), Some((0.4, 0.25)));
        assert_eq!(cross(a, [[4.0, 1.0], [4.0, 6.0]]), None);
        assert!(near(a, [[4.0, 1.0], [4.0, 6.0]], 1.1) && !near(a, [[4.0, 1.0], [4.0, 6.0]], 0.9));
        assert!(near(a, [[4.0, -2.0], [4.0, 6.0]], 0.1));
        assert!((to_segment([13.0, 4.0], a) - 5.0).abs() < 1e-12);
    }
}
