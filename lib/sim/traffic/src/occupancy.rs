//! The vehicles and obstacles on lanes, and which is ahead and behind.

use nalgebra::{Point3, Vector3};

use crate::car_following::time_s;
use crate::road::kerbside::Kerbside;
use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;
use crate::vehicle::attention::Class;

/// Other lanes' traffic is looked at this far before a merge, metres.
const MERGE_VIEW_M: f64 = 40.0;
/// Half the length of road that a walker needs, metres.
const WALKER_HALF_M: f64 = 0.6;
/// Drivers pass before a walker who comes to their lane this long after they have, seconds, counting on this
/// share of their acceleration.
const PASSED_S: f64 = 1.5;
const EASE: f64 = 0.5;
/// Most lanes looked at in a search.
const MAX_LANES: usize = 64;
/// Drivers let in those who ask within this distance, metres.
const ASKED_M: f64 = 50.0;
/// The ends of a vehicle that changes lanes are this part of its length, metres.
const END_M: f64 = 1.0;
/// Half the length of the longest vehicle, metres.
const LONGEST_HALF_M: f64 = 7.0;
/// A vehicle that reaches this far over the edge of a lane is on it, metres.
const REACHES_M: f64 = 0.3;

/// In place of the index of a vehicle: a thing that stands in a hazard.
pub(crate) const STANDING: usize = usize::MAX;
/// The same of a vehicle on a given trajectory, which goes on and gives way to nobody.
pub(crate) const GIVEN: usize = usize::MAX - 1;
/// Things shorter than this are looked at in their middle only, metres.
const SHORT_M: f64 = 1.0;

/// Whether what is on a lane is a wreck or another thing that nobody drives away, or somebody who cannot get
/// past one.
pub(crate) fn is_stranded(vehicles: &[Vehicle], who: usize) -> bool {
    who != GIVEN && vehicles.get(who).is_none_or(|v| v.is_crashed() || v.lane_choice().is_boxed_in())
}

/// Onwards or backwards along lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sense {
    Ahead,
    Behind,
}

/// A walker who crosses a lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossingWalker {
    /// Metres along the lane to where it does.
    pub(crate) along_m: f64,
    /// Seconds until it is there.
    pub(crate) in_s: f64,
}

/// Something on a lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Occupant {
    pub(crate) along_m: f64,
    pub(crate) half_length_m: f64,
    /// Way from there on to the middle of the vehicle that leads it, metres: 0 but for what is towed.
    pub(crate) behind_m: f64,
    pub(crate) speed_mps: f64,
    /// Index of the vehicle; things that stand in hazards have none of that index.
    pub(crate) vehicle: usize,
    /// What drivers take it for.
    pub(crate) class: Class,
}

/// The vehicle ahead of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leader {
    /// Between bumpers, metres.
    pub(crate) gap_m: f64,
    pub(crate) speed_mps: f64,
    /// Index of the vehicle, as in [`Occupant`].
    pub(crate) vehicle: usize,
    /// What drivers take it for.
    pub(crate) class: Class,
}

/// What is on each lane in this step.
#[derive(Debug, Default)]
pub(crate) struct Occupancy {
    vehicles: Vec<Vec<Occupant>>,
    /// Where walkers are about to cross the lane.
    walkers: Vec<Vec<CrossingWalker>>,
    /// Vehicles on lanes beside that must change to this one and find no gap.
    asking: Vec<Vec<Occupant>>,
    /// Things that stand for the whole scene, with their lanes.
    standing: Vec<(usize, Occupant)>,
    /// Parked vehicles that reach into lanes.
    pub(crate) kerbside: Kerbside,
    touched: Vec<usize>,
}

/// A parked vehicle that blocks a lane.
fn parked(along_m: f64, half_length_m: f64) -> Occupant {
    let (behind_m, speed_mps) = (0.0, 0.0);
    Occupant { along_m, half_length_m, behind_m, speed_mps, vehicle: STANDING, class: Class::Vehicles }
}

/// Spots on every lane that a body reaches well into.
fn footprint(
    net: &Net,
    (at, yaw_rad, size_m): (&Point3<f64>, f64, [f64; 3]),
    vehicle: usize,
    class: Class,
) -> Vec<(usize, Occupant)> {
    let (sin, cos) = frames::math::sin_cos(yaw_rad);
    let (half_length, half_width) = (0.5 * size_m[0], 0.5 * size_m[1]);
    let parts: &[f64] = if size_m[0] < SHORT_M { &[0.0] } else { &[-1.0, -0.5, 0.0, 0.5, 1.0] };
    let mut spots = Vec::new();
    for part in parts {
        let off = part * half_length;
        let point = at + Vector3::new(cos * off, sin * off, 0.0);
        for (lane, along_m) in net.lanes_at(&point, half_width - 0.4) {
            let half_length_m = half_width.max(0.25 * half_length);
            let (behind_m, speed_mps) = (0.0, 0.0);
            spots.push((lane, Occupant { along_m, half_length_m, behind_m, speed_mps, vehicle, class }));
        }
    }
    spots
}

