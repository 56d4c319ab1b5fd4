//! The ground that vehicles are about to sweep, corners and all: drivers stop for people and vehicles
//! on it, also beside their lane, and for obstacles of accidents and road works, those of long vehicles for
//! queues beside the lane that they turn into; walkers who are not crossing step back from it.

use catalogue::trains::Train;
use nalgebra::{Point3, Vector2, Vector3};

use crate::grid::Grid;
use crate::outline::outline;
use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::attention::Class;
use crate::vehicle::motion::after_rod;
use crate::vehicle::towed::{Towed, middle};

/// Distances between the places on the way that are looked at, within the second one and beyond, metres.
const STEPS_M: [f64; 2] = [0.25, 1.0];
/// Drivers look as far ahead as they need to stop at this braking, m/s2, and so much farther, but never
/// farther than that, metres.
const BRAKING: f64 = 2.0;
const REACH_M: [f64; 2] = [5.0, 25.0];
/// Walkers look at what is swept within this time, seconds, and this way, metres.
const SOON_S: f64 = 1.5;
const SOON_M: f64 = 1.5;
/// Walkers as near to a vehicle as this do not walk into it, metres.
const BESIDE_M: f64 = 1.5;
/// Room left around vehicles, metres: by drivers and by walkers.
const DRIVERS_M: f64 = 0.1;
/// Nearer means by more than this, metres.
const NEARER_M: f64 = 0.02;
const WALKERS_M: f64 = 0.25;
/// Walkers look at places so much farther than a vehicle sweeps soon, metres: half a second of the fastest,
/// and a step.
const MINDED_M: f64 = 6.0;
/// Vehicles longer than this swing out over lanes beside theirs where they turn, metres.
const LONG_M: f64 = 8.0;
/// Side of a cell, metres: drivers look no farther, half of the longest vehicle included.
const CELL_M: f64 = 36.0;
/// The same for what is swept, metres: half the diagonal of the longest vehicle and a walker.
const PRINT_CELL_M: f64 = 8.0;
/// What is towed comes no farther aside of its side than this, metres.
const TOWED_ASIDE_M: f64 = 3.0;
/// Bodies on other levels do not meet, metres.
const LEVEL_M: f64 = 2.5;

/// The ground under a vehicle at some place on its way.
#[derive(Clone, Copy, Debug)]
struct Footprint {
    at: Point3<f64>,
    ahead: Vector2<f64>,
    half_m: [f64; 2],
}

impl Footprint {
    fn new(at: Point3<f64>, yaw_rad: f64, [length, width, _]: [f64; 3]) -> Self {
        let (sin, cos) = frames::math::sin_cos(yaw_rad);
        Self { at, ahead: Vector2::new(cos, sin), half_m: [0.5 * length, 0.5 * width] }
    }

    /// Metres ahead of and to the left of its middle.
    fn local(&self, point: &Point3<f64>) -> [f64; 2] {
        let away = (point - self.at).xy();
        [away.dot(&self.ahead), self.ahead.perp(&away)]
    }

    /// How far outside a point on this level is, metres; negative inside.
    fn outside_m(&self, point: &Point3<f64>) -> f64 {
        let [ahead, left] = self.local(point);
        (ahead.abs() - self.half_m[0]).max(left.abs() - self.half_m[1])
    }

    fn is_level(&self, point: &Point3<f64>) -> bool {
        (point.z - self.at.z).abs() < LEVEL_M
    }
}

/// What a vehicle tows, as it is going to come after.
#[derive(Clone, Debug)]
struct Tow {
    train: &'static Train,
    /// Where it is now.
    here: Footprint,
    hitch: Point3<f64>,
    yaw_rad: f64,
}

impl Tow {
    fn new(towed: &Towed) -> Self {
        let (train, yaw_rad) = (towed.train(), towed.yaw_rad());
        let here = Footprint::new(towed.position(), yaw_rad, train.towed.size_m);
        let ahead = here.ahead * train.coupling_m;
        Self { train, here, hitch: here.at + Vector3::new(ahead.x, ahead.y, 0.0), yaw_rad }
    }

