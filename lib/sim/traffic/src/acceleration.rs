//! The acceleration that a driver wishes for: behind leaders, before lines and walkers, beside those who are
//! passed.

use crate::car_following::{COMFORT_BRAKING, Idm, braking_to_stop};
use crate::junction::approach::Approach;
use crate::lane_change::room_to_pull_out_m;
use crate::occupancy::{Occupancy, is_stranded};
use crate::road::net::Net;
use crate::swept_path::Gaps;
use crate::vehicle::Vehicle;
use crate::vehicle::attention::{Class, Sight};
use schema::FRAME_PERIOD_S;

/// Gap to a walker on the road, metres.
const WALKER_GAP_M: f64 = 2.0;
/// Way left before a walker would be touched by any part of the vehicle, metres.
const TOUCHING_GAP_M: f64 = 0.6;
/// Gap to the place before a line where drivers come to rest, metres.
const LINE_GAP_M: f64 = 0.2;
/// Braking for a place to pull out behind a wreck, m/s2: a vehicle that needs more stops nearer to it.
const FIRM_BRAKING: f64 = 4.0;
/// Braking for a bend ahead, m/s2, of those who see it too late to brake as planned.
const BEND_BRAKING: f64 = 3.5;
/// Drivers brake before a place to stop at by so many times what is needed.
const NEEDED: f64 = 1.2;
/// Time gap that drivers keep there, seconds.
const LINE_HEADWAY_S: f64 = 0.6;
/// Gap to the rear of a vehicle that is being passed, metres, and free space beside it.
const PASSED_GAP_M: f64 = 0.5;
const PASSED_ASIDE_M: f64 = 0.3;
/// At walking speed it is less: metres more per m/s.
const PASSED_ASIDE_S: f64 = 0.05;

/// The least of all accelerations that a driver has reasons for, m/s2.
struct DesiredAcceleration {
    /// With all that it sees, and without what it overlooks for the moment.
    seen: f64,
    careless: f64,
}

impl DesiredAcceleration {
    /// Takes in a reason, as the driver sees it.
    fn limit(&mut self, sight: Sight, acceleration_mps2: f64) {
        if sight != Sight::Away {
            self.seen = self.seen.min(acceleration_mps2);
        }
        if sight == Sight::Sees {
            self.careless = self.careless.min(acceleration_mps2);
        }
    }

    /// Hard braking is asked for by what nobody overlooks.
    fn acceleration_mps2(&self) -> f64 {
        if self.seen < -COMFORT_BRAKING { self.seen } else { self.careless }
    }
}

/// How a driver comes to rest before a line.
pub(crate) fn before_line(idm: &Idm) -> Idm {
    Idm { standstill_gap_m: LINE_GAP_M, headway_s: LINE_HEADWAY_S, ..*idm }
}

/// A driver with its wished speed on the way to the next line, m/s.
struct Follower<'a> {
    net: &'a Net,
    occupancy: &'a Occupancy,
    vehicles: &'a [Vehicle],
    me: usize,
    idm: Idm,
    speed: f64,
    wished: f64,
}

impl Follower<'_> {
    fn vehicle(&self) -> &Vehicle {
        &self.vehicles[self.me]
    }

    /// The wish behind something at a gap that moves at a speed, with a gap at rest and a time gap of its
    /// own.
    fn following(&self, gap_m: f64, ahead_mps: f64, standstill_gap_m: f64, headway_s: f64) -> f64 {
        let idm = Idm { standstill_gap_m, headway_s, ..self.idm };
        idm.following(self.speed, self.wished, gap_m, ahead_mps)
    }

    /// The wish before a place to stop at. The model brakes the harder the later it knows of it, up to three
    /// times as hard as there is need for: drivers do so by a fifth.
    fn stopping(&self, gap_m: f64) -> f64 {
        let needed = NEEDED * braking_to_stop(self.speed, gap_m - 0.5 * self.speed * FRAME_PERIOD_S);
        let wish = before_line(&self.idm).following(self.speed, self.wished, gap_m, 0.0);
        wish.max(-needed.max(COMFORT_BRAKING))
    }

    /// Before other vehicles on the own lane, on the way to it, or beside while they are passed.
    fn vehicles(&self, sight: Sight, wish: &mut DesiredAcceleration) {
        let (net, vehicle, idm) = (self.net, self.vehicle(), self.idm);
        let (speed, wished) = (self.speed, self.wished);
        if let Some(leader) = self.occupancy.leader(net, self.vehicles, self.me) {
            let sight = vehicle.driver().sight(leader.class);
            wish.limit(sight, idm.following(speed, wished, leader.gap_m, leader.speed_mps));
            if is_stranded(self.vehicles, leader.vehicle) {
                // As before a line: a vehicle that keeps a large gap comes nearer than that when it brakes
                // late.
                let soonest_m = speed * speed / (2.0 * FIRM_BRAKING);
                let room_m = leader.gap_m - room_to_pull_out_m(vehicle.length_m());
                let to_m = room_m.max(soonest_m.min(leader.gap_m));
                wish.limit(sight, self.following(to_m, 0.0, LINE_GAP_M, idm.headway_s));
            }
        }
        if let Some(leader) = self.occupancy.asking(net, self.vehicles, self.me) {
            let yielding = idm.following(speed, wished, leader.gap_m, leader.speed_mps);
            if yielding > -COMFORT_BRAKING {
                wish.limit(sight, yielding);
            }
        }
        if let Some((gap, ahead)) = passed_gap(vehicle, self.vehicles) {
            wish.limit(sight, self.following(gap, ahead, PASSED_GAP_M, 0.3));
        }
    }

    /// Before walkers who cross the lane.
    fn walkers(&self, sight: Sight, wish: &mut DesiredAcceleration) {
        if let Some(gap) = self.occupancy.walker_gap(self.net, self.vehicle()) {
            wish.limit(sight, self.following(gap, 0.0, WALKER_GAP_M, self.idm.headway_s));
        }
    }

    /// Before anybody and anything that the body would touch.
    fn touching(&self, gaps_m: &Gaps, wish: &mut DesiredAcceleration) {
        for (class, gap_m) in Class::ALL.into_iter().zip(gaps_m) {
            if let Some(gap_m) = *gap_m {
                let sight = self.vehicle().driver().sight(class);
                wish.limit(sight, self.following(gap_m, 0.0, TOUCHING_GAP_M, 0.3));
            }
        }
    }
}

