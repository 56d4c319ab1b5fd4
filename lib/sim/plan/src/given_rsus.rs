//! RSUs where the user says.

use nalgebra::Point3;
use opendrive::{LaneInfo, Map};
use settings::GivenRsu;

/// A lane's surface is looked for within this distance of an RSU's foot, metres.
const LANE_REACH_M: f64 = 4.0;

/// What is odd about the places of RSUs: on a lane that is driven on, or far from all vehicles at their
/// start, where no traffic is.
pub(crate) fn oddities(
    map: &Map,
    given: &[&GivenRsu],
    vehicles: &[Point3<f64>],
    radius_m: f64,
) -> Vec<String> {
    let mut odd = Vec::new();
    for (number, rsu) in given.iter().enumerate() {
        let [x, y, z] = rsu.xyz_m;
        let foot = Point3::new(x, y, z);
        let is_driven = |lane: &LaneInfo| lane.lane_type.is_drivable();
        if map.lanes_within(foot, LANE_REACH_M, is_driven).iter().any(opendrive::LaneHit::is_inside) {
            odd.push(format!(
                "rsu_{number} (agents.rsus_at) stands on a lane for vehicles, at {x}, {y}: they drive through it"
            ));
        }
        let away_m = vehicles.iter().map(|at| (at - foot).norm()).fold(f64::INFINITY, f64::min);
        if away_m > radius_m {
            odd.push(format!(
                "rsu_{number} (agents.rsus_at) stands {away_m:.0} m from the nearest vehicle's start, and traffic starts \
                 within {radius_m:.0} m of vehicles: give `agents.starts` near it"
            ));
        }
    }
    odd
}
