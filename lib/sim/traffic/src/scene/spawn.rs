//! Where vehicles start.

use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::sync::Arc;

use catalogue::{
    BaseType, Model, Special, fleet,
    trains::{self, Train},
};
use nalgebra::Point3;
use opendrive::{LanePos, Map};
use random::Stream;
use schema::tables::{ActorRow, PlanSceneRow};
use schema::{ActorRole, AgentKind};
use settings::TrafficSettings;

use crate::bends::is_tight;
use crate::error::TrafficError;
use crate::given::GivenActors;
use crate::hazards::Hazards;
use crate::input::SceneInput;
use crate::road::centreline::CentrelinePoint;
use crate::road::net::Net;
use crate::scene::free_space::Taken;
use crate::vehicle::driver::DriverProfile;
use crate::vehicle::motion::hitch;
use crate::vehicle::towed::middle;
use crate::wide_ways::{towed_yaw_rad, wide_ways};

/// What a vehicle tows, about to be placed behind it.
#[derive(Debug)]
pub(crate) struct TowedStart {
    pub(crate) train: &'static Train,
    pub(crate) color: Vec<u8>,
    /// The middle of its footprint.
    pub(crate) point: Point3<f64>,
    pub(crate) yaw_rad: f64,
    /// Lanes before that of its lead, nearest first.
    pub(crate) behind: Vec<usize>,
    /// For each lane how long it can drive on from there, seconds, and what is enough.
    pub(crate) ways_s: Arc<[f64]>,
    pub(crate) enough_s: f64,
}

/// Trains get on no faster than this, metres per second, however long they drive.
const TRAIN_MPS: f64 = 28.0;
/// They can drive on so much longer than a scene takes, seconds.
const SPARE_S: f64 = 3.0;

/// A vehicle about to be placed.
#[derive(Debug)]
pub(crate) struct Start {
    pub(crate) model: &'static Model,
    pub(crate) color: Vec<u8>,
    /// An agent, or part of the background.
    pub(crate) role: ActorRole,
    pub(crate) driver: DriverProfile,
    /// Its emergency lights flash.
    pub(crate) emergency: bool,
    pub(crate) lane: usize,
    pub(crate) along_m: f64,
    pub(crate) point: Point3<f64>,
    pub(crate) yaw_rad: f64,
    pub(crate) towed: Option<TowedStart>,
}

/// Vehicles longer than this need room in bends, from so far before to so far behind them, looked at in such
/// steps, metres.
const LONG_M: f64 = 7.0;
const BEND_END_M: f64 = 11.0;
/// What turns by less is no bend, radians per metre.
const STRAIGHT: f64 = 1.0 / 180.0;
const BEND_STEP_M: f64 = 2.0;

/// All vehicles of a scene that drivers drive, agents in order, then background vehicles, and the objects in
/// its hazards. Nothing starts where actors on given trajectories come by within some frames.
pub(crate) fn vehicle_starts(
    input: &SceneInput<'_>,
    fixed: &[ActorRow],
    net: &Net,
    (given, frames): (&GivenActors, Range<i32>),
) -> Result<(Vec<Start>, Hazards), TrafficError> {
    let scene = input.scene;
    let mut taken = Taken::parked(fixed);
    let given_agents = given.agents_at(frames.start);
    given.keep_free(&mut taken, frames);
    let mut starts = Vec::new();
    let vehicles = input.agents.iter().filter(|a| a.signal.is_none() && a.agent.kind == AgentKind::Vehicle);
    for agent in vehicles.filter(|a| !given.has(a.agent)) {
        let model = input.catalogue.find(&agent.model).filter(|m| m.wheelbase_m > 0.0).ok_or_else(|| {
            TrafficError::UnknownModel { scene: scene.scene, agent: agent.agent, model: agent.model.clone() }
        })?;
        let (lane, along_m) = nearest_place(input.map, net, agent.xyz_m.into(), agent.rpy_rad[2])
            .ok_or_else(|| TrafficError::NoDrivingLanes { scene: scene.scene, map: scene.map.clone() })?;
        // Where the room clear of junctions is taken by another agent, the planned place is free.
        let places = [clear_of_junctions(net, lane, along_m, both(model)), along_m]
            .map(|along_m| (along_m, net.lanes[lane].centre.place(along_m)));
        let is_free =
            |(_, at): &&(f64, CentrelinePoint)| taken.is_free(&at.point, at.heading_rad, model.size_m);
        let (along_m, place) = *places.iter().find(is_free).unwrap_or(&places[1]);
        taken.insert(place.point, place.heading_rad, model.size_m);
        let driver = DriverProfile::new(
            model,
            agent.reckless,
            agent.distracted,
            agent.speed_difference,
            agent.standstill_gap_m,
        );
        starts.push(Start {
            model,
            color: agent.color.clone(),
            role: ActorRole::Agent(agent.agent),
            driver,
            emergency: false,
            lane,
            along_m,
            point: place.point,
            yaw_rad: place.heading_rad,
            towed: None,
        });
    }
    let hazards = Hazards::place(input, fixed, &mut taken);
    background(input, net, (&hazards, given_agents), &mut taken, &mut starts);
    Ok((starts, hazards))
}

