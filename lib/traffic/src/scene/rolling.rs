//! Traffic that is under way when a scene begins: each vehicle as fast as its driver wishes and can stop for what is ahead.

use crate::car_following::envelope;
use crate::occupancy::Occupancy;
use crate::road::net::{Net, PLANNED_BRAKING};
use crate::vehicle::Vehicle;

/// Speeds are settled after at most so many rounds: each takes what is known one vehicle further back.
const ROUNDS: usize = 64;
/// They are settled when none changes by more than this, m/s.
const SETTLED_MPS: f64 = 0.01;

/// The speed at which a driver can follow one that brakes to rest from its own speed, m/s: in the time gap nothing happens
/// yet, and `gap = s0 + v T + (v^2 - u^2) / (2 b)`.
fn following_mps(gap_m: f64, ahead_mps: f64, standstill_gap_m: f64, headway_s: f64) -> f64 {
    let (b, free_m) = (PLANNED_BRAKING, (gap_m - standstill_gap_m).max(0.0));
    let reacting = b * headway_s;
    // Nearer than the gap at rest nobody is faster than the one ahead.
    let square = reacting * reacting + ahead_mps * ahead_mps + 2.0 * b * free_m;
    (square.sqrt() - reacting).max(0.0)
}

/// Lets all vehicles roll that stand where they start; nobody has leave to pass a line yet, so all can stop before the next.
pub(crate) fn set_rolling(net: &Net, occupancy: &mut Occupancy, vehicles: &mut [Vehicle]) {
    for vehicle in vehicles.iter_mut() {
        // What is in view depends on the speed.
        vehicle.roll(net, vehicle.wished_speed(net));
        let line_m = vehicle.next_line(net).map(|line| line.gap_m - net.lanes[line.entry].line_gap_m);
        let ends_m = [line_m, vehicle.end_of_road_m(net)];
        let stops = ends_m.into_iter().flatten().map(|gap_m| envelope(0.0, gap_m, PLANNED_BRAKING));
        vehicle.roll(net, stops.fold(vehicle.wished_speed(net), f64::min));
    }
    for _ in 0..ROUNDS {
        occupancy.fill(net, vehicles);
        let mut changed: f64 = 0.0;
        for me in 0..vehicles.len() {
            let Some(leader) = occupancy.leader(net, vehicles, me) else { continue };
            let ahead_mps = vehicles.get(leader.vehicle).map_or(leader.speed_mps, Vehicle::speed_mps);
            let (idm, speed) = (vehicles[me].driver().idm(), vehicles[me].speed_mps());
            let most = following_mps(leader.gap_m, ahead_mps, idm.standstill_gap_m, idm.headway_s);
            if most < speed {
                changed = changed.max(speed - most);
                vehicles[me].roll(net, most);
            }
        }
        if changed < SETTLED_MPS {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_follows_stops_behind_one_that_stops() {
        for (gap_m, ahead) in [(6.0, 0.0), (10.0, 5.0), (30.0, 12.0), (80.0, 0.0), (15.0, 20.0)] {
            let v = following_mps(gap_m, ahead, 4.0, 0.6);
            // Both brake at 2 m/s2, the second one 0.6 s later.
            let (own_m, other_m) = (0.6 * v + v * v / 4.0, ahead * ahead / 4.0);
            assert!((gap_m + other_m - own_m - 4.0).abs() < 1e-9, "{gap_m} {ahead}: {v}");
        }
        assert_eq!(following_mps(3.0, 0.0, 4.0, 0.6), 0.0);
    }
}
