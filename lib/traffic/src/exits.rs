//! The way through a junction and the room behind it: nobody sets off who would have to stop where others cross.

use crate::approach::Line;
use crate::net::Net;
use crate::occupancy::Occupancy;
use crate::reservations::Reservations;
use crate::sleep::Wake;
use crate::vehicles::Vehicle;

/// Free space behind the rear of a vehicle that waits behind a junction, metres.
const EXIT_MARGIN_M: f64 = 1.5;
/// Vehicles between two junctions nearer than this are counted, so that none has to wait in the first one, metres.
const STORED_M: f64 = 60.0;
/// A vehicle behind a junction slower than this blocks it, m/s.
const EXIT_SLOW_MPS: f64 = 5.0 / 3.6;

/// What those claim who have been refused for long, in one step: those who are asked later get no leave across their
/// lanes and into the lanes they want to get to.
#[derive(Debug, Default)]
pub(crate) struct Claims {
    pub(crate) lanes: Vec<usize>,
    pub(crate) exits: Vec<usize>,
}

/// The lanes through the junction, and on through the next one where the stretch between is too short to wait on. Nobody
/// waits before a lane with the right of way, so such a lane is no end of the stretch.
pub(crate) fn movement(net: &Net, vehicle: &Vehicle, line: &Line) -> Vec<(usize, f64)> {
    let need = vehicle.model.size_m[0] + EXIT_MARGIN_M;
    let mut through: Vec<(usize, f64)> = Vec::new();
    let mut outside = 0.0;
    // Lanes of junctions on the stretch.
    let mut between = Vec::new();
    for (lane, start) in vehicle.lanes_ahead(net).skip(line.position) {
        let is_junction = net.lanes[lane].junction.is_some();
        if is_junction && (through.is_empty() || !net.lanes[lane].right_of_way) {
            // Room to wait before the next line?
            if !through.is_empty() && outside >= need + net.lanes[lane].line_gap_m {
                break;
            }
            through.append(&mut between);
            through.push((lane, start));
            outside = 0.0;
        } else {
            if is_junction {
                between.push((lane, start));
            }
            outside += net.lanes[lane].way.length_m;
        }
        if through.len() >= 16 {
            break;
        }
    }
    through
}

/// The lane that a vehicle comes to behind its last junction lane.
pub(crate) fn exit_of(net: &Net, vehicle: &Vehicle, movement: &[(usize, f64)]) -> Option<usize> {
    let &(last, start) = movement.last()?;
    let exit_at = start + net.lanes[last].way.length_m;
    vehicle.lanes_ahead(net).find(|(_, start)| start + 1e-6 >= exit_at).map(|(lane, _)| lane)
}

/// Whether there is room for the vehicle behind its last junction lane, those on their way there counted.
pub(crate) fn has_exit(
    reservations: &Reservations,
    net: &Net,
    occupancy: &Occupancy,
    vehicles: &[Vehicle],
    me: usize,
    movement: &[(usize, f64)],
) -> bool {
    let vehicle = &vehicles[me];
    let Some(&(last, last_start)) = movement.last() else { return true };
    // Who stands there keeps nobody from going on but those who mean to follow.
    if movement.iter().all(|&(lane, _)| net.lanes[lane].right_of_way) {
        return true;
    }
    let exit_at = last_start + net.lanes[last].way.length_m;
    let gap = |v: &Vehicle| v.model.size_m[0] + v.driver.idm.standstill_gap_m;
    let mut need = vehicle.model.size_m[0] + EXIT_MARGIN_M;
    let mut first_exit = None;
    // Those who will wait before the next line, and the way there.
    let (mut stored, mut stretch) = (0.0, f64::INFINITY);
    let mut sleeper_m = f64::INFINITY;
    for (lane, start) in vehicle.lanes_ahead(net) {
        if start + 1e-6 < exit_at {
            continue;
        }
        if let Some(next) = net.lanes[lane].junction.filter(|_| !net.lanes[lane].right_of_way) {
            let leaves = |v: &Vehicle| v.held.iter().any(|h| net.lanes[h.lane].junction == Some(next));
            if vehicle.held.iter().any(|h| h.lane == lane) || start - exit_at > STORED_M {
                break;
            }
            let between = vehicle.lanes_ahead(net).filter(|(_, s)| (exit_at - 1e-6..start).contains(s));
            // Wrecks reach over several places.
            let mut seen = Vec::new();
            for spot in between.flat_map(|(l, _)| &occupancy.vehicles[l]) {
                let again = seen.contains(&spot.vehicle);
                seen.push(spot.vehicle);
                match vehicles.get(spot.vehicle) {
                    Some(other) if again || spot.vehicle == me || leaves(other) => {}
                    Some(other) => stored += gap(other),
                    None => stored += 2.0 * spot.half_length_m,
                }
            }
            stretch = start - exit_at - net.lanes[lane].line_gap_m;
            break;
        }
        if first_exit.is_none() {
            first_exit = Some(lane);
            for &before in &net.lanes[lane].previous {
                for &other in reservations.holders[before].iter().filter(|&&other| other != me) {
                    need += gap(&vehicles[other]);
                }
            }
        }
        if start > exit_at + need.max(STORED_M) {
            break;
        }
        let blocked = occupancy.vehicles[lane].iter().any(|spot| {
            let rear = start + spot.along_m - spot.half_length_m - exit_at;
            if vehicles.get(spot.vehicle).is_some_and(|v| v.wake == Wake::Asleep) {
                sleeper_m = sleeper_m.min(rear);
            }
            spot.vehicle != me && spot.speed_mps < EXIT_SLOW_MPS && rear < need
        });
        if blocked {
            return false;
        }
    }
    if sleeper_m.is_finite() {
        // All on their way to it will stand behind it, however fast they are.
        let exits = vehicle.lanes_ahead(net).filter(|(_, start)| start + 1e-6 >= exit_at);
        let spots = exits.flat_map(|(lane, start)| {
            occupancy.vehicles[lane].iter().map(move |spot| (start + spot.along_m - exit_at, spot))
        });
        let before = spots.filter(|(to_m, spot)| *to_m < sleeper_m && spot.vehicle != me);
        let queue: f64 = before.filter_map(|(_, spot)| vehicles.get(spot.vehicle)).map(gap).sum();
        if need + queue > sleeper_m {
            return false;
        }
    }
    need + stored <= stretch
}

/// Whether somebody has leave for a way through a junction that leads to a vehicle, and counts on its going on.
pub(crate) fn is_counted_on(reservations: &Reservations, net: &Net, vehicle: &Vehicle) -> bool {
    // Lanes upstream with the way from their beginnings to the vehicle's rear.
    let mut open = vec![(vehicle.route[0], vehicle.along_m - vehicle.half_length_m())];
    while let Some((lane, way_m)) = open.pop() {
        if way_m > STORED_M || open.len() > 64 {
            continue;
        }
        for &before in &net.lanes[lane].previous {
            if net.lanes[before].junction.is_none() {
                open.push((before, way_m + net.lanes[before].way.length_m));
            } else if !reservations.holders[before].is_empty() {
                return true;
            }
        }
    }
    false
}