/// Background vehicles on free spawn points near the agents.
fn background(
    input: &SceneInput<'_>,
    net: &Net,
    (hazards, mut agents): (&Hazards, Vec<Point3<f64>>),
    taken: &mut Taken,
    starts: &mut Vec<Start>,
) {
    let (scene, traffic) = (input.scene, &input.settings.traffic);
    let stream = |topic, entity| Stream::new(scene.seed, u64::from(scene.scene), topic, entity);
    agents.extend(starts.iter().map(|start| start.point));
    let mut points = spawn_points(input.map, net, scene.spawn_separation_m);
    points.retain(|&(lane, along)| {
        let at = net.lanes[lane].centre.place(along).point;
        agents.iter().any(|a| (a - at).norm() < scene.spawn_radius_m)
            && !hazards.is_near_end(net.lanes[lane].centre.lane, &at, 0.5 * scene.spawn_separation_m)
    });
    let drawn = stream("traffic/count", 0).int_inclusive(0, (points.len() as i64 - 3).max(0));
    let wanted = scene.background_vehicles.map_or(drawn, i64::from).max(0) as usize;
    let catalogue: Vec<&'static Model> = input.catalogue.vehicles().collect();
    let mut roads = TrainRoads { net, agents: &agents, scene, ways_s: BTreeMap::new() };
    let order = stream("traffic/order", 0).sample_indices(points.len(), wanted);
    for (i, &(lane, along)) in order.into_iter().map(|k| &points[k]).enumerate() {
        let mut draw = stream("traffic/vehicle", i as u64);
        let Some(&model) = draw.choose_weighted(&catalogue, |m| input.catalogue.weight(m)) else { return };
        let Some(paint) = draw.choose(model.paints) else { return };
        let reckless = draw.chance(traffic.reckless_background);
        let distracted = draw.chance(traffic.distracted_background) && !reckless;
        let difference = draw.uniform(-0.4, 0.2);
        let gap = draw.normal(4.2, 1.0).max(0.0);
        let emergency = draw.chance(traffic.emergency_lights) && fleet::is_emergency(model);
        let driver = DriverProfile::new(
            model,
            reckless,
            distracted,
            traffic.speed_difference.unwrap_or(difference),
            traffic.standstill_gap_m.unwrap_or(gap),
        );
        let mut articulated = stream("traffic/articulated", i as u64);
        if let Some(train) = train_instead(traffic, model, &mut articulated)
            && let Some(start) = roads.start(train, (lane, along), taken, &mut articulated)
        {
            let driver = DriverProfile::new(
                train.lead,
                reckless,
                distracted,
                // No faster than the limit.
                traffic.speed_difference.unwrap_or(difference).max(0.0),
                traffic.standstill_gap_m.unwrap_or(gap),
            );
            starts.push(Start { driver, ..start });
            continue;
        }
        let along_m = clear_of_junctions(net, lane, along, both(model));
        let place = net.lanes[lane].centre.place(along_m);
        let fits = clear_of_junctions(net, lane, along_m, both(model)) == along_m
            && !overhangs(net, lane, along_m, both(model))
            && !swings_out(net, lane, along_m, both(model));
        if !fits || !taken.is_free(&place.point, place.heading_rad, model.size_m) {
            continue;
        }
        taken.insert(place.point, place.heading_rad, model.size_m);
        starts.push(Start {
            model,
            color: paint.to_vec(),
            role: ActorRole::Background,
            driver,
            emergency,
            lane,
            along_m,
            point: place.point,
            yaw_rad: place.heading_rad,
            towed: None,
        });
    }
}