impl Occupancy {
    pub(crate) fn new(lanes: usize) -> Self {
        Self {
            vehicles: vec![Vec::new(); lanes],
            walkers: vec![Vec::new(); lanes],
            asking: vec![Vec::new(); lanes],
            standing: Vec::new(),
            kerbside: Kerbside::default(),
            touched: Vec::new(),
        }
    }

    /// The vehicles and things on a lane.
    pub(crate) fn on_lane(&self, lane: usize) -> &[Occupant] {
        &self.vehicles[lane]
    }

    fn clear(&mut self) {
        for lane in self.touched.drain(..) {
            self.vehicles[lane].clear();
            self.walkers[lane].clear();
            self.asking[lane].clear();
        }
    }

    pub(crate) fn add_vehicle(&mut self, lane: usize, spot: Occupant) {
        self.touched.push(lane);
        self.vehicles[lane].push(spot);
    }

    pub(crate) fn add_walker(&mut self, lane: usize, walker: CrossingWalker) {
        self.touched.push(lane);
        self.walkers[lane].push(walker);
    }

    /// Puts a body that moves on the lanes under it for this step: middle, yaw and size, velocity, who it is,
    /// and what drivers take it for.
    pub(crate) fn add_body(
        &mut self,
        net: &Net,
        place: (&Point3<f64>, f64, [f64; 3]),
        velocity_mps: Vector3<f64>,
        who: usize,
        class: Class,
    ) {
        for (lane, spot) in footprint(net, place, who, class) {
            let (sin, cos) = frames::math::sin_cos(net.lanes[lane].centre.place(spot.along_m).heading_rad);
            let speed_mps = (velocity_mps.x * cos + velocity_mps.y * sin).max(0.0);
            self.add_vehicle(lane, Occupant { speed_mps, ..spot });
        }
    }

    /// Puts things on the lanes under them, until told anew: middle, yaw and size of each, and what drivers
    /// take it for.
    pub(crate) fn stand(
        &mut self,
        net: &Net,
        things: impl Iterator<Item = ((Point3<f64>, f64, [f64; 3]), Class)>,
    ) {
        self.standing.clear();
        for ((at, yaw_rad, size_m), class) in things {
            self.standing.extend(footprint(net, (&at, yaw_rad, size_m), STANDING, class));
        }
    }

    /// Rebuilds the vehicles' places. Crashed ones block every lane that their footprint touches, those who
    /// change lanes both.
    pub(crate) fn fill(&mut self, net: &Net, vehicles: &[Vehicle]) {
        self.clear();
        for k in 0..self.standing.len() {
            let (lane, spot) = self.standing[k];
            self.add_vehicle(lane, spot);
        }
        for (i, vehicle) in vehicles.iter().enumerate() {
            let half_length_m = vehicle.half_length_m();
            if !vehicle.is_crashed() {
                let spot = Occupant {
                    along_m: vehicle.route().along_m(),
                    half_length_m,
                    behind_m: 0.0,
                    speed_mps: vehicle.speed_mps(),
                    vehicle: i,
                    class: Class::Vehicles,
                };
                self.add_vehicle(vehicle.route().lane(), spot);
                if vehicle.lateral().change().is_some() {
                    let margin_m = 0.5 * vehicle.model().size_m[1] - REACHES_M;
                    let (sin, cos) = frames::math::sin_cos(vehicle.motion().yaw_rad());
                    // Its middle, and its ends: it stands askew.
                    for (part, half_length_m) in [(0.0, half_length_m), (-1.0, END_M), (1.0, END_M)] {
                        let off = part * (vehicle.half_length_m() - END_M).max(0.0);
                        let point = vehicle.motion().position() + Vector3::new(cos * off, sin * off, 0.0);
                        for (lane, along_m) in net.lanes_at(&point, margin_m) {
                            if lane != vehicle.route().lane()
                                && net.lanes[lane].beside.iter().any(Option::is_some)
                            {
                                self.add_vehicle(lane, Occupant { along_m, half_length_m, ..spot });
                            }
                        }
                    }
                }
                self.add_towed(net, vehicle, spot);
                if let Some(lane) = vehicle.lane_choice().wanted() {
                    let front_m =
                        net.lanes[lane].centre.project(vehicle.motion().position()).0 + half_length_m;
                    let half_length_m = 0.5 * vehicle.length_m();
                    self.touched.push(lane);
                    self.asking[lane].push(Occupant {
                        along_m: front_m - half_length_m,
                        half_length_m,
                        ..spot
                    });
                }
                continue;
            }
            for (at, yaw_rad, size_m) in vehicle.sections() {
                for (lane, spot) in footprint(net, (&at, yaw_rad, size_m), i, Class::Vehicles) {
                    self.add_vehicle(lane, spot);
                }
            }
        }
    }

