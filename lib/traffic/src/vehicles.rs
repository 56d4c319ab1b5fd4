//! Vehicles on their routes: who is ahead, how fast to go, where the next step leads.

use std::collections::VecDeque;

use random::Stream;
use schema::models::{BaseType, Model};

use crate::approach::Approach;
use crate::attention::{Attention, Class, Sight};
use crate::bodies::Body;
use crate::change::{Shift, room_to_pull_out_m};
use crate::driver::{COMFORT_BRAKING, Idm, envelope};
use crate::moving::Glide;
use crate::net::{Net, PLANNED_BRAKING};
use crate::occupancy::{Occupancy, is_stranded};
use crate::reservations::Held;
use crate::sides::Side;
use crate::sleep::Wake;
use crate::sway::Sway;
use crate::ways::Place;

/// Bicycles go no faster, m/s.
const BICYCLE_MPS: f64 = 8.0;
/// Slower than this is standing, m/s.
const STANDING_MPS: f64 = 0.3;
/// Nobody stops nearer to a leader than this, metres.
const LEAST_GAP_M: f64 = 0.5;
/// Time gap that drivers keep, seconds: with the drawn standing gaps, queues of cars clear at some 1,600 vehicles per hour and lane.
const HEADWAY_S: f64 = 0.6;
/// Lookahead at rest, metres.
const NEAR_M: f64 = 40.0;
/// Gap to a walker on the road, metres.
const WALKER_GAP_M: f64 = 2.0;
/// Way left before a walker would be touched by any part of the vehicle, metres.
const TOUCHING_GAP_M: f64 = 0.6;
/// Gap to the place before a line where drivers come to rest, metres.
const LINE_GAP_M: f64 = 0.2;
/// Drivers stop this far before the end of a road, metres.
const ROAD_END_M: f64 = 1.0;
/// Braking for a place to pull out behind a wreck, m/s2: who needs more stops nearer to it.
const FIRM_BRAKING: f64 = 4.0;
/// Gap to the rear of a vehicle that is being passed, metres, and free space beside it.
const PASSED_GAP_M: f64 = 0.5;
const PASSED_ASIDE_M: f64 = 0.3;
/// At walking speed it is less: metres more per m/s.
const PASSED_ASIDE_S: f64 = 0.05;

/// Who drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Driver {
    pub(crate) reckless: bool,
    pub(crate) distracted: bool,
    /// Speed below the limit as a share of it.
    pub(crate) speed_difference: f64,
    pub(crate) idm: Idm,
}

impl Driver {
    pub(crate) fn new(
        model: &Model,
        reckless: bool,
        distracted: bool,
        speed_difference: f64,
        standstill_gap_m: f64,
    ) -> Self {
        let acceleration = match model.base {
            BaseType::Truck | BaseType::Bus => 1.3,
            BaseType::Bicycle => 1.2,
            _ => 2.5,
        };
        let idm = Idm {
            acceleration,
            braking: 2.5,
            headway_s: HEADWAY_S,
            standstill_gap_m: standstill_gap_m.max(LEAST_GAP_M),
        };
        Self { reckless, distracted, speed_difference, idm }
    }
}