/// Whether a train drives in place of a background vehicle, and which.
fn train_instead(traffic: &TrafficSettings, model: &Model, draw: &mut Stream) -> Option<&'static Train> {
    let ordinary = model.special == Special::None;
    let base = if draw.chance(traffic.articulated_lorries) {
        BaseType::Truck
    } else if model.base == BaseType::Bus && ordinary && draw.chance(traffic.articulated_buses) {
        BaseType::Bus
    } else {
        return None;
    };
    draw.choose_common(&trains::of_base(base))
}

/// Where trains may be; what is known of the map is found when the first one of each kind is placed.
struct TrainRoads<'a> {
    net: &'a Net,
    agents: &'a [Point3<f64>],
    scene: &'a PlanSceneRow,
    /// By the name of what is towed.
    ways_s: BTreeMap<&'static str, Arc<[f64]>>,
}

impl TrainRoads<'_> {
    /// A train with its lead near a place on a lane, if there is room for it and it can get on from there.
    fn start(
        &mut self,
        train: &'static Train,
        (lane, along): (usize, f64),
        taken: &mut Taken,
        draw: &mut Stream,
    ) -> Option<Start> {
        let (net, model) = (self.net, train.lead);
        let reach_m = self.scene.spawn_radius_m + TRAIN_MPS * (self.scene.duration_s + self.scene.warmup_s);
        let enough_s = self.scene.duration_s + self.scene.warmup_s + SPARE_S;
        let ways_s = self
            .ways_s
            .entry(train.towed.name)
            .or_insert_with(|| wide_ways(net, train, self.agents, reach_m))
            .clone();
        let ends = [0.5 * model.size_m[0], train.rear_m()];
        let along_m = clear_of_junctions(net, lane, along, ends);
        let fits = clear_of_junctions(net, lane, along_m, ends) == along_m
            && !overhangs(net, lane, along_m, ends)
            && !swings_out(net, lane, along_m, ends);
        let behind = came_along(net, (lane, along_m), train.rear_m())?;
        let room_s = ways_s[lane] - along_m / net.lanes[lane].limit_mps;
        if !fits || room_s < enough_s || !behind.iter().all(|&l| ways_s[l] > 0.0) {
            return None;
        }
        let at = net.lanes[lane].centre.place(along_m);
        let hitch = hitch(train, at.point, at.heading_rad, at.pitch_rad);
        let yaw_rad = towed_yaw_rad(net, train, (lane, along_m), &behind);
        let point = middle(train, hitch, yaw_rad, at.pitch_rad);
        let sections = [(at.point, at.heading_rad, model.size_m), (point, yaw_rad, train.towed.size_m)];
        if !sections.iter().all(|&(at, yaw_rad, size_m)| taken.is_free(&at, yaw_rad, size_m)) {
            return None;
        }
        let colors = [model.paints, train.towed.paints].map(|paints| draw.choose(paints));
        let [Some(color), Some(towed_color)] = colors else { return None };
        for (at, yaw_rad, size_m) in sections {
            taken.insert(at, yaw_rad, size_m);
        }
        let color_of = |paint: &[u8; 3]| paint.to_vec();
        let towed =
            TowedStart { train, color: color_of(towed_color), point, yaw_rad, behind, ways_s, enough_s };
        Some(Start {
            model,
            color: color_of(color),
            role: ActorRole::Background,
            driver: DriverProfile::new(model, false, false, 0.0, 0.0),
            emergency: false,
            lane,
            along_m,
            point: at.point,
            yaw_rad: at.heading_rad,
            towed: Some(towed),
        })
    }
}

/// The lanes that a vehicle with its middle at a place and its rear so far behind came along, nearest first:
/// of those that merge the first one. None where the road begins later.
fn came_along(net: &Net, (lane, along_m): (usize, f64), rear_m: f64) -> Option<Vec<usize>> {
    let mut behind = Vec::new();
    let (mut at, mut left_m) = (lane, rear_m - along_m);
    while left_m > 0.0 {
        at = *net.lanes[at].previous.first()?;
        left_m -= net.lanes[at].centre.length_m;
        behind.push(at);
    }
    Some(behind)
}

