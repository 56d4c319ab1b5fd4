//! Right of way: which vehicle may enter a junction, by signals, signs, and in turns where ways cross.
//!
//! A driver may pass the line before a junction only with all lanes of its way through it reserved. Where the
//! ways of two meet, the one whose reservation is older goes first. A later one is given if nobody who goes
//! first stands, and the driver comes to the place when it is free, or behind the other one where ways merge;
//! if something takes longer, it waits before the place. It is also given before one that has not passed its
//! line and is so far away that it need not brake: that one asks again. Reservations end when the vehicle's
//! rear has left the lane.
//!
//! No vehicle waits for ever inside: it waits for an older reservation, or for the vehicle ahead on its lane,
//! whose reservation is as old; the oldest one can leave, because entry needs room behind the junction. Where
//! ways are reserved in parts, the next part may be held by one who stands for who asks for it: it is given
//! then, and with the age of the part before, or both would stand for good.
//!
//! A ring is reserved in such parts, lane by lane: no way crosses it, and vehicles that merge into it have a
//! sign. Lanes like that have the right of way: they are no reason to ask for more of the way before, for
//! room behind them, or to respect claims; and if all stand, vehicles on them go before vehicles that wait to
//! merge.
//!
//! Requests are served by rank: vehicles inside, vehicles that wait for long, vehicles without a sign that do
//! not turn left at a light, the others; then in the order in which drivers came to the line, vehicle numbers
//! breaking ties. A vehicle that has been refused for long claims its way and the room behind it, for some
//! seconds at a time: later vehicles get no reservation across the one or into the other, so that a busy road
//! does not starve a side street.

use crate::car_following::{COMFORT_BRAKING, braking_to_stop};
use crate::junction::approach::{Approach, Line, OPEN, class_of, forbids, slow_down};
use crate::junction::conflict::{Conflict, MergeLeader, Yielding};
use crate::junction::exits::{PriorityClaims, exit_of, has_exit, movement};
use crate::junction::queues::{followed, pass_on_ages};
use crate::junction::reservations::ReservationTable;
use crate::occupancy::{Leader, Occupancy, is_stranded};
use crate::road::net::{Lane, Net};
use crate::road::signals::Signals;
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;
use crate::vehicle::attention::Class;
use crate::vehicle::claim::Reservation;
use schema::SignalState;

/// Slower than this is creeping, m/s.
const CREEPING_MPS: f64 = 1.0;
/// Nobody means to stop nearer to a line than this, metres.
const LINE_MARGIN_M: f64 = 0.5;
/// A vehicle that stands within this distance of a line is at it, metres, and farther off where drivers stop
/// farther off.
const LINE_M: f64 = 7.0;
/// Standing time at a stop sign, steps (2 s).
const STOP_STEPS: u32 = 40;
/// At green, queues this long set off as one, metres.
const QUEUE_M: f64 = 60.0;
/// A vehicle that has been refused for this long claims its way, steps (10 s).
const PATIENCE_STEPS: u32 = 200;
/// A claim lasts this long, steps (5 s).
const CLAIM_STEPS: u32 = 100;
/// A vehicle that can stop before its line with this braking may be asked to let another one go first, m/s2.
const LEFT_BRAKING: f64 = 2.0;

/// What drivers come to a junction with, in one step of time.
#[derive(Clone, Copy)]
pub(crate) struct Junctions<'a> {
    pub(crate) net: &'a Net,
    pub(crate) signals: &'a Signals,
    pub(crate) occupancy: &'a Occupancy,
    pub(crate) step: u32,
    pub(crate) time_s: f64,
}

/// A driver asks for leave to pass a line.
struct Request {
    rank: u8,
    /// Step at which it came to the line.
    since: u32,
    vehicle: usize,
    line: Line,
}

/// The right of way at all junctions.
#[derive(Debug)]
pub(crate) struct RightOfWay {
    table: ReservationTable,
    /// For each vehicle whether somebody right behind it has leave.
    followed: Vec<bool>,
    /// The heads of the queues that those with leave stand in.
    heads: Vec<Option<usize>>,
}

