//! Bends so tight that long vehicles need the opposite lane, too: a vehicle that would touch another
//! one there waits before the bend until the other one is through.
//!
//! A vehicle holds a bend from when it could hardly stop before it until its rear has left it. Vehicles that
//! have room beside one another hold it together, so that cars never wait for cars. A vehicle that has waited
//! for long goes before those who would come towards it after.

use crate::car_following::braking_to_stop;
use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;
use crate::vehicle::attention::Class;

/// Bends are looked at where the inner lane's radius is smaller than the last of these, metres; stretches of
/// a bend whose radius is smaller than one of them are a bend by themselves.
const RADII_M: [f64; 3] = [45.0, 80.0, 180.0];
/// Between the middles of two of the longest vehicles that meet, metres: so much, and so much more times the
/// bend's curvature as the one swings out and the other one cuts in.
const LONGEST_M: f64 = 2.75;
const SWING_M2: f64 = 81.0;
/// Lanes with their middles nearer than this lie beside each other, metres.
const BESIDE_M: f64 = 4.6;
/// Room between two who meet, metres.
const SPARE_M: f64 = 0.2;
/// What belongs to a bend before and behind it, metres.
const ENDS_M: f64 = 2.0;
/// A long vehicle that comes out on the inside has its front corner on the other lane still, metres.
const EXIT_M: f64 = 11.0;
/// Stops are planned with this braking, m/s2, from so far before the bend on, metres.
const BRAKING: f64 = 1.8;
const BEFORE_M: f64 = 6.0;
/// Waiting vehicles come to rest this far before it, metres.
const STOP_M: f64 = 1.0;
/// A vehicle that would have to brake harder than this goes, m/s2.
const HARD_BRAKING: f64 = 5.0;
/// A vehicle that is in a bend and slower than this may still wait there, m/s.
const STANDING_MPS: f64 = 0.5;
/// A vehicle that has waited this long goes first, steps (5 s).
const PATIENCE_STEPS: u32 = 100;
/// Bends nearer to each other than this and the vehicle's length are one for it, metres.
const BETWEEN_M: f64 = 6.0;

/// A lane's part in a bend.
#[derive(Clone, Copy, Debug)]
struct BendLane {
    lane: usize,
    from_m: f64,
    to_m: f64,
}

/// A bend of two lanes that run towards each other.
#[derive(Clone, Debug)]
struct Bend {
    /// The lane on the inside, and the one on the outside.
    parts: [BendLane; 2],
    /// Smallest radius of the inner lane's middle, and distance of the two middles, metres.
    radius_m: f64,
    apart_m: f64,
    holders: Vec<Holder>,
    /// Vehicles that have waited for long, with their part of the bend.
    claims: Vec<(usize, usize)>,
}

#[derive(Clone, Copy, Debug)]
struct Holder {
    vehicle: usize,
    part: usize,
    /// The vehicle's odometer when its rear leaves the bend, metres.
    until_m: f64,
}

/// A bend ahead of a vehicle.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    bend: usize,
    part: usize,
    /// From the front bumper to its beginning, and from the followed point to its end, metres.
    gap_m: f64,
    end_m: f64,
}

/// All such bends of a map, with the vehicles in them.
#[derive(Debug)]
pub(crate) struct Bends {
    bends: Vec<Bend>,
    /// For each lane its bends, with the lane's part.
    of_lane: Vec<Vec<(usize, usize)>>,
    /// For each vehicle the steps it has waited.
    waited: Vec<u32>,
}

impl Bends {
    pub(crate) fn new(net: &Net, vehicles: usize) -> Self {
        let mut found =
            Self { bends: Vec::new(), of_lane: vec![Vec::new(); net.lanes.len()], waited: vec![0; vehicles] };
        for lane in (0..net.lanes.len()).filter(|l| net.lanes[*l].junction.is_none()) {
            for run in runs(net, lane) {
                for bend in opposite(net, lane, &run) {
                    for (part, p) in bend.parts.iter().enumerate() {
                        found.of_lane[p.lane].push((found.bends.len(), part));
                    }
                    found.bends.push(bend);
                }
            }
        }
        found
    }

