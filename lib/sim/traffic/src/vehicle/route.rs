//! The lanes that a vehicle is going to drive on, and where it is along them.

use std::collections::VecDeque;
use std::sync::Arc;

use random::Stream;

use crate::road::centreline::CentrelinePoint;
use crate::road::net::Net;
use crate::vehicle::given_route::GivenRoute;

/// Vehicles with few ways to choose from go straight on so many times as often as they turn.
const STRAIGHT_ON: f64 = 3.0;

/// A vehicle's way over the lane graph, drawn as far as it looks ahead.
#[derive(Debug)]
pub(crate) struct Route {
    /// Branches and turn lanes are drawn from it.
    stream: Stream,
    /// Lanes from the one it is on; never empty.
    lanes: VecDeque<usize>,
    /// Way on the first lane, metres.
    along_m: f64,
    /// Way along lanes since the start, metres.
    odometer_m: f64,
    /// Its odometer at the last lane change, metres.
    changed_m: f64,
    /// The turn lane beside that it means to take.
    turn_lane: Option<usize>,
    /// Of a vehicle that tows another one.
    train: Option<TrainRoute>,
    /// What the user wants it to pass.
    given: Option<GivenRoute>,
}

/// What else the route of a vehicle knows that tows another one.
#[derive(Debug)]
struct TrainRoute {
    /// For each lane how long it can drive on from its beginning over lanes that are wide enough, seconds,
    /// and what is enough.
    ways_s: Arc<[f64]>,
    enough_s: f64,
    /// The lanes that it comes from, the last one at the end, as far as what is towed may be on them.
    behind: VecDeque<Left>,
    keep_m: f64,
}

/// A lane that was left.
#[derive(Clone, Copy, Debug)]
struct Left {
    lane: usize,
    /// Odometer at its beginning and where it was left, metres.
    zero_m: f64,
    until_m: f64,
}

impl TrainRoute {
    fn leave(&mut self, left: Left) {
        self.behind.push_back(left);
        let from_m = left.until_m - self.keep_m;
        while self.behind.front().is_some_and(|first| first.until_m < from_m) {
            self.behind.pop_front();
        }
    }
}

impl Route {
    /// A route that begins on a lane, at some metres along it.
    pub(crate) fn new(lane: usize, along_m: f64, stream: Stream) -> Self {
        let lanes = VecDeque::from([lane]);
        Self {
            stream,
            lanes,
            along_m,
            odometer_m: 0.0,
            changed_m: 0.0,
            turn_lane: None,
            train: None,
            given: None,
        }
    }

    /// The same, over lanes that the user gave.
    pub(crate) fn over(self, given: Option<GivenRoute>) -> Self {
        Self { given, ..self }
    }

    /// The same for a vehicle that tows another one: for each lane how long it can drive on from there, and
    /// for how long it has to, seconds; the lanes that it came from, nearest first, and how far back the
    /// other one may be on them, metres.
    pub(crate) fn of_train(
        self,
        net: &Net,
        (ways_s, enough_s): (Arc<[f64]>, f64),
        behind: &[usize],
        keep_m: f64,
    ) -> Self {
        let mut until_m = self.odometer_m - self.along_m;
        let mut left = VecDeque::new();
        for &lane in behind {
            let zero_m = until_m - net.lanes[lane].centre.length_m;
            left.push_front(Left { lane, zero_m, until_m });
            until_m = zero_m;
        }
        Self { train: Some(TrainRoute { ways_s, enough_s, behind: left, keep_m }), ..self }
    }

    /// Whether a lane is wide enough for what it tows, and leads on as far as the one that it is on.
    pub(crate) fn may_use(&self, lane: usize) -> bool {
        let own = self.lanes[0];
        let leads_on = self.given.as_ref().is_none_or(|given| given.may_use(lane, own));
        leads_on
            && self
                .train
                .as_ref()
                .is_none_or(|train| train.ways_s[lane] >= train.ways_s[own].min(train.enough_s))
    }

    /// The lane that its vehicle's middle was on so much way ago, and the way on it, metres.
    pub(crate) fn lane_behind(&self, back_m: f64) -> (usize, f64) {
        let at_m = self.odometer_m - back_m;
        let mut found = (self.lanes[0], self.odometer_m - self.along_m);
        for left in self.train.iter().flat_map(|train| train.behind.iter().rev()) {
            if at_m >= left.until_m {
                break;
            }
            found = (left.lane, left.zero_m);
        }
        (found.0, at_m - found.1)
    }

    /// The middle of the lane there.
    pub(crate) fn place_behind(&self, net: &Net, back_m: f64) -> CentrelinePoint {
        let (lane, along_m) = self.lane_behind(back_m);
        net.lanes[lane].centre.place_beyond(along_m)
    }