/// A vehicle. The followed point is the middle of its footprint, which moves along the route.
#[derive(Debug)]
pub(crate) struct Vehicle {
    pub(crate) model: &'static Model,
    pub(crate) driver: Driver,
    /// Branches and turn lanes are drawn from it.
    pub(crate) stream: Stream,
    /// Lanes from the one it is on.
    pub(crate) route: VecDeque<usize>,
    /// Way on the first lane, metres.
    pub(crate) along_m: f64,
    /// Way along lanes since the start, metres.
    pub(crate) odometer_m: f64,
    /// Way in space since the start, metres.
    pub(crate) rolled_m: f64,
    pub(crate) speed_mps: f64,
    pub(crate) acceleration_mps2: f64,
    pub(crate) yaw_rad: f64,
    pub(crate) place: Place,
    pub(crate) steer_rad: f64,
    /// Lean of its body.
    pub(crate) sway: Sway,
    /// The lane change under way.
    pub(crate) shift: Option<Shift>,
    /// What it is off its way since a seam where two ways do not quite meet.
    pub(crate) slack: Option<Glide>,
    /// The turn lane beside that it means to take.
    pub(crate) pocket: Option<usize>,
    /// The lane beside that it must change to and finds no gap on.
    pub(crate) asks: Option<usize>,
    /// Its odometer at the last lane change, metres.
    pub(crate) changed_m: f64,
    /// It stands too near behind a wreck to get past it.
    pub(crate) stuck: bool,
    /// It hit or was hit: nobody drives it any more.
    pub(crate) crashed: bool,
    /// Junction lanes that are kept free for it.
    pub(crate) held: Vec<Held>,
    /// Step at which it came to the line that it waits at.
    pub(crate) waiting_since: Option<u32>,
    /// Steps it has stood still at a stop sign.
    pub(crate) stood_steps: u32,
    /// Steps that it has asked in vain for leave to pass a line.
    pub(crate) refused_steps: u32,
    /// Those it stands for inside a junction, by their indices.
    pub(crate) stands_for: Vec<usize>,
    pub(crate) attention: Attention,
    pub(crate) wake: Wake,
    pub(crate) body: Body,
}

impl Vehicle {
    /// Whether it stands, or hardly moves.
    pub(crate) fn stands(&self) -> bool {
        self.speed_mps < STANDING_MPS
    }

    /// Age of its oldest reservation; lower is older.
    pub(crate) fn oldest_leave(&self) -> Option<u64> {
        self.held.iter().map(|held| held.order).min()
    }

    /// Makes its reservations at least as old as this.
    pub(crate) fn age_leave(&mut self, order: u64) {
        self.held.iter_mut().for_each(|held| held.order = held.order.min(order));
    }

    pub(crate) fn half_length_m(&self) -> f64 {
        0.5 * self.model.size_m[0]
    }

    /// How far ahead it looks, metres.
    pub(crate) fn view_m(&self) -> f64 {
        NEAR_M + 2.0 * self.speed_mps + self.speed_mps * self.speed_mps / (2.0 * PLANNED_BRAKING)
    }

    /// The wished speed on a lane without traffic and curves, m/s.
    fn lane_speed(&self, net: &Net, lane: usize) -> f64 {
        let speed = net.lanes[lane].limit_mps * (1.0 - self.driver.speed_difference);
        if self.model.base == BaseType::Bicycle { speed.min(BICYCLE_MPS) } else { speed }
    }

    /// Draws branches until the route reaches beyond the view.
    pub(crate) fn extend_route(&mut self, net: &Net) {
        let mut ahead: f64 =
            self.route.iter().map(|&l| net.lanes[l].way.length_m).sum::<f64>() - self.along_m;
        let reach = self.view_m() + 60.0;
        while ahead < reach {
            let Some(&last) = self.route.back() else { return };
            let Some(&next) = self.stream.choose(&net.lanes[last].next) else { return };
            self.route.push_back(next);
            ahead += net.lanes[next].way.length_m;
        }
    }

    /// Having come to another lane, draws whether to take the turn lane that opens beside it: all ways on are as likely.
    pub(crate) fn arrive(&mut self, net: &Net) {
        self.pocket = None;
        let own = &net.lanes[self.route[0]];
        for pocket in own.beside.iter().flatten().map(|b| b.lane) {
            let lane = &net.lanes[pocket];
            if lane.previous.is_empty() && !lane.next.is_empty() {
                let ways = lane.next.len() as f64;
                if self.stream.chance(ways / (ways + own.next.len() as f64)) {
                    self.pocket = Some(pocket);
                }
            }
        }
    }

