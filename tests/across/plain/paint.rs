//! What is painted or declared on the ground - crossings, hazards, markings - from the map's file and the
//! log.

use frames::{Agent, Pose, World};
use nalgebra::{Point2, Vector3};
use schema::BevClass;

use super::grid::{Bits, CELL_M, Grid, LAYER_M, SIDE, TIE, bit};
use super::roads::{self, Line, Road, Slice};

/// Step along markings, metres.
const STEP_M: f64 = 0.05;
/// Chains of points stand for markings that bend, this near to them, metres.
const CHAIN_M: f64 = 0.02;
/// One cell a sample: samples are at most this far apart, metres.
const SAMPLE_M: f64 = 0.99 * CELL_M;
/// In junctions it is tried once a metre whether another road's asphalt covers a marking.
const COVER_M: f64 = 1.0;
/// ... where its lane reaches over the marking by this; and how much of that rounding decides.
const BORDER_M: [f64; 2] = [0.2, 0.05];
/// Heights are compared this loosely: a road's cross-section has kerbs, metres.
const HEIGHT_M: f64 = 0.2;

/// Crossings (on road) and hazards: even-odd, where the area is within half a clearance of the ground.
pub(super) fn areas(
    roads: &[Road],
    hazards: &[Vec<Vector3<f64>>],
    grid: &Grid,
    level: &[f64],
    bits: &mut Bits,
) {
    let crossings = roads.iter().flat_map(|r| &r.crossings).map(|polygon| (BevClass::Crosswalk, polygon));
    let hazards = hazards.iter().map(|polygon| (BevClass::Hazard, polygon));
    for (class, polygon) in crossings.chain(hazards) {
        let corners: Vec<Vector3<f64>> = polygon.iter().map(|&p| grid.of(p)).collect();
        let (lows, highs) = (corners.iter().map(|p| p.z), corners.iter().map(|p| p.z));
        let (low, high) = (lows.fold(f64::INFINITY, f64::min), highs.fold(f64::NEG_INFINITY, f64::max));
        // Cells about the area: towns have hundreds of crossings, most of them far away.
        let about = |axis: usize| {
            let values = || corners.iter().map(|p| p[axis]);
            let (low, high) =
                (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
            ((low - 1.0).max(0.0) as usize)..((high + 1.0).clamp(0.0, SIDE as f64) as usize)
        };
        for cell in about(1).flat_map(|row| about(0).map(move |column| row * SIDE + column)) {
            let level = level[cell];
            let at = Point2::new((cell % SIDE) as f64 + 0.5, (cell / SIDE) as f64 + 0.5);
            let (mut inside, mut nearest) = (false, f64::INFINITY);
            for (k, b) in corners.iter().enumerate() {
                let a = corners[(k + corners.len() - 1) % corners.len()];
                if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
                    inside = !inside;
                }
                let (along, away) = ((b - a).xy(), at.coords - a.xy());
                let share = (away.dot(&along) / along.norm_squared().max(1e-30)).clamp(0.0, 1.0);
                nearest = nearest.min((away - along * share).norm());
            }
            let far = |z: f64| (z - level).abs();
            let on_layer = far(low).max(far(high)) < 2.4 - HEIGHT_M;
            let may_be = low - 2.4 - HEIGHT_M < level && level < high + 2.4 + HEIGHT_M;
            let road = class == BevClass::Hazard || bits.sure[cell] & bit(BevClass::Road) != 0;
            if (inside || nearest < TIE) && may_be && road {
                bits.set(cell, class, inside && nearest >= TIE && on_layer);
            }
        }
    }
}

/// Whether a marking shows at a place: surely, surely not, or as it happens.
#[derive(Clone, Copy, PartialEq)]
enum Shows {
    Yes,
    No,
    Perhaps,
}

/// A place on a marking.
struct Place {
    at: Vector3<f64>,
    shows: Shows,
}

