//! Queues before and in junctions: a vehicle with a reservation that is behind another one can only go on
//! with that one.

use crate::occupancy::Occupancy;
use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::claim::Reservation;

/// The one that a vehicle with leave has ahead of it on the way that it has leave for, by its index.
fn ahead(net: &Net, occupancy: &Occupancy, vehicles: &[Vehicle], me: usize) -> Option<usize> {
    let vehicle = &vehicles[me];
    let end_m =
        |r: &Reservation| r.start_m + net.lanes[r.lane].centre.length_m - vehicle.route().odometer_m();
    let last_m = vehicle.claim().reservations().iter().map(end_m).fold(f64::NEG_INFINITY, f64::max);
    let leader = occupancy.leader(net, vehicles, me)?;
    (leader.gap_m + vehicle.half_length_m() < last_m && leader.vehicle < vehicles.len())
        .then_some(leader.vehicle)
}

/// For each vehicle whether somebody right behind it has leave: it must not ask again after that.
pub(crate) fn followed(net: &Net, occupancy: &Occupancy, vehicles: &[Vehicle]) -> Vec<bool> {
    let mut followed = vec![false; vehicles.len()];
    for me in (0..vehicles.len()).filter(|&me| !vehicles[me].claim().is_empty() && !vehicles[me].is_crashed())
    {
        if let Some(leader) = ahead(net, occupancy, vehicles, me) {
            followed[leader] = true;
        }
    }
    followed
}

/// Makes the leave of those who stand at the head of queues, for others who stand, as old as that of those
/// behind them: an older leave behind a younger one would have the one at the head wait for somebody who
/// waits for its queue. Returns the heads of the queues that those with leave stand in; None for those who
/// move or stand at the head themselves.
pub(crate) fn pass_on_ages(net: &Net, occupancy: &Occupancy, vehicles: &mut [Vehicle]) -> Vec<Option<usize>> {
    let mut heads = vec![None; vehicles.len()];
    for me in 0..vehicles.len() {
        let mut oldest = vehicles[me].claim().oldest();
        let mut at = me;
        // From one to the next ahead, to the head of the queue.
        for _ in 0..vehicles.len() {
            let Some(order) = oldest.filter(|_| vehicles[at].stands()) else { break };
            if at != me {
                heads[me] = Some(at);
                let rivals = vehicles[at].claim().yields_to();
                if !rivals.is_empty() && rivals.iter().all(|&rival| vehicles[rival].stands()) {
                    vehicles[at].claim_mut().age(order);
                }
            }
            let Some(next) = ahead(net, occupancy, vehicles, at).filter(|&next| next != me) else { break };
            oldest = vehicles[next].claim().oldest().map(|own| own.min(order));
            at = next;
        }
    }
    heads
}