impl Junctions<'_> {
    /// What a driver makes of the line ahead, without leave to pass it.
    fn approach(&self, vehicle: &Vehicle, line: &Line) -> Approach {
        let entry = &self.net.lanes[line.entry];
        let class = class_of(entry);
        let speed = vehicle.speed_mps();
        // A vehicle beyond the place to stop when its light changes, or that asks again, stops before the
        // line as it can.
        let soonest_m = (speed * speed / (2.0 * COMFORT_BRAKING)).min(line.gap_m - LINE_MARGIN_M);
        let mut approach =
            Approach { line: Some(((line.gap_m - entry.line_gap_m).max(soonest_m), class)), ..OPEN };
        if !vehicle.driver().is_away(class) {
            let signed = entry.stop_sign || entry.yield_sign;
            approach.cap_mps = slow_down(vehicle, self.net, entry.signals.is_empty(), signed, line.gap_m);
        }
        approach
    }

    /// Whether the leader right before a line has leave for the junction behind it, where those who follow go
    /// with it: at green, and on lanes with the right of way.
    fn leads_in(&self, vehicles: &[Vehicle], leader: &Leader, entry: &Lane, light: SignalState) -> bool {
        let leave = |r: &Reservation| self.net.lanes[r.lane].junction == entry.junction;
        (light == SignalState::Green || entry.right_of_way)
            && vehicles.get(leader.vehicle).is_some_and(|v| v.claim().reservations().iter().any(leave))
    }

    /// The request of a driver for the line ahead, if it is near, the first one there, and may go.
    fn request(&self, vehicles: &mut [Vehicle], me: usize, line: Line) -> Option<Request> {
        let entry = &self.net.lanes[line.entry];
        let light = self.signals.strictest(&entry.signals, self.time_s);
        let vehicle = &vehicles[me];
        let (driver, speed) = (vehicle.driver(), vehicle.speed_mps());
        let blind = driver.is_away(class_of(entry));
        // Only the first in the queue asks, and where there is nobody to let pass those who follow one that
        // has leave; at a green light from farther away.
        let sees = !driver.is_away(Class::Vehicles);
        let leader = sees.then(|| self.occupancy.leader(self.net, vehicles, me)).flatten();
        let leader = leader.filter(|l| l.gap_m < line.gap_m - 0.5);
        let follows = leader.is_some_and(|l| self.leads_in(vehicles, &l, entry, light));
        let second = leader.is_some() && !follows;
        let near = line.gap_m
            <= entry.line_gap_m.max(LINE_M) + 1.0 + speed * 1.0 + speed * speed / (2.0 * 1.5)
            || follows && light == SignalState::Green && line.gap_m < QUEUE_M;
        let must_stand = entry.stop_sign && entry.signals.is_empty() && !blind;
        let claim = vehicles[me].claim_mut();
        if must_stand && speed < 0.1 && line.gap_m < entry.line_gap_m + 2.5 && !second {
            claim.stand_at_sign();
        }
        if !near || second {
            claim.leave_line();
            return None;
        }
        let since = claim.wait_at_line(self.step);
        let stood = !must_stand || claim.stood_steps() >= STOP_STEPS;
        let vehicle = &vehicles[me];
        // A vehicle that is about to be deactivated only goes on where it has a reservation.
        let goes = vehicle.wake() == Activity::Awake || !vehicle.claim().is_empty();
        let forbidden = forbids(light, speed, line.gap_m);
        ((!forbidden || blind) && stood && goes).then(|| Request {
            rank: rank(vehicle, entry),
            since,
            vehicle: me,
            line,
        })
    }
}

impl RightOfWay {
    /// For a number of lanes, with nothing reserved.
    pub(crate) fn new(lanes: usize) -> Self {
        Self { table: ReservationTable::new(lanes), followed: Vec::new(), heads: Vec::new() }
    }

    pub(crate) fn reservations(&self) -> &ReservationTable {
        &self.table
    }

    /// Reserves the lanes under a vehicle where it starts.
    pub(crate) fn start(&mut self, net: &Net, vehicle: &mut Vehicle, me: usize) {
        let (lane, along_m) = (vehicle.route().lane(), vehicle.route().along_m());
        // Where the rear hangs back into a junction, the lanes under it are taken.
        if along_m < vehicle.rear_m() {
            for &before in net.lanes[lane].previous.iter().filter(|&&l| net.lanes[l].junction.is_some()) {
                self.table.reserve(vehicle, me, before, -along_m - net.lanes[before].centre.length_m);
            }
        }
        self.table.reserve_here(net, vehicle, me);
    }

