//! Who and what a scene begins with: vehicles, walkers, parked vehicles, lamps.

use frames::{Object, Pose, World};
use nalgebra::Point3;
use opendrive::Map;
use random::Stream;
use schema::ObjectId;
use schema::tables::ActorRow;
use schema::{ActorKind, ActorRole, models};

use crate::bodies::{Bodies, Owner};
use crate::error::TrafficError;
use crate::input::SceneInput;
use crate::junction::right_of_way::RightOfWay;
use crate::road::kerbside::Kerbside;
use crate::road::net::Net;
use crate::scene::spawn::Start;
use crate::vehicle::Vehicle;
use crate::vehicle::doors::Doors;
use crate::vehicle::driver::Driver;
use crate::vehicle::motion::Motion;
use crate::vehicle::route::Route;
use crate::walking::crowd::Crowd;
use crate::walking::fixtures::Fixtures;
use crate::walking::paths::Paths;
use crate::walking::routes::Routes;
use crate::walking::walker::{WHEELCHAIR_MPS, Walker};

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
        let route = Route::new(start.lane, start.along_m, stream("traffic/route"));
        let body = bodies.vehicle(&start.point, start.yaw_rad, start.model.size_m, Owner::Vehicle(i as u32));
        let at = net.lanes[start.lane].centre.place(start.along_m);
        let motion = Motion::at_rest(at, start.yaw_rad, body);
        let door_open = if start.role == ActorRole::Background { traffic.door_open } else { 0.0 };
        let doors = Doors::new(start.model, door_open, stream("traffic/doors"));
        let mut vehicle = Vehicle::new(net, start.model, driver, route, motion, doors, start.emergency);
        right_of_way.start(net, &mut vehicle, i);
        vehicles.push(vehicle);
    }
    vehicles
}

/// The walkers, each with whether it crosses roads anywhere.
pub(crate) fn place_walkers(
    input: &SceneInput<'_>,
    paths: &Paths,
    routes: &Routes,
    fixtures: &Fixtures,
    places: &[(usize, usize, f64)],
    bodies: &mut Bodies,
) -> Vec<(Walker, bool)> {
    let scene = input.scene;
    let catalogue: Vec<&'static models::Model> = models::walkers().collect();
    let mut walkers: Vec<(Walker, bool)> = Vec::with_capacity(places.len());
    let mut crowd = Crowd::default();
    for (i, &(number, way, along)) in places.iter().enumerate() {
        let mut draw = Stream::new(scene.seed, u64::from(scene.scene), "traffic/walker", number as u64);
        let (Some(&model), Some(&color)) = (draw.choose(&catalogue), draw.choose(&CLOTHES)) else { break };
        let speed = draw.log_normal(0.16, 0.64).max(input.settings.walkers.min_speed_mps).max(0.1);
        let mut chairs = Stream::new(scene.seed, u64::from(scene.scene), "traffic/wheelchair", number as u64);
        let (model, speed) = match models::wheelchair() {
            Some(chair) if chairs.chance(input.settings.walkers.wheelchair) => {
                (chair, speed.min(WHEELCHAIR_MPS))
            }
            _ => (model, speed),
        };
        let anywhere = draw.chance(scene.walker_cross_factor);
        let owner = Owner::Walker(i as u32);
        let make_body = |at: &Point3<f64>| bodies.walker(at, model.size_m, owner);
        let mut walker =
            Walker::new(model, color, draw, paths, routes, (way, along), speed, anywhere, make_body);
        walker.find_room(paths, fixtures, &crowd);
        crowd.add(walker.position(), walker.velocity_mps(), walker.radius_m());
        walkers.push((walker, anywhere));
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

/// Traffic lights with the signals of the map that they show, by object id.
pub(crate) fn lamps(map: &Map, fixed: &[ActorRow]) -> Vec<(ObjectId, usize)> {
    let lights = fixed.iter().filter(|a| a.kind == ActorKind::TrafficLight);
    let mut found: Vec<(ObjectId, usize)> = lights
        .filter_map(|actor| {
            let wanted = actor.opendrive_id.as_deref()?;
            let signal = map.signals().iter().position(|s| s.dynamic && s.id == wanted)?;
            Some((actor.id, signal))
        })
        .collect();
    found.sort_unstable();
    found
}

/// Object ids of a scene's actors, in the order of the log.
pub(crate) struct ActorIds {
    pub(crate) agents: Vec<ObjectId>,
    pub(crate) rsus: Vec<ObjectId>,
    pub(crate) background: Vec<ObjectId>,
    pub(crate) walkers: Vec<ObjectId>,
    pub(crate) hazards: Vec<ObjectId>,
}

impl ActorIds {
    /// Numbers so many of each: agents, RSUs, background vehicles, walkers, things of hazards.
    pub(crate) fn new(input: &SceneInput<'_>, counts: [usize; 5]) -> Result<Self, TrafficError> {
        let (first, wanted) = (input.first_id, counts.iter().sum());
        let last = usize::from(first) + wanted;
        if first == 0 || last > usize::from(ObjectId::MAX) + 1 {
            return Err(TrafficError::TooManyObjects { scene: input.scene.scene, wanted, first });
        }
        let mut all = (usize::from(first)..last).map(|id| id as ObjectId);
        let [agents, rsus, background, walkers, hazards] =
            counts.map(|count| all.by_ref().take(count).collect());
        Ok(Self { agents, rsus, background, walkers, hazards })
    }
}
