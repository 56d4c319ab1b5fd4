//! The lanes that a vehicle is going to drive on, and where it is along them.

use std::collections::VecDeque;

use random::Stream;

use crate::road::net::Net;

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
}

impl Route {
    /// A route that begins on a lane, at some metres along it.
    pub(crate) fn new(lane: usize, along_m: f64, stream: Stream) -> Self {
        let lanes = VecDeque::from([lane]);
        Self { stream, lanes, along_m, odometer_m: 0.0, changed_m: 0.0, turn_lane: None }
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
            let Some(&next) = self.stream.choose(&net.lanes[last].next) else { return };
            self.lanes.push_back(next);
            ahead_m += net.lanes[next].centre.length_m;
        }
    }

    /// Having come to another lane, draws whether to take the turn lane that opens beside it: all ways on are as likely.
    pub(crate) fn choose_turn_lane(&mut self, net: &Net) {
        self.turn_lane = None;
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
            self.along_m -= net.lanes[left].centre.length_m;
        }
    }

    /// Corrects the place on a lane just entered, which need not go on exactly where the one before ends.
    pub(crate) fn correct_to(&mut self, along_m: f64) {
        self.along_m = along_m;
    }

    /// Begins anew on the lane beside.
    pub(crate) fn change_to(&mut self, lane: usize, along_m: f64) {
        self.lanes = VecDeque::from([lane]);
        self.along_m = along_m;
        self.changed_m = self.odometer_m;
    }
}
