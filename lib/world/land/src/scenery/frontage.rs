//! The outer edges of streets and railways: where land begins.

use nalgebra::{Point3, Vector3};
use opendrive::{LaneType, Map};

use crate::surfaces::{Ground, Section, Strip};

/// The traffic along one side of a road.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Traffic {
    /// Lanes of the side: the most that it has anywhere.
    pub(crate) lanes: usize,
    /// Which way they run: +1 along the frontage, -1 against it; 0 without lanes.
    pub(crate) direction: f64,
    /// Whether the road has no lanes on its other side, and sidewalks on both.
    pub(crate) one_way_street: bool,
    /// Whether there is a parking lane.
    pub(crate) parks: bool,
}

/// Medians from this width on have room for signs, metres.
const MEDIAN_M: f64 = 0.9;

/// One side of a road, from its start to its end.
pub(crate) struct Frontage {
    /// Names its random stream: twice the road's index, plus one on the left.
    pub(crate) entity: u64,
    points: Vec<Point3<f64>>,
    away: Vec<Vector3<f64>>,
    /// Whether the outermost lane at each point is a sidewalk, and its width, metres.
    walk_m: Vec<f64>,
    along_m: Vec<f64>,
    /// The middle of the side's half of the median at each point, where there is a raised one.
    medians: Vec<Option<Point3<f64>>>,
    pub(crate) traffic: Traffic,
    /// Speed limit of the road, m/s (0: unknown).
    pub(crate) speed_mps: f64,
    /// Whether a railway runs at the edge.
    pub(crate) track: bool,
}

/// A place on a frontage.
pub(crate) struct Spot {
    pub(crate) point: Point3<f64>,
    /// Horizontal direction away from the road.
    pub(crate) away: Vector3<f64>,
    /// Width of the sidewalk, metres; 0 where there is none.
    pub(crate) walk_m: f64,
    /// The middle of the side's half of the median.
    pub(crate) median: Option<Point3<f64>>,
}

impl Spot {
    /// The place `far_m` beyond the edge (negative: on the sidewalk) and `along_m` sideways.
    pub(crate) fn beside(&self, far_m: f64, along_m: f64) -> Point3<f64> {
        let along = Vector3::new(-self.away.y, self.away.x, 0.0);
        self.point + self.away * far_m + along * along_m
    }

    /// Yaw of something that looks at the road.
    pub(crate) fn facing_yaw(&self) -> f64 {
        frames::math::atan2(-self.away.y, -self.away.x)
    }
}

impl Frontage {
    pub(crate) fn length_m(&self) -> f64 {
        self.along_m.last().copied().unwrap_or(0.0)
    }

    /// The place at a distance from the start.
    pub(crate) fn at(&self, along_m: f64) -> Option<Spot> {
        let k = self.along_m.partition_point(|d| *d <= along_m).clamp(1, self.along_m.len().checked_sub(1)?);
        let (d0, d1) = (self.along_m[k - 1], self.along_m[k]);
        let share = if d1 > d0 { ((along_m - d0) / (d1 - d0)).clamp(0.0, 1.0) } else { 0.0 };
        let away = self.away[k - 1] + (self.away[k] - self.away[k - 1]) * share;
        Some(Spot {
            point: self.points[k - 1] + (self.points[k] - self.points[k - 1]) * share,
            away: away.try_normalize(1e-9)?,
            walk_m: self.walk_m[k - 1].min(self.walk_m[k]),
            median: self.medians[k - 1].zip(self.medians[k]).map(|(a, b)| a + (b - a) * share),
        })
    }

    /// Distance from the start of the point that is nearest to a place of the plan, and how far it is,
    /// metres.
    pub(crate) fn nearest(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let away = self.points.iter().map(|p| (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y));
        let (k, square) = away.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        // Points are metres apart: the place is beside the piece before or after it.
        let foot = |a: usize, b: usize| {
            let (from, way) = (self.points[a], self.points[b] - self.points[a]);
            let length2 = way.x * way.x + way.y * way.y;
            let share = ((x - from.x) * way.x + (y - from.y) * way.y) / length2.max(1e-12);
            let share = share.clamp(0.0, 1.0);
            let (dx, dy) = (from.x + share * way.x - x, from.y + share * way.y - y);
            [self.along_m[a] + share * (self.along_m[b] - self.along_m[a]), (dx * dx + dy * dy).sqrt()]
        };
        let pieces = [
            k.checked_sub(1).map(|before| foot(before, k)),
            (k + 1 < self.points.len()).then(|| foot(k, k + 1)),
        ];
        let best = pieces.into_iter().flatten().min_by(|a, b| a[1].total_cmp(&b[1]));
        Some(best.unwrap_or([self.along_m[k], square.sqrt()]))
    }
}

