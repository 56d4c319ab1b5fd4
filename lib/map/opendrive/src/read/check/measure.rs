//! Numbers beyond all measure: with them sums overflow, and places come out as not-a-number.

use crate::model::{Cubic, Curve, Geometry, Lane, Road};

/// Farther than this from the origin, or higher, or longer, is nothing on earth, metres (and whatever other
/// unit).
const ABSURD: f64 = 1e8;
/// More turning than this along one reference line is nothing on earth, radians.
const ABSURD_TURN_RAD: f64 = 1e5;
/// How far from its first t a lateral shape is looked at, metres.
const SHAPE_REACH_M: f64 = 100.0;

/// Whether a number of a file is beyond all measure.
pub(crate) fn is_absurd(value: f64) -> bool {
    value.abs() > ABSURD
}

/// The first place at which something of a road is beyond all measure, and what it is.
pub(crate) fn absurdity(road: &Road) -> Option<(f64, &'static str)> {
    if is_absurd(road.length_m) {
        return Some((0.0, "the length"));
    }
    let mut turn = 0.0;
    let piece = road.plan_view.iter().find(|g| {
        turn += turn_rad(g);
        piece_is_absurd(g) || turn > ABSURD_TURN_RAD
    });
    let list = |records: &[Cubic]| absurd_cubic(records, road.length_m);
    piece
        .map(|g| (g.s, "the reference line"))
        .or_else(|| list(&road.elevation).map(|s| (s, "the elevation")))
        .or_else(|| list(&road.superelevation).map(|s| (s, "the superelevation")))
        .or_else(|| list(&road.lane_offset).map(|s| (s, "the lane offset")))
        .or_else(|| {
            let crossfall: Vec<Cubic> = road.crossfall.iter().map(|c| c.angle_rad).collect();
            list(&crossfall).map(|s| (s, "the crossfall"))
        })
        .or_else(|| {
            let shape =
                road.shape.iter().find(|r| cubic_is_absurd(&r.cubic_of_t, SHAPE_REACH_M) || is_absurd(r.s));
            shape.map(|r| (r.s, "the lateral shape"))
        })
        .or_else(|| {
            let mut sections = road.sections.iter();
            sections.find(|s| is_absurd(s.s)).map(|s| (s.s, "a lane section"))
        })
        .or_else(|| {
            let ends = road.sections.iter().skip(1).map(|s| s.s).chain([road.length_m]);
            road.sections.iter().zip(ends).find_map(|(section, end)| {
                let place = section.lanes().find_map(|lane| absurd_lane(lane, end - section.s))?;
                Some((section.s + place, "a lane"))
            })
        })
}

/// At least as much as a piece of the reference line turns, radians; 0 for polynomials, which turn little.
fn turn_rad(g: &Geometry) -> f64 {
    match &g.curve {
        Curve::Arc { curvature } => curvature.abs() * g.length_m,
        Curve::Spiral { curvature_start, curvature_end } => {
            curvature_start.abs().max(curvature_end.abs()) * g.length_m
        }
        Curve::Line | Curve::Poly3 { .. } | Curve::ParamPoly3 { .. } => 0.0,
    }
}

fn piece_is_absurd(g: &Geometry) -> bool {
    let polynomial = |c: &[f64; 4], p: f64| {
        let [a, b, c, d] = *c;
        cubic_is_absurd(&Cubic { s: 0.0, a, b, c, d }, p)
    };
    [g.s, g.x_m, g.y_m, g.hdg_rad, g.length_m].into_iter().any(is_absurd)
        || match &g.curve {
            Curve::Line => false,
            Curve::Arc { curvature } => is_absurd(*curvature),
            Curve::Spiral { curvature_start, curvature_end } => {
                is_absurd(*curvature_start) || is_absurd(*curvature_end)
            }
            Curve::Poly3 { v } => polynomial(v, g.length_m),
            Curve::ParamPoly3 { u, v, normalised } => {
                let end = if *normalised { 1.0 } else { g.length_m };
                polynomial(u, end) || polynomial(v, end)
            }
        }
}

/// Whether a term of a cubic is absurd anywhere up to `reach`.
fn cubic_is_absurd(c: &Cubic, reach: f64) -> bool {
    let reach = reach.max(0.0);
    [c.s, c.a, c.b * reach, c.c * reach * reach, c.d * reach * reach * reach].into_iter().any(is_absurd)
}

/// Start of the first record that is absurd before the next one begins.
fn absurd_cubic(records: &[Cubic], end: f64) -> Option<f64> {
    let ends = records.iter().skip(1).map(|r| r.s).chain([end]);
    records.iter().zip(ends).find(|(r, end)| cubic_is_absurd(r, end - r.s)).map(|(r, _)| r.s)
}

/// The offset of the first record of a lane that is absurd within its section.
fn absurd_lane(lane: &Lane, length_m: f64) -> Option<f64> {
    absurd_cubic(&lane.widths, length_m).or_else(|| absurd_cubic(&lane.borders, length_m)).or_else(|| {
        let heights = lane.heights.iter();
        heights.into_iter().find(|h| [h.inner_m, h.outer_m].into_iter().any(is_absurd)).map(|h| h.s_offset)
    })
}