    /// The lanes of the route with the way from the vehicle's middle to their beginnings (negative for the first).
    pub(crate) fn lanes_ahead<'a>(&'a self, net: &'a Net) -> impl Iterator<Item = (usize, f64)> + 'a {
        let mut to = -self.along_m;
        self.route.iter().map(move |&lane| {
            let start = to;
            to += net.lanes[lane].way.length_m;
            (lane, start)
        })
    }

    /// The side that it asks to be let in to.
    pub(crate) fn means_side(&self, net: &Net) -> Option<Side> {
        let wanted = self.asks?;
        let beside = &net.lanes[self.route[0]].beside;
        Side::BOTH.into_iter().find(|s| beside[*s as usize].as_ref().is_some_and(|b| b.lane == wanted))
    }

    /// From the front to the next junction on the route, metres; far where none is in view.
    pub(crate) fn junction_gap_m(&self, net: &Net) -> f64 {
        let mut ahead = self.lanes_ahead(net);
        let next = ahead.find(|(lane, _)| net.lanes[*lane].junction.is_some());
        next.map_or(f64::INFINITY, |(_, start)| start - self.half_length_m())
    }

    /// The wished speed here without traffic, m/s.
    pub(crate) fn driver_speed(&self, net: &Net) -> f64 {
        self.lane_speed(net, self.route[0]).min(net.curve_speed(self.route[0], self.along_m)).max(0.1)
    }

    /// From the front to the place to stop at the end of a road that leads nowhere, metres, where one is in view.
    pub(crate) fn end_of_road_m(&self, net: &Net) -> Option<f64> {
        let leads_on = self.route.back().is_some_and(|l| !net.lanes[*l].next.is_empty());
        let end = self.lanes_ahead(net).last().map_or(0.0, |(lane, start)| start + net.lanes[lane].usable_m);
        (!leads_on).then_some(end - self.half_length_m() - ROAD_END_M)
    }

    /// The wished speed here: limits and curves, ahead too.
    pub(crate) fn wished_speed(&self, net: &Net) -> f64 {
        let mut wished = f64::INFINITY;
        let view = self.view_m();
        for (lane, start) in self.lanes_ahead(net) {
            if start > view {
                break;
            }
            let (limit, curve) = if start <= 0.0 {
                (self.lane_speed(net, lane), net.curve_speed(lane, self.along_m))
            } else {
                let before = start - self.half_length_m();
                (
                    envelope(self.lane_speed(net, lane), before, PLANNED_BRAKING),
                    envelope(net.lanes[lane].curve_mps[0], before, PLANNED_BRAKING),
                )
            };
            wished = wished.min(limit).min(curve);
        }
        wished.max(0.1)
    }
}