    /// Serves all who wait or come near a line, and tells each vehicle what to make of it.
    pub(crate) fn serve(&mut self, now: &Junctions<'_>, vehicles: &mut [Vehicle]) -> Vec<Approach> {
        let mut approaches = vec![OPEN; vehicles.len()];
        let mut requests = Vec::new();
        for (me, approach) in approaches.iter_mut().enumerate() {
            if let Some(line) = self.line_ahead(now, vehicles, me) {
                *approach = now.approach(&vehicles[me], &line);
                requests.extend(now.request(vehicles, me, line));
            }
        }
        requests.sort_by_key(|r| (r.rank, r.since, r.vehicle));
        let mut claims = PriorityClaims::default();
        self.followed = followed(now.net, now.occupancy, vehicles);
        for Request { vehicle: me, line, .. } in requests {
            if self.grant(now, vehicles, me, &line, &mut claims) {
                approaches[me] = OPEN;
                vehicles[me].claim_mut().stop_waiting();
            } else {
                vehicles[me].claim_mut().refuse();
            }
        }
        self.table.keep_order(vehicles);
        self.heads = pass_on_ages(now.net, now.occupancy, vehicles);
        for (me, approach) in approaches.iter_mut().enumerate() {
            if !vehicles[me].is_crashed() {
                let sees = !vehicles[me].driver().is_away(Class::Vehicles);
                let yields_to = sees.then(|| self.give_way(now.net, vehicles, me, approach));
                vehicles[me].claim_mut().yield_to(yields_to.unwrap_or_default());
            }
        }
        approaches
    }

    /// Ends what a vehicle needs no longer, and finds the line that it may not pass without asking.
    fn line_ahead(&mut self, now: &Junctions<'_>, vehicles: &mut [Vehicle], me: usize) -> Option<Line> {
        let (net, vehicle) = (now.net, &mut vehicles[me]);
        self.table.release_passed(net, vehicle, me);
        if vehicle.is_crashed() {
            // Vehicles that come to the wreck see it on their lane.
            self.table.release_all(vehicle, me);
            return None;
        }
        if vehicle.wake() == Activity::Asleep {
            return None;
        }
        if vehicle.driver().sees_no_lines() {
            self.table.reserve_here(net, vehicle, me);
            return None;
        }
        // A light may change between leave and line.
        if let Some((entry, gap)) = vehicle.next_entry(net)
            && !vehicle.driver().is_away(Class::Lights)
            && forbids(now.signals.strictest(&net.lanes[entry].signals, now.time_s), vehicle.speed_mps(), gap)
        {
            self.table.release_ahead(vehicle, me);
        }
        let line = vehicle.next_line(net);
        if line.is_none() {
            vehicle.claim_mut().leave_line();
        }
        line
    }

