//! Traffic that is under way when a scene begins: each vehicle as fast as its driver wishes and can stop for
//! what is ahead.

use crate::acceleration::before_line;
use crate::bends::Bends;
use crate::car_following::Idm;
use crate::occupancy::Occupancy;
use crate::road::net::{Net, PLANNED_BRAKING};
use crate::vehicle::Vehicle;

/// Speeds are settled after at most so many rounds: each takes what is known one vehicle further back.
const ROUNDS: usize = 64;
/// They are settled when none changes by more than this, m/s.
const SETTLED_MPS: f64 = 0.01;

/// The highest speed at which a driver behind something that moves at `ahead_mps` brakes no harder than it
/// plans to, m/s: the intelligent driver model, `s0 + v T + v (v - u) / (2 sqrt(a b)) = s sqrt(p / a)`,
/// solved for `v`. Nobody moves nearer than the gap at rest allows.
fn following_mps(idm: &Idm, gap_m: f64, ahead_mps: f64) -> f64 {
    let room_m = gap_m * (PLANNED_BRAKING / idm.acceleration).sqrt() - idm.standstill_gap_m;
    if room_m <= 0.0 {
        return 0.0;
    }
    let root = (idm.acceleration * idm.braking).sqrt();
    let half = 0.5 * (2.0 * root * idm.headway_s - ahead_mps);
    (half * half + 2.0 * root * room_m).sqrt() - half
}

/// Lets all vehicles roll that stand where they start; nobody has leave to pass a line yet, so all can stop
/// before the next. `mark_others` puts whatever else is on lanes there.
pub(crate) fn set_rolling(
    net: &Net,
    occupancy: &mut Occupancy,
    bends: &mut Bends,
    vehicles: &mut [Vehicle],
    mark_others: &dyn Fn(&mut Occupancy),
) {
    for vehicle in vehicles.iter_mut() {
        // What is in view depends on the speed.
        vehicle.roll(net, vehicle.wished_speed(net));
        let line_m = vehicle.next_line(net).map(|line| line.gap_m - net.lanes[line.entry].line_gap_m);
        let ends_m = [line_m, vehicle.end_of_road_m(net)];
        let idm = before_line(&vehicle.driver().idm());
        let stops = ends_m.into_iter().flatten().map(|gap_m| following_mps(&idm, gap_m, 0.0));
        vehicle.roll(net, stops.fold(vehicle.wished_speed(net), f64::min));
    }
    bends.start(net, vehicles);
    for _ in 0..ROUNDS {
        occupancy.fill(net, vehicles);
        mark_others(occupancy);
        let mut changed: f64 = 0.0;
        for me in 0..vehicles.len() {
            let Some(leader) = occupancy.leader(net, vehicles, me) else { continue };
            let ahead_mps = vehicles.get(leader.vehicle).map_or(leader.speed_mps, Vehicle::speed_mps);
            let (idm, speed) = (vehicles[me].driver().idm(), vehicles[me].speed_mps());
            let most = following_mps(&idm, leader.gap_m, ahead_mps);
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
    fn who_follows_brakes_as_planned() {
        let idm = Idm { acceleration: 1.3, braking: 2.5, headway_s: 0.6, standstill_gap_m: 4.0 };
        for (gap_m, ahead) in [(6.0, 0.0), (10.0, 5.0), (30.0, 12.0), (80.0, 0.0), (15.0, 20.0)] {
            let v = following_mps(&idm, gap_m, ahead);
            // Without a wish to go faster, nor to go slower.
            assert!(
                (idm.following(v, v, gap_m, ahead) + PLANNED_BRAKING).abs() < 1e-9,
                "{gap_m} {ahead}: {v}"
            );
        }
        assert_eq!(following_mps(&idm, 3.0, 0.0), 0.0);
        assert_eq!(following_mps(&idm, 3.0, 20.0), 0.0);
    }
}
