//! Which lanes a pedestrian crossing crosses, which lights hold their traffic, and from where to where it
//! leads.

use frames::math::{atan2, sin_cos};
use nalgebra::{Point3, Vector3};

use super::area::ring_contains;
use super::lanes::carries_vehicles;
use super::{Crosswalk, LaneId, Map};

/// Step of the search along a lane, metres of s: crossings are wider.
const STEP_M: f64 = 0.25;
/// Most steps along one lane; absurd sizes only lose accuracy.
const MAX_STEPS: f64 = 4096.0;
/// Halvings that make a step a tenth of a millimetre.
const HALVINGS: u32 = 12;
/// A crossing is on the lanes at most this far above or below it, metres.
const STOREY_M: f64 = 2.0;
/// A light this near to a crossing along a lane is the crossing's, too, metres.
const AT_LIGHT_M: f64 = 12.0;

/// A stretch of lane under a pedestrian crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrosswalkSpan {
    /// Index into [`Map::crosswalks`].
    pub crosswalk: usize,
    /// The lane.
    pub lane: LaneId,
    /// Where its centre line enters and leaves the crossing, metres of s from the lane's beginning, in the
    /// direction of travel.
    pub along_m: [f64; 2],
}

/// From where to where a crossing leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrosswalkAxis {
    /// The middles of its two short sides.
    pub ends: [Point3<f64>; 2],
    /// Half its width, metres.
    pub half_width_m: f64,
}

impl Crosswalk {
    /// The middles of the two short sides along the polygon's main direction; none for what has no length.
    #[must_use]
    pub fn axis(&self) -> Option<CrosswalkAxis> {
        let polygon = &self.polygon;
        let count = polygon.len();
        if count < 3 {
            return None;
        }
        let centre = polygon.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / count as f64;
        // Second moments of the corners; the main axis has the larger one.
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for p in polygon {
            let d = p.coords - centre;
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
        }
        let (sin, cos) = sin_cos(0.5 * atan2(2.0 * xy, xx - yy));
        let reach = |p: &Point3<f64>| (p.x - centre.x) * cos + (p.y - centre.y) * sin;
        let (low, high) =
            polygon.iter().map(reach).fold((f64::MAX, f64::MIN), |(l, h), r| (l.min(r), h.max(r)));
        let z = |wanted: f64| {
            let nearest =
                polygon.iter().min_by(|a, b| (reach(a) - wanted).abs().total_cmp(&(reach(b) - wanted).abs()));
            nearest.map_or(centre.z, |p| p.z)
        };
        let at = |r: f64| Point3::new(centre.x + cos * r, centre.y + sin * r, z(r));
        let across = |p: &Point3<f64>| ((p.y - centre.y) * cos - (p.x - centre.x) * sin).abs();
        let half_width_m = polygon.iter().map(across).fold(f64::INFINITY, f64::min);
        (high - low > 1.0).then(|| CrosswalkAxis { ends: [at(low), at(high)], half_width_m })
    }

    /// What the lights for those who walk over it are called: `crosswalk:` and its id.
    #[must_use]
    pub fn light_name(&self) -> String {
        format!("crosswalk:{}", self.id)
    }
}

impl Map {
    /// The lights that hold the traffic which would go over a crosswalk next: indices into [`Map::signals`],
    /// sorted. Computed anew by every call.
    #[must_use]
    pub fn crosswalk_signals(&self, crosswalk: usize) -> Vec<usize> {
        let Some(known) = self.crosswalks.get(crosswalk) else { return Vec::new() };
        let mut found: Vec<usize> = Vec::new();
        for span in self.spans_of(crosswalk, known) {
            let Some(lane) = self.lane(span.lane).filter(|lane| lane.lane_type.is_drivable()) else {
                continue;
            };
            if span.along_m[0] < AT_LIGHT_M {
                found.extend(self.signals_of_lane(span.lane));
            }
            if lane.s_length() - span.along_m[1] < AT_LIGHT_M {
                found.extend(self.successors(span.lane).iter().flat_map(|id| self.signals_of_lane(*id)));
            }
        }
        found.retain(|signal| self.signals[*signal].dynamic);
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The lanes for vehicles whose centre line runs over each crosswalk, by crosswalk, then by lane.
    /// Computed anew by every call.
    #[must_use]
    pub fn crosswalk_spans(&self) -> Vec<CrosswalkSpan> {
        let spans = self.crosswalks.iter().enumerate().flat_map(|(i, crosswalk)| self.spans_of(i, crosswalk));
        spans.collect()
    }

    fn spans_of(&self, index: usize, crosswalk: &Crosswalk) -> Vec<CrosswalkSpan> {
        let ring = &crosswalk.polygon;
        let count = ring.len().max(1) as f64;
        let centre = Point3::from(ring.iter().fold(Vector3::zeros(), |sum, p| sum + p.coords) / count);
        let radius = ring.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let mut spans: Vec<CrosswalkSpan> = Vec::new();
        for hit in self.lanes_within(centre, radius, |lane| carries_vehicles(lane.lane_type)) {
            let Some(info) = self.lane(hit.lane) else { continue };
            let inside = |s: f64| {
                let place = self.lane_point(hit.lane, s, 0.0).map(|p| p.position);
                place.is_some_and(|p| (p.z - centre.z).abs() <= STOREY_M && ring_contains(ring, p.x, p.y))
            };
            // Along a bent lane s may run up to twice as far as the way.
            let from = (hit.s - 2.0 * radius).max(info.s_start);
            let to = (hit.s + 2.0 * radius).min(info.s_end);
            let steps = ((to - from) / STEP_M).ceil().clamp(1.0, MAX_STEPS);
            let at = |k: f64| from + (to - from) * (k / steps);
            let covered: Vec<f64> =
                (0..=steps as usize).map(|k| k as f64).filter(|k| inside(at(*k))).collect();
            let (Some(first), Some(last)) = (covered.first(), covered.last()) else { continue };
            let edge = |mut within: f64, mut without: f64| {
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (within + without);
                    if inside(middle) {
                        within = middle;
                    } else {
                        without = middle;
                    }
                }
                within
            };
            let low = if *first > 0.0 { edge(at(*first), at(first - 1.0)) } else { from };
            let high = if *last < steps { edge(at(*last), at(last + 1.0)) } else { to };
            let (a, b) = (info.along_of_s(low), info.along_of_s(high));
            spans.push(CrosswalkSpan { crosswalk: index, lane: hit.lane, along_m: [a.min(b), a.max(b)] });
        }
        spans.sort_by_key(|a| a.lane);
        spans
    }
}