/// The acceleration a driver wishes for, given what it makes of the junction ahead and the gaps to the bend
/// it must wait before and to where it would touch somebody or something.
pub(crate) fn wished_acceleration(
    net: &Net,
    occupancy: &Occupancy,
    vehicles: &[Vehicle],
    me: usize,
    approach: &Approach,
    bend_m: Option<f64>,
    touching_m: &Gaps,
) -> f64 {
    let vehicle = &vehicles[me];
    let idm = vehicle.driver().idm();
    let speed = vehicle.speed_mps();
    let sight = |class: Class| vehicle.driver().sight(class);
    let (of_vehicles, of_walkers) = (sight(Class::Vehicles), sight(Class::Walkers));
    let of_line = approach.line.map_or(Sight::Sees, |(_, class)| sight(class));
    let [limit_mps, bend_mps] = vehicle.wished_speeds(net);
    let lane_mps = limit_mps.min(bend_mps).max(0.1);
    let wished = lane_mps.min(approach.cap_mps).max(0.1);
    let seen = idm.free(speed, wished);
    let careless = if of_line == Sight::Blinks { idm.free(speed, lane_mps.max(0.1)) } else { seen };
    let mut wish = DesiredAcceleration { seen, careless };
    // The model alone would still be too fast when the bend or the lower limit begins.
    for (most_mps, braking) in [(bend_mps, BEND_BRAKING), (limit_mps, COMFORT_BRAKING)] {
        wish.limit(Sight::Sees, ((most_mps - speed) / FRAME_PERIOD_S).max(-braking));
    }
    let behind = Follower { net, occupancy, vehicles, me, idm, speed, wished };
    behind.vehicles(of_vehicles, &mut wish);
    behind.walkers(of_walkers, &mut wish);
    behind.touching(touching_m, &mut wish);
    if let Some(first) = approach.merging {
        wish.limit(of_vehicles, first.answer(&idm, speed, wished));
    }
    let ends = [
        // Without a reservation even drivers who look away stop there: the way is not free.
        (approach.line.map(|(gap, _)| gap), if of_line == Sight::Away { Sight::Sees } else { of_line }),
        (approach.stop_gap_m, of_vehicles),
        (bend_m, of_vehicles),
        (vehicle.end_of_road_m(net), Sight::Sees),
    ];
    for (gap, sight) in ends {
        if let Some(gap) = gap {
            wish.limit(sight, behind.stopping(gap));
        }
    }
    wish.acceleration_mps2()
}

/// Gap to the vehicle in the old lane while a lane change has not led out of its way, and its speed.
fn passed_gap(vehicle: &Vehicle, vehicles: &[Vehicle]) -> Option<(f64, f64)> {
    let other = vehicles.get(vehicle.lateral().change()?.passing()?)?;
    let yaw_rad = vehicle.motion().yaw_rad();
    let (sin, cos) = frames::math::sin_cos(yaw_rad);
    let gaps_m = other.sections().filter_map(|(at, other_yaw_rad, [length, width, _])| {
        let away = at - vehicle.motion().position();
        let (ahead, left) = (away.x * cos + away.y * sin, away.y * cos - away.x * sin);
        // The other one is askew seen from here: its ends reach farther across.
        let (askew, straight) = frames::math::sin_cos(other_yaw_rad - yaw_rad);
        let across = width * straight.abs() + length * askew.abs();
        // Slowly one passes more closely.
        let clearance = (0.1 + PASSED_ASIDE_S * vehicle.speed_mps()).min(PASSED_ASIDE_M);
        let free = 0.5 * (vehicle.model().size_m[1] + across) + clearance;
        let gap = ahead - vehicle.half_length_m() - 0.5 * length;
        // By the time it is there it is farther over.
        let over = vehicle.lateral().offset_after(gap.max(0.0))[0] - vehicle.lateral().offset_after(0.0)[0];
        let aside = (left - over).abs();
        (aside < free && ahead > 0.0).then_some(gap)
    });
    gaps_m.reduce(f64::min).map(|gap| (gap, other.speed_mps()))
}
