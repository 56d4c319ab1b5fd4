//! The union of many small pieces in plan, on an integer grid: the same bits everywhere.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::angle::Angle;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::mesh::int::outline::offset::IntOutlineOffset;
use i_overlay::mesh::int::style::{IntLineJoin, IntOutlineStyle};
use nalgebra::Point2;

/// Spacing of the grid, metres.
const GRID_M: f64 = 1e-4;
/// Pieces farther from the origin than this are left out (the integers end at 107 km).
const REACH_M: f64 = 50_000.0;
/// Cracks narrower than twice this are closed, grid units (3 cm).
const CLOSE: i32 = 300;
/// Smaller islands and holes are left out, square grid units (10 cm by 10 cm).
const MIN_AREA: u64 = 1_000_000;
/// Sharper corners are cut while cracks are closed, far enough out to get them back whole: a twenty-fourth of
/// a turn.
const SHARPEST: Angle = Angle::from_bits(u32::MAX / 24);

/// Rings of a polygon: the outline counter-clockwise, then holes clockwise; the first point is not repeated.
pub(super) type Rings = Vec<Vec<Point2<f64>>>;

type Ring = Vec<IntPoint<i32>>;

/// The union of quadrangles, without cracks, crumbs and self-intersections.
///
/// `pieces` have their corners in order, either way round; folded ones count as the two triangles they
/// consist of. Vertices of the answer lie within a tenth of a millimetre of those of the pieces, or where
/// their edges cross.
pub(super) fn union(pieces: &[[Point2<f64>; 4]], origin: Point2<f64>) -> Vec<Rings> {
    let mut rings: Vec<Ring> = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let corners = piece.map(|p| to_grid(p, origin));
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            add(&mut rings, [a, b, c, d]);
        }
    }
    let clean = IntOverlayOptions { ogc: true, ..IntOverlayOptions::default() };
    let whole =
        Overlay::<i32>::from_subj_and_clip_custom(&rings, &Vec::<Ring>::new(), clean, Default::default())
            .overlay(OverlayRule::Subject, FillRule::NonZero);
    // Growing and shrinking again closes cracks and leaves everything else where it was.
    let style = IntOutlineStyle::new(CLOSE).line_join(IntLineJoin::Miter(SHARPEST));
    let last = IntOverlayOptions { min_output_area: MIN_AREA, ..clean };
    let shapes = whole
        .outline_custom(&style, clean)
        .and_then(|grown| grown.outline_custom(&style.offset(-CLOSE), last));
    let from_grid = |p: &IntPoint<i32>| {
        Point2::new(origin.x + f64::from(p.x) * GRID_M, origin.y + f64::from(p.y) * GRID_M)
    };
    let shapes = shapes.unwrap_or_default();
    shapes
        .iter()
        .map(|shape| shape.iter().map(|ring| ring.iter().map(from_grid).collect()).collect())
        .collect()
}

fn to_grid(point: Point2<f64>, origin: Point2<f64>) -> Option<IntPoint<i32>> {
    let offset = point - origin;
    let inside = offset.x.abs() < REACH_M && offset.y.abs() < REACH_M;
    let cell = |metres: f64| (metres / GRID_M).round() as i32;
    inside.then(|| IntPoint::new(cell(offset.x), cell(offset.y)))
}

/// Twice the signed area of a triangle.
fn area(a: IntPoint<i32>, b: IntPoint<i32>, c: IntPoint<i32>) -> i64 {
    let d = |p: IntPoint<i32>| (i64::from(p.x) - i64::from(a.x), i64::from(p.y) - i64::from(a.y));
    let (b, c) = (d(b), d(c));
    b.0 * c.1 - b.1 * c.0
}

