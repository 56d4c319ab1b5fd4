//! Words on lanes lie within them and are read by those who come along; before each line of a stop sign there
//! is one.

use nalgebra::{Point3, Vector3};
use opendrive::{Map, RoadSymbol};

use super::label;

/// Words are between so far before a stop line, metres.
const BEFORE_M: [f64; 2] = [1.0, 8.0];
/// Streets shorter than this need none, metres.
const SHORT_M: f64 = 16.0;

pub(super) fn faults(map: &Map) -> Vec<String> {
    let mut faults = Vec::new();
    let symbols = map.road_symbols();
    for symbol in symbols.iter().filter(|symbol| !symbol.word.is_empty()) {
        let ring = symbol.areas.iter().flatten();
        if symbol.areas.is_empty() {
            faults.push(format!("{} at {} is not painted", symbol.word, symbol.place));
        }
        if symbol.word == "bicycle" {
            let off = ring.filter(|p| {
                !map.lanes_within(**p, 3.0, |lane| lane.lane_type == opendrive::LaneType::Biking)
                    .iter()
                    .any(opendrive::LaneHit::is_inside)
            });
            if off.count() > 0 {
                faults.push(format!("the bicycle at {} reaches out of its lane", symbol.place));
            }
            continue;
        }
        let Some(hit) = map.nearest_driving_lane(symbol.place) else {
            faults.push(format!("{} at {} lies on no lane", symbol.word, symbol.place));
            continue;
        };
        let here = label(map, hit.lane);
        let within = |p: &Point3<f64>| {
            let hit = map.lanes_within(*p, 3.0, |lane| lane.id == hit.lane);
            hit.iter().any(|hit| hit.t_m.abs() < 0.5 * hit.width_m - 0.1)
        };
        if !symbol.areas.iter().flatten().all(within) {
            faults.push(format!("{} reaches out of {here}", symbol.word));
        }
        let heading = map.lane_point(hit.lane, hit.s, 0.0).map_or(0.0, |p| p.heading_rad);
        if symbol.word == "STOP" && !is_read_along(symbol, heading) {
            faults.push(format!("STOP on {here} cannot be read"));
        }
    }
    for line in map.stop_lines() {
        let is_stop = |i: &usize| map.signals().get(*i).is_some_and(opendrive::SignalInfo::is_stop_sign);
        if !line.signals.iter().any(is_stop) {
            continue;
        }
        let middle = nalgebra::center(&line.ends[0], &line.ends[1]);
        for lane in &line.lanes {
            let Some(there) = map.point_at(*lane) else { continue };
            if map.road_length(lane.lane.road).is_none_or(|m| m < SHORT_M)
                || map.junction_of(lane.lane).is_some()
            {
                continue;
            }
            let before = |symbol: &&RoadSymbol| {
                let off = there.position - symbol.place;
                let (sin, cos) = frames::math::sin_cos(there.heading_rad);
                let (ahead, left) = (cos * off.x + sin * off.y, cos * off.y - sin * off.x);
                symbol.word == "STOP" && (BEFORE_M[0]..BEFORE_M[1]).contains(&ahead) && left.abs() < 1.0
            };
            let count = symbols.iter().filter(before).count();
            if count != 1 {
                faults.push(format!(
                    "{count} words STOP before the line at {middle} on {}",
                    label(map, lane.lane)
                ));
            }
        }
    }
    faults
}

/// Whether a STOP has its P to the right of those who drive that way, and its bow ahead.
fn is_read_along(symbol: &RoadSymbol, heading_rad: f64) -> bool {
    let (sin, cos) = frames::math::sin_cos(heading_rad);
    let plan = |p: &Point3<f64>| {
        let off: Vector3<f64> = *p - symbol.place;
        [sin * off.x - cos * off.y, cos * off.x + sin * off.y]
    };
    let rings: Vec<Vec<[f64; 2]>> = symbol.areas.iter().map(|ring| ring.iter().map(plan).collect()).collect();
    let range = |k: usize| {
        let all = rings.iter().flatten().map(|p| p[k]);
        [all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([left, right], [near, far]) = (range(0), range(1));
    let inked = |x: f64, y: f64| {
        rings.iter().any(|ring| {
            let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
            pairs
                .filter(|(a, b)| {
                    (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                })
                .count()
                % 2
                == 1
        })
    };
    // Shares of ink in the near and far half of a quarter of the width.
    let halves = |from: f64, to: f64| {
        [[0.02, 0.46], [0.54, 0.98]].map(|[low, high]| {
            let at = |i: i32, k: i32| {
                let share = |low: f64, high: f64, i: i32| low + (high - low) * (f64::from(i) + 0.5) / 20.0;
                inked(left + (right - left) * share(from, to, i), near + (far - near) * share(low, high, k))
            };
            (0..400).filter(|i| at(i % 20, i / 20)).count() as f64 / 400.0
        })
    };
    let (s, p) = (halves(0.0, 0.2), halves(0.8, 1.0));
    // It is longer along the lane than wide, too.
    p[1] > 1.6 * p[0] && (s[1] - s[0]).abs() < 0.2 * s[0] && far - near > right - left
}