/// The acceleration a driver wishes for, given what it makes of the junction ahead and the gaps to the bend it must wait
/// before and to where it would touch a walker.
pub(crate) fn wished_acceleration(
    net: &Net,
    occupancy: &Occupancy,
    vehicles: &[Vehicle],
    me: usize,
    approach: &Approach,
    [bend_m, touching_m]: [Option<f64>; 2],
) -> f64 {
    let vehicle = &vehicles[me];
    let idm = vehicle.driver.idm;
    let speed = vehicle.speed_mps;
    let sight = |class: Class| vehicle.attention.sight(class);
    let (of_vehicles, of_walkers) = (sight(Class::Vehicles), sight(Class::Walkers));
    let of_line = approach.line.map_or(Sight::Sees, |(_, class)| sight(class));
    let lane_mps = vehicle.wished_speed(net);
    let wished = lane_mps.min(approach.cap_mps).max(0.1);
    // With all that it sees, and without what it overlooks for the moment.
    let mut seen = idm.free(speed, wished);
    let mut careless = if of_line == Sight::Blinks { idm.free(speed, lane_mps.max(0.1)) } else { seen };
    let mut heed = |sight: Sight, wish: f64| {
        if sight != Sight::Away {
            seen = seen.min(wish);
        }
        if sight == Sight::Sees {
            careless = careless.min(wish);
        }
    };
    let leader = (of_vehicles != Sight::Away).then(|| occupancy.leader(net, vehicles, me)).flatten();
    if let Some(leader) = leader {
        heed(of_vehicles, idm.following(speed, wished, leader.gap_m, leader.speed_mps));
        if is_stranded(vehicles, leader.vehicle) {
            // As before a line: who only keeps a large gap comes nearer than that when it brakes late.
            let soonest_m = speed * speed / (2.0 * FIRM_BRAKING);
            let room_m = leader.gap_m - room_to_pull_out_m(vehicle.model.size_m[0]);
            let idm = Idm { standstill_gap_m: LINE_GAP_M, ..idm };
            let to_m = room_m.max(soonest_m.min(leader.gap_m));
            heed(of_vehicles, idm.following(speed, wished, to_m, 0.0));
        }
    }
    if let Some(leader) = occupancy.asking(net, vehicles, me) {
        let yielding = idm.following(speed, wished, leader.gap_m, leader.speed_mps);
        if yielding > -COMFORT_BRAKING {
            heed(of_vehicles, yielding);
        }
    }
    if let Some((gap, ahead)) = vehicle.passed_gap(vehicles) {
        let idm = Idm { standstill_gap_m: PASSED_GAP_M, headway_s: 0.3, ..idm };
        heed(of_vehicles, idm.following(speed, wished, gap, ahead));
    }
    if let Some(gap) = occupancy.walker_gap(net, vehicle) {
        let idm = Idm { standstill_gap_m: WALKER_GAP_M, ..idm };
        heed(of_walkers, idm.following(speed, wished, gap, 0.0));
    }
    if let Some(gap) = touching_m {
        let idm = Idm { standstill_gap_m: TOUCHING_GAP_M, headway_s: 0.3, ..idm };
        heed(of_walkers, idm.following(speed, wished, gap, 0.0));
    }
    if let Some(first) = approach.merging {
        heed(of_vehicles, first.answer(&idm, speed, wished));
    }
    let ends = [
        // Without leave even those stop there who look away: the way is not free.
        (approach.line.map(|(gap, _)| gap), if of_line == Sight::Away { Sight::Sees } else { of_line }),
        (approach.stop_gap_m, of_vehicles),
        (bend_m, of_vehicles),
        (vehicle.end_of_road_m(net), Sight::Sees),
    ];
    for (gap, sight) in ends {
        let idm = Idm { standstill_gap_m: LINE_GAP_M, headway_s: 0.6, ..idm };
        if let Some(gap) = gap {
            heed(sight, idm.following(speed, wished, gap, 0.0));
        }
    }
    if seen < -COMFORT_BRAKING { seen } else { careless }
}

impl Vehicle {
    /// Gap to the vehicle in the old lane while a lane change has not led out of its way, and its speed.
    fn passed_gap(&self, vehicles: &[Vehicle]) -> Option<(f64, f64)> {
        let other = vehicles.get(self.shift.as_ref().filter(|s| !s.is_out())?.passed?)?;
        let (sin, cos) = frames::math::sin_cos(self.yaw_rad);
        let away = other.place.point - self.place.point;
        let (ahead, left) = (away.x * cos + away.y * sin, away.y * cos - away.x * sin);
        // The other one is askew seen from here: its ends reach farther across.
        let (askew, straight) = frames::math::sin_cos(other.yaw_rad - self.yaw_rad);
        let [length, width, _] = other.model.size_m;
        let across = width * straight.abs() + length * askew.abs();
        // Slowly one passes more closely.
        let spare = (0.1 + PASSED_ASIDE_S * self.speed_mps).min(PASSED_ASIDE_M);
        let free = 0.5 * (self.model.size_m[1] + across) + spare;
        let gap = ahead - self.half_length_m() - other.half_length_m();
        // By the time it is there it is farther over.
        let over = self.offset_after(gap.max(0.0))[0] - self.offset_after(0.0)[0];
        let aside = (left - over).abs();
        (aside < free && ahead > 0.0).then_some((gap, other.speed_mps))
    }
}
