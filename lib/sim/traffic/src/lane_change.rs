//! Lane changes: when a driver wishes for one, whether it is safe, and the way over.
//!
//! Drivers change to pass slower or stranded vehicles (MOBIL: Kesting, Treiber, Helbing, 2007), and must
//! change where their lane ends or their turn has a lane of its own. Nobody changes in junctions, across
//! marks that forbid it, or into a gap that makes another brake hard. A driver who must change and cannot,
//! asks: the next one behind in the other lane lets it in, so that two full lanes zip into one.

use crate::occupancy::{GIVEN, Occupancy, Occupant, Sense, is_stranded};
use crate::road::net::Net;
use crate::road::sides::{CHANGE_WIDTH_M, Side};
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;
use crate::vehicle::attention::Class;
use crate::vehicle::lateral::{LaneChange, LateralTransition, OUT};

/// Slower than this is standing, m/s.
const STANDING_MPS: f64 = 0.1;
/// Each driver looks every so many steps.
const EVERY_STEPS: u32 = 5;
/// Seconds that a change takes: 1.5 m/s2 sideways for a lane of 3.5 m.
const CHANGE_S: f64 = 3.7;
/// Speed that drivers gain while they change, as passing they accelerate, m/s.
const GAINS_MPS: f64 = 2.0;
/// Shortest way over, metres; long vehicles need more, in their lengths.
const SHORTEST_M: f64 = 11.0;
const SHORTEST_LENGTHS: f64 = 2.2;
/// Space left then to the rear of the one ahead, metres.
const PAST_M: f64 = 1.5;
/// Drivers who see late what stands ahead come nearer than they mean to, metres.
const LATE_M: f64 = 2.5;
/// Gain in acceleration that a change has to bring, m/s2.
const GAIN: f64 = 0.4;
/// Weight of the loss of the one behind.
const POLITENESS: f64 = 0.2;
/// Strongest braking that a change may ask of the one behind, m/s2: by choice and where it must be.
const SAFE_BRAKING: [f64; 2] = [1.8, 2.8];
/// Leaders this near are worth passing, metres, if slower than this share of the wished speed.
const LEADER_M: f64 = 60.0;
const SLOW: f64 = 0.85;
/// No change by choice this near to a junction, metres.
const CALM_M: f64 = 60.0;
/// Drivers leave a lane that ends within this distance, metres.
const END_M: f64 = 150.0;
/// Middles of lanes side by side lie this far apart, metres.
const APART_M: [f64; 2] = [2.0, 5.0];
/// The place on the new lane lies this exactly beside the vehicle, metres.
const SQUARE_M: f64 = 1e-3;

/// The shortest way over of a vehicle of a length, metres.
fn shortest_m(length_m: f64) -> f64 {
    SHORTEST_M.max(SHORTEST_LENGTHS * length_m)
}

/// Gap to what stands ahead from which a vehicle of a length gets past it, metres.
pub(crate) fn room_to_pull_out_m(length_m: f64) -> f64 {
    OUT * shortest_m(length_m) + PAST_M + LATE_M
}

/// Why a driver wants to change.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motive {
    /// The lane ends, metres ahead.
    LaneEnds(f64),
    /// The turn has a lane of its own.
    TurnLane(usize),
    /// A wreck or a hazard blocks the lane.
    Around,
    /// To go faster.
    Pass,
}

/// A change that is possible.
struct Change {
    lane: usize,
    along_m: f64,
    gain: f64,
    change: LaneChange,
}

/// What a driver finds beside it.
enum Found {
    Gap(Change),
    /// There is a lane, but no gap.
    Full(usize),
    /// There is a lane, but what stands ahead is too near to get out of this one.
    Blocked,
    Nothing,
}

/// Lets every driver whose turn it is to look begin a change. New places are entered at once, so that no two
/// take the same gap.
pub(crate) fn change_lanes(net: &Net, occupancy: &mut Occupancy, vehicles: &mut [Vehicle], step: u32) {
    for me in 0..vehicles.len() {
        if !(step + me as u32).is_multiple_of(EVERY_STEPS) {
            continue;
        }
        vehicles[me].lane_choice_mut().settle();
        let Some(wish) = wish(net, occupancy, vehicles, me) else { continue };
        let mut best: Option<Change> = None;
        let (mut full, mut blocked) = (None, false);
        for side in Side::BOTH {
            match gap_beside(net, occupancy, vehicles, me, side, wish) {
                Found::Gap(change) if best.as_ref().is_none_or(|b| change.gain > b.gain) => {
                    best = Some(change)
                }
                Found::Full(lane) => full = full.or(Some(lane)),
                Found::Blocked => blocked = true,
                Found::Gap(_) | Found::Nothing => {}
            }
        }
        match best {
            Some(change) => begin(net, occupancy, &mut vehicles[me], me, change),
            None if wish != Motive::Pass => {
                let boxed_in = blocked && full.is_none() && vehicles[me].speed_mps() < STANDING_MPS;
                vehicles[me].lane_choice_mut().ask(full, boxed_in);
            }
            None => {}
        }
    }
}

