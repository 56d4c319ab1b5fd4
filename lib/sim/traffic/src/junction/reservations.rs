//! Reservations of junction lanes: which vehicle holds which, and which is older.

use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::claim::Reservation;

/// Reservations of all junction lanes; what each vehicle has is in its claim.
#[derive(Debug)]
pub(crate) struct ReservationTable {
    /// The vehicles that hold each lane.
    holders: Vec<Vec<usize>>,
    given: u64,
}

impl ReservationTable {
    pub(crate) fn new(lanes: usize) -> Self {
        Self { holders: vec![Vec::new(); lanes], given: 0 }
    }

    /// The vehicles that hold a lane.
    pub(crate) fn holders(&self, lane: usize) -> &[usize] {
        &self.holders[lane]
    }

    /// Reserves a lane for a vehicle without asking.
    pub(crate) fn reserve(&mut self, vehicle: &mut Vehicle, me: usize, lane: usize, start_m: f64) {
        self.given += 1;
        if vehicle.claim_mut().reserve(Reservation { lane, start_m, order: self.given }) {
            self.holders[lane].push(me);
        }
    }

    /// Reserves the lane that a driver who asks nobody is on.
    pub(crate) fn reserve_here(&mut self, net: &Net, vehicle: &mut Vehicle, me: usize) {
        let lane = vehicle.route().lane();
        if net.lanes[lane].junction.is_some() {
            let start = vehicle.route().odometer_m() - vehicle.route().along_m();
            self.reserve(vehicle, me, lane, start);
        }
    }

    /// Ends the reservations but for those to keep.
    fn keep(&mut self, vehicle: &mut Vehicle, me: usize, keep: impl Fn(&Reservation) -> bool) {
        let holders = &mut self.holders;
        vehicle.claim_mut().keep(keep, |lane| holders[lane].retain(|&v| v != me));
    }

    /// Ends all reservations of a vehicle.
    pub(crate) fn release_all(&mut self, vehicle: &mut Vehicle, me: usize) {
        self.keep(vehicle, me, |_| false);
    }

    /// Ends the reservations of lanes that a vehicle's rear has left.
    pub(crate) fn release_passed(&mut self, net: &Net, vehicle: &mut Vehicle, me: usize) {
        let rear = vehicle.route().odometer_m() - vehicle.rear_m();
        self.keep(vehicle, me, |r| rear <= r.start_m + net.lanes[r.lane].centre.length_m + 0.3);
    }

    /// Ends the reservations of lanes that a vehicle's front has not reached.
    pub(crate) fn release_ahead(&mut self, vehicle: &mut Vehicle, me: usize) {
        let front = vehicle.route().odometer_m() + vehicle.half_length_m();
        self.keep(vehicle, me, |r| r.start_m <= front);
    }

    /// Makes the reservation of the vehicle ahead on the way to a lane as old as those of the vehicles behind
    /// it: otherwise a vehicle that yields to its own follower would wait for itself.
    pub(crate) fn keep_order(&self, vehicles: &mut [Vehicle]) {
        for (lane, holders) in self.holders.iter().enumerate().filter(|(_, holders)| holders.len() > 1) {
            let mut row: Vec<(f64, usize)> = Vec::with_capacity(holders.len());
            for &who in holders {
                if let Some(held) = vehicles[who].claim().of_lane(lane) {
                    row.push((held.start_m - vehicles[who].route().odometer_m(), who));
                }
            }
            row.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
            let mut oldest = u64::MAX;
            for (_, who) in row {
                oldest = vehicles[who].claim_mut().age_lane(lane, oldest).unwrap_or(oldest);
            }
        }
    }
}
