//! Two vehicles whose ways through a junction meet: who is first, who waits where, and which gaps are long enough.

use crate::driver::braking_to_stop;
use crate::junction::Held;
use crate::net::{Conflict, Lane, Net};
use crate::vehicles::Vehicle;

/// Lanes with no smaller radius than this are straight for long vehicles, metres.
const STRAIGHT_M: f64 = 60.0;
/// Vehicles longer than this need room in turns, metres.
const LONG_M: f64 = 5.2;
/// Free space between two vehicles that pass each other, metres.
const ASIDE_M: f64 = 0.4;
/// The rear of the first one is this far beyond the place before the second one comes, metres.
const BEHIND_M: f64 = 1.0;
/// Drivers who let others pass inside a junction stop this far before the place, metres.
const BEFORE_M: f64 = 1.0;
/// Places that begin within this distance of a line are waited for before it, metres.
const AT_LINE_M: f64 = 0.5;
/// Who is slower than this may stand for long: nobody sets off in the hope that it clears the way, m/s.
const MOVING_MPS: f64 = 1.0;
/// Who goes first is gone this long before the other one comes, seconds.
const FIRST_GAP_S: f64 = 1.0;
/// Who goes second may count on so much, seconds: it waits before the place if it is too early.
const SECOND_SLACK_S: f64 = 0.3;
/// Braking that drivers accept to go second and impose on those who go second behind them, m/s2.
const OWN_BRAKING: f64 = 2.0;
const IMPOSED_BRAKING: f64 = 1.2;
/// Drivers brake before a place that will not be free in time from here, and in any case from here, m/s2.
const EARLY_BRAKING: f64 = 1.2;
const LATE_BRAKING: f64 = 2.5;
/// Shares of a driver's acceleration that others count on who need it to be gone, and to be away still.
const SLOW_SHARE: f64 = 0.4;
const FAST_SHARE: f64 = 1.0;

/// Half the width of the strip that a vehicle sweeps on a lane, metres: long ones swing out and cut corners.
fn swept_half_width(vehicle: &Vehicle, lane: &Lane) -> f64 {
    let [length, width, _] = vehicle.model.size_m;
    let swing = if lane.radius_m > STRAIGHT_M {
        0.0
    } else if length > LONG_M {
        0.15 * length
    } else {
        0.2
    };
    0.5 * width + swing
}

/// The way of one of two vehicles through the place where they meet, metres from where it is now.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// From the front to the beginning, and from the rear to the end.
    to_begin_m: f64,
    to_end_m: f64,
    /// From the middle to the lane's end.
    to_lane_end_m: f64,
}

impl Part {
    fn new(net: &Net, vehicle: &Vehicle, lane: usize, start_m: f64, zone_m: [f64; 2]) -> Self {
        let (from_m, half) = (start_m - vehicle.odometer_m, vehicle.half_length_m());
        // What is too near from the first metre on may be so before.
        let before_m = if zone_m[0] < AT_LINE_M { net.lanes[lane].line_gap_m } else { 0.0 };
        Self {
            to_begin_m: from_m + zone_m[0] - before_m - half,
            to_end_m: from_m + zone_m[1] + half + BEHIND_M,
            to_lane_end_m: from_m + net.lanes[lane].way.length_m,
        }
    }

    fn is_in(&self) -> bool {
        self.to_begin_m < 0.0 && self.to_end_m > 0.0
    }
}

/// A place where the ways of two vehicles meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting<'a> {
    net: &'a Net,
    lane: usize,
    me: &'a Vehicle,
    rival: &'a Vehicle,
    mine: Part,
    theirs: Part,
    /// Between the bumpers of the rival's rear and the own front, if both were on one lane; for ways that merge.
    gap_m: f64,
    merges: bool,
}

/// What a driver does about a rival who goes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wait {
    /// Stops within so many metres.
    Stop(f64),
    /// Follows at a gap, metres, something that moves so fast, m/s.
    Follow(f64, f64),
}

