//! Two vehicles whose ways through a junction meet: which goes first, where the other one waits, and which
//! gaps are long enough.

use crate::car_following::{Idm, braking_to_stop, time_s};
use crate::road::net::{ConflictArea, Lane, Net};
use crate::vehicle::Vehicle;
use crate::vehicle::claim::Reservation;

/// Free space between two vehicles that pass each other, metres.
const ASIDE_M: f64 = 0.4;
/// The rear of the first one is this far beyond the place before the second one comes, metres.
const BEHIND_M: f64 = 1.0;
/// Drivers who let others pass inside a junction stop this far before the place, metres.
const BEFORE_M: f64 = 1.0;
/// Places that begin within this distance of a line are waited for before it, metres.
const AT_LINE_M: f64 = 0.5;
/// Standing vehicles are passed with this much room, metres.
const CLEAR_M: f64 = 0.3;
/// A vehicle slower than this may stand for long: no driver sets off in the hope that it clears the way, m/s.
const MOVING_MPS: f64 = 1.0;
/// The first vehicle is gone this long before the other one comes, seconds.
const FIRST_GAP_S: f64 = 1.0;
/// The second vehicle may count on this much, seconds: it waits before the place if it is too early.
const SECOND_EARLY_S: f64 = 0.3;
/// Braking that drivers accept to go second and impose on those who go second behind them, m/s2.
const OWN_BRAKING: f64 = 2.0;
const IMPOSED_BRAKING: f64 = 1.2;
/// Drivers brake before a place that will not be free in time from here, and in any case from here, m/s2.
const EARLY_BRAKING: f64 = 1.2;
const LATE_BRAKING: f64 = 2.5;
/// Braking with which drivers fall behind one beside them whom they let go ahead where their ways merge,
/// m/s2.
const FALL_BACK_BRAKING: f64 = 1.2;
/// Gap behind one who goes first that is enough where ways merge, metres.
const MERGE_GAP_M: f64 = 2.0;
/// Shares of a driver's acceleration that others count on: those who need it to be gone, and those who need
/// it to be away still.
const SLOW_SHARE: f64 = 0.4;
const FAST_SHARE: f64 = 1.0;

/// Half the width of the strip that a vehicle sweeps on a lane, metres: its front corners swing out, and what
/// it tows cuts in.
fn swept_half_width(vehicle: &Vehicle, lane: &Lane) -> f64 {
    let [inwards_m, outwards_m] = vehicle.reaches_m(lane.swing_radius_m);
    if vehicle.towed().is_some() { outwards_m.max(inwards_m) } else { outwards_m }
}

/// The way of one of two vehicles through the place where they meet, metres from where it is now.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// From the front to the beginning, and from the rear to the end.
    to_begin_m: f64,
    to_end_m: f64,
    /// From the middle to the lane's end.
    to_lane_end_m: f64,
}

impl Crossing {
    fn new(net: &Net, vehicle: &Vehicle, lane: usize, start_m: f64, zone_m: [f64; 2]) -> Self {
        let (from_m, half) = (start_m - vehicle.route().odometer_m(), vehicle.half_length_m());
        // What is too near from the first metre on may be so before.
        let before_m = if zone_m[0] < AT_LINE_M { net.lanes[lane].line_gap_m } else { 0.0 };
        Self {
            to_begin_m: from_m + zone_m[0] - before_m - half,
            to_end_m: from_m + zone_m[1] + vehicle.rear_m() + BEHIND_M,
            to_lane_end_m: from_m + net.lanes[lane].centre.length_m,
        }
    }

    fn is_in(&self) -> bool {
        self.to_begin_m < 0.0 && self.to_end_m > 0.0
    }
}

/// A place where the ways of two vehicles meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conflict<'a> {
    net: &'a Net,
    lane: usize,
    me: &'a Vehicle,
    rival: &'a Vehicle,
    mine: Crossing,
    theirs: Crossing,
    /// Between the bumpers of the rival's rear and the own front, if both were on one lane; for ways that
    /// merge.
    gap_m: f64,
    merges: bool,
}

/// What a driver does about a rival who goes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Yielding {
    /// Stops within so many metres.
    Stop(f64),
    /// Lets one go ahead where the ways merge.
    MergeBehind(MergeLeader),
}

/// One who goes first where ways merge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MergeLeader {
    /// Between its rear bumper and the own front, as if both were on one lane already, metres; negative
    /// beside each other.
    pub(crate) gap_m: f64,
    /// From the own front to where the ways come too near each other, metres.
    pub(crate) to_begin_m: f64,
    pub(crate) speed_mps: f64,
}

