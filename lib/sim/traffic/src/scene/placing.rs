//! What a scene begins with: vehicles, walkers, parked vehicles, lamps.

use catalogue::{Model, people};
use frames::{Object, Pose, World};
use nalgebra::Point3;
use random::Stream;
use schema::ObjectId;
use schema::tables::ActorRow;
use schema::{ActorKind, ActorRole, Attribute};

use crate::bodies::{Bodies, Owner};
use crate::error::TrafficError;
use crate::given::GivenActors;
use crate::input::SceneInput;
use crate::junction::right_of_way::RightOfWay;
use crate::road::kerbside::Kerbside;
use crate::road::net::Net;
use crate::scene::spawn::Start;
use crate::vehicle::Vehicle;
use crate::vehicle::doors::Doors;
use crate::vehicle::driver::Driver;
use crate::vehicle::given_route::GivenRoute;
use crate::vehicle::motion::Motion;
use crate::vehicle::motion::hitch;
use crate::vehicle::route::Route;
use crate::vehicle::towed::Towed;
use crate::walking::crowd::{Crowd, radius_m};
use crate::walking::fixtures::Fixtures;
use crate::walking::gait::RUN_MPS;
use crate::walking::paths::Paths;
use crate::walking::routes::Routes;
use crate::walking::seats;
use crate::walking::talk::{self, TURNS_RAD};
use crate::walking::waiting::WaitingPlaces;
use crate::walking::walker::{AWAITS_S, WHEELCHAIR_MPS, Walker};
use crate::walking::walking_group::{WalkingGroup, abreast, draw_sizes};

/// Pedestrians who wait when a scene begins go on waiting for this long, seconds, at least and at most.
const WAITS_S: [f64; 2] = [5.0, 90.0];
/// Groups stand when a scene begins, and talk, so many times as often as those who are alone.
const TALKS: f64 = 2.0;
/// Shares of grown-up walkers on their feet who push a pram and who lead a dog, and how fast prams are at
/// most, m/s.
const PRAMS: f64 = 0.02;
const DOGS: f64 = 0.03;
const PRAM_MPS: f64 = 1.8;
/// Routes of trains remember so much more than the train's length, metres.
const KEPT_M: f64 = 10.0;
/// Clothes of walkers (sRGB).
const CLOTHES: [[u8; 3]; 8] = [
    [40, 44, 52],
    [120, 30, 34],
    [32, 60, 110],
    [66, 92, 60],
    [170, 160, 140],
    [200, 120, 40],
    [90, 70, 110],
    [225, 225, 220],
];

/// The vehicles, at rest where they start.
pub(crate) fn place_vehicles(
    net: &Net,
    starts: &[Start],
    input: &SceneInput<'_>,
    bodies: &mut Bodies,
    right_of_way: &mut RightOfWay,
) -> Vec<Vehicle> {
    let (scene, traffic) = (input.scene, &input.settings.traffic);
    let mut vehicles = Vec::with_capacity(starts.len());
    for (i, start) in starts.iter().enumerate() {
        let stream = |topic| Stream::new(scene.seed, u64::from(scene.scene), topic, i as u64);
        let driver = Driver::new(start.driver, traffic, stream("traffic/slip"));
        let given = match start.role {
            ActorRole::Agent(agent) => GivenRoute::of(net, input.map, input.routes, agent),
            _ => None,
        };
        let route = Route::new(start.lane, start.along_m, stream("traffic/route")).over(given);
        let body = bodies.vehicle(&start.point, start.yaw_rad, start.model.size_m, Owner::Vehicle(i as u32));
        let at = net.lanes[start.lane].centre.place(start.along_m);
        let (route, towed) = match &start.towed {
            Some(follows) => {
                let train = follows.train;
                let keep_m = train.rear_m() + KEPT_M;
                let size_m = train.towed.size_m;
                let owner = Owner::Vehicle(i as u32);
                let behind = bodies.vehicle(&follows.point, follows.yaw_rad, size_m, owner);
                bodies.couple([body, behind], [-train.hitch_m, train.coupling_m]);
                let hitch = hitch(train, at.point, start.yaw_rad, at.pitch_rad);
                let route =
                    route.of_train(net, (follows.ways_s.clone(), follows.enough_s), &follows.behind, keep_m);
                let mut towed = Towed::new(train, hitch, follows.yaw_rad, behind);
                towed.stand(&route.place_behind(net, train.hitch_m + train.rod_m));
                (route, Some(towed))
            }
            None => (route, None),
        };
        let motion = Motion::at_rest(at, start.yaw_rad, body);
        let door_open = if start.role == ActorRole::Background { traffic.door_open } else { 0.0 };
        let doors = Doors::new(start.model, door_open, stream("traffic/doors"));
        let vehicle = Vehicle::new(net, start.model, driver, route, motion, doors, start.emergency);
        let mut vehicle = vehicle.towing(towed);
        right_of_way.start(net, &mut vehicle, i);
        vehicles.push(vehicle);
    }
    vehicles
}