/// From the middle of a vehicle to its front and its rear, metres.
fn both(model: &Model) -> [f64; 2] {
    [0.5 * model.size_m[0]; 2]
}

/// The map's spawn points, but for those in tight bends, which are shared like junctions: lane and metres
/// along it.
fn spawn_points(map: &Map, net: &Net, separation_m: f64) -> Vec<(usize, f64)> {
    let place = |pos: LanePos| {
        let lane = net.find(pos.lane).filter(|&l| net.lanes[l].junction.is_none())?;
        Some((lane, net.lanes[lane].centre.project(map.point_at(pos)?.position).0))
    };
    map.spawn_points(separation_m).into_iter().filter_map(place).collect()
}

/// Moves a start along its lane so that the vehicle neither hangs back into a junction nor stands in the next
/// one, as far as the lane is long enough.
fn clear_of_junctions(net: &Net, lane: usize, along_m: f64, ends_m: [f64; 2]) -> f64 {
    let [front_m, rear_m] = ends_m.map(|end_m| end_m + 0.6);
    let facts = &net.lanes[lane];
    let in_junction = |&i: &usize| net.lanes[i].junction.is_some();
    let low = if facts.previous.iter().any(in_junction) { rear_m } else { 0.0 };
    let high = facts.centre.length_m - if facts.next.iter().any(in_junction) { front_m } else { 0.0 };
    along_m.max(low).min(high.max(0.0))
}

/// Whether a vehicle there is so long that it would begin in a bend where others may have no room beside it.
fn swings_out(net: &Net, lane: usize, along_m: f64, [front_m, rear_m]: [f64; 2]) -> bool {
    let ends_m = [along_m - rear_m - BEND_END_M, along_m + front_m + BEND_END_M];
    let steps = ((ends_m[1] - ends_m[0]) / BEND_STEP_M).ceil();
    let place = |k: u32| ends_m[0] + (ends_m[1] - ends_m[0]) * f64::from(k) / steps;
    let bent = |k: u32| {
        let width_m = net.lanes[lane].centre.place(place(k)).width_m;
        net.curvature(lane, place(k)).abs() > STRAIGHT && is_tight(net.curvature(lane, place(k)), width_m)
    };
    front_m + rear_m > LONG_M && (0..=steps as u32).any(bent)
}

/// Whether a vehicle there would reach into a junction, over lanes of any length.
fn overhangs(net: &Net, lane: usize, along_m: f64, [front_m, rear_m]: [f64; 2]) -> bool {
    let reach = |forward: bool| {
        let from = if forward { net.lanes[lane].centre.length_m - along_m } else { along_m };
        let end_m = if forward { front_m } else { rear_m };
        let mut open = VecDeque::from([(lane, end_m - from)]);
        while let Some((at, left)) = open.pop_front() {
            let onward = if forward { &net.lanes[at].next } else { &net.lanes[at].previous };
            for &i in onward {
                if left > 0.0 && net.lanes[i].junction.is_some() {
                    return true;
                }
                if left > net.lanes[i].centre.length_m && open.len() < 64 {
                    open.push_back((i, left - net.lanes[i].centre.length_m));
                }
            }
        }
        false
    };
    reach(true) || reach(false)
}

/// The place of a planned pose: on the nearest lane outside junctions that runs its way.
fn nearest_place(map: &Map, net: &Net, at: Point3<f64>, yaw_rad: f64) -> Option<(usize, f64)> {
    let usable = |lane: &opendrive::LaneInfo| lane.junction.is_none() && net.find(lane.id).is_some();
    let hits = map.lanes_within(at, 2.0, usable);
    let runs_along = |hit: &&opendrive::LaneHit| {
        let way = net.find(hit.lane).map(|i| &net.lanes[i].centre);
        way.is_some_and(|w| frames::wrap_pi(w.place(w.project(at).0).heading_rad - yaw_rad).abs() < 1.0)
    };
    let lane = match hits.iter().find(runs_along) {
        Some(hit) => hit.lane,
        None => {
            map.nearest_lane(at, usable).or_else(|| map.nearest_lane(at, |l| net.find(l.id).is_some()))?.lane
        }
    };
    let index = net.find(lane)?;
    Some((index, net.lanes[index].centre.project(at).0))
}