    /// Whether a disc is where it may come within a way.
    fn is_near(&self, point: &Point3<f64>, radius_m: f64, reach_m: f64) -> bool {
        let [ahead, left] = self.here.local(point);
        ahead > -self.here.half_m[0]
            && ahead - radius_m < self.here.half_m[0] + reach_m
            && left.abs() < self.here.half_m[1] + radius_m + TOWED_ASIDE_M
            && self.here.is_level(point)
    }

    /// Comes after the lead, which has gone on to a place.
    fn follow(&mut self, lead: &Footprint) -> Footprint {
        let back = lead.ahead * self.train.hitch_m;
        let hitch = lead.at - Vector3::new(back.x, back.y, 0.0);
        self.yaw_rad = after_rod(self.yaw_rad, &(hitch - self.hitch), self.train.rod_m);
        self.hitch = hitch;
        Footprint::new(middle(self.train, hitch, self.yaw_rad, 0.0), self.yaw_rad, self.train.towed.size_m)
    }
}

/// Points on the outlines of vehicles that stand on lanes beside the way of another one, within a distance: a
/// long vehicle that turns swings out over them. They wait for those ahead of them, never for it.
fn queues_beside<'a>(
    net: &Net,
    vehicles: &'a [Vehicle],
    me: usize,
    within_m: f64,
) -> impl Iterator<Item = Point3<f64>> + 'a {
    let (at, own) = (vehicles[me].motion().position(), vehicles[me].route().lane());
    let ahead = vehicles[me].lanes_ahead(net).take_while(|(_, start)| *start < within_m);
    let beside = ahead.flat_map(|(lane, _)| net.lanes[lane].beside.iter().flatten().map(|side| side.lane));
    let beside: Vec<usize> = beside.filter(|lane| *lane != own).collect();
    let queued = vehicles
        .iter()
        .filter(move |other| other.stands() && !other.is_crashed() && beside.contains(&other.route().lane()));
    let near = queued.filter(move |other| {
        let reach_m = within_m + other.half_length_m();
        (other.motion().position() - at).norm() < reach_m
    });
    near.flat_map(|other| outline(other.motion().position(), other.motion().yaw_rad(), other.model().size_m))
}

/// Metres to go on, for each class of what is in the way.
pub(crate) type Gaps = [Option<f64>; Class::ALL.len()];

/// Pedestrians near the lanes, and the ground that is swept soon, in one step of time.
#[derive(Debug)]
pub(crate) struct SweptPaths {
    walkers: Vec<(Point3<f64>, f64)>,
    grid: Grid,
    /// For each walker whether a vehicle may come to where it is or steps to.
    minded: Vec<bool>,
    /// Vehicles with walkers beside them, where they are now.
    here: Vec<Footprint>,
    soon: Vec<Footprint>,
    soon_grid: Grid,
    /// Points on the outlines of the obstacles of hazards, and what drivers take them for.
    things: Vec<(Point3<f64>, Class)>,
    thing_grid: Grid,
}

impl SweptPaths {
    /// For a scene without hazards.
    pub(crate) fn new() -> Self {
        Self {
            things: Vec::new(),
            thing_grid: Grid::new(CELL_M),
            walkers: Vec::new(),
            grid: Grid::new(CELL_M),
            minded: Vec::new(),
            here: Vec::new(),
            soon: Vec::new(),
            soon_grid: Grid::new(PRINT_CELL_M),
        }
    }

    /// Takes in the objects in hazards, until told anew: middle, yaw and size of each, and what drivers take
    /// it for.
    pub(crate) fn set_things(&mut self, things: impl Iterator<Item = ((Point3<f64>, f64, [f64; 3]), Class)>) {
        self.things.clear();
        self.thing_grid.clear();
        for ((at, yaw_rad, size_m), class) in things {
            self.things.extend(outline(at, yaw_rad, size_m).map(|point| (point, class)));
        }
        let points = self.things.iter().enumerate();
        self.thing_grid.fill(points.map(|(i, (point, _))| ([point.x, point.y], i)));
    }

    /// Forgets the step before.
    pub(crate) fn clear(&mut self) {
        self.walkers.clear();
        self.grid.clear();
        self.minded.clear();
        self.here.clear();
        self.soon.clear();
        self.soon_grid.clear();
    }

    /// A walker, as a disc; they are numbered as they come.
    pub(crate) fn add_walker(&mut self, point: Point3<f64>, radius_m: f64) {
        self.grid.insert(point.x, point.y, self.walkers.len());
        self.walkers.push((point, radius_m));
        self.minded.push(false);
    }