fn begin(net: &Net, occupancy: &mut Occupancy, vehicle: &mut Vehicle, me: usize, change: Change) {
    vehicle.change_lane(net, (change.lane, change.along_m), change.change);
    let spot = Occupant {
        along_m: change.along_m,
        half_length_m: vehicle.half_length_m(),
        behind_m: 0.0,
        speed_mps: vehicle.speed_mps(),
        vehicle: me,
        class: Class::Vehicles,
    };
    occupancy.add_vehicle(change.lane, spot);
}

/// Whether and why a driver wants to change.
fn wish(net: &Net, occupancy: &Occupancy, vehicles: &[Vehicle], me: usize) -> Option<Motive> {
    let vehicle = &vehicles[me];
    let lane = &net.lanes[vehicle.route().lane()];
    let settled = vehicle.lateral().change().is_none() && !vehicle.is_crashed() && vehicle.claim().is_empty();
    if !settled
        || vehicle.driver().is_away(Class::Vehicles)
        || vehicle.wake() != Activity::Awake
        || lane.junction.is_some()
        || lane.beside.iter().all(Option::is_none)
    {
        return None;
    }
    if let Some(lane) = vehicle.route().turn_lane() {
        return Some(Motive::TurnLane(lane));
    }
    if let Some(end_m) = vehicle.end_of_road_m(net).filter(|end_m| *end_m < END_M) {
        return Some(Motive::LaneEnds(end_m));
    }
    let leader = occupancy.leader(net, vehicles, me).filter(|leader| leader.gap_m < LEADER_M)?;
    if is_stranded(vehicles, leader.vehicle) {
        return Some(Motive::Around);
    }
    let speed = vehicle.speed_mps();
    if vehicle.towed().is_some() {
        return None;
    }
    let settled = vehicle.route().since_change_m() >= (10.0 * speed).max(10.0);
    let slow = leader.speed_mps < SLOW * vehicle.wished_speed(net);
    let calm = vehicle.junction_gap_m(net) > CALM_M + speed * CHANGE_S;
    (settled && slow && calm).then_some(Motive::Pass)
}

/// What a driver finds on one side.
fn gap_beside(
    net: &Net,
    occupancy: &Occupancy,
    vehicles: &[Vehicle],
    me: usize,
    side: Side,
    wish: Motive,
) -> Found {
    let vehicle = &vehicles[me];
    let own = &net.lanes[vehicle.route().lane()];
    let Some(beside) = &own.beside[side as usize] else { return Found::Nothing };
    if matches!(wish, Motive::TurnLane(lane) if lane != beside.lane) {
        return Found::Nothing;
    }
    let (length, width) = (vehicle.length_m(), vehicle.model().size_m[1]);
    let (speed, half) = (vehicle.speed_mps(), vehicle.half_length_m());
    let target = &net.lanes[beside.lane];
    let near_m = target.centre.project(vehicle.motion().position()).0;
    let (along_m, from_m) = target.centre.cross(vehicle.motion().position(), near_m);
    let span_m = (CHANGE_S * (speed + GAINS_MPS)).max(shortest_m(length));
    // On the lane all the way, between marks that may be crossed, wide enough, and done before the next
    // junction.
    let [first, last] = [0.0, OUT * span_m]
        .map(|on| own.centre.index((vehicle.route().along_m() + on).min(own.centre.length_m)));
    let opposite = target.centre.place(along_m);
    let level = (opposite.point.z - vehicle.motion().position().z).abs() < 1.0;
    // Not before its beginning.
    let square = opposite.local(&vehicle.motion().position())[0].abs() < SQUARE_M;
    let wide = [0.4, 1.0]
        .iter()
        .all(|part| target.centre.place(along_m + part * span_m).width_m >= CHANGE_WIDTH_M.max(width + 0.4));
    let (room_m, ends) = room(net, beside.lane, along_m, span_m + 200.0);
    let better = match wish {
        Motive::LaneEnds(end_m) => !ends || room_m > end_m + 20.0,
        _ => !ends,
    };
    let reachable = (APART_M[0]..APART_M[1]).contains(&from_m.abs())
        && (from_m > 0.0) == (side == Side::Right)
        && (0.0..target.centre.length_m).contains(&along_m)
        && level
        && square
        && better
        && vehicle.route().may_use(beside.lane)
        // What is towed comes over later.
        && room_m > span_m + vehicle.rear_m().max(half) + 1.0;
    if !reachable {
        return Found::Nothing;
    }
    if !wide || !beside.allowed[first..=last].iter().all(|a| *a) {
        return Found::Nothing;
    }
    // Out of the old lane before its leader's rear is reached: too near to it there is no way out, unless it
    // goes on.
    let leader = occupancy.leader(net, vehicles, me);
    let near = leader.filter(|l| {
        let closing = 1.0 - (l.speed_mps / speed.max(2.0)).min(1.0);
        l.gap_m < OUT * span_m * closing + PAST_M
    });
    if let Some(leader) = near {
        let is_stuck = is_stranded(vehicles, leader.vehicle);
        return if is_stuck { Found::Blocked } else { Found::Full(beside.lane) };
    }
    match gap(net, occupancy, vehicles, me, (beside.lane, along_m), wish) {
        Some((gain, passed)) => Found::Gap(Change {
            lane: beside.lane,
            along_m,
            gain,
            change: LaneChange::new(LateralTransition::new(from_m, span_m), passed),
        }),
        None => Found::Full(beside.lane),
    }
}