impl MergeLeader {
    /// Acceleration with which a driver falls behind in time: braking a little from the beginning, and as
    /// hard as for a leader only for one who is there.
    pub(crate) fn answer(&self, idm: &Idm, speed_mps: f64, wished_mps: f64) -> f64 {
        let behind = |gap_m: f64| idm.following(speed_mps, wished_mps, gap_m, self.speed_mps);
        let there = behind(self.gap_m.max(self.to_begin_m));
        // A standing vehicle may stand for long: the driver goes as far as possible.
        if self.speed_mps < MOVING_MPS {
            there
        } else {
            there.min(behind(self.gap_m).max(-FALL_BACK_BRAKING))
        }
    }
}

impl<'a> Conflict<'a> {
    /// Where a vehicle that is to be on a lane from `start_m` of its odometer on meets one that holds another
    /// lane; None where nobody has to mind the other.
    pub(crate) fn new(
        net: &'a Net,
        (me, lane, start_m): (&'a Vehicle, usize, f64),
        area: &ConflictArea,
        (rival, held): (&'a Vehicle, &Reservation),
    ) -> Option<Self> {
        let together_m = swept_half_width(me, &net.lanes[lane])
            + swept_half_width(rival, &net.lanes[area.other])
            + ASIDE_M;
        let zone = area.zone(together_m)?;
        let mine = Crossing::new(net, me, lane, start_m, zone.own_m);
        let theirs = Crossing::new(net, rival, area.other, held.start_m, zone.other_m);
        // One who follows on a lane that both are on, no later than here, waits behind. On a ring those ahead
        // come to the lanes of those behind them, too, at last.
        let mut before = rival.claim().reservations().iter().filter(|r| r.start_m <= held.start_m);
        let (mine_m, theirs_m) = (me.route().odometer_m(), rival.route().odometer_m());
        let follows = before.any(|r| {
            let here = me.claim().of_lane(r.lane);
            here.is_some_and(|own| mine_m - own.start_m > (theirs_m - r.start_m).max(0.0))
        });
        let over = rival.is_crashed() || theirs.to_end_m < 0.0 || mine.to_end_m < 0.0 || follows;
        let gap_m = mine.to_lane_end_m - theirs.to_lane_end_m - me.half_length_m() - rival.rear_m();
        (!over).then_some(Self { net, lane, me, rival, mine, theirs, gap_m, merges: area.merges })
    }

    /// Whether the rival goes first; `earlier`: its reservation is older: what is in the place already is.
    /// Where ways merge, those who are beside each other may both be: then the one goes first who is nearer
    /// to their common lane.
    pub(crate) fn rival_first(&self, earlier: bool) -> bool {
        let ahead_m = self.mine.to_lane_end_m - self.theirs.to_lane_end_m;
        match (self.mine.is_in(), self.theirs.is_in()) {
            (true, true) => self.merges && (ahead_m > 0.0 || ahead_m == 0.0 && earlier),
            (true, false) => self.merges && earlier && ahead_m > 0.0,
            (false, true) => !self.merges || earlier || ahead_m >= 0.0,
            (false, false) => earlier,
        }
    }

    /// Whether the rival is in the place.
    pub(crate) fn is_rival_in(&self) -> bool {
        self.theirs.is_in()
    }

    /// What to do, if anything, while the rival goes first.
    pub(crate) fn yielding(&self) -> Option<Yielding> {
        if self.merges {
            return Some(Yielding::MergeBehind(self.merge_leader()));
        }
        let (speed, gap_m) = (self.me.speed_mps(), self.mine.to_begin_m - BEFORE_M);
        if self.mine.to_begin_m < 0.0 || self.stands_clear() {
            return None;
        }
        let braking = braking_to_stop(speed, gap_m);
        let early = self.rival_gone_s() > self.arrives_s(self.me, self.mine.to_begin_m);
        (braking > LATE_BRAKING || early && (braking > EARLY_BRAKING || speed < MOVING_MPS))
            .then_some(Yielding::Stop(gap_m))
    }

    /// Whether the rival, on its way out of the place, stands so that it leaves room: as a vehicle that
    /// queues behind the junction with its rear still in it.
    fn stands_clear(&self) -> bool {
        let is_leaving = self.theirs.to_end_m < self.rival.rear_m() + BEHIND_M;
        if !is_leaving || !self.rival.stands() {
            return false;
        }
        let way = &self.net.lanes[self.lane].centre;
        let least_m = 0.5 * self.me.model().size_m[1] + CLEAR_M;
        let corners = self.rival.sections().flat_map(|(at, yaw_rad, [length, width, _])| {
            let (sin, cos) = frames::math::sin_cos(yaw_rad);
            [[0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [-0.5, 0.5]].map(|[u, v]| {
                let (ahead, left) = (u * length, v * width);
                let corner =
                    at + nalgebra::Vector3::new(ahead * cos - left * sin, ahead * sin + left * cos, 0.0);
                way.cross(corner, way.project(corner).0).1
            })
        });
        let corners: Vec<f64> = corners.collect();
        corners.iter().all(|left| *left > least_m) || corners.iter().all(|left| *left < -least_m)
    }

    /// Whether a driver may set off behind the rival, which goes first.
    pub(crate) fn accepts_gap_behind(&self) -> bool {
        if self.rival.speed_mps() < MOVING_MPS {
            return !self.merges && self.theirs.is_in() && self.stands_clear();
        }
        if self.merges {
            let (idm, speed) = (self.me.driver().idm(), self.me.speed_mps());
            let wished = self.me.speed_here(self.net).max(speed);
            return self.falls_behind() && self.merge_leader().answer(&idm, speed, wished) > -OWN_BRAKING;
        }
        let arrives_s = self.arrives_s(self.me, self.mine.to_begin_m);
        arrives_s > self.rival_gone_s() - SECOND_EARLY_S
            && braking_to_stop(self.me.speed_mps(), self.mine.to_begin_m - BEFORE_M) < OWN_BRAKING
    }

    /// Whether a driver may go before the rival, which then need not brake for it, or a little where the ways
    /// merge.
    pub(crate) fn accepts_gap_before(&self) -> bool {
        if self.merges {
            let gap_m = self.theirs.to_lane_end_m
                - self.mine.to_lane_end_m
                - self.me.rear_m()
                - self.rival.half_length_m();
            let (idm, speed) = (self.rival.driver().idm(), self.rival.speed_mps());
            let wished = self.rival.speed_here(self.net).max(speed);
            return gap_m > 0.0
                && idm.following(speed, wished, gap_m, self.me.speed_mps()) > -IMPOSED_BRAKING;
        }
        self.gone_s(self.me, self.mine.to_end_m) + FIRST_GAP_S
            < self.arrives_s(self.rival, self.theirs.to_begin_m)
    }

    fn merge_leader(&self) -> MergeLeader {
        MergeLeader { gap_m: self.gap_m, to_begin_m: self.mine.to_begin_m, speed_mps: self.rival.speed_mps() }
    }

    /// Whether the rival is far enough ahead, or will be with a little braking, when the own front comes to
    /// where the ways are too near each other.
    fn falls_behind(&self) -> bool {
        let idm = self.me.driver().idm();
        // What the rival has to go until its rear is a gap beyond that place.
        let missing_m = self.mine.to_begin_m.max(0.0) + idm.standstill_gap_m.min(MERGE_GAP_M) - self.gap_m;
        let time_s = self.gone_s(self.rival, missing_m);
        let speed = self.me.speed_mps();
        let braking_s = time_s.min(speed / FALL_BACK_BRAKING);
        speed * braking_s - 0.5 * FALL_BACK_BRAKING * braking_s * braking_s <= self.mine.to_begin_m.max(0.0)
            || missing_m <= 0.0
    }

    fn rival_gone_s(&self) -> f64 {
        self.gone_s(self.rival, self.theirs.to_end_m)
    }

    /// At the latest, if nothing holds it up, a vehicle has gone so far.
    fn gone_s(&self, who: &Vehicle, way_m: f64) -> f64 {
        let bends = self.net.lanes[self.lane].curve_mps[0];
        let top = who.speed_here(self.net).min(bends).max(who.speed_mps().min(bends)).max(MOVING_MPS);
        time_s(way_m, who.speed_mps().min(top), SLOW_SHARE * who.driver().idm().acceleration, top)
    }

    /// At the earliest a vehicle has gone so far.
    fn arrives_s(&self, who: &Vehicle, way_m: f64) -> f64 {
        let top = who.wished_speed(self.net).max(who.speed_mps());
        time_s(way_m, who.speed_mps(), FAST_SHARE * who.driver().idm().acceleration, top)
    }
}