    /// Those whom a vehicle meets on a lane, which it reaches at `start_m` of its odometer, with their
    /// reservations.
    fn conflicts<'a>(
        &'a self,
        net: &'a Net,
        vehicles: &'a [Vehicle],
        me: usize,
        (lane, start_m): (usize, f64),
    ) -> impl Iterator<Item = (usize, &'a Reservation, Conflict<'a>)> + 'a {
        net.lanes[lane].conflicts.iter().flat_map(move |area| {
            let rivals = self.table.holders(area.other).iter().filter(move |&&rival| rival != me);
            rivals.filter_map(move |&rival| {
                let held = vehicles[rival].claim().of_lane(area.other)?;
                let own = (&vehicles[me], lane, start_m);
                Some((rival, held, Conflict::new(net, own, area, (&vehicles[rival], held))?))
            })
        })
    }

    /// Whether a vehicle yields, standing, to another one, or to somebody whose queue that one stands at the
    /// head of.
    fn yields_to(&self, vehicle: &Vehicle, who: usize) -> bool {
        let heads = |other: &usize| self.heads.get(*other).copied().flatten() == Some(who);
        vehicle.claim().yields_to().iter().any(|other| *other == who || heads(other))
    }

    /// Whether a lane can be reserved beside what is reserved already; notes whom that leaves to ask again.
    fn is_free(
        &self,
        net: &Net,
        vehicles: &[Vehicle],
        me: usize,
        place: (usize, f64),
        ask_again: &mut Vec<usize>,
    ) -> bool {
        self.conflicts(net, vehicles, me, place).all(|(rival, _, conflict)| {
            // A vehicle that waits for this one anyway lets it go on, or both would wait for ever.
            let stands = self.yields_to(&vehicles[rival], me) || lets_pass(net, vehicles, me, place.0, rival);
            if stands && !conflict.is_rival_in() || conflict.accepts_gap_behind() {
                return true;
            }
            let before = is_before_line(net, &vehicles[rival])
                && conflict.accepts_gap_before()
                && !self.followed.get(rival).is_some_and(|followed| *followed)
                && !self.is_followed(vehicles, rival);
            if before {
                ask_again.push(rival);
            }
            before
        })
    }

    /// Whether somebody behind a vehicle has leave for one of its lanes: the one ahead must not ask again
    /// after that.
    fn is_followed(&self, vehicles: &[Vehicle], who: usize) -> bool {
        let to = |v: &Vehicle, r: &Reservation| r.start_m - v.route().odometer_m();
        vehicles[who].claim().reservations().iter().any(|own| {
            self.table.holders(own.lane).iter().filter(|&&v| v != who).any(|&v| {
                let held = vehicles[v].claim().of_lane(own.lane);
                held.is_some_and(|r| to(&vehicles[v], r) > to(&vehicles[who], own))
            })
        })
    }

    /// What a vehicle does inside a junction, or near it, about those who go first; returns whom it yields
    /// to, standing.
    fn give_way(&self, net: &Net, vehicles: &[Vehicle], me: usize, approach: &mut Approach) -> Vec<usize> {
        let vehicle = &vehicles[me];
        let (idm, speed) = (vehicle.driver().idm(), vehicle.speed_mps());
        let mut yields_to = Vec::new();
        let answer = |to: &MergeLeader| to.answer(&idm, speed, speed.max(1.0));
        for own in vehicle.claim().reservations() {
            for (rival, held, conflict) in self.conflicts(net, vehicles, me, (own.lane, own.start_m)) {
                // A rival whose queue stands for this one cannot go first, unless it is there.
                let head = self.heads.get(rival).copied().flatten();
                let waits_for_me = head.is_some_and(|head| vehicles[head].claim().yields_to().contains(&me));
                if !conflict.rival_first(turn(net, held, rival) < turn(net, own, me))
                    || waits_for_me && !conflict.is_rival_in()
                {
                    continue;
                }
                let yielding = conflict.yielding();
                if yielding.is_some() && vehicle.stands() {
                    yields_to.push(rival);
                }
                match yielding {
                    Some(Yielding::Stop(gap_m)) => {
                        approach.stop_gap_m = Some(approach.stop_gap_m.map_or(gap_m, |g| g.min(gap_m)));
                    }
                    Some(Yielding::MergeBehind(to))
                        if approach.merging.is_none_or(|m| answer(&to) < answer(&m)) =>
                    {
                        approach.merging = Some(to);
                    }
                    Some(Yielding::MergeBehind(_)) | None => {}
                }
            }
        }
        yields_to
    }

    /// Tries to reserve the whole way through the junction behind a line, across no lane and into no exit
    /// that another one claims.
    fn grant(
        &mut self,
        now: &Junctions<'_>,
        vehicles: &mut [Vehicle],
        me: usize,
        line: &Line,
        claims: &mut PriorityClaims,
    ) -> bool {
        let (net, occupancy) = (now.net, now.occupancy);
        let movement = movement(net, &vehicles[me], line);
        let into = exit_of(net, &vehicles[me], &movement);
        // Who is in a junction already must get out of it first, and claims are for those who wait, not for
        // those who have the right of way.
        let inside = !vehicles[me].claim().is_empty() || net.lanes[line.entry].right_of_way;
        let exit = (inside || into.is_none_or(|lane| !claims.exits.contains(&lane)))
            && has_exit(&self.table, net, occupancy, vehicles, me, &movement);
        let claimed = |lane: usize| {
            !inside && net.lanes[lane].conflicts.iter().any(|c| claims.lanes.contains(&c.other))
        };
        let odometer = vehicles[me].route().odometer_m();
        let mut ask_again = Vec::new();
        let blind = vehicles[me].driver().is_away(Class::Vehicles);
        let free = blind
            || movement.iter().all(|&(lane, start)| {
                let place = (lane, odometer + start);
                // A wreck in the way.
                let mut there = occupancy.on_lane(lane).iter();
                let open = !there.any(|o| start + o.along_m > 0.0 && is_stranded(vehicles, o.vehicle));
                open && !claimed(lane) && self.is_free(net, vehicles, me, place, &mut ask_again)
            });
        if !free || !(exit || blind) {
            if claims_way(vehicles[me].claim().refused_steps()) {
                claims.exits.extend(into);
                if exit {
                    claims.lanes.extend(movement.iter().map(|&(lane, _)| lane));
                }
            }
            return false;
        }
        for rival in ask_again {
            self.table.release_ahead(&mut vehicles[rival], rival);
        }
        self.reserve_movement(net, vehicles, me, movement);
        true
    }

    /// Reserves a way through junctions, as old as the reservations of those who are passed and as the own
    /// ones that others stand for.
    fn reserve_movement(
        &mut self,
        net: &Net,
        vehicles: &mut [Vehicle],
        me: usize,
        movement: Vec<(usize, f64)>,
    ) {
        let odometer = vehicles[me].route().odometer_m();
        // Vehicles that yield to this one on its old way yield to it on its new way: its
        // reservation is as old.
        let age = vehicles[me].claim().oldest();
        let stood_for = vehicles.iter().any(|other| self.yields_to(other, me));
        for (lane, start) in movement {
            let place = (lane, odometer + start);
            let passed = self
                .conflicts(net, vehicles, me, place)
                .filter(|(rival, _, conflict)| {
                    lets_pass(net, vehicles, me, lane, *rival) && !conflict.is_rival_in()
                })
                .map(|(_, held, _)| held.order);
            let order = passed.min();
            self.table.reserve(&mut vehicles[me], me, lane, place.1);
            if let Some(order) = order {
                vehicles[me].claim_mut().age_lane(lane, order);
            }
        }
        if let Some(order) = age.filter(|_| stood_for) {
            vehicles[me].claim_mut().age(order);
        }
    }
}

