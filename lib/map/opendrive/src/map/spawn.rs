//! Where vehicles may start: one rule for all that place vehicles.

use std::collections::BTreeMap;

use nalgebra::Point3;

use super::{LanePos, Map};

/// Lanes narrower than this carry no vehicle, metres: the widest bodies on the road (2.55 m) just fit.
pub const VEHICLE_LANE_WIDTH_M: f64 = 2.6;
/// A spawn point must not have a junction this far ahead, metres.
const CLEAR_AHEAD_M: f64 = 4.0;
/// Points nearer to each other than this are one (overlapping lanes), metres.
const SAME_POINT_M: f64 = 2.0;
/// Finest spacing that is honoured, metres.
const MIN_SEPARATION_M: f64 = 1.0;

impl Map {
    /// Places where a vehicle may start, ascending by lane, then along it.
    ///
    /// Samples every driving lane from its beginning each `separation_m` metres of s (at least 1 m), and
    /// keeps the places outside junctions that are wide enough ([`VEHICLE_LANE_WIDTH_M`]) and have road but
    /// no junction within 4 m ahead, each at least 2 m from those kept before it.
    #[must_use]
    pub fn spawn_points(&self, separation_m: f64) -> Vec<LanePos> {
        let separation_m = if separation_m > MIN_SEPARATION_M { separation_m } else { MIN_SEPARATION_M };
        let mut points = Vec::new();
        let mut taken = Taken::default();
        for lane in self.lanes().iter().filter(|l| l.lane_type.is_drivable() && l.junction.is_none()) {
            let count = (lane.s_length() / separation_m).floor() as usize;
            for i in 0..=count {
                let pos = LanePos { lane: lane.id, along_m: i as f64 * separation_m };
                let ahead = self.ahead(pos, CLEAR_AHEAD_M);
                if ahead.is_empty() || ahead.iter().any(|p| self.junction_of(p.lane).is_some()) {
                    continue;
                }
                if let Some(point) = self.point_at(pos)
                    && point.width_m >= VEHICLE_LANE_WIDTH_M
                    && taken.insert(point.position)
                {
                    points.push(pos);
                }
            }
        }
        points
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