/// What walkers are placed among.
pub(crate) struct Streets<'a> {
    pub(crate) paths: &'a Paths,
    pub(crate) routes: &'a Routes,
    pub(crate) fixtures: &'a Fixtures,
    pub(crate) waiting: &'a WaitingPlaces,
    pub(crate) given: &'a GivenActors,
    /// Of the moment when the scene begins.
    pub(crate) frame: i32,
}

/// A walker as it is drawn, before it has a place.
struct Drawn {
    model: &'static Model,
    color: [u8; 3],
    speed_mps: f64,
    stream: Stream,
    anywhere: bool,
}

/// Draws the model and character of a walker.
fn draw_walker(input: &SceneInput<'_>, catalogue: &[(&'static Model, f64)], number: u64) -> Option<Drawn> {
    let (scene, settings) = (input.scene, &input.settings.walkers);
    let mut stream = Stream::new(scene.seed, u64::from(scene.scene), "traffic/walker", number);
    let (model, color) = (stream.choose_common(catalogue)?, *stream.choose(&CLOTHES)?);
    let speed = stream.log_normal(0.16, 0.64).min(RUN_MPS).max(settings.min_speed_mps).max(0.1);
    let mut chairs = Stream::new(scene.seed, u64::from(scene.scene), "traffic/wheelchair", number);
    let (model, speed_mps) = if chairs.chance(settings.wheelchair) {
        (&people::WHEELCHAIR, speed.min(WHEELCHAIR_MPS))
    } else {
        let takes = Stream::new(scene.seed, u64::from(scene.scene), "traffic/walker/takes", number);
        take_along(model, speed, takes)
    };
    let anywhere = stream.chance(scene.walker_cross_factor);
    Some(Drawn { model, color, speed_mps, stream, anywhere })
}

/// Of grown-ups some push a pram, none of them running, and some lead a dog.
fn take_along(model: &'static Model, speed_mps: f64, mut draw: Stream) -> (&'static Model, f64) {
    if model.facts().get(&Attribute::Age) == Some("child") {
        return (model, speed_mps);
    }
    match draw.uniform(0.0, 1.0) {
        share if share < PRAMS => (&people::WITH_PRAM, speed_mps.min(PRAM_MPS)),
        share if share < PRAMS + DOGS => (&people::WITH_DOG, speed_mps),
        _ => (model, speed_mps),
    }
}