    /// Whether a walker has to look out for vehicles off the road.
    pub(crate) fn is_minded(&self, walker: usize) -> bool {
        self.minded.get(walker).copied().unwrap_or(false)
    }

    /// A vehicle that nobody drives: walkers keep out of it.
    pub(crate) fn add_wreck(&mut self, vehicle: &Vehicle) {
        vehicle.sections().for_each(|body| self.add_body(body));
    }

    /// A body, by its middle, yaw and size: walkers keep out of it.
    pub(crate) fn add_body(&mut self, (at, yaw_rad, size_m): (Point3<f64>, f64, [f64; 3])) {
        let here = Footprint::new(at, yaw_rad, size_m);
        let reach_m = here.half_m[0] + here.half_m[1] + MINDED_M;
        let mut beside = false;
        for walker in self.grid.around(here.at.x, here.at.y) {
            if (self.walkers[walker].0 - here.at).xy().norm() < reach_m {
                (self.minded[walker], beside) = (true, true);
            }
        }
        if beside {
            self.here.push(here);
        }
    }

    /// Where a body is going to be soon.
    pub(crate) fn add_soon(&mut self, (at, yaw_rad, size_m): (Point3<f64>, f64, [f64; 3])) {
        let soon = Footprint::new(at, yaw_rad, size_m);
        for walker in self.grid.around(at.x, at.y) {
            if (self.walkers[walker].0 - at).xy().norm() < soon.half_m[0] + soon.half_m[1] + MINDED_M {
                self.minded[walker] = true;
            }
        }
        self.soon.push(soon);
    }