    /// What a vehicle tows, on the lane that it comes along, and on those beside which it reaches into.
    fn add_towed(&mut self, net: &Net, vehicle: &Vehicle, lead: Occupant) {
        let Some(towed) = vehicle.towed() else { return };
        let (train, (sin, cos)) = (towed.train(), frames::math::sin_cos(towed.yaw_rad()));
        let [length_m, width_m, _] = train.towed.size_m;
        let behind_m = train.apart_m();
        let spot = Occupant { behind_m, half_length_m: 0.5 * length_m, ..lead };
        let (own, along_m) = vehicle.route().lane_behind(behind_m);
        self.add_vehicle(own, Occupant { along_m, ..spot });
        for part in [-0.45, -0.15, 0.15, 0.45] {
            let off_m = part * length_m;
            let point = towed.position() + Vector3::new(cos * off_m, sin * off_m, 0.0);
            for (lane, along_m) in net.lanes_at(&point, 0.5 * width_m - REACHES_M) {
                if lane != own && net.lanes[lane].beside.iter().any(Option::is_some) {
                    let (half_length_m, behind_m) = (0.15 * length_m, behind_m - off_m);
                    self.add_vehicle(lane, Occupant { along_m, half_length_m, behind_m, ..spot });
                }
            }
        }
    }

    /// The nearest vehicle or thing ahead of `me` on its route that its driver does not overlook for long.
    /// Vehicles that branch off or merge count while they overlap.
    pub(crate) fn leader(&self, net: &Net, vehicles: &[Vehicle], me: usize) -> Option<Leader> {
        let vehicle = &vehicles[me];
        let (own_half, view) = (vehicle.half_length_m(), vehicle.view_m());
        let width_m = vehicle.model().size_m[1];
        let mut best: Option<Leader> = None;
        let mut consider = |to_m: f64, spot: &Occupant| {
            let gap_m = to_m - own_half - spot.half_length_m;
            let is_nearest = spot.vehicle != me && to_m > 0.0 && best.is_none_or(|b| gap_m < b.gap_m);
            if is_nearest && !vehicle.driver().is_away(spot.class) {
                let Occupant { speed_mps, vehicle, class, .. } = *spot;
                best = Some(Leader { gap_m, speed_mps, vehicle, class });
            }
        };
        let mut found_on_lane = false;
        for (k, (lane, start)) in vehicle.lanes_ahead(net).enumerate() {
            if start > view || found_on_lane {
                break;
            }
            for spot in &self.vehicles[lane] {
                let to = start + spot.along_m;
                // Two at the very same place: the one with the lower number goes first.
                let to = if to == 0.0 && spot.vehicle < me { 1e-6 } else { to };
                found_on_lane |= spot.vehicle != me && to > 0.0;
                consider(to, spot);
            }
            for (along_m, half_length_m) in self.kerbside.blocking(lane, width_m) {
                consider(start + along_m, &parked(along_m, half_length_m));
            }
            for &(sibling, zone) in &net.lanes[lane].diverging {
                for spot in &self.vehicles[sibling] {
                    if spot.along_m - spot.half_length_m < zone {
                        consider(start + spot.along_m, spot);
                    }
                }
                // Vehicles that have branched off but for their rear.
                let length = net.lanes[sibling].centre.length_m;
                if length < zone + LONGEST_HALF_M {
                    for spot in net.lanes[sibling].next.iter().flat_map(|&on| &self.vehicles[on]) {
                        if length + spot.along_m - spot.half_length_m < zone {
                            consider(start + length + spot.along_m, spot);
                        }
                    }
                }
            }
            let length = net.lanes[lane].centre.length_m;
            let own_to_end = start + length;
            if own_to_end > MERGE_VIEW_M + 20.0 {
                continue;
            }
            for &(sibling, zone) in &net.lanes[lane].merging {
                let sibling_length = net.lanes[sibling].centre.length_m;
                for spot in &self.vehicles[sibling] {
                    let to_end = sibling_length - spot.along_m;
                    // What is towed goes where its lead goes.
                    let lead_m = to_end - spot.behind_m;
                    let first = lead_m < own_to_end || (lead_m == own_to_end && spot.vehicle < me);
                    // A sleeper is not going to merge.
                    let sleeps = vehicles.get(spot.vehicle).is_some_and(|v| v.wake() == Activity::Asleep);
                    let view_m = if sleeps { spot.half_length_m } else { MERGE_VIEW_M };
                    let near = to_end < zone + view_m && k < 2;
                    if first && near {
                        consider((own_to_end - to_end).max(1e-6), spot);
                    }
                }
            }
        }
        best
    }