/// The walkers, each with whether it crosses roads anywhere: alone, in groups that begin where the first of
/// them was to begin, or standing where people wait; groups who stand talk with one another.
pub(crate) fn place_walkers(
    input: &SceneInput<'_>,
    streets: &Streets<'_>,
    places: &[(usize, usize, f64)],
    bodies: &mut Bodies,
) -> Vec<(Walker, bool)> {
    let Streets { paths, routes, fixtures, waiting, given, frame } = *streets;
    let (scene, settings) = (input.scene, &input.settings.walkers);
    let stream = |topic, entity| Stream::new(scene.seed, u64::from(scene.scene), topic, entity);
    let catalogue = input.catalogue.walkers();
    let mut walkers: Vec<(Walker, bool)> = Vec::with_capacity(places.len());
    let mut crowd = Crowd::default();
    given.join(&mut crowd, frame);
    let sizes = draw_sizes(places.len(), settings.in_groups, &|i| stream("traffic/walker/group", i));
    for size in sizes {
        let first = walkers.len();
        let members = &places[first..first + size];
        let drawn: Vec<Drawn> =
            members.iter().filter_map(|m| draw_walker(input, &catalogue, m.0 as u64)).collect();
        let slowest = drawn.iter().map(|d| d.speed_mps).fold(f64::INFINITY, f64::min);
        let anywhere = drawn.first().is_some_and(|d| d.anywhere);
        let (number, way, along_m) = members[0];
        let mut talks = stream("traffic/walker/talk", number as u64);
        let ring = (size > 1 && talks.chance(TALKS * settings.waiting)).then(|| {
            let middle = waiting.draw(paths, (way, along_m), &mut talks);
            let radius_m = drawn.iter().map(|d| radius_m(d.model.size_m)).fold(0.0, f64::max);
            let turn_rad = talks.uniform(TURNS_RAD[0], TURNS_RAD[1]);
            talk::ring(paths, fixtures, &crowd, &middle, (drawn.len(), radius_m, turn_rad))
        });
        let ring = ring.flatten().map(|places| (places, talks.uniform(WAITS_S[0], WAITS_S[1])));
        for (rank, Drawn { model, color, speed_mps, stream: own, .. }) in drawn.into_iter().enumerate() {
            let owner = Owner::Walker((first + rank) as u32);
            let make_body = |at: &Point3<f64>| bodies.walker(at, model.size_m, owner);
            let place = (way, along_m);
            let mut walker =
                Walker::new(model, color, own, paths, routes, place, speed_mps, anywhere, make_body);
            let mut waits = stream("traffic/walker/waiting", number as u64);
            if let Some(offset) = abreast(size, rank) {
                let others = (first..first + size).filter(|i| *i != first + rank).collect();
                walker.join(WalkingGroup { first, others }, offset, slowest);
                if let Some((places, until_s)) = &ring {
                    // The others go where the first goes, or wherever they like where it is late.
                    let late_s = if rank > 0 { AWAITS_S } else { 0.0 };
                    walker.wait(paths, &places[rank], until_s + late_s);
                } else {
                    let trip = walkers.get(first).filter(|_| rank > 0).and_then(|(first, _)| first.trip());
                    walker.keep_up(1.0, rank > 0, trip);
                }
            } else if waits.chance(settings.waiting) {
                let place = waiting.draw(paths, place, &mut waits);
                walker.wait(paths, &place, waits.uniform(WAITS_S[0], WAITS_S[1]));
                let mut sits = stream("traffic/walker/sits", number as u64);
                if let Some(seat) = seats::take(waiting.seats(&place), model, &crowd, &mut sits) {
                    walker.sit(&seat);
                }
            }
            if walker.seat_m() == 0.0 {
                walker.find_room(paths, fixtures, &crowd);
            }
            crowd.add(walker.position(), walker.velocity_mps(), walker.radius_m());
            walkers.push((walker, anywhere));
        }
    }
    walkers
}

/// Parked vehicles: bodies to run into, and in the way of drivers where they reach into a lane.
pub(crate) fn add_parked(fixed: &[ActorRow], net: &Net, kerbside: &mut Kerbside, bodies: &mut Bodies) {
    for actor in fixed.iter().filter(|a| a.kind == ActorKind::Parked) {
        let at = Point3::from(actor.xyz_m);
        let yaw_rad = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion).yaw();
        let size = [actor.length_m, actor.width_m, actor.height_m].map(|v| v.max(0.1));
        bodies.fixed(&at, yaw_rad, size, Owner::Parked);
        kerbside.add(net, &at, yaw_rad, size);
    }
}

/// Object ids of a scene's actors, in the order of the log.
pub(crate) struct ActorIds {
    pub(crate) agents: Vec<ObjectId>,
    pub(crate) rsus: Vec<ObjectId>,
    pub(crate) background: Vec<ObjectId>,
    pub(crate) walkers: Vec<ObjectId>,
    pub(crate) hazards: Vec<ObjectId>,
    pub(crate) towed: Vec<ObjectId>,
    /// Agents on given trajectories, which come first, and the others, which come last.
    pub(crate) given: [Vec<ObjectId>; 2],
}

impl ActorIds {
    /// Numbers so many of each: agents, RSUs, background vehicles, walkers, things of hazards, what is towed;
    /// and of those on given trajectories agents and others.
    pub(crate) fn new(
        input: &SceneInput<'_>,
        counts: [usize; 6],
        given: [usize; 2],
    ) -> Result<Self, TrafficError> {
        let (first, wanted) = (input.first_id, counts.iter().chain(&given).sum());
        let last = usize::from(first) + wanted;
        if first == 0 || last > usize::from(ObjectId::MAX) + 1 {
            return Err(TrafficError::TooManyObjects { scene: input.scene.scene, wanted, first });
        }
        let mut all = (usize::from(first)..last).map(|id| id as ObjectId);
        let mut take = |count| all.by_ref().take(count).collect::<Vec<ObjectId>>();
        let given_agents = take(given[0]);
        let [agents, rsus, background, walkers, hazards, towed] = counts.map(&mut take);
        let given = [given_agents, take(given[1])];
        Ok(Self { agents, rsus, background, walkers, hazards, towed, given })
    }
}