    /// Metres that a vehicle can go on until it would touch a walker, something of a hazard or a queue beside
    /// its way, of each class, if there is one that its driver does not overlook for long; notes what it
    /// sweeps soon.
    pub(crate) fn gaps_m(&mut self, net: &Net, vehicles: &[Vehicle], me: usize) -> Gaps {
        let vehicle = &vehicles[me];
        let sees = |class: Class| !vehicle.driver().is_away(class);
        let speed = vehicle.speed_mps();
        let reach_m = (speed * speed / (2.0 * BRAKING) + REACH_M[0]).min(REACH_M[1]);
        let size_m = vehicle.model().size_m;
        let here = Footprint::new(vehicle.motion().position(), vehicle.motion().yaw_rad(), size_m);
        let mut towed = vehicle.towed().map(Tow::new);
        // The tightest bend within reach bounds what is swept aside.
        let lanes = vehicle.lanes_ahead(net).take_while(|(_, start)| *start < reach_m);
        let radius_m = lanes.map(|(lane, _)| net.lanes[lane].radius_m).fold(f64::INFINITY, f64::min);
        let lateral_m = if vehicle.lateral().change().is_some() { 1.0 } else { 0.0 };
        // Whatever the vehicle sweeps lies within the way it looks ahead and half its diagonal.
        let at = vehicle.motion().position();
        let half_m = here.half_m[0].max(vehicle.rear_m()) + here.half_m[1];
        let soon_m = SOON_S * speed + SOON_M;
        let mut around = Vec::new();
        let walkers = sees(Class::Walkers).then(|| self.grid.around(at.x, at.y));
        for walker in walkers.into_iter().flatten() {
            let (point, radius_m) = self.walkers[walker];
            let away_m = (point - at).xy().norm();
            if away_m < half_m + soon_m + MINDED_M {
                self.minded[walker] = true;
            }
            if away_m < half_m + reach_m + BESIDE_M {
                around.push((point, radius_m, Class::Walkers));
            }
        }
        let is_beside = |print: &Footprint| {
            around.iter().any(|(point, radius, _)| {
                let [ahead, left] = print.local(point);
                ahead.abs() < print.half_m[0] + BESIDE_M
                    && left.abs() < print.half_m[1] + radius + BESIDE_M
                    && print.is_level(point)
            })
        };
        let beside = [Some(here), towed.as_ref().map(|towed| towed.here)];
        let beside = beside.map(|print| print.filter(is_beside));
        let things = self.thing_grid.around(at.x, at.y).map(|thing| self.things[thing]);
        let seen =
            things.filter(|(point, class)| (point - at).xy().norm() < half_m + reach_m && sees(*class));
        around.extend(seen.map(|(point, class)| (point, 0.0, class)));
        if sees(Class::Vehicles) && vehicle.length_m() > LONG_M {
            let queues = queues_beside(net, vehicles, me, half_m + reach_m);
            around.extend(queues.map(|point| (point, 0.0, Class::Vehicles)));
        }
        let mut near: Vec<&(Point3<f64>, f64, Class)> = around
            .iter()
            .filter(|(point, radius, _)| {
                let [ahead, left] = here.local(point);
                let to = ahead - radius;
                let aside = left.abs() - here.half_m[1] - radius - WALKERS_M;
                let in_the_way = ahead > -here.half_m[0]
                    && to < here.half_m[0] + reach_m
                    && aside < lateral_m + to.abs() * to.abs() / radius_m
                    && here.is_level(point);
                in_the_way || towed.as_ref().is_some_and(|towed| towed.is_near(point, *radius, reach_m))
            })
            .collect();
        for print in beside.into_iter().flatten() {
            self.here.push(print);
            self.soon.push(print);
        }
        let mut gaps_m = Gaps::default();
        let mut on_m = 0.0;
        let (mut at, mut yaw_rad) = (vehicle.motion().position(), vehicle.motion().yaw_rad());
        while on_m < reach_m && !near.is_empty() {
            let step_m = if on_m < STEPS_M[1] { STEPS_M[0] } else { STEPS_M[1] };
            on_m += step_m;
            let Some(next) = vehicle.point_ahead(net, on_m) else { break };
            yaw_rad = after_rod(yaw_rad, &(next - at), vehicle.half_base_m());
            at = next;
            let print = Footprint::new(at, yaw_rad, size_m);
            let tow = towed.as_mut().map(|towed| (towed.follow(&print), towed.here));
            if on_m <= soon_m {
                self.soon.push(print);
                self.soon.extend(tow.map(|(print, _)| print));
            }
            // A person beside it who comes no nearer is passed.
            let meets = |print: &Footprint, here: &Footprint, point: &Point3<f64>, radius: f64| {
                let outside_m = print.outside_m(point);
                outside_m < radius + DRIVERS_M && outside_m < here.outside_m(point) - NEARER_M
            };
            let hit = |(point, radius, _): &&&(Point3<f64>, f64, Class)| {
                meets(&print, &here, point, *radius)
                    || tow.is_some_and(|(print, here)| meets(&print, &here, point, *radius))
            };
            while let Some((.., class)) = near.iter().find(hit) {
                gaps_m[*class as usize] = Some(on_m - step_m);
                near.retain(|(.., other)| other != class);
            }
        }
        gaps_m
    }

    /// Whether a way leads a walker into a vehicle or farther into it.
    pub(crate) fn blocks(&self, from: &Point3<f64>, way: Vector2<f64>, radius_m: f64) -> bool {
        let after = |share: f64| Point3::new(from.x + share * way.x, from.y + share * way.y, from.z);
        // Vehicles are wider than half of such a way is long.
        [0.5, 1.0].map(after).iter().any(|to| {
            self.here.iter().any(|print| {
                let outside_m = print.outside_m(to);
                outside_m < radius_m && outside_m < print.outside_m(from) && print.is_level(from)
            })
        })
    }

    /// All vehicles have looked: walkers may look, too.
    pub(crate) fn settle(&mut self) {
        let prints = self.soon.iter().enumerate();
        self.soon_grid.fill(prints.map(|(i, print)| ([print.at.x, print.at.y], i)));
    }

    /// How far outside the ground that is swept soon a walker would be at a place, metres, at most
    /// [`WALKERS_M`] beyond.
    pub(crate) fn clear_m(&self, at: &Point3<f64>, radius_m: f64) -> f64 {
        let around = self.soon_grid.around(at.x, at.y).map(|print| &self.soon[print]);
        let on_level = around.filter(|print| print.is_level(at));
        on_level.map(|print| print.outside_m(at) - radius_m).fold(WALKERS_M, f64::min)
    }

    /// Whether a walker at a place is in the way of what is swept soon.
    pub(crate) fn is_swept(&self, at: &Point3<f64>, radius_m: f64) -> bool {
        self.clear_m(at, radius_m) < WALKERS_M
    }
}
