//! Which lanes a pedestrian crossing crosses.

use nalgebra::Point3;

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

impl Map {
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
        let centre =
            Point3::from(ring.iter().fold(nalgebra::Vector3::zeros(), |sum, p| sum + p.coords) / count);
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
