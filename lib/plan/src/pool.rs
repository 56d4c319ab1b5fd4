//! Places where vehicles may start.

use std::collections::BTreeMap;

use nalgebra::Point3;
use opendrive::{LanePos, Map};

/// A spawn point must not have a junction this far ahead, metres.
const CLEAR_AHEAD_M: f64 = 4.0;
/// Points nearer to each other than this are one (overlapping lanes), metres.
const SAME_POINT_M: f64 = 2.0;
/// Lanes narrower than this carry no vehicle, metres.
const MIN_WIDTH_M: f64 = 2.0;
/// Finest spacing that is honoured, metres.
const MIN_SEPARATION_M: f64 = 1.0;
/// A map whose middle spawn point lies above this counts as high ground, metres.
const HIGH_GROUND_M: f64 = 100.0;

/// A place on the centre line of a driving lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpawnPoint {
    /// Where on the road network.
    pub pos: LanePos,
    /// In the world, on the road surface, metres.
    pub xyz_m: Point3<f64>,
    /// Roll, pitch and yaw of a vehicle that faces the direction of travel, radians.
    pub rpy_rad: [f64; 3],
}

impl SpawnPoint {
    /// The point of a place on a lane.
    pub(crate) fn at(map: &Map, pos: LanePos) -> Option<Self> {
        let point = map.point_at(pos)?;
        let rpy_rad = [point.roll_rad, point.pitch_rad, point.heading_rad];
        (point.width_m >= MIN_WIDTH_M).then_some(Self { pos, xyz_m: point.position, rpy_rad })
    }
}

/// All spawn points of a map, ascending by lane, then along it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpawnPool {
    /// The points.
    pub points: Vec<SpawnPoint>,
    /// Driving lanes that were looked at.
    pub lanes: usize,
}

impl SpawnPool {
    /// Samples every driving lane from its beginning each `separation_m` metres of s, and keeps the points outside
    /// junctions that have road but no junction within 4 m ahead, each at least 2 m from those kept before it.
    #[must_use]
    pub fn new(map: &Map, separation_m: f64) -> Self {
        let separation_m = if separation_m > MIN_SEPARATION_M { separation_m } else { MIN_SEPARATION_M };
        let mut pool = Self::default();
        let mut taken = Taken::default();
        for lane in map.lanes().iter().filter(|l| l.lane_type.is_drivable()) {
            pool.lanes += 1;
            if lane.junction.is_some() {
                continue;
            }
            let count = (lane.s_length() / separation_m).floor() as usize;
            for i in 0..=count {
                let pos = LanePos { lane: lane.id, along_m: i as f64 * separation_m };
                let ahead = map.ahead(pos, CLEAR_AHEAD_M);
                if ahead.is_empty() || ahead.iter().any(|p| map.junction_of(p.lane).is_some()) {
                    continue;
                }
                if let Some(point) = SpawnPoint::at(map, pos)
                    && taken.insert(point.xyz_m)
                {
                    pool.points.push(point);
                }
            }
        }
        pool
    }

    /// Whether the roads lie high above the map's zero level.
    #[must_use]
    pub fn is_high_ground(&self) -> bool {
        let mut heights: Vec<f64> = self.points.iter().map(|p| p.xyz_m.z).collect();
        heights.sort_by(f64::total_cmp);
        heights.get(heights.len() / 2).is_some_and(|z| *z > HIGH_GROUND_M)
    }
}

/// Points kept so far, in square cells as wide as the distance asked about.
#[derive(Default)]
struct Taken(BTreeMap<(i64, i64), Vec<Point3<f64>>>);

impl Taken {
    /// Adds a point unless one is within [`SAME_POINT_M`].
    fn insert(&mut self, point: Point3<f64>) -> bool {
        let cell = |v: f64| (v / SAME_POINT_M).floor() as i64;
        let (x, y) = (cell(point.x), cell(point.y));
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let near = self.0.get(&(x + dx, y + dy));
            if near.is_some_and(|kept| kept.iter().any(|k| (k - point).norm() <= SAME_POINT_M)) {
                return false;
            }
        }
        self.0.entry((x, y)).or_default().push(point);
        true
    }
}