/// Holds the markings of a mask against the middles that the file states: wherever one shows, a sample stands
/// at least once a cell's width; `bits` learn where there may be one. Returns the metres of markings that
/// were followed.
pub(super) fn markings(
    roads: &[Road],
    grid: &Grid,
    pose: &Pose<World, Agent>,
    level: &[f64],
    is_open: &[bool],
    got: &[u8],
    (bits, place): (&mut Bits, &str),
) -> f64 {
    let origin = Vector3::from(pose.xyz());
    let is_near = |p: &Vector3<f64>, more: f64| (p - origin).xy().norm() < 120.0 + more;
    // Wider than any road is.
    let insets = [BORDER_M[0] + BORDER_M[1], BORDER_M[0] - BORDER_M[1]];
    let slices = |road: &Road| insets.map(|inset| road.slices(inset, |p| is_near(p, 40.0)));
    let slices: Vec<[Vec<Slice>; 2]> = roads.iter().map(slices).collect();
    let mut followed_m = 0.0;
    for line in roads.iter().flat_map(Road::lines) {
        let Some([from, to]) = line.near(|p| is_near(p, 5.0)) else { continue };
        let count = ((to - from) / STEP_M).ceil().max(1.0) as usize;
        let s = |k: usize| from + (to - from) * k as f64 / count as f64;
        let points: Vec<Vector3<f64>> = (0..=count).map(|k| line.at(s(k))).collect();
        let mut since_m = 0.0;
        for (k, here) in places(&line, &points, roads, &slices, &|p| is_near(p, 0.0)).iter().enumerate() {
            let step_m = if k > 0 { (points[k] - points[k - 1]).xy().norm() } else { 0.0 };
            let p = grid.of(here.at);
            let seen = painted_cells(&p, here.shows, level, bits, |cell| {
                (is_open[cell], got[BevClass::RoadLine as usize * SIDE * SIDE + cell] != 0)
            });
            since_m = if seen { 0.0 } else { since_m + step_m };
            let in_grid = (0.0..SIDE as f64).contains(&p.x) && (0.0..SIDE as f64).contains(&p.y);
            followed_m += if here.shows == Shows::Yes && in_grid { step_m } else { 0.0 };
            let most_m = SAMPLE_M + 2.0 * (CHAIN_M + TIE);
            let (row, column) = (p.y.floor(), p.x.floor());
            let of = format!("road {} lane {} at s {:.2}", line.road.id, line.border_of, s(k));
            assert!(
                since_m < most_m,
                "{place}: no road_line for {since_m} m till row {row}, column {column} ({of})"
            );
        }
    }
    followed_m
}

/// Whether a marking's place needs no further look: a cell there is set, or it says nothing. Allows the cells
/// around it.
fn painted_cells(
    p: &Vector3<f64>,
    shows: Shows,
    level: &[f64],
    bits: &mut Bits,
    cell_of: impl Fn(usize) -> (bool, bool),
) -> bool {
    let reach = (CHAIN_M + 0.5 * STEP_M) / CELL_M + TIE;
    let mut seen = shows != Shows::Yes;
    for (dx, dy) in [(0.0, 0.0), (reach, 0.0), (-reach, 0.0), (0.0, reach), (0.0, -reach)] {
        let at = [p.x + dx, p.y + dy].map(f64::floor);
        if !at.iter().all(|c| (0.0..SIDE as f64).contains(c)) {
            seen = true;
            continue;
        }
        let cell = at[1] as usize * SIDE + at[0] as usize;
        let off = (p.z - level[cell]).abs() - LAYER_M;
        if shows != Shows::No && off < HEIGHT_M {
            bits.set(cell, BevClass::RoadLine, false);
        }
        let (is_open, is_set) = cell_of(cell);
        seen |= is_open || is_set || off > -HEIGHT_M;
    }
    seen
}

/// Where a marking shows: all along, but for the asphalt of other roads in junctions.
fn places(
    line: &Line,
    points: &[Vector3<f64>],
    roads: &[Road],
    slices: &[[Vec<Slice>; 2]],
    is_near: &dyn Fn(&Vector3<f64>) -> bool,
) -> Vec<Place> {
    if !line.is_in_junction() {
        return points.iter().map(|&at| Place { at, shows: Shows::Yes }).collect();
    }
    // Only what lies about the line.
    let side = |axis: usize| {
        let values = || points.iter().map(move |p| p[axis]);
        values().fold(f64::INFINITY, f64::min) - 5.0..values().fold(f64::NEG_INFINITY, f64::max) + 5.0
    };
    let (across, up) = (side(0), side(1));
    let about = |slice: &&Slice| across.contains(&slice[0].x) && up.contains(&slice[0].y);
    let others = || roads.iter().zip(slices).filter(|(road, _)| !std::ptr::eq(*road, line.road));
    let others = [0, 1].map(|k| others().flat_map(|(_, s)| s[k].iter().filter(about)).collect::<Vec<_>>());
    let covered = |p: &Vector3<f64>| {
        let by = |k: usize| others[k].iter().any(|slice| roads::covers(slice, p));
        if !is_near(p) {
            Shows::Perhaps
        } else if by(0) {
            Shows::No
        } else if by(1) {
            Shows::Perhaps
        } else {
            Shows::Yes
        }
    };
    let single: Vec<Shows> = points.iter().map(covered).collect();
    // One try decides for the metre about it.
    let about = (COVER_M / STEP_M).ceil() as usize + 1;
    let settled = |k: usize| {
        let around = &single[k.saturating_sub(about)..(k + about + 1).min(single.len())];
        if around.iter().all(|shows| *shows == single[k]) { single[k] } else { Shows::Perhaps }
    };
    points.iter().enumerate().map(|(k, &at)| Place { at, shows: settled(k) }).collect()
}
