//! Who and what a scene begins with: vehicles, walkers, parked vehicles, lamps.

use std::collections::VecDeque;

use frames::{Object, Pose, World};
use nalgebra::Point3;
use opendrive::Map;
use random::Stream;
use schema::ObjectId;
use schema::models;

use crate::SceneInput;
use crate::attention::Attention;
use crate::bodies::Bodies;
use crate::crowd::Crowd;
use crate::fixtures::Fixtures;
use crate::net::Net;
use crate::paths::Paths;
use crate::reservations::Reservations;
use crate::routes::Routes;
use crate::sleep::Wake;
use crate::spawn::Start;
use crate::sway::Sway;
use crate::vehicles::Vehicle;
use crate::walkers::{WHEELCHAIR_MPS, Walker};

/// Owner numbers of bodies: vehicles from 0, walkers from here, fixed things from twice this, those of hazards
/// from three times this.
pub(crate) const WALKERS: u32 = 1 << 20;
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
    reservations: &mut Reservations,
) -> Vec<Vehicle> {
    let scene = input.scene;
    let mut vehicles = Vec::with_capacity(starts.len());
    for (i, start) in starts.iter().enumerate() {
        let mut vehicle = Vehicle {
            model: start.model,
            driver: start.driver,
            stream: Stream::new(scene.seed, u64::from(scene.scene), "traffic/route", i as u64),
            route: VecDeque::from([start.lane]),
            along_m: start.along_m,
            odometer_m: 0.0,
            rolled_m: 0.0,
            speed_mps: 0.0,
            acceleration_mps2: 0.0,
            yaw_rad: start.yaw_rad,
            place: net.lanes[start.lane].way.place(start.along_m),
            steer_rad: 0.0,
            sway: Sway::default(),
            shift: None,
            slack: None,
            pocket: None,
            asks: None,
            changed_m: 0.0,
            stuck: false,
            crashed: false,
            held: Vec::new(),
            waiting_since: None,
            stood_steps: 0,
            refused_steps: 0,
            stands_for: Vec::new(),
            attention: Attention::new(
                &input.settings.traffic,
                start.driver.reckless,
                start.driver.distracted,
                Stream::new(scene.seed, u64::from(scene.scene), "traffic/slip", i as u64),
            ),
            wake: Wake::Awake,
            body: bodies.vehicle(&start.point, start.yaw_rad, start.model.size_m, i as u32),
        };
        vehicle.arrive(net);
        vehicle.extend_route(net);
        // Where the rear hangs back into a junction, the lanes under it are taken.
        if start.along_m < vehicle.half_length_m() {
            for &before in net.lanes[start.lane].previous.iter().filter(|&&l| net.lanes[l].junction.is_some())
            {
                reservations.hold(&mut vehicle, i, before, -start.along_m - net.lanes[before].way.length_m);
            }
        }
        reservations.intrude(net, &mut vehicle, i);
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
        let owner = WALKERS + i as u32;
        let make_body = |at: &Point3<f64>| bodies.walker(at, model.size_m, owner);
        let mut walker =
            Walker::new(model, color, draw, paths, routes, (way, along), speed, anywhere, make_body);
        walker.find_room(paths, fixtures, &crowd);
        crowd.add(walker.point, walker.velocity_mps, walker.radius_m());
        walkers.push((walker, anywhere));
    }
    walkers
}

/// Parked vehicles as obstacles, unless they stand so near a lane that careful drivers would touch them.
pub(crate) fn add_fixed(input: &SceneInput<'_>, net: &Net, bodies: &mut Bodies) {
    for (i, actor) in input.fixed.iter().enumerate().filter(|(_, a)| a.kind == "parked") {
        let at = Point3::from(actor.xyz_m);
        if net.lanes_at(&at, 1.5).is_empty() {
            let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
            let size = [actor.length_m, actor.width_m, actor.height_m].map(|v| v.max(0.1));
            bodies.fixed(&at, pose.yaw(), size, 2 * WALKERS + i as u32);
        }
    }
}

/// The scene's traffic lights with the signals of the map that they show, by object id.
pub(crate) fn lamps(map: &Map, input: &SceneInput<'_>) -> Vec<(ObjectId, usize)> {
    let lights = input.fixed.iter().filter(|a| a.kind == "traffic_light");
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
