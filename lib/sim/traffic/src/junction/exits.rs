//! The way through a junction and the room behind it: no vehicle sets off that would have to stop where
//! others cross.

use crate::junction::approach::Line;
use crate::junction::reservations::ReservationTable;
use crate::occupancy::Occupancy;
use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;

/// Free space behind the rear of a vehicle that waits behind a junction, metres.
const EXIT_MARGIN_M: f64 = 1.5;
/// Vehicles between two junctions nearer than this are counted, so that none has to wait in the first one,
/// metres.
const STORED_M: f64 = 60.0;
/// A vehicle behind a junction slower than this blocks it, m/s.
const EXIT_SLOW_MPS: f64 = 5.0 / 3.6;

/// What those claim who have been refused for long, in one step: those who are asked later get no leave
/// across their lanes and into the lanes they want to get to.
#[derive(Debug, Default)]
pub(crate) struct PriorityClaims {
    pub(crate) lanes: Vec<usize>,
    pub(crate) exits: Vec<usize>,
}

/// The lanes through the junction, and on through the next one where the stretch between is too short to wait
/// on. Nobody waits before a lane with the right of way, so such a lane is no end of the stretch.
pub(crate) fn movement(net: &Net, vehicle: &Vehicle, line: &Line) -> Vec<(usize, f64)> {
    let need = vehicle.length_m() + EXIT_MARGIN_M;
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
            outside += net.lanes[lane].centre.length_m;
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
    let exit_at = start + net.lanes[last].centre.length_m;
    vehicle.lanes_ahead(net).find(|(_, start)| start + 1e-6 >= exit_at).map(|(lane, _)| lane)
}

/// Whether there is room for the vehicle behind its last junction lane, those on their way there counted.
pub(crate) fn has_exit(
    reservations: &ReservationTable,
    net: &Net,
    occupancy: &Occupancy,
    vehicles: &[Vehicle],
    me: usize,
    movement: &[(usize, f64)],
) -> bool {
    let Some(&(last, last_start)) = movement.last() else { return true };
    // Who stands there keeps nobody from going on but those who mean to follow.
    if movement.iter().all(|&(lane, _)| net.lanes[lane].right_of_way) {
        return true;
    }
    let at_m = last_start + net.lanes[last].centre.length_m;
    Exit { net, occupancy, vehicles, me, at_m }.has_room(reservations)
}

/// What a vehicle needs in a queue, metres.
fn queued_m(vehicle: &Vehicle) -> f64 {
    vehicle.length_m() + vehicle.driver().idm().standstill_gap_m
}

/// The stretch behind the last junction lane of a vehicle's movement, which is so far ahead of its middle.
struct Exit<'a> {
    net: &'a Net,
    occupancy: &'a Occupancy,
    vehicles: &'a [Vehicle],
    me: usize,
    at_m: f64,
}

impl Exit<'_> {
    /// Lanes from the exit on, with the way to their beginnings.
    fn lanes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let lanes = self.vehicles[self.me].lanes_ahead(self.net);
        lanes.filter(|(_, start)| start + 1e-6 >= self.at_m)
    }

    /// Whether the vehicle can stop there clear of the junction.
    fn has_room(&self, reservations: &ReservationTable) -> bool {
        let vehicle = &self.vehicles[self.me];
        let mut need = vehicle.length_m() + EXIT_MARGIN_M;
        let mut is_first = true;
        // The vehicles that will wait before the next line, and the way there.
        let (mut stored, mut stretch) = (0.0, f64::INFINITY);
        let mut sleeper_m = f64::INFINITY;
        for (lane, start) in self.lanes() {
            let facts = &self.net.lanes[lane];
            if let Some(next) = facts.junction.filter(|_| !facts.right_of_way) {
                if vehicle.claim().of_lane(lane).is_none() && start - self.at_m <= STORED_M {
                    stored = self.stored_m(start, next);
                    stretch = start - self.at_m - facts.line_gap_m;
                }
                break;
            }
            if is_first {
                is_first = false;
                let holders = facts.previous.iter().flat_map(|&before| reservations.holders(before));
                for &other in holders.filter(|&&other| other != self.me) {
                    need += queued_m(&self.vehicles[other]);
                }
            }
            if start > self.at_m + need.max(STORED_M) {
                break;
            }
            let blocked = self.occupancy.on_lane(lane).iter().any(|there| {
                let rear = start + there.along_m - there.half_length_m - self.at_m;
                if self.vehicles.get(there.vehicle).is_some_and(|v| v.wake() == Activity::Asleep) {
                    sleeper_m = sleeper_m.min(rear);
                }
                there.vehicle != self.me && there.speed_mps < EXIT_SLOW_MPS && rear < need
            });
            if blocked {
                return false;
            }
        }
        // All on their way to a sleeper will stand behind it, however fast they are.
        let behind_sleeper = sleeper_m.is_infinite() || need + self.queue_m(sleeper_m) <= sleeper_m;
        behind_sleeper && need + stored <= stretch
    }

    /// Room that the vehicles need that will wait before the line of the next junction, to which it is so
    /// far, metres.
    fn stored_m(&self, line_m: f64, next: usize) -> f64 {
        let leaves = |v: &Vehicle| {
            v.claim().reservations().iter().any(|r| self.net.lanes[r.lane].junction == Some(next))
        };
        let between = self.vehicles[self.me].lanes_ahead(self.net);
        let between = between.filter(|(_, start)| (self.at_m - 1e-6..line_m).contains(start));
        let mut stored = 0.0;
        // Wrecks reach over several places.
        let mut seen = Vec::new();
        for there in between.flat_map(|(lane, _)| self.occupancy.on_lane(lane)) {
            let again = seen.contains(&there.vehicle);
            seen.push(there.vehicle);
            match self.vehicles.get(there.vehicle) {
                Some(other) if again || there.vehicle == self.me || leaves(other) => {}
                Some(other) => stored += queued_m(other),
                None => stored += 2.0 * there.half_length_m,
            }
        }
        stored
    }

    /// Room that the vehicles need that will stand behind an inactive one, which is so far behind the
    /// junction, metres.
    fn queue_m(&self, sleeper_m: f64) -> f64 {
        let there = self.lanes().flat_map(|(lane, start)| {
            let on_lane = self.occupancy.on_lane(lane).iter();
            on_lane.map(move |there| (start + there.along_m - self.at_m, there))
        });
        let before = there
            .filter(|(to_m, there)| *to_m < sleeper_m && there.vehicle != self.me && there.behind_m == 0.0);
        before.filter_map(|(_, there)| self.vehicles.get(there.vehicle)).map(queued_m).sum()
    }
}

/// Whether somebody has leave for a way through a junction that leads to a vehicle, and counts on its going
/// on.
pub(crate) fn is_counted_on(reservations: &ReservationTable, net: &Net, vehicle: &Vehicle) -> bool {
    // Lanes upstream with the way from their beginnings to the vehicle's rear.
    let mut open = vec![(vehicle.route().lane(), vehicle.route().along_m() - vehicle.rear_m())];
    while let Some((lane, way_m)) = open.pop() {
        if way_m > STORED_M || open.len() > 64 {
            continue;
        }
        for &before in &net.lanes[lane].previous {
            if net.lanes[before].junction.is_none() {
                open.push((before, way_m + net.lanes[before].centre.length_m));
            } else if !reservations.holders(before).is_empty() {
                return true;
            }
        }
    }
    false
}
