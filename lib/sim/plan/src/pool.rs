//! Places where vehicles may start.

use nalgebra::Point3;
use opendrive::{LaneInfo, LanePos, Map, VEHICLE_LANE_WIDTH_M};
use settings::GivenStart;

use crate::PlanError;

/// A map whose middle spawn point lies above this counts as high ground, metres.
const HIGH_GROUND_M: f64 = 100.0;
/// A start that the user gives lies this near to the centre line of a lane, metres.
const GIVEN_REACH_M: f64 = 5.0;

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

/// Ground that a vehicle of a size takes.
pub(crate) type TakenGround = (SpawnPoint, [f64; 3]);

impl SpawnPoint {
    /// The point of a place on a lane; None where the lane carries no vehicle.
    pub(crate) fn at(map: &Map, pos: LanePos) -> Option<Self> {
        let point = map.point_at(pos)?;
        let rpy_rad = [point.roll_rad, point.pitch_rad, point.heading_rad];
        (point.width_m >= VEHICLE_LANE_WIDTH_M).then_some(Self { pos, xyz_m: point.position, rpy_rad })
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
    /// The map's spawn points ([`Map::spawn_points`]), `separation_m` metres of s apart.
    #[must_use]
    pub fn new(map: &Map, separation_m: f64) -> Self {
        let points =
            map.spawn_points(separation_m).into_iter().filter_map(|pos| SpawnPoint::at(map, pos)).collect();
        let lanes = map.lanes().iter().filter(|l| l.lane_type.is_drivable()).count();
        Self { points, lanes }
    }

    /// The points that a user gave for a map, each on the centre line of the driving lane outside junctions
    /// that is nearest among those that run its way.
    ///
    /// # Errors
    /// There is no such lane within 5 m.
    pub fn of_starts<'a>(map: &Map, starts: impl Iterator<Item = &'a GivenStart>) -> Result<Self, PlanError> {
        let mut pool = Self::default();
        for start in starts {
            let usable = |l: &LaneInfo| l.lane_type.is_drivable() && l.junction.is_none();
            let hits = map.lanes_within(start.xyz_m.into(), GIVEN_REACH_M, usable);
            let runs_along = |p: &SpawnPoint| {
                frames::wrap_pi(p.rpy_rad[2] - start.yaw_rad).abs() < std::f64::consts::FRAC_PI_3
            };
            let mut points = hits.iter().filter_map(|hit| {
                let along_m = map.lane(hit.lane)?.along_of_s(hit.s);
                SpawnPoint::at(map, LanePos { lane: hit.lane, along_m })
            });
            let point = points.find(runs_along).ok_or_else(|| PlanError::NoLaneThere {
                map: start.map.clone(),
                xyz_m: start.xyz_m,
                reach_m: GIVEN_REACH_M,
            })?;
            pool.points.push(point);
        }
        pool.lanes = pool.points.len();
        Ok(pool)
    }

    /// Whether the roads lie high above the map's zero level.
    #[must_use]
    pub fn is_high_ground(&self) -> bool {
        let mut heights: Vec<f64> = self.points.iter().map(|p| p.xyz_m.z).collect();
        heights.sort_by(f64::total_cmp);
        heights.get(heights.len() / 2).is_some_and(|z| *z > HIGH_GROUND_M)
    }
}
