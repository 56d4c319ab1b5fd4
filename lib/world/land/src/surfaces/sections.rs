//! Lane sections sampled once: strips whose neighbours share their vertices.

use nalgebra::{Point3, Vector3};
use opendrive::{LaneId, LaneType, Map};

use crate::surfaces::region::Region;

/// Chords stay this near to the lane borders, metres.
const TOLERANCE_M: f64 = 0.01;
/// Longest piece of a strip, metres of s.
const STEP_M: f64 = 6.0;
/// The same in junctions, where raised strips are cut away piece by piece.
const JUNCTION_STEP_M: f64 = 1.5;
/// No road is wider from the middle, metres: pieces of one reach so far.
pub(crate) const WIDEST_M: f64 = 40.0;
/// Height of a kerb where the map states none, metres.
const KERB_M: f64 = 0.12;

/// What a lane's surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Asphalt for vehicles.
    Paved,
    /// Raised, for walkers.
    Walk,
    /// Raised, between the carriageways.
    Median,
    /// The bed of a railway.
    Track,
    /// Flat, without use, between other lanes.
    Waste,
    /// Not built: land beside the road.
    Land,
}

impl Ground {
    fn of(lane: LaneType) -> Self {
        match lane {
            LaneType::Sidewalk | LaneType::Walking | LaneType::Curb => Self::Walk,
            LaneType::Median => Self::Median,
            track if track.is_track() => Self::Track,
            LaneType::None => Self::Waste,
            _ => Self::Paved,
        }
    }

    pub(crate) fn raised(self) -> bool {
        matches!(self, Self::Walk | Self::Median)
    }

    /// Whether paint can lie on it.
    pub(crate) fn is_road(self) -> bool {
        matches!(self, Self::Paved | Self::Waste)
    }
}

/// How far a lane is raised over its road's surface at its inner and outer border, metres: as the map states
/// it, else a kerb's height for sidewalks and medians.
fn lane_raise_m(map: &Map, lane: LaneId, s: f64) -> [f64; 2] {
    let Some(info) = map.lane(lane) else { return [0.0; 2] };
    let stated = map.lane_height(lane, s).unwrap_or([0.0; 2]);
    if stated == [0.0; 2] && Ground::of(info.lane_type).raised() { [KERB_M; 2] } else { stated }
}

/// One lane of a section. Points run with s; `left` has the larger t. Heights include kerbs.
#[derive(Clone, Debug)]
pub struct Strip {
    /// The lane.
    pub lane: LaneId,
    /// What it is.
    pub ground: Ground,
    /// Its left border.
    pub left: Vec<Point3<f64>>,
    /// Its right border.
    pub right: Vec<Point3<f64>>,
    /// How far the points are raised over the road's surface, left and right.
    pub raise: Vec<[f64; 2]>,
}

/// Points of an outer edge and the horizontal direction away from the road at each.
pub type Edge<'a> = (&'a [Point3<f64>], Vec<Vector3<f64>>);

/// A lane section, its strips from right to left.
#[derive(Clone, Debug)]
pub struct Section {
    /// Index of its road.
    pub road: u32,
    /// Its number within the road.
    pub section: u16,
    /// Whether its road runs through a junction.
    pub junction: bool,
    /// Whether the road begins or ends with this section.
    pub ends: [bool; 2],
    /// Where it is sampled, metres along the road.
    pub s: Vec<f64>,
    /// Its lanes.
    pub strips: Vec<Strip>,
    /// The highest speed limit of its lanes, m/s; 0 where none is known.
    pub speed_mps: f64,
}

impl Section {
    /// Whether the piece from sample `i` to the next is within a region.
    pub(crate) fn inside(&self, i: usize, region: &Region) -> bool {
        let Some(strip) = self.strips.first() else { return false };
        region.contains(strip.right[i].x, strip.right[i].y)
    }

    /// Outermost built strip on the right (0) or left (1).
    #[must_use]
    pub fn outermost(&self, side: usize) -> Option<&Strip> {
        let mut built = self.strips.iter().filter(|s| s.ground != Ground::Land);
        if side == 0 { built.next() } else { built.next_back() }
    }

