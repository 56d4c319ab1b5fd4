//! Who may enter a junction: signals, signs, and by turns where ways cross.
//!
//! A driver may pass the line before a junction only with all lanes of its way through it reserved. Where the ways of
//! two meet, the one whose reservation is older goes first. A later one is given if nobody who goes first stands, and
//! the driver comes to the place when it is free, or behind the other one where ways merge; if something takes longer,
//! it waits before the place. It is also given before one that has not passed its line and is so far away that it need
//! not brake: that one asks again. Reservations end when the vehicle's rear has left the lane.
//!
//! Nobody waits for ever inside: whoever waits there waits for an older reservation, or for who is ahead on its lane and
//! has one as old; the oldest one can leave, because entry needs room behind the junction. Where ways are reserved in parts,
//! the next part may be held by one who stands for who asks for it: it is given then, and with the age of the part before,
//! or both would stand for good.
//!
//! A ring is reserved in such parts, lane by lane: nobody crosses it, and who merges into it has a sign. Lanes like that
//! have the right of way: they are no reason to ask for more of the way before, for room behind them, or to heed claims; and
//! if all stand, who is on them goes before who waits to merge.
//!
//! Requests are served by rank: who is inside, who waits for long, who has no sign and does not turn left at a light, the
//! others; then in the order in which drivers came to the line, vehicle numbers breaking ties. Whoever has been refused
//! for long claims its way and the room behind it, for some seconds at a time: those who come later get no leave across the
//! one or into the other, so that a busy road does not starve a side street.

use crate::approach::{Approach, Line, OPEN, class_of, forbids, slow_down};
use crate::attention::Class;
use crate::driver::{COMFORT_BRAKING, braking_to_stop};
use crate::exits::{Claims, exit_of, has_exit, movement};
use crate::meeting::{LetIn, Meeting, Wait};
use crate::net::{Lane, Net};
use crate::occupancy::{Occupancy, is_stranded};
use crate::queues::{followed, pass_on_ages};
use crate::reservations::{Held, Reservations};
use crate::signals::{Light, Signals};
use crate::sleep::Wake;
use crate::vehicles::Vehicle;

/// Slower than this is creeping, m/s.
const CREEPING_MPS: f64 = 1.0;
/// Nobody means to stop nearer to a line than this, metres.
const LINE_SPARE_M: f64 = 0.5;
/// Who stands within this distance of a line is at it, metres, and farther off where drivers stop farther off.
const LINE_M: f64 = 7.0;
/// Standing time at a stop sign, steps (2 s).
const STOP_STEPS: u32 = 40;
/// At green, queues this long set off as one, metres.
const QUEUE_M: f64 = 60.0;
/// Who has been refused for this long claims its way, steps (10 s).
const PATIENCE_STEPS: u32 = 200;
/// A claim lasts this long, steps (5 s).
const CLAIM_STEPS: u32 = 100;
/// Who can stop before its line with this braking may be asked to let another one go first, m/s2.
const LEFT_BRAKING: f64 = 2.0;