    /// Gives bends to those who are in them when a scene begins, before anybody else asks: the farther in,
    /// the sooner. Those who would touch them there stand and wait, or roll so that they can stop.
    pub(crate) fn start(&mut self, net: &Net, vehicles: &mut [Vehicle]) {
        let asking = vehicles.iter().enumerate().map(|(me, vehicle)| (me, self.ahead(net, vehicle, me)));
        let mut asking: Vec<(usize, Vec<Ahead>)> = asking.filter(|(_, ahead)| !ahead.is_empty()).collect();
        asking.sort_by(|(_, a), (_, b)| a[0].gap_m.total_cmp(&b[0].gap_m));
        for (me, ahead) in &asking {
            let (speed, to_m) = (vehicles[*me].speed_mps(), ahead[0].gap_m - STOP_M);
            if to_m > 0.0 && braking_to_stop(speed, to_m) < BRAKING {
                continue;
            }
            if ahead.iter().all(|a| self.is_free(vehicles, *me, a)) {
                self.hold(&vehicles[*me], *me, ahead);
            } else {
                vehicles[*me].roll(net, speed.min((2.0 * BRAKING * to_m.max(0.0)).sqrt()));
            }
        }
    }

    /// A vehicle holds bends until it is through.
    fn hold(&mut self, vehicle: &Vehicle, me: usize, ahead: &[Ahead]) {
        for a in ahead {
            let until_m = vehicle.route().odometer_m() + a.end_m + vehicle.rear_m();
            self.bends[a.bend].holders.push(Holder { vehicle: me, part: a.part, until_m });
        }
    }

    /// The gap from a vehicle's front to the bend before which it has to wait, for each vehicle, metres.
    pub(crate) fn serve(&mut self, net: &Net, vehicles: &[Vehicle]) -> Vec<Option<f64>> {
        for bend in &mut self.bends {
            bend.holders.retain(|h| {
                let vehicle = &vehicles[h.vehicle];
                !vehicle.is_crashed() && vehicle.route().odometer_m() < h.until_m
            });
            bend.claims.retain(|(v, _)| self.waited[*v] > PATIENCE_STEPS);
        }
        (0..vehicles.len()).map(|me| self.ask(net, vehicles, me)).collect()
    }

    /// Whether a vehicle holds a bend.
    pub(crate) fn is_held_by(&self, vehicle: usize) -> bool {
        self.bends.iter().any(|bend| bend.holders.iter().any(|h| h.vehicle == vehicle))
    }

    fn ask(&mut self, net: &Net, vehicles: &[Vehicle], me: usize) -> Option<f64> {
        let vehicle = &vehicles[me];
        let speed = vehicle.speed_mps();
        let stays = vehicle.is_crashed() || vehicle.wake() == Activity::Asleep;
        let ahead = if stays { Vec::new() } else { self.ahead(net, vehicle, me) };
        let near_m = speed * speed / (2.0 * BRAKING) + BEFORE_M;
        let Some(first) = ahead.first().filter(|a| a.gap_m < near_m) else {
            self.waited[me] = 0;
            return None;
        };
        let free = ahead.iter().all(|a| self.is_free(vehicles, me, a));
        let goes = braking_to_stop(speed, first.gap_m) > HARD_BRAKING && speed > 1.0;
        let passes = first.gap_m < 0.0 && speed > STANDING_MPS;
        if free || goes || passes || vehicle.driver().is_away(Class::Vehicles) {
            self.hold(vehicle, me, &ahead);
            self.waited[me] = 0;
            return None;
        }
        self.waited[me] += 1;
        if self.waited[me] == PATIENCE_STEPS + 1 {
            ahead.iter().for_each(|a| self.bends[a.bend].claims.push((me, a.part)));
        }
        Some(first.gap_m - STOP_M)
    }

    /// The next bends ahead that a vehicle does not hold, as far as it cannot wait between them.
    fn ahead(&self, net: &Net, vehicle: &Vehicle, me: usize) -> Vec<Ahead> {
        let mut found: Vec<Ahead> = Vec::new();
        let (half, view) = (vehicle.half_length_m(), vehicle.view_m());
        for (lane, start) in vehicle.lanes_ahead(net).take_while(|(_, start)| *start < view + 60.0) {
            for &(bend, part) in &self.of_lane[lane] {
                let b = &self.bends[bend];
                let BendLane { from_m, to_m, .. } = b.parts[part];
                let held = b.holders.iter().any(|h| h.vehicle == me);
                if start + to_m + vehicle.rear_m() > 0.0 && !held {
                    found.push(Ahead { bend, part, gap_m: start + from_m - half, end_m: start + to_m });
                }
            }
        }
        found.sort_by(|a, b| a.gap_m.total_cmp(&b.gap_m));
        let room_m = vehicle.length_m() + BETWEEN_M;
        let mut end_m = f64::INFINITY;
        let joined = found.iter().take_while(|a| {
            let near = end_m == f64::INFINITY || a.gap_m + half - end_m < room_m;
            end_m = if end_m == f64::INFINITY { a.end_m } else { end_m.max(a.end_m) };
            near
        });
        joined.copied().collect()
    }