    /// The outer edge on the right (0) or left (1), and the horizontal direction away from the road at each
    /// sample.
    #[must_use]
    pub fn edge(&self, side: usize) -> Option<Edge<'_>> {
        let strip = self.outermost(side)?;
        let edge = if side == 0 { &strip.right } else { &strip.left };
        let away = (0..edge.len())
            .map(|i| {
                let forward = edge[(i + 1).min(edge.len() - 1)] - edge[i.saturating_sub(1)];
                let left = Vector3::new(-forward.y, forward.x, 0.0);
                let away = if side == 0 { -left } else { left };
                away.try_normalize(1e-9).unwrap_or_else(Vector3::zeros)
            })
            .collect();
        Some((edge, away))
    }
}

/// All sections of a road.
pub(crate) fn of_road(map: &Map, road: u32) -> Vec<Section> {
    let count = map.section_count(road);
    (0..count as u16).filter_map(|index| sample(map, road, index, count)).collect()
}

/// The upright box around a road and all that belongs to it.
pub(crate) fn bounds(map: &Map, road: u32) -> Option<Region> {
    let length = map.road_length(road)?;
    let probes = (length / 25.0).ceil().clamp(1.0, 10_000.0) as usize;
    let at = (0..=probes).map(|i| length * i as f64 / probes as f64);
    let points = at.filter_map(|s| map.road_point(road, s, 0.0, 0.0));
    let boxes = points.map(|p| Region { min: [p.x, p.y], max: [p.x, p.y] });
    let around = boxes.reduce(|a, b| Region {
        min: [0, 1].map(|k| a.min[k].min(b.min[k])),
        max: [0, 1].map(|k| a.max[k].max(b.max[k])),
    })?;
    Some(around.grown(WIDEST_M))
}

fn sample(map: &Map, road: u32, index: u16, count: usize) -> Option<Section> {
    let lanes = map.lanes_of(road, index);
    let first = lanes.first()?;
    let junction = first.junction.is_some();
    let step = if junction { JUNCTION_STEP_M } else { STEP_M };
    let s = divided(&map.section_samples(road, index, TOLERANCE_M), step);
    let mut strips: Vec<Strip> = Vec::with_capacity(lanes.len());
    for lane in lanes {
        let line = map.lane_polyline_at(lane.id, &s);
        if line.left.len() != s.len() || s.len() < 2 {
            return None;
        }
        let mut strip = Strip {
            lane: lane.id,
            ground: Ground::of(lane.lane_type),
            left: line.left,
            right: line.right,
            raise: Vec::with_capacity(s.len()),
        };
        for (i, s) in s.iter().enumerate() {
            let [inner, outer] = lane_raise_m(map, lane.id, *s);
            let [left, right] = if lane.id.lane > 0 { [outer, inner] } else { [inner, outer] };
            strip.left[i].z += left;
            strip.right[i].z += right;
            strip.raise.push([left, right]);
        }
        strips.push(strip);
    }
    // Unused lanes at the outside are land; those inside are part of the street.
    let used = |s: &Strip| s.ground != Ground::Waste;
    let (from, to) = (strips.iter().position(used), strips.iter().rposition(used));
    for (i, strip) in strips.iter_mut().enumerate() {
        if strip.ground == Ground::Waste && (from.is_none_or(|f| i < f) || to.is_none_or(|t| i > t)) {
            strip.ground = Ground::Land;
        }
    }
    let speed = lanes.iter().filter_map(|l| l.speed_limit_mps).fold(0.0, f64::max);
    Some(Section {
        road,
        section: index,
        junction,
        ends: [index == 0, usize::from(index) + 1 == count],
        s,
        strips,
        speed_mps: speed,
    })
}

/// The samples with more between them, so that no step is longer than `step_m`.
fn divided(samples: &[f64], step_m: f64) -> Vec<f64> {
    let mut fine = Vec::with_capacity(samples.len());
    for pair in samples.windows(2) {
        let pieces = ((pair[1] - pair[0]) / step_m).ceil().clamp(1.0, 100_000.0) as usize;
        fine.extend((0..pieces).map(|i| pair[0] + (pair[1] - pair[0]) * i as f64 / pieces as f64));
    }
    fine.extend(samples.last());
    fine
}