impl Reservations {
    /// Those whom a vehicle meets on a lane, which it reaches at `start_m` of its odometer, with their reservations.
    fn meetings<'a>(
        &'a self,
        net: &'a Net,
        vehicles: &'a [Vehicle],
        me: usize,
        (lane, start_m): (usize, f64),
    ) -> impl Iterator<Item = (usize, &'a Held, Meeting<'a>)> + 'a {
        net.lanes[lane].conflicts.iter().flat_map(move |conflict| {
            self.holders[conflict.other].iter().filter(move |&&rival| rival != me).filter_map(move |&rival| {
                let held = vehicles[rival].held.iter().find(|h| h.lane == conflict.other)?;
                let own = (&vehicles[me], lane, start_m);
                Some((rival, held, Meeting::new(net, own, conflict, (&vehicles[rival], held))?))
            })
        })
    }

    /// Whether a vehicle stands for another one, or for somebody in the queue behind that one.
    fn stands_for(&self, vehicle: &Vehicle, who: usize) -> bool {
        let heads = |other: &usize| self.heads.get(*other).copied().flatten() == Some(who);
        vehicle.stands_for.iter().any(|other| *other == who || heads(other))
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
        self.meetings(net, vehicles, me, place).all(|(rival, _, meeting)| {
            // Who stands for this one anyway lets it go on, or both would stand for good.
            let stands =
                self.stands_for(&vehicles[rival], me) || lets_pass(net, vehicles, me, place.0, rival);
            if stands && !meeting.is_rival_in() || meeting.is_gap_behind() {
                return true;
            }
            let before = is_before_line(net, &vehicles[rival])
                && meeting.is_gap_before()
                && !self.followed.get(rival).is_some_and(|followed| *followed)
                && !self.is_followed(vehicles, rival);
            if before {
                ask_again.push(rival);
            }
            before
        })
    }

    /// Whether somebody behind a vehicle has leave for one of its lanes: the one ahead must not ask again after that.
    fn is_followed(&self, vehicles: &[Vehicle], who: usize) -> bool {
        let to = |v: &Vehicle, h: &Held| h.start_m - v.odometer_m;
        vehicles[who].held.iter().any(|own| {
            self.holders[own.lane].iter().filter(|&&v| v != who).any(|&v| {
                let held = vehicles[v].held.iter().find(|h| h.lane == own.lane);
                held.is_some_and(|h| to(&vehicles[v], h) > to(&vehicles[who], own))
            })
        })
    }

    /// What a vehicle does inside a junction, or near it, about those who go first; returns whom it stands for.
    fn give_way(&self, net: &Net, vehicles: &[Vehicle], me: usize, approach: &mut Approach) -> Vec<usize> {
        let vehicle = &vehicles[me];
        let mut stands_for = Vec::new();
        let answer =
            |to: &LetIn| to.answer(&vehicle.driver.idm, vehicle.speed_mps, vehicle.speed_mps.max(1.0));
        for own in &vehicle.held {
            for (rival, held, meeting) in self.meetings(net, vehicles, me, (own.lane, own.start_m)) {
                // A rival whose queue stands for this one cannot go first, unless it is there.
                let head = self.heads.get(rival).copied().flatten();
                let waits_for_me = head.is_some_and(|head| vehicles[head].stands_for.contains(&me));
                if !meeting.rival_first(turn(net, held, rival) < turn(net, own, me))
                    || waits_for_me && !meeting.is_rival_in()
                {
                    continue;
                }
                let wait = meeting.wait();
                if wait.is_some() && vehicle.stands() {
                    stands_for.push(rival);
                }
                match wait {
                    Some(Wait::Stop(gap_m)) => {
                        approach.stop_gap_m = Some(approach.stop_gap_m.map_or(gap_m, |g| g.min(gap_m)));
                    }
                    Some(Wait::LetIn(to)) if approach.merging.is_none_or(|m| answer(&to) < answer(&m)) => {
                        approach.merging = Some(to);
                    }
                    Some(Wait::LetIn(_)) | None => {}
                }
            }
        }
        stands_for
    }

    /// Tries to reserve the whole way through the junction behind a line, across no lane and into no exit that another one
    /// claims.
    fn request(
        &mut self,
        net: &Net,
        occupancy: &Occupancy,
        vehicles: &mut [Vehicle],
        me: usize,
        line: &Line,
        claims: &mut Claims,
    ) -> bool {
        let movement = movement(net, &vehicles[me], line);
        let into = exit_of(net, &vehicles[me], &movement);
        // Who is in a junction already must get out of it first, and claims are for those who wait, not for those who have
        // the right of way.
        let inside = !vehicles[me].held.is_empty() || net.lanes[line.entry].right_of_way;
        let exit = (inside || into.is_none_or(|lane| !claims.exits.contains(&lane)))
            && has_exit(self, net, occupancy, vehicles, me, &movement);
        let claimed = |lane: usize| {
            !inside && net.lanes[lane].conflicts.iter().any(|c| claims.lanes.contains(&c.other))
        };
        let odometer = vehicles[me].odometer_m;
        let mut ask_again = Vec::new();
        let blind = vehicles[me].attention.is_away(Class::Vehicles);
        let free = blind
            || movement.iter().all(|&(lane, start)| {
                let place = (lane, odometer + start);
                // A wreck in the way.
                let mut spots = occupancy.vehicles[lane].iter();
                let open = !spots.any(|s| start + s.along_m > 0.0 && is_stranded(vehicles, s.vehicle));
                open && !claimed(lane) && self.is_free(net, vehicles, me, place, &mut ask_again)
            });
        if !free || !(exit || blind) {
            if claims_way(vehicles[me].refused_steps) {
                claims.exits.extend(into);
                if exit {
                    claims.lanes.extend(movement.iter().map(|&(lane, _)| lane));
                }
            }
            return false;
        }
        for rival in ask_again {
            self.give_back(&mut vehicles[rival], rival);
        }
        // Whoever stands for this one on the way it has stands for it on the way it gets: its leave is as old.
        let age = vehicles[me].oldest_leave();
        let stood_for = vehicles.iter().any(|other| self.stands_for(other, me));
        for (lane, start) in movement {
            let place = (lane, odometer + start);
            let passed = self
                .meetings(net, vehicles, me, place)
                .filter(|(rival, _, meeting)| {
                    lets_pass(net, vehicles, me, lane, *rival) && !meeting.is_rival_in()
                })
                .map(|(_, held, _)| held.order);
            let order = passed.min();
            self.hold(&mut vehicles[me], me, lane, place.1);
            if let Some((order, held)) = order.zip(vehicles[me].held.iter_mut().find(|h| h.lane == lane)) {
                held.order = held.order.min(order);
            }
        }
        if let Some(order) = age.filter(|_| stood_for) {
            vehicles[me].age_leave(order);
        }
        true
    }

    /// Serves all who wait or come near a line, and tells each vehicle what to make of it.
    pub(crate) fn serve(
        &mut self,
        net: &Net,
        signals: &Signals,
        occupancy: &Occupancy,
        vehicles: &mut [Vehicle],
        step: u32,
        time_s: f64,
    ) -> Vec<Approach> {
        let mut approaches = vec![OPEN; vehicles.len()];
        let mut requests: Vec<(u8, u32, usize, Line)> = Vec::new();
        for me in 0..vehicles.len() {
            self.release(net, &mut vehicles[me], me);
            if vehicles[me].crashed {
                // Whoever meets the wreck sees it on its lane.
                self.leave(&mut vehicles[me], me, |_| false);
                continue;
            }
            if vehicles[me].wake == Wake::Asleep {
                continue;
            }
            if vehicles[me].attention.sees_no_lines() {
                let vehicle = &mut vehicles[me];
                self.intrude(net, vehicle, me);
                continue;
            }
            // A light may change between leave and line.
            if let Some((entry, gap)) = vehicles[me].next_entry(net)
                && !vehicles[me].attention.is_away(Class::Lights)
                && forbids(signals.strictest(&net.lanes[entry].signals, time_s), vehicles[me].speed_mps, gap)
            {
                self.give_back(&mut vehicles[me], me);
            }
            let Some(line) = vehicles[me].next_line(net) else {
                vehicles[me].waiting_since = None;
                continue;
            };
            let entry = &net.lanes[line.entry];
            let light = signals.strictest(&entry.signals, time_s);
            let class = class_of(entry);
            let blind = vehicles[me].attention.is_away(class);
            let speed = vehicles[me].speed_mps;
            let approach = &mut approaches[me];
            // Who is beyond the place to stop when its light changes, or asks again, stops before the line as it can.
            let soonest_m = (speed * speed / (2.0 * COMFORT_BRAKING)).min(line.gap_m - LINE_SPARE_M);
            approach.line = Some(((line.gap_m - entry.line_gap_m).max(soonest_m), class));
            if !blind {
                approach.cap_mps = slow_down(
                    &vehicles[me],
                    net,
                    entry.signals.is_empty(),
                    entry.stop_sign || entry.yield_sign,
                    line.gap_m,
                );
            }
            let forbidden = forbids(light, speed, line.gap_m);
            // Only the first in the queue asks, and where there is nobody to let pass those who follow one that has leave; at a
            // green light from farther away.
            let sees = !vehicles[me].attention.is_away(Class::Vehicles);
            let leader = sees.then(|| occupancy.leader(net, vehicles, me)).flatten();
            let leader = leader.filter(|l| l.gap_m < line.gap_m - 0.5);
            let follows = leader.is_some_and(|l| {
                let leave = |h: &Held| net.lanes[h.lane].junction == entry.junction;
                (light == Light::Green || entry.right_of_way)
                    && vehicles.get(l.vehicle).is_some_and(|v| v.held.iter().any(leave))
            });
            let second = leader.is_some() && !follows;
            let near = line.gap_m
                <= entry.line_gap_m.max(LINE_M) + 1.0 + speed * 1.0 + speed * speed / (2.0 * 1.5)
                || follows && light == Light::Green && line.gap_m < QUEUE_M;
            let vehicle = &mut vehicles[me];
            let must_stand = entry.stop_sign && entry.signals.is_empty() && !blind;
            if must_stand && speed < 0.1 && line.gap_m < entry.line_gap_m + 2.5 && !second {
                vehicle.stood_steps += 1;
            }
            if !near || second {
                vehicle.waiting_since = None;
                continue;
            }
            let since = *vehicle.waiting_since.get_or_insert(step);
            let stood = !must_stand || vehicle.stood_steps >= STOP_STEPS;
            // Who is about to sleep only goes on where it has leave already.
            let goes = vehicle.wake == Wake::Awake || !vehicle.held.is_empty();
            if (!forbidden || blind) && stood && goes {
                requests.push((rank(vehicle, entry), since, me, line));
            }
        }
        requests.sort_by_key(|(rank, since, me, _)| (*rank, *since, *me));
        let mut claims = Claims::default();
        self.followed = followed(net, occupancy, vehicles);
        for (_, _, me, line) in requests {
            if self.request(net, occupancy, vehicles, me, &line, &mut claims) {
                approaches[me] = OPEN;
                vehicles[me].waiting_since = None;
                vehicles[me].stood_steps = 0;
                vehicles[me].refused_steps = 0;
            } else {
                vehicles[me].refused_steps += 1;
            }
        }
        self.keep_order(vehicles);
        self.heads = pass_on_ages(net, occupancy, vehicles);
        for (me, approach) in approaches.iter_mut().enumerate() {
            if !vehicles[me].crashed {
                let sees = !vehicles[me].attention.is_away(Class::Vehicles);
                let stands_for = sees.then(|| self.give_way(net, vehicles, me, approach));
                vehicles[me].stands_for = stands_for.unwrap_or_default();
            }
        }
        approaches
    }
}