    /// Draws where to go after a lane.
    fn draw_next(&mut self, net: &Net, lane: usize) -> Option<usize> {
        let next = &net.lanes[lane].next;
        if let Some(given) = self.given.as_ref().and_then(|given| given.next(self.lanes.iter().skip(1), next))
        {
            return Some(given);
        }
        let Some(train) = &self.train else { return self.stream.choose(next).copied() };
        // Where none leads on for long enough, the one that leads on for longest does, as it did from the
        // beginning.
        let longest_s = next.iter().map(|&l| train.ways_s[l]).fold(0.0, f64::max);
        let least_s = longest_s.min(train.enough_s);
        let wide: Vec<usize> = next.iter().copied().filter(|&l| train.ways_s[l] >= least_s).collect();
        let straight = |l: &usize| if net.lanes[*l].turn == 0 { STRAIGHT_ON } else { 1.0 };
        self.stream.choose_weighted(&wide, straight).copied()
    }

    /// The lane it is on.
    pub(crate) fn lane(&self) -> usize {
        self.lanes[0]
    }

    /// Way on that lane, metres.
    pub(crate) fn along_m(&self) -> f64 {
        self.along_m
    }

    /// Way along lanes since the start, metres.
    pub(crate) fn odometer_m(&self) -> f64 {
        self.odometer_m
    }

    /// Way along lanes since the last lane change, metres.
    pub(crate) fn since_change_m(&self) -> f64 {
        self.odometer_m - self.changed_m
    }

    /// The turn lane beside that it means to take.
    pub(crate) fn turn_lane(&self) -> Option<usize> {
        self.turn_lane
    }

    /// The last lane that is drawn.
    pub(crate) fn last(&self) -> Option<usize> {
        self.lanes.back().copied()
    }

    /// Whether another lane comes after the first one.
    pub(crate) fn goes_on(&self) -> bool {
        self.lanes.len() > 1
    }

    /// The lanes with the way from the vehicle's middle to their beginnings (negative for the first).
    pub(crate) fn lanes_ahead<'a>(&'a self, net: &'a Net) -> impl Iterator<Item = (usize, f64)> + 'a {
        let mut to = -self.along_m;
        self.lanes.iter().map(move |&lane| {
            let start = to;
            to += net.lanes[lane].centre.length_m;
            (lane, start)
        })
    }

    /// The way to the end of the route, metres.
    pub(crate) fn remaining_m(&self, net: &Net) -> f64 {
        self.lanes.iter().map(|&l| net.lanes[l].centre.length_m).sum::<f64>() - self.along_m
    }

    /// Draws branches until the route reaches so far.
    pub(crate) fn extend(&mut self, net: &Net, reach_m: f64) {
        let mut ahead_m = self.remaining_m(net);
        while ahead_m < reach_m {
            let Some(&last) = self.lanes.back() else { return };
            let Some(next) = self.draw_next(net, last) else { return };
            self.lanes.push_back(next);
            ahead_m += net.lanes[next].centre.length_m;
        }
    }

    /// Having come to another lane, draws whether to take the turn lane that opens beside it: all ways on are
    /// as likely.
    pub(crate) fn choose_turn_lane(&mut self, net: &Net) {
        self.turn_lane = None;
        if let Some(given) = &mut self.given {
            given.pass(self.lanes[0]);
            self.turn_lane = given.beside(net, self.lanes[0]);
        }
        if self.train.is_some() || self.given.as_ref().is_some_and(GivenRoute::goes_on) {
            return;
        }
        let own = &net.lanes[self.lanes[0]];
        for beside in own.beside.iter().flatten().map(|b| b.lane) {
            let lane = &net.lanes[beside];
            if lane.previous.is_empty() && !lane.next.is_empty() {
                let ways = lane.next.len() as f64;
                if self.stream.chance(ways / (ways + own.next.len() as f64)) {
                    self.turn_lane = Some(beside);
                }
            }
        }
    }

    /// Drives on to a place of the first lane, or of its straight continuation.
    pub(crate) fn advance_to(&mut self, along_m: f64) {
        self.odometer_m += along_m - self.along_m;
        self.along_m = along_m;
    }

    /// Leaves the first lane behind.
    pub(crate) fn enter_next(&mut self, net: &Net) {
        if let Some(left) = self.lanes.pop_front() {
            let (zero_m, length_m) = (self.odometer_m - self.along_m, net.lanes[left].centre.length_m);
            if let Some(train) = &mut self.train {
                train.leave(Left { lane: left, zero_m, until_m: zero_m + length_m });
            }
            self.along_m -= length_m;
        }
    }

    /// Corrects the place on a lane just entered, which need not go on exactly where the one before ends.
    pub(crate) fn correct_to(&mut self, along_m: f64) {
        self.along_m = along_m;
    }

    /// Begins anew on the lane beside.
    pub(crate) fn change_to(&mut self, lane: usize, along_m: f64) {
        if let Some(train) = &mut self.train {
            let zero_m = self.odometer_m - self.along_m;
            train.leave(Left { lane: self.lanes[0], zero_m, until_m: self.odometer_m });
        }
        self.lanes = VecDeque::from([lane]);
        self.along_m = along_m;
        self.changed_m = self.odometer_m;
    }
}