/// The order of two reservations, the older one before. One that was made as old as another one goes before
/// it where it has the right of way.
fn turn(net: &Net, held: &Reservation, who: usize) -> (u64, bool, usize) {
    (held.order, !net.lanes[held.lane].right_of_way, who)
}

/// Whether one that has the right of way on a lane may pass a rival with an older reservation: both stand,
/// and the rival waits for somebody else.
fn lets_pass(net: &Net, vehicles: &[Vehicle], me: usize, lane: usize, rival: usize) -> bool {
    net.lanes[lane].right_of_way
        && vehicles[me].speed_mps() < CREEPING_MPS
        && vehicles[rival].stands()
        && !vehicles[rival].claim().yields_to().is_empty()
}

/// Whether a driver who has been refused for so long claims its way: for some seconds, then again after it
/// has waited once more, as it may wait for somebody whom no claim moves.
fn claims_way(refused_steps: u32) -> bool {
    refused_steps > PATIENCE_STEPS && (refused_steps - PATIENCE_STEPS) % PATIENCE_STEPS <= CLAIM_STEPS
}

/// The order in which requests are served.
fn rank(vehicle: &Vehicle, entry: &Lane) -> u8 {
    let turns_left = entry.turn > 0 && !entry.signals.is_empty();
    match () {
        () if !vehicle.claim().is_empty() => 0,
        () if vehicle.claim().refused_steps() > PATIENCE_STEPS => 1,
        () if !entry.yield_sign && !entry.stop_sign && !turns_left => 2,
        () => 3,
    }
}

/// Whether a vehicle with leave has not passed its line and can stop there with ease.
fn is_before_line(net: &Net, vehicle: &Vehicle) -> bool {
    let front = vehicle.route().odometer_m() + vehicle.half_length_m();
    let gap = |r: &Reservation| r.start_m - front - net.lanes[r.lane].line_gap_m;
    let nearest = vehicle.claim().reservations().iter().map(gap).fold(f64::INFINITY, f64::min);
    nearest > 0.0 && braking_to_stop(vehicle.speed_mps(), nearest) < LEFT_BRAKING
}