/// The order of two reservations, the older one before. One that was made as old as another one goes before it where it
/// has the right of way.
fn turn(net: &Net, held: &Held, who: usize) -> (u64, bool, usize) {
    (held.order, !net.lanes[held.lane].right_of_way, who)
}

/// Whether one that has the right of way on a lane may pass a rival with an older reservation: both stand, and the rival
/// waits for somebody else.
fn lets_pass(net: &Net, vehicles: &[Vehicle], me: usize, lane: usize, rival: usize) -> bool {
    net.lanes[lane].right_of_way
        && vehicles[me].speed_mps < CREEPING_MPS
        && vehicles[rival].stands()
        && !vehicles[rival].stands_for.is_empty()
}

/// Whether a driver who has been refused for so long claims its way: for some seconds, then again after it has waited once
/// more, as it may wait for somebody whom no claim moves.
fn claims_way(refused_steps: u32) -> bool {
    refused_steps > PATIENCE_STEPS && (refused_steps - PATIENCE_STEPS) % PATIENCE_STEPS <= CLAIM_STEPS
}

/// Who is asked first.
fn rank(vehicle: &Vehicle, entry: &Lane) -> u8 {
    let turns_left = entry.turn > 0 && !entry.signals.is_empty();
    match () {
        () if !vehicle.held.is_empty() => 0,
        () if vehicle.refused_steps > PATIENCE_STEPS => 1,
        () if !entry.yield_sign && !entry.stop_sign && !turns_left => 2,
        () => 3,
    }
}

/// Whether a vehicle with leave has not passed its line and can stop there with ease.
fn is_before_line(net: &Net, vehicle: &Vehicle) -> bool {
    let front = vehicle.odometer_m + vehicle.half_length_m();
    let gap = |h: &Held| h.start_m - front - net.lanes[h.lane].line_gap_m;
    let nearest = vehicle.held.iter().map(gap).fold(f64::INFINITY, f64::min);
    nearest > 0.0 && braking_to_stop(vehicle.speed_mps, nearest) < LEFT_BRAKING
}
