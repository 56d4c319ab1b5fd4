//! Who may enter a junction: signals, signs, and by turns where ways cross.
//!
//! A driver may pass the line before a junction only with all lanes of its way through it reserved. Where the ways of
//! two meet, the one whose reservation is older goes first. A later one is given if nobody who goes first stands, and
//! the driver comes to the place when it is free, or behind the other one where ways merge; if something takes longer,
//! it waits before the place. It is also given before one that has not passed its line and is so far away that it need
//! not brake: that one asks again. Reservations end when the vehicle's rear has left the lane.
//!
//! Nobody waits for ever inside: whoever waits there waits for an older reservation, or for who is ahead on its lane and
//! has one; the oldest one can leave, because entry needs room behind the junction. Where ways are reserved in parts, as on
//! roundabouts, the next part may be held by one who stands for who asks for it: it is given then, and with the age of the
//! part before, or both would stand for good.
//!
//! Requests are served by rank: who is inside, who waits for long, who has no sign and does not turn left at a light, the
//! others; then in the order in which drivers came to the line, vehicle numbers breaking ties. Whoever has been refused
//! for long claims its way and the room behind it: those who come later get no leave across the one or into the other, so
//! that a busy road does not starve a side street.

use crate::driver::{COMFORT_BRAKING, braking_to_stop, envelope};
use crate::meeting::{LetIn, Meeting, Wait};
use crate::net::{Lane, Net, PLANNED_BRAKING};
use crate::occupancy::{Occupancy, is_stranded};
use crate::signals::{Light, Signals};
use crate::vehicles::Vehicle;

/// Free space behind the rear of a vehicle that waits behind a junction, metres.
const EXIT_MARGIN_M: f64 = 1.5;
/// Vehicles between two junctions nearer than this are counted, so that none has to wait in the first one, metres.
const STORED_M: f64 = 60.0;
/// A vehicle behind a junction slower than this blocks it, m/s.
const EXIT_SLOW_MPS: f64 = 5.0 / 3.6;
/// Drivers stop at yellow if this braking is enough, m/s2.
const YELLOW_BRAKING: f64 = 3.5;
/// Drivers stop at red if it is at all possible, m/s2.
const RED_BRAKING: f64 = 7.5;
/// Nobody means to stop nearer to a line than this, metres.
const LINE_SPARE_M: f64 = 0.5;
/// Who stands within this distance of a line is at it, metres, and farther off where drivers stop farther off.
const LINE_M: f64 = 7.0;
/// Standing time at a stop sign, steps (2 s).
const STOP_STEPS: u32 = 40;
/// At green, queues this long set off as one, metres.
const QUEUE_M: f64 = 60.0;
/// Slower than this is standing, m/s.
const STANDING_MPS: f64 = 0.3;
/// Who has been refused for this long claims its way, steps (10 s).
const PATIENCE_STEPS: u32 = 200;
/// Who can stop before its line with this braking may be asked to let another one go first, m/s2.
const LEFT_BRAKING: f64 = 2.0;
/// Speed towards traffic lights and towards signs, m/s.
const LIGHT_MPS: f64 = 15.0 / 3.6;
const SIGN_MPS: f64 = 10.0 / 3.6;
/// The slow-down begins at this many seconds of the wished speed.
const SLOWDOWN_S: f64 = 3.5;

/// A reserved junction lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    pub(crate) lane: usize,
    /// The vehicle's odometer at the lane's beginning, metres.
    pub(crate) start_m: f64,
    /// Number of the reservation: older ones go first.
    order: u64,
}

/// The next line that a vehicle has no leave to pass.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// From the front bumper, metres.
    pub(crate) gap_m: f64,
    /// First lane behind the line.
    pub(crate) entry: usize,
    /// Position of `entry` in the route.
    position: usize,
}

/// Reservations of all junction lanes.
#[derive(Debug)]
pub(crate) struct Reservations {
    holders: Vec<Vec<usize>>,
    given: u64,
}

/// What those claim who have been refused for long, in one step: those who are asked later get no leave across their
/// lanes and into the lanes they want to get to.
#[derive(Debug, Default)]
struct Claims {
    lanes: Vec<usize>,
    exits: Vec<usize>,
}

/// What a driver makes of the line ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Approach {
    /// Gap to the place to stop, before the line if it must not be passed, or inside, metres.
    pub(crate) stop_gap_m: Option<f64>,
    /// The one that goes first where ways merge.
    pub(crate) merging: Option<LetIn>,
    /// Highest speed here, m/s.
    pub(crate) cap_mps: f64,
}

/// Nothing to mind.
const OPEN: Approach = Approach { stop_gap_m: None, merging: None, cap_mps: f64::INFINITY };

impl Vehicle {
    /// The next line ahead that the front has not passed, whether or not there is leave to pass it.
    fn next_entry(&self, net: &Net) -> Option<(usize, f64)> {
        let mut before: Option<usize> = None;
        for (lane, start) in self.lanes_ahead(net) {
            let gap = start - self.half_length_m();
            if gap > self.view_m() {
                return None;
            }
            let same = before.is_some_and(|b| net.lanes[b].junction == net.lanes[lane].junction);
            if net.lanes[lane].junction.is_some() && !same && gap > 0.0 {
                return Some((lane, gap));
            }
            before = Some(lane);
        }
        None
    }