    /// The gap to the nearest place ahead where a walker is about to cross whom the vehicle does not pass
    /// well before.
    pub(crate) fn walker_gap(&self, net: &Net, vehicle: &Vehicle) -> Option<f64> {
        let mut best: Option<f64> = None;
        for (lane, start) in vehicle.lanes_ahead(net) {
            if start > vehicle.view_m() {
                break;
            }
            for crosser in &self.walkers[lane] {
                let gap = start + crosser.along_m - vehicle.half_length_m() - WALKER_HALF_M;
                // A person beside or behind the front is not run over by going on.
                if gap <= -0.3 || best.is_some_and(|b| gap >= b) {
                    continue;
                }
                let past_m = gap + vehicle.length_m() + 2.0 * WALKER_HALF_M;
                let ease = EASE * vehicle.driver().idm().acceleration;
                if crosser.in_s
                    < time_s(past_m, vehicle.speed_mps(), ease, vehicle.speed_here(net)) + PASSED_S
                {
                    best = Some(gap);
                }
            }
        }
        best
    }

    /// The first vehicle but `me`, or thing that one of its width cannot pass, from a place on a lane onwards
    /// or backwards, over all branches: metres between the middles. One at the very place is ahead.
    pub(crate) fn first(
        &self,
        net: &Net,
        sense: Sense,
        (lane, along_m): (usize, f64),
        (me, width_m): (usize, f64),
        reach_m: f64,
    ) -> Option<(f64, Occupant)> {
        let length = |lane: usize| net.lanes[lane].centre.length_m;
        let mut best: Option<(f64, Occupant)> = None;
        // Lanes with the place as metres along each of them, as if it went straight on.
        let mut open = vec![(lane, along_m)];
        let mut seen = 0;
        while let Some((at, place_m)) = open.pop() {
            seen += 1;
            let blocking = self.kerbside.blocking(at, width_m).map(|(along, half)| parked(along, half));
            for spot in self.vehicles[at].iter().copied().chain(blocking) {
                let (to, is_there) = match sense {
                    Sense::Ahead => (spot.along_m - place_m, spot.along_m >= place_m),
                    Sense::Behind => (place_m - spot.along_m, spot.along_m < place_m),
                };
                if spot.vehicle != me && is_there && best.is_none_or(|b| to < b.0) {
                    best = Some((to, spot));
                }
            }
            let (end, on) = match sense {
                Sense::Ahead => (length(at) - place_m, &net.lanes[at].next),
                Sense::Behind => (place_m, &net.lanes[at].previous),
            };
            if end < reach_m && best.is_none_or(|b| end < b.0) && seen < MAX_LANES {
                open.extend(on.iter().map(|&l| match sense {
                    Sense::Ahead => (l, place_m - length(at)),
                    Sense::Behind => (l, place_m + length(l)),
                }));
            }
        }
        best
    }

    /// The nearest vehicle ahead that asks to be let in on the way of `me`.
    pub(crate) fn asking(&self, net: &Net, vehicles: &[Vehicle], me: usize) -> Option<Leader> {
        let vehicle = &vehicles[me];
        if net.lanes[vehicle.route().lane()].junction.is_some() {
            return None;
        }
        let mut best: Option<Leader> = None;
        for (lane, start) in vehicle.lanes_ahead(net).take_while(|(_, start)| *start < ASKED_M) {
            for spot in self.asking[lane].iter().filter(|s| s.vehicle != me) {
                let gap_m = start + spot.along_m - vehicle.half_length_m() - spot.half_length_m;
                if gap_m > 0.0 && best.is_none_or(|b| gap_m < b.gap_m) {
                    let Occupant { speed_mps, vehicle, class, .. } = *spot;
                    best = Some(Leader { gap_m, speed_mps, vehicle, class });
                }
            }
        }
        best
    }
}
