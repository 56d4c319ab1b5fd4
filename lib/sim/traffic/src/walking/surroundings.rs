//! What walkers see around them, and which gaps in the traffic they accept.

use crate::occupancy::{GIVEN, Occupancy};
use crate::road::net::Net;
use crate::road::signals::Signals;
use crate::swept_path::SweptPaths;
use crate::vehicle::Vehicle;
use crate::vehicle::attention::Class;
use crate::walking::fixtures::Fixtures;
use crate::walking::paths::{Crossing, Paths};
use crate::walking::routes::Routes;

/// Vehicles are looked for this far upstream, metres.
const LOOK_M: f64 = 60.0;

/// Where walkers walk, the objects there and what goes on there.
pub(crate) struct Surroundings<'a> {
    pub(crate) paths: &'a Paths,
    pub(crate) routes: &'a Routes,
    pub(crate) fixtures: &'a Fixtures,
    pub(crate) net: &'a Net,
    pub(crate) occupancy: &'a Occupancy,
    pub(crate) vehicles: &'a [Vehicle],
    pub(crate) sweeps: &'a SweptPaths,
    pub(crate) signals: &'a Signals,
    pub(crate) time_s: f64,
}

impl Surroundings<'_> {
    /// Whether the lights hold the traffic until a walker who needs this long is across.
    pub(crate) fn is_held(&self, crossing: &Crossing, needed_s: f64) -> bool {
        self.signals.hold(&crossing.signals, self.time_s, needed_s)
    }

    /// Whether the road is clear for so long, or if that is enough, whether everyone can stop.
    pub(crate) fn is_clear(&self, crossing: &Crossing, needed_s: f64, they_stop: bool) -> bool {
        crossing.lanes.iter().all(|&(lane, along, _)| {
            // Upstream, depth first: lane and the metres from its beginning to the crossing point.
            let mut open = vec![(lane, along)];
            while let Some((at, to)) = open.pop() {
                for there in self.occupancy.on_lane(at) {
                    let gap = to - there.along_m - there.half_length_m;
                    let speed = there.speed_mps;
                    let gone = gap < -2.0 * there.half_length_m - 0.8;
                    let standing = speed < 0.3;
                    let sees = |v: &Vehicle| !v.driver().is_away(Class::Walkers);
                    let stops = gap > 4.0 + 0.7 * speed + speed * speed / 4.0
                        && there.vehicle != GIVEN
                        && self.vehicles.get(there.vehicle).is_none_or(sees);
                    let far = gap > speed * needed_s + 3.0;
                    let clear = gone || far || (standing && gap > 1.5) || (they_stop && stops);
                    if !clear {
                        return false;
                    }
                }
                if to < LOOK_M && open.len() < 64 {
                    let lane = &self.net.lanes[at];
                    let length = |p: usize| self.net.lanes[p].centre.length_m;
                    open.extend(lane.previous.iter().map(|&p| (p, to + length(p))));
                }
            }
            true
        })
    }
}