/// Both sides of every road outside junctions, by road.
pub(crate) fn frontages(map: &Map, sections: &[&Section]) -> Vec<Frontage> {
    let mut found: Vec<Frontage> = Vec::new();
    for side in 0..2u64 {
        for section in sections.iter().filter(|s| !s.junction) {
            let Some((edge, away)) = section.edge(side as usize) else { continue };
            let Some(strip) = section.outermost(side as usize) else { continue };
            let entity = 2 * u64::from(section.road) + side;
            if found.last().is_none_or(|f| f.entity != entity) {
                found.push(Frontage {
                    entity,
                    points: Vec::new(),
                    away: Vec::new(),
                    walk_m: Vec::new(),
                    along_m: Vec::new(),
                    medians: Vec::new(),
                    traffic: Traffic::default(),
                    speed_mps: 0.0,
                    track: strip.ground == Ground::Track,
                });
            }
            let Some(front) = found.last_mut() else { continue };
            front.speed_mps = front.speed_mps.max(section.speed_mps);
            front.traffic = front.traffic.and(traffic(map, section, side));
            let median = median(section, side);
            for (i, (point, away)) in edge.iter().zip(away).enumerate() {
                let step = front.points.last().map_or(0.0, |last| (point - last).norm());
                let walk =
                    if strip.ground == Ground::Walk { (strip.left[i] - strip.right[i]).norm() } else { 0.0 };
                front.along_m.push(front.length_m() + step);
                front.points.push(*point);
                front.away.push(away);
                front.walk_m.push(walk);
                let middle = median.map(|strip| (strip.left[i], strip.right[i]));
                let wide = middle.filter(|(left, right)| (left - right).norm() >= MEDIAN_M);
                front.medians.push(wide.map(|(left, right)| nalgebra::center(&left, &right)));
            }
        }
    }
    found.sort_by_key(|f| f.entity);
    found
}

/// Whether a strip belongs to the right (0) or left (1) side of its road.
fn is_of(strip: &Strip, side: u64) -> bool {
    (strip.lane.lane > 0) == (side == 1)
}

fn traffic(map: &Map, section: &Section, side: u64) -> Traffic {
    let lanes = |side: u64| {
        let own = section.strips.iter().filter(move |strip| is_of(strip, side));
        own.filter_map(|strip| map.lane(strip.lane)).filter(|lane| lane.lane_type.is_drivable())
    };
    let own: Vec<_> = lanes(side).collect();
    let walked = |side: usize| section.outermost(side).is_some_and(|strip| strip.ground == Ground::Walk);
    let parking = |strip: &&Strip| {
        is_of(strip, side) && map.lane(strip.lane).is_some_and(|lane| lane.lane_type == LaneType::Parking)
    };
    Traffic {
        lanes: own.len(),
        direction: own.first().map_or(0.0, |lane| lane.direction),
        one_way_street: !own.is_empty() && lanes(1 - side).next().is_none() && walked(0) && walked(1),
        parks: section.strips.iter().any(|strip| parking(&strip)),
    }
}

impl Traffic {
    /// That of a longer piece, of which the other one is of the rest.
    fn and(self, other: Self) -> Self {
        Self {
            lanes: self.lanes.max(other.lanes),
            direction: if self.direction == 0.0 { other.direction } else { self.direction },
            one_way_street: (self.lanes == 0 || self.one_way_street)
                && (other.lanes == 0 || other.one_way_street),
            parks: self.parks || other.parks,
        }
    }
}

/// The side's part of a raised median.
fn median(section: &Section, side: u64) -> Option<&Strip> {
    section.strips.iter().find(|strip| is_of(strip, side) && strip.ground == Ground::Median)
}