/// The gain in acceleration on another lane and the vehicle that is passed, if there is a gap.
fn gap(
    net: &Net,
    occupancy: &Occupancy,
    vehicles: &[Vehicle],
    me: usize,
    (lane, along_m): (usize, f64),
    wish: Motive,
) -> Option<(f64, Option<usize>)> {
    let vehicle = &vehicles[me];
    let (speed, half) = (vehicle.speed_mps(), vehicle.half_length_m());
    let (wished, idm) = (vehicle.wished_speed(net), vehicle.driver().idm());
    let must = wish != Motive::Pass;
    let own = (me, vehicle.model().size_m[1]);
    let leader = occupancy.leader(net, vehicles, me);
    let now = leader.map_or(idm.free(speed, wished), |l| idm.following(speed, wished, l.gap_m, l.speed_mps));
    let ahead = occupancy.first(net, Sense::Ahead, (lane, along_m), own, vehicle.view_m());
    let then = match ahead {
        Some((to_m, spot)) => {
            let gap_m = to_m - half - spot.half_length_m;
            let least = if must { 1.0 } else { 2.0 } + 0.3 * (speed - spot.speed_mps).max(0.0) + 0.2 * speed;
            // Nobody chooses a lane that is blocked in view.
            if gap_m < least || !must && is_stranded(vehicles, spot.vehicle) {
                return None;
            }
            idm.following(speed, wished, gap_m, spot.speed_mps)
        }
        None => idm.free(speed, wished),
    };
    let braking = SAFE_BRAKING[usize::from(must)];
    if then < now.min(-braking) {
        return None;
    }
    let mut loss = 0.0;
    let behind = occupancy.first(net, Sense::Behind, (lane, along_m), own, 80.0);
    if let Some((to_m, spot)) = behind.filter(|(_, spot)| spot.vehicle == GIVEN) {
        // It brakes for nobody.
        let closing_mps = (spot.speed_mps - speed).max(0.0);
        let gap_m = to_m - vehicle.rear_m() - spot.half_length_m;
        if gap_m < 1.0 + CHANGE_S * closing_mps + 0.3 * spot.speed_mps {
            return None;
        }
    }
    if let Some((to_m, spot)) = behind
        && let Some(other) = vehicles.get(spot.vehicle).filter(|v| !v.is_crashed())
    {
        let gap_m = to_m - vehicle.rear_m() - spot.half_length_m;
        if gap_m < 1.0 + 0.3 * spot.speed_mps {
            return None;
        }
        let wished = other.speed_here(net);
        let after = other.driver().idm().following(spot.speed_mps, wished, gap_m, speed);
        let before = ahead.map_or(other.driver().idm().free(spot.speed_mps, wished), |(on_m, front)| {
            let gap_m = to_m + on_m - spot.half_length_m - front.half_length_m;
            other.driver().idm().following(spot.speed_mps, wished, gap_m, front.speed_mps)
        });
        // A vehicle that stands anyway is not made to brake.
        if after < -braking && spot.speed_mps > 0.5 {
            return None;
        }
        loss = (before - after).max(0.0);
    }
    let gain = then - now - POLITENESS * loss;
    (must || gain > GAIN).then_some((gain, leader.map(|l| l.vehicle)))
}

/// Metres from a place on a lane to the next junction or the end of the road, up to a limit, and whether it
/// is an end.
fn room(net: &Net, lane: usize, along_m: f64, limit_m: f64) -> (f64, bool) {
    let (mut lane, mut room_m) = (lane, net.lanes[lane].usable_m - along_m);
    while room_m < limit_m {
        match net.lanes[lane].next.first() {
            None => return (room_m, true),
            Some(&next) if net.lanes[next].junction.is_some() => return (room_m, false),
            Some(&next) => {
                room_m += net.lanes[next].centre.length_m;
                lane = next;
            }
        }
    }
    (room_m, false)
}
