//! Leave to use the lanes of junctions: who holds which, and whose is older.

use crate::net::Net;
use crate::vehicles::Vehicle;

/// A reserved junction lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    pub(crate) lane: usize,
    /// The vehicle's odometer at the lane's beginning, metres.
    pub(crate) start_m: f64,
    /// Number of the reservation: older ones go first.
    pub(crate) order: u64,
}

/// Reservations of all junction lanes.
#[derive(Debug)]
pub(crate) struct Reservations {
    /// The vehicles that hold each lane.
    pub(crate) holders: Vec<Vec<usize>>,
    given: u64,
    /// For each vehicle whether somebody right behind it has leave.
    pub(crate) followed: Vec<bool>,
    /// The heads of the queues that those with leave stand in.
    pub(crate) heads: Vec<Option<usize>>,
}

impl Reservations {
    pub(crate) fn new(lanes: usize) -> Self {
        Self { holders: vec![Vec::new(); lanes], given: 0, followed: Vec::new(), heads: Vec::new() }
    }

    /// Reserves a lane for a vehicle without asking.
    pub(crate) fn hold(&mut self, vehicle: &mut Vehicle, me: usize, lane: usize, start_m: f64) {
        self.given += 1;
        if !vehicle.held.iter().any(|h| h.lane == lane) {
            vehicle.held.push(Held { lane, start_m, order: self.given });
            self.holders[lane].push(me);
        }
    }

    /// Ends the reservations but for those to keep.
    pub(crate) fn leave(&mut self, vehicle: &mut Vehicle, me: usize, keep: impl Fn(&Held) -> bool) {
        let holders = &mut self.holders;
        vehicle.held.retain(|held| {
            let keep = keep(held);
            if !keep {
                holders[held.lane].retain(|&v| v != me);
            }
            keep
        });
    }

    /// Makes the leave of whoever is ahead on its way to a lane as old as that of those behind: who lets those pass that it
    /// follows would wait for itself otherwise.
    pub(crate) fn keep_order(&self, vehicles: &mut [Vehicle]) {
        for (lane, holders) in self.holders.iter().enumerate().filter(|(_, holders)| holders.len() > 1) {
            let mut row: Vec<(f64, usize, usize)> = Vec::with_capacity(holders.len());
            for &who in holders {
                let vehicle = &vehicles[who];
                if let Some(i) = vehicle.held.iter().position(|h| h.lane == lane) {
                    row.push((vehicle.held[i].start_m - vehicle.odometer_m, who, i));
                }
            }
            row.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
            let mut oldest = u64::MAX;
            for (_, who, i) in row {
                let held = &mut vehicles[who].held[i];
                oldest = oldest.min(held.order);
                held.order = oldest;
            }
        }
    }

    /// Ends the reservations of lanes that a vehicle's rear has left.
    pub(crate) fn release(&mut self, net: &Net, vehicle: &mut Vehicle, me: usize) {
        let rear = vehicle.odometer_m - vehicle.half_length_m();
        self.leave(vehicle, me, |held| rear <= held.start_m + net.lanes[held.lane].way.length_m + 0.3);
    }

    /// Ends the reservations of lanes that a vehicle's front has not reached.
    pub(crate) fn give_back(&mut self, vehicle: &mut Vehicle, me: usize) {
        let front = vehicle.odometer_m + vehicle.half_length_m();
        self.leave(vehicle, me, |held| held.start_m <= front);
    }

    /// Reserves the lane that a driver who asks nobody is on.
    pub(crate) fn intrude(&mut self, net: &Net, vehicle: &mut Vehicle, me: usize) {
        let lane = vehicle.route[0];
        if net.lanes[lane].junction.is_some() {
            let start = vehicle.odometer_m - vehicle.along_m;
            self.hold(vehicle, me, lane, start);
        }
    }
}