impl<'a> Meeting<'a> {
    /// Where a vehicle that is to be on a lane from `start_m` of its odometer on meets one that holds another lane; None
    /// where nobody has to mind the other.
    pub(crate) fn new(
        net: &'a Net,
        (me, lane, start_m): (&'a Vehicle, usize, f64),
        conflict: &Conflict,
        (rival, held): (&'a Vehicle, &Held),
    ) -> Option<Self> {
        let together_m = swept_half_width(me, &net.lanes[lane])
            + swept_half_width(rival, &net.lanes[conflict.other])
            + ASIDE_M;
        let zone = conflict.zone(together_m)?;
        let mine = Part::new(net, me, lane, start_m, zone.own_m);
        let theirs = Part::new(net, rival, conflict.other, held.start_m, zone.other_m);
        // One who follows on a lane that both are on waits behind.
        let follows = rival.held.iter().any(|h| {
            let here = me.held.iter().find(|own| own.lane == h.lane);
            here.is_some_and(|own| me.odometer_m - own.start_m > (rival.odometer_m - h.start_m).max(0.0))
        });
        let over = rival.crashed || theirs.to_end_m < 0.0 || mine.to_end_m < 0.0 || follows;
        let gap_m = mine.to_lane_end_m - theirs.to_lane_end_m - me.half_length_m() - rival.half_length_m();
        (!over).then_some(Self { net, lane, me, rival, mine, theirs, gap_m, merges: conflict.merges })
    }

    /// Whether the rival goes first, who got its leave `earlier` or did not: what is in the place already is.
    pub(crate) fn rival_first(&self, earlier: bool) -> bool {
        match (self.mine.is_in(), self.theirs.is_in()) {
            (true, true) => self.merges && self.gap_m > -self.me.half_length_m(),
            (true, false) => false,
            (false, true) => true,
            (false, false) => earlier,
        }
    }

    /// Whether the rival is in the place.
    pub(crate) fn is_rival_in(&self) -> bool {
        self.theirs.is_in()
    }

    /// What to do, if anything, while the rival goes first.
    pub(crate) fn wait(&self) -> Option<Wait> {
        if self.merges {
            // Room is made until the ways are one.
            return Some(Wait::Follow(self.gap_m.max(self.mine.to_begin_m), self.rival.speed_mps));
        }
        let (speed, gap_m) = (self.me.speed_mps, self.mine.to_begin_m - BEFORE_M);
        if self.mine.to_begin_m < 0.0 {
            return None;
        }
        let braking = braking_to_stop(speed, gap_m);
        let early = self.rival_gone_s() > self.arrives_s(self.me, self.mine.to_begin_m);
        (braking > LATE_BRAKING || early && (braking > EARLY_BRAKING || speed < MOVING_MPS))
            .then_some(Wait::Stop(gap_m))
    }

    /// Whether a driver may set off behind the rival, which goes first.
    pub(crate) fn is_gap_behind(&self) -> bool {
        if self.rival.speed_mps < MOVING_MPS {
            return false;
        }
        if self.merges {
            return self.following(self.me, self.rival, self.mine.to_begin_m) > -OWN_BRAKING;
        }
        let arrives_s = self.arrives_s(self.me, self.mine.to_begin_m);
        arrives_s > self.rival_gone_s() - SECOND_SLACK_S
            && braking_to_stop(self.me.speed_mps, self.mine.to_begin_m - BEFORE_M) < OWN_BRAKING
    }

    /// Whether a driver may go before the rival, which then need not brake for it, or a little where the ways merge.
    pub(crate) fn is_gap_before(&self) -> bool {
        if self.merges {
            let gap_m = self.theirs.to_lane_end_m
                - self.mine.to_lane_end_m
                - self.me.half_length_m()
                - self.rival.half_length_m();
            return gap_m > 0.0 && self.following(self.rival, self.me, gap_m) > -IMPOSED_BRAKING;
        }
        self.gone_s(self.me, self.mine.to_end_m) + FIRST_GAP_S
            < self.arrives_s(self.rival, self.theirs.to_begin_m)
    }

    /// Acceleration with which one follows the other one, as on one lane.
    fn following(&self, who: &Vehicle, ahead: &Vehicle, to_begin_m: f64) -> f64 {
        let gap_m = if std::ptr::eq(who, self.me) { self.gap_m.max(to_begin_m) } else { to_begin_m };
        who.driver.idm.following(
            who.speed_mps,
            who.driver_speed(self.net).max(who.speed_mps),
            gap_m,
            ahead.speed_mps,
        )
    }

    fn rival_gone_s(&self) -> f64 {
        self.gone_s(self.rival, self.theirs.to_end_m)
    }

    /// At the latest, if nothing holds it up, a vehicle has gone so far.
    fn gone_s(&self, who: &Vehicle, way_m: f64) -> f64 {
        let bends = self.net.lanes[self.lane].curve_mps[0];
        let top = who.driver_speed(self.net).min(bends).max(who.speed_mps.min(bends)).max(MOVING_MPS);
        time_s(way_m, who.speed_mps.min(top), SLOW_SHARE * who.driver.idm.acceleration, top)
    }

    /// At the earliest a vehicle has gone so far.
    fn arrives_s(&self, who: &Vehicle, way_m: f64) -> f64 {
        let top = who.wished_speed(self.net).max(who.speed_mps);
        time_s(way_m, who.speed_mps, FAST_SHARE * who.driver.idm.acceleration, top)
    }
}

/// The time for a way with an even acceleration up to a top speed, seconds.
fn time_s(way_m: f64, speed_mps: f64, acceleration: f64, top_mps: f64) -> f64 {
    let way_m = way_m.max(0.0);
    let gaining_m = (top_mps * top_mps - speed_mps * speed_mps).max(0.0) / (2.0 * acceleration);
    if way_m <= gaining_m {
        ((speed_mps * speed_mps + 2.0 * acceleration * way_m).sqrt() - speed_mps) / acceleration
    } else {
        let top = top_mps.max(speed_mps);
        (top - speed_mps) / acceleration + (way_m - gaining_m) / top
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn times_are_those_of_small_steps(way in 0.0..80.0f64, speed in 0.0..20.0f64, more in 0.0..10.0f64, a in 0.4..3.0f64) {
            let top = speed.max(1.0) + more;
            let (mut v, mut gone, mut steps) = (speed, 0.0, 0u32);
            while gone < way && steps < 1_000_000 {
                let next: f64 = (v + 0.001 * a).min(top);
                gone += 0.0005 * (v + next);
                v = next;
                steps += 1;
            }
            let expected = 0.001 * f64::from(steps);
            prop_assert!((time_s(way, speed, a, top) - expected).abs() < 0.01, "{} {expected}", time_s(way, speed, a, top));
        }
    }
}