    /// The next line ahead without leave.
    pub(crate) fn next_line(&self, net: &Net) -> Option<Line> {
        let mut before: Option<usize> = None;
        for (position, (lane, start)) in self.lanes_ahead(net).enumerate() {
            if start > self.view_m() {
                return None;
            }
            let enters = net.lanes[lane].junction.is_some() && position > 0;
            let same = before.is_some_and(|b| net.lanes[b].junction == net.lanes[lane].junction);
            if enters && !same && !self.held.iter().any(|h| h.lane == lane) {
                return Some(Line { gap_m: start - self.half_length_m(), entry: lane, position });
            }
            before = Some(lane);
        }
        None
    }
}

impl Reservations {
    pub(crate) fn new(lanes: usize) -> Self {
        Self { holders: vec![Vec::new(); lanes], given: 0 }
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
    fn leave(&mut self, vehicle: &mut Vehicle, me: usize, keep: impl Fn(&Held) -> bool) {
        let holders = &mut self.holders;
        vehicle.held.retain(|held| {
            let keep = keep(held);
            if !keep {
                holders[held.lane].retain(|&v| v != me);
            }
            keep
        });
    }

    /// Ends the reservations of lanes that a vehicle's rear has left.
    pub(crate) fn release(&mut self, net: &Net, vehicle: &mut Vehicle, me: usize) {
        let rear = vehicle.odometer_m - vehicle.half_length_m();
        self.leave(vehicle, me, |held| rear <= held.start_m + net.lanes[held.lane].way.length_m + 0.3);
    }

    /// Ends the reservations of lanes that a vehicle's front has not reached.
    fn give_back(&mut self, vehicle: &mut Vehicle, me: usize) {
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

    /// The lanes through the junction, and on through the next one where the stretch between is too short to wait on.
    fn movement(net: &Net, vehicle: &Vehicle, line: &Line) -> Vec<(usize, f64)> {
        let need = vehicle.model.size_m[0] + EXIT_MARGIN_M;
        let mut through: Vec<(usize, f64)> = Vec::new();
        let mut outside = f64::INFINITY;
        for (lane, start) in vehicle.lanes_ahead(net).skip(line.position) {
            if net.lanes[lane].junction.is_some() {
                // Room to wait before the next line?
                if !through.is_empty()
                    && (need + net.lanes[lane].line_gap_m..f64::INFINITY).contains(&outside)
                {
                    break;
                }
                through.push((lane, start));
                outside = 0.0;
            } else {
                outside += net.lanes[lane].way.length_m;
            }
            if through.len() >= 16 {
                break;
            }
        }
        through
    }

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
            let stands = vehicles[rival].stands_for.contains(&me) && !meeting.is_rival_in();
            if stands || meeting.is_gap_behind() {
                return true;
            }
            let before = is_before_line(net, &vehicles[rival])
                && meeting.is_gap_before()
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
                if !meeting.rival_first(held.order < own.order) {
                    continue;
                }
                let wait = meeting.wait();
                if wait.is_some() && vehicle.speed_mps < STANDING_MPS {
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

    /// Whether there is room for the vehicle behind its last junction lane, those on their way there counted.
    fn has_exit(
        &self,
        net: &Net,
        occupancy: &Occupancy,
        vehicles: &[Vehicle],
        me: usize,
        movement: &[(usize, f64)],
    ) -> bool {
        let vehicle = &vehicles[me];
        let Some(&(last, last_start)) = movement.last() else { return true };
        let exit_at = last_start + net.lanes[last].way.length_m;
        let gap = |v: &Vehicle| v.model.size_m[0] + v.driver.idm.standstill_gap_m;
        let mut need = vehicle.model.size_m[0] + EXIT_MARGIN_M;
        let mut first_exit = None;
        // Those who will wait before the next line, and the way there.
        let (mut stored, mut stretch) = (0.0, f64::INFINITY);
        for (lane, start) in vehicle.lanes_ahead(net) {
            if start + 1e-6 < exit_at {
                continue;
            }
            if let Some(next) = net.lanes[lane].junction {
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
                    for &other in self.holders[before].iter().filter(|&&other| other != me) {
                        need += gap(&vehicles[other]);
                    }
                }
            }
            if start > exit_at + need.max(STORED_M) {
                break;
            }
            let blocked = occupancy.vehicles[lane].iter().any(|spot| {
                let rear = start + spot.along_m - spot.half_length_m - exit_at;
                spot.vehicle != me && spot.speed_mps < EXIT_SLOW_MPS && rear < need
            });
            if blocked {
                return false;
            }
        }
        need + stored <= stretch
    }

    /// The lane that a vehicle comes to behind its last junction lane.
    fn exit_of(net: &Net, vehicle: &Vehicle, movement: &[(usize, f64)]) -> Option<usize> {
        let &(last, start) = movement.last()?;
        let exit_at = start + net.lanes[last].way.length_m;
        vehicle.lanes_ahead(net).find(|(_, start)| start + 1e-6 >= exit_at).map(|(lane, _)| lane)
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
        let movement = Self::movement(net, &vehicles[me], line);
        let into = Self::exit_of(net, &vehicles[me], &movement);
        // Who is in a junction already must get out of it first.
        let inside = !vehicles[me].held.is_empty();
        let exit = (inside || into.is_none_or(|lane| !claims.exits.contains(&lane)))
            && self.has_exit(net, occupancy, vehicles, me, &movement);
        let claimed = |lane: usize| {
            !inside && net.lanes[lane].conflicts.iter().any(|c| claims.lanes.contains(&c.other))
        };
        let odometer = vehicles[me].odometer_m;
        let mut ask_again = Vec::new();
        let free = movement.iter().all(|&(lane, start)| {
            let place = (lane, odometer + start);
            // A wreck in the way.
            let mut spots = occupancy.vehicles[lane].iter();
            let open = !spots.any(|s| start + s.along_m > 0.0 && is_stranded(vehicles, s.vehicle));
            open && !claimed(lane) && self.is_free(net, vehicles, me, place, &mut ask_again)
        });
        if !free || !exit {
            if vehicles[me].refused_steps > PATIENCE_STEPS {
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
        let age = vehicles[me].held.iter().map(|held| held.order).min();
        let stood_for = vehicles.iter().any(|other| other.stands_for.contains(&me));
        for (lane, start) in movement {
            self.hold(&mut vehicles[me], me, lane, odometer + start);
        }
        if let Some(order) = age.filter(|_| stood_for) {
            vehicles[me].held.iter_mut().for_each(|held| held.order = held.order.min(order));
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
            if vehicles[me].driver.reckless {
                let vehicle = &mut vehicles[me];
                self.intrude(net, vehicle, me);
                continue;
            }
            // A light may change between leave and line.
            if let Some((entry, gap)) = vehicles[me].next_entry(net)
                && !vehicles[me].driver.distracted
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
            let blind = vehicles[me].driver.distracted;
            let speed = vehicles[me].speed_mps;
            let approach = &mut approaches[me];
            // Who is beyond the place to stop when its light changes, or asks again, stops before the line as it can.
            let soonest_m = (speed * speed / (2.0 * COMFORT_BRAKING)).min(line.gap_m - LINE_SPARE_M);
            approach.stop_gap_m = Some((line.gap_m - entry.line_gap_m).max(soonest_m));
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
            // Only the first in the queue asks, and at a green light those who follow one that has leave, from farther away.
            let leader = occupancy.leader(net, vehicles, me).filter(|l| l.gap_m < line.gap_m - 0.5);
            let follows = leader.is_some_and(|l| {
                let leave = |h: &Held| net.lanes[h.lane].junction == entry.junction;
                light == Light::Green && vehicles.get(l.vehicle).is_some_and(|v| v.held.iter().any(leave))
            });
            let second = leader.is_some() && !follows;
            let near = line.gap_m
                <= entry.line_gap_m.max(LINE_M) + 1.0 + speed * 1.0 + speed * speed / (2.0 * 1.5)
                || follows && line.gap_m < QUEUE_M;
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
            if (!forbidden || blind) && stood {
                requests.push((rank(vehicle, entry), since, me, line));
            }
        }
        requests.sort_by_key(|(rank, since, me, _)| (*rank, *since, *me));
        let mut claims = Claims::default();
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
        for (me, approach) in approaches.iter_mut().enumerate() {
            if !vehicles[me].crashed && !vehicles[me].driver.reckless {
                vehicles[me].stands_for = self.give_way(net, vehicles, me, approach);
            }
        }
        approaches
    }
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

/// Whether a light keeps a driver before its line: not where the line is passed or stopping is impossible.
fn forbids(light: Light, speed_mps: f64, gap_m: f64) -> bool {
    let braking = braking_to_stop(speed_mps, gap_m);
    let can_stop = match light {
        Light::Red => braking < RED_BRAKING || speed_mps < 1.0,
        Light::Yellow => braking < YELLOW_BRAKING || speed_mps < 1.0,
        Light::Green | Light::Off => false,
    };
    can_stop && gap_m > -0.2
}

/// Drivers slow down towards lights of any colour and towards stop and yield signs; and never so fast that neither
/// stopping nor passing within the yellow time is possible.
fn slow_down(vehicle: &Vehicle, net: &Net, unsignalised: bool, signed: bool, gap_m: f64) -> f64 {
    if unsignalised && !signed {
        return f64::INFINITY;
    }
    let low = if unsignalised { SIGN_MPS } else { LIGHT_MPS };
    let target = vehicle.wished_speed(net);
    let from_m = SLOWDOWN_S * target;
    let gap_m = gap_m.max(0.0);
    let slope =
        if gap_m < from_m { low.min(target) + (target - low).max(0.0) * gap_m / from_m } else { target };
    slope.min(envelope(low, gap_m, PLANNED_BRAKING))
}