    /// Whether nobody is in a bend, or claims it, whom a vehicle there would touch.
    fn is_free(&self, vehicles: &[Vehicle], me: usize, ahead: &Ahead) -> bool {
        let bend = &self.bends[ahead.bend];
        let touches = |other: usize| {
            let pair = if ahead.part == 0 { [me, other] } else { [other, me] };
            bend.is_too_tight(pair.map(|v| &vehicles[v]))
        };
        let waits_longer = |v: usize| self.waited[v] > self.waited[me];
        bend.holders.iter().all(|h| h.part == ahead.part || !touches(h.vehicle))
            && bend.claims.iter().all(|&(v, part)| part == ahead.part || !waits_longer(v) || !touches(v))
    }
}

impl Bend {
    /// Whether a vehicle on the inside and one on the outside would touch.
    fn is_too_tight(&self, [inner, outer]: [&Vehicle; 2]) -> bool {
        let out_m = inner.reaches_m(self.radius_m)[1];
        let in_m = outer.reaches_m(self.radius_m + self.apart_m)[0];
        out_m + in_m + SPARE_M > self.apart_m
    }
}

/// Whether some two vehicles have no room beside each other on lanes so far apart that turn by so much.
pub(crate) fn is_tight(curvature: f64, apart_m: f64) -> bool {
    LONGEST_M + SWING_M2 * curvature.abs() > apart_m
}

/// A stretch of a lane with a small radius.
#[derive(Clone, Copy, Debug)]
struct Run {
    from_m: f64,
    to_m: f64,
    turns_left: bool,
    /// Which of [`RADII_M`] it is below.
    class: usize,
}

/// All such stretches of a lane.
fn runs(net: &Net, lane: usize) -> Vec<Run> {
    let way = &net.lanes[lane].centre;
    let mut found: Vec<Run> = Vec::new();
    for w in way.samples.windows(2) {
        let curvature = way.curvature(0.5 * (w[0].along_m + w[1].along_m));
        let Some(class) = RADII_M.iter().position(|radius_m| curvature.abs() * radius_m > 1.0) else {
            continue;
        };
        let turns_left = curvature > 0.0;
        let goes_on =
            |r: &&mut Run| r.turns_left == turns_left && r.class == class && w[0].along_m - r.to_m < 1e-6;
        match found.last_mut().filter(goes_on) {
            Some(run) => run.to_m = w[1].along_m,
            None => found.push(Run { from_m: w[0].along_m, to_m: w[1].along_m, turns_left, class }),
        }
    }
    found
}

/// The bends that a lane's stretch makes with lanes that run the other way on its outside.
fn opposite(net: &Net, lane: usize, run: &Run) -> Vec<Bend> {
    let &Run { from_m, to_m, turns_left, .. } = run;
    let mut found: Vec<Bend> = Vec::new();
    let way = &net.lanes[lane].centre;
    for sample in way.samples.iter().filter(|s| (from_m..=to_m).contains(&s.along_m)) {
        for (other, along_m) in net.lanes_at(&sample.point, BESIDE_M) {
            let facing = net.lanes[other].centre.place(along_m);
            let away = facing.point - sample.point;
            let left_m = sample.tangent.x * away.y - sample.tangent.y * away.x;
            let (sin, cos) = frames::math::sin_cos(facing.heading_rad);
            let opposed = sample.tangent.x * cos + sample.tangent.y * sin < -0.7;
            let outside = (left_m > 0.0) != turns_left;
            if !opposed || !outside || left_m.abs() > BESIDE_M || net.lanes[other].junction.is_some() {
                continue;
            }
            let radius_m = 1.0 / way.curvature(sample.along_m).abs().max(1e-9);
            let around =
                [(lane, sample.along_m, ENDS_M), (other, along_m, EXIT_M)].map(|(lane, at_m, before_m)| {
                    BendLane { lane, from_m: at_m - before_m, to_m: at_m + ENDS_M }
                });
            match found.iter_mut().find(|b| b.parts[1].lane == other) {
                Some(bend) => {
                    for (part, more) in bend.parts.iter_mut().zip(around) {
                        part.from_m = part.from_m.min(more.from_m);
                        part.to_m = part.to_m.max(more.to_m);
                    }
                    bend.apart_m = bend.apart_m.min(left_m.abs());
                    bend.radius_m = bend.radius_m.min(radius_m);
                }
                None => found.push(Bend {
                    parts: around,
                    radius_m,
                    apart_m: left_m.abs(),
                    holders: Vec::new(),
                    claims: Vec::new(),
                }),
            }
        }
    }
    found.retain(|bend| is_tight(1.0 / bend.radius_m, bend.apart_m));
    found
}