/// Adds a quadrangle counter-clockwise: whole where it is convex, else as two triangles.
fn add(rings: &mut Vec<Ring>, [a, b, c, d]: [IntPoint<i32>; 4]) {
    let turns = [area(a, b, c), area(b, c, d), area(c, d, a), area(d, a, b)];
    if turns.iter().all(|t| *t >= 0) {
        if turns.iter().any(|t| *t > 0) {
            rings.push(vec![a, b, c, d]);
        }
        return;
    }
    if turns.iter().all(|t| *t <= 0) {
        rings.push(vec![d, c, b, a]);
        return;
    }
    for [p, q, r] in [[a, b, c], [a, c, d]] {
        match area(p, q, r) {
            0 => {}
            1.. => rings.push(vec![p, q, r]),
            _ => rings.push(vec![r, q, p]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square(x: f64, y: f64, size: f64) -> [Point2<f64>; 4] {
        [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(u, v)| Point2::new(x + u, y + v))
    }

    /// Winding-free test: a ray to the right crosses the rings an odd number of times.
    fn inside(shapes: &[Rings], p: Point2<f64>) -> bool {
        let mut odd = false;
        for ring in shapes.iter().flatten() {
            for i in 0..ring.len() {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y) {
                    odd = !odd;
                }
            }
        }
        odd
    }

    #[test]
    fn four_bars_leave_a_hole() {
        let bars =
            [(0.0, 0.0, 10.0, 1.0), (0.0, 9.0, 10.0, 1.0), (0.0, 0.0, 1.0, 10.0), (9.0, 0.0, 1.0, 10.0)].map(
                |(x, y, w, h)| {
                    [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(u, v)| Point2::new(x + u, y + v))
                },
            );
        let shapes = union(&bars, Point2::new(3.0, -2.0));
        assert_eq!(shapes.len(), 1);
        assert_eq!(shapes[0].iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
        assert!(inside(&shapes, Point2::new(0.5, 5.0)) && !inside(&shapes, Point2::new(5.0, 5.0)));
        // Closing cracks must not round corners.
        let corner =
            shapes[0][0].iter().map(|p| (p - Point2::new(10.0, 10.0)).norm()).fold(f64::INFINITY, f64::min);
        assert!(corner < 3e-4, "{corner}");
    }

    #[test]
    fn cracks_close_and_gaps_stay() {
        let crack = union(&[square(0.0, 0.0, 4.0), square(4.05, 0.0, 4.0)], Point2::origin());
        assert_eq!((crack.len(), crack[0].len()), (1, 1));
        let gap = union(&[square(0.0, 0.0, 4.0), square(4.08, 0.0, 4.0)], Point2::origin());
        assert_eq!(gap.len(), 2);
    }

    #[test]
    fn folded_and_broken_pieces_are_borne() {
        let bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| Point2::new(x, y));
        let far = square(1e300, 0.0, 1.0);
        let none = square(f64::NAN, 0.0, 1.0);
        let point = square(5.0, 5.0, 0.0);
        let shapes = union(&[bow, far, none, point], Point2::origin());
        assert!(inside(&shapes, Point2::new(1.5, 1.0)) || inside(&shapes, Point2::new(1.0, 1.5)));
        assert!(union(&[], Point2::origin()).is_empty());
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn membership_is_that_of_the_pieces(
            pieces in prop::collection::vec((-20.0..20.0f64, -20.0..20.0f64, 0.5..12.0f64, 0.5..12.0f64, 0.0..3.0f64), 1..25),
            points in prop::collection::vec((-25.0..35.0f64, -25.0..35.0f64), 40),
        ) {
            // Rectangles turned by some angle.
            let place = |&(x, y, w, h, turn): &(f64, f64, f64, f64, f64)| {
                let (sin, cos) = frames::math::sin_cos(turn);
                [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(u, v)| Point2::new(x + cos * u - sin * v, y + sin * u + cos * v))
            };
            let quads: Vec<_> = pieces.iter().map(place).collect();
            let shapes = union(&quads, Point2::new(1.0, 1.0));
            for (x, y) in points {
                // Distance to the inside of a rectangle, positive within.
                let depth = |&(px, py, w, h, turn): &(f64, f64, f64, f64, f64)| {
                    let (sin, cos) = frames::math::sin_cos(turn);
                    let (u, v) = (cos * (x - px) + sin * (y - py), cos * (y - py) - sin * (x - px));
                    u.min(w - u).min(v).min(h - v)
                };
                let deepest = pieces.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
                if deepest > 0.001 {
                    prop_assert!(inside(&shapes, Point2::new(x, y)));
                }
                // Cracks and small holes are filled on purpose.
                if deepest < -0.15 {
                    prop_assert!(!inside(&shapes, Point2::new(x, y)));
                }
            }
        }
    }
}
