//! Coming to a junction: the line before it, what the light forbids, and how fast to come.

use crate::car_following::{braking_to_stop, envelope};
use crate::junction::conflict::MergeLeader;
use crate::road::net::{Lane, Net, PLANNED_BRAKING};
use crate::vehicle::Vehicle;
use crate::vehicle::attention::Class;
use schema::SignalState;

/// Drivers stop at yellow if this braking is enough, m/s2.
const YELLOW_BRAKING: f64 = 3.5;
/// Drivers stop at red if it is at all possible, m/s2.
const RED_BRAKING: f64 = 7.5;
/// Speed towards traffic lights and towards signs, m/s.
const LIGHT_MPS: f64 = 15.0 / 3.6;
const SIGN_MPS: f64 = 10.0 / 3.6;
/// The slow-down begins at this many seconds of the wished speed.
const SLOWDOWN_S: f64 = 3.5;

/// The next line that a vehicle has no leave to pass.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// From the front bumper, metres.
    pub(crate) gap_m: f64,
    /// First lane behind the line.
    pub(crate) entry: usize,
    /// Position of `entry` in the route.
    pub(crate) position: usize,
}

/// What a driver makes of the line ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Approach {
    /// Gap to the place to stop before the line, if it must not be passed, metres, and what the driver has to
    /// see there.
    pub(crate) line: Option<(f64, Class)>,
    /// Gap to the place to stop inside, metres.
    pub(crate) stop_gap_m: Option<f64>,
    /// The one that goes first where ways merge.
    pub(crate) merging: Option<MergeLeader>,
    /// Highest speed here for the line's sake, m/s.
    pub(crate) cap_mps: f64,
}

/// Nothing to mind.
pub(crate) const OPEN: Approach =
    Approach { line: None, stop_gap_m: None, merging: None, cap_mps: f64::INFINITY };

/// What a driver has to see at a line.
pub(crate) fn class_of(entry: &Lane) -> Class {
    if entry.signals.is_empty() { Class::Signs } else { Class::Lights }
}

impl Vehicle {
    /// The next line ahead that the front has not passed, whether or not there is leave to pass it.
    pub(crate) fn next_entry(&self, net: &Net) -> Option<(usize, f64)> {
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
            if enters && !same && self.claim().of_lane(lane).is_none() {
                return Some(Line { gap_m: start - self.half_length_m(), entry: lane, position });
            }
            before = Some(lane);
        }
        None
    }
}

/// Whether a light keeps a driver before its line: not where the line is passed or stopping is impossible.
pub(crate) fn forbids(light: SignalState, speed_mps: f64, gap_m: f64) -> bool {
    let braking = braking_to_stop(speed_mps, gap_m);
    let can_stop = match light {
        SignalState::Red => braking < RED_BRAKING || speed_mps < 1.0,
        SignalState::Yellow => braking < YELLOW_BRAKING || speed_mps < 1.0,
        SignalState::Green | SignalState::Off => false,
    };
    can_stop && gap_m > -0.2
}

/// Drivers slow down towards lights of any colour and towards stop and yield signs; and never so fast that
/// neither stopping nor passing within the yellow time is possible.
pub(crate) fn slow_down(vehicle: &Vehicle, net: &Net, unsignalised: bool, signed: bool, gap_m: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// At 10 m/s braking by a m/s2 takes 50 / a metres.
    #[test]
    fn a_light_holds_whoever_can_brake_as_hard_as_it_asks_for() {
        let holds = |light, metres_per_s2: f64| forbids(light, 10.0, 50.0 / metres_per_s2);
        assert!(holds(SignalState::Yellow, 3.4) && !holds(SignalState::Yellow, 3.6));
        assert!(holds(SignalState::Red, 7.4) && !holds(SignalState::Red, 7.6));
        assert!(!holds(SignalState::Green, 0.1) && !holds(SignalState::Off, 0.1));
        // Whoever hardly moves stops, however near the line is; past the line nothing holds.
        assert!(forbids(SignalState::Yellow, 0.9, 0.0) && !forbids(SignalState::Red, 0.9, -0.3));
    }
}
