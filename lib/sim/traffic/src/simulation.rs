//! The loop: signals, drivers, walkers, bodies, log.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use frames::{LocalOrigin, Object, Pose, World};
use nalgebra::Point3;
use schema::footprint::footprint;
use schema::tables::{ActorRow, FrameRow, PlanSceneRow, StateRow};
use schema::tile::TileIndex;
use schema::{FRAME_PERIOD_S, ObjectId};

use crate::acceleration::wished_acceleration;
use crate::activation::Activation;
use crate::bends::Bends;
use crate::bodies::{Bodies, Hit, Owner};
use crate::car_following::{COMFORT_BRAKING, MAX_ACCELERATION, MAX_BRAKING};
use crate::error::TrafficError;
use crate::given::GivenActors;
use crate::hazards::{Obstacle, Obstacles};
use crate::input::{SceneInput, SimulationLog};
use crate::junction::right_of_way::{Junctions, RightOfWay};
use crate::lane_change::change_lanes;
use crate::occupancy::Occupancy;
use crate::road::net::Net;
use crate::road::signals::Signals;
use crate::scene::initial_actors::InitialActors;
use crate::scene::lamps::{Lamp, lamps};
use crate::scene::log::{log_towed, log_vehicles, log_walkers, vehicle_lamps, weather_lamps};
use crate::scene::placing::{Streets, add_parked, place_vehicles, place_walkers};
use crate::scene::rolling::set_rolling;
use crate::scene::rows::Snapshot;
use crate::swept_path::SweptPaths;
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;
use crate::vehicle::attention::Class;
use crate::vehicle::towed::Towed;
use crate::walking::crowd::Crowd;
use crate::walking::fixtures::Fixtures;
use crate::walking::paths::Paths;
use crate::walking::routes::Routes;
use crate::walking::surroundings::Surroundings;
use crate::walking::together::keep_together;
use crate::walking::waiting::WaitingPlaces;
use crate::walking::walker::Walker;

/// Walkers' destinations are at most this many times as far from an agent's start as walkers' starts, and on
/// large maps at most so many metres for each second that is simulated.
const DESTINATION_RADII: f64 = 1.6;
const LARGE_DESTINATION_MPS: f64 = 35.0;
/// Maps that extend farther than this are large, metres: CARLA's large ones are 10 km long, the others less
/// than 3 km.
const LARGE_M: f64 = 5000.0;
/// A vehicle that is pushed by less than this drives on, m/s, unless that comes from ahead or behind: along
/// the vehicle by more than this share.
const HARMLESS_MPS: f64 = 1.0;
const BESIDE: f64 = 0.7;
/// Longest warm-up, seconds.
const MAX_WARMUP_S: f64 = 3600.0;

/// How far walkers' destinations are from an agent's start at most, metres, on a map that extends so far.
fn destination_radius_m(scene: &PlanSceneRow, extent_m: f64) -> f64 {
    let most_m = LARGE_DESTINATION_MPS * (scene.duration_s + scene.warmup_s);
    (DESTINATION_RADII * scene.spawn_radius_m).min(if extent_m > LARGE_M { most_m } else { f64::INFINITY })
}

/// Simulates a scene. `on_step` hears of steps done and in all, and may stop the simulation.
///
/// # Errors
/// When the plan or the map cannot be followed, ids run out, or `on_step` breaks.
pub fn simulate(
    input: &SceneInput<'_>,
    on_step: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<SimulationLog, TrafficError> {
    let scene = input.scene;
    let warmup = scene.warmup_s;
    if !(0.0..=MAX_WARMUP_S).contains(&warmup) {
        return Err(TrafficError::BadPlan {
            scene: scene.scene,
            field: "warmup_s",
            value: warmup.to_string(),
        });
    }
    // Frame -1 is the state one step before frame 0, so at least one step comes first.
    let lead = ((warmup / FRAME_PERIOD_S).round() as usize).max(1);
    let mut simulation = Simulation::new(input, lead)?;
    let total = lead + (scene.frames as usize).saturating_sub(1);
    for done in 0..=total {
        if done > 0 {
            simulation.step(done as u32 - 1);
            simulation.meet_fixed(done as i32 - lead as i32)?;
        }
        if done + 1 >= lead {
            simulation.record(done as i32 - lead as i32);
        }
        if on_step(done, total).is_break() {
            return Err(TrafficError::Interrupted { scene: scene.scene });
        }
    }
    simulation.log_signals(lead);
    simulation.standing.complete(&mut simulation.log);
    Ok(simulation.log)
}

/// What never moves near some places and was not known yet.
fn near(
    input: &SceneInput<'_>,
    places: &[Point3<f64>],
    tiles: &mut BTreeSet<TileIndex>,
) -> Result<Vec<ActorRow>, TrafficError> {
    match input.fixed.near(places, tiles) {
        ControlFlow::Continue(fixed) => Ok(fixed),
        ControlFlow::Break(()) => Err(TrafficError::Interrupted { scene: input.scene.scene }),
    }
}

struct Simulation<'a> {
    input: &'a SceneInput<'a>,
    net: Net,
    signals: Signals,
    paths: Paths,
    routes: Routes,
    fixtures: Fixtures,
    vehicles: Vec<Vehicle>,
    walkers: Vec<Walker>,
    given: GivenActors,
    /// Frame 0 is so many steps after the start.
    lead: usize,
    vehicle_ids: Vec<ObjectId>,
    walker_ids: Vec<ObjectId>,
    towed_ids: Vec<ObjectId>,
    /// The objects in hazards.
    standing: Obstacles,
    /// Tiles of the fixed world that somebody came near.
    tiles: BTreeSet<TileIndex>,
    /// Traffic lights there.
    lamps: Vec<Lamp>,
    /// Where road-side units stand.
    rsus: Vec<Point3<f64>>,
    occupancy: Occupancy,
    right_of_way: RightOfWay,
    bodies: Bodies,
    sweeps: SweptPaths,
    bends: Bends,
    activation: Activation,
    /// Poses one step ago, for velocities: vehicles, walkers, what is towed.
    before: Vec<Pose<World, Object>>,
    log: SimulationLog,
}

impl<'a> Simulation<'a> {
    fn new(input: &'a SceneInput<'a>, lead: usize) -> Result<Self, TrafficError> {
        let (map, scene) = (input.map, input.scene);
        let net = Net::new(map);
        if net.lanes.is_empty() {
            return Err(TrafficError::NoDrivingLanes { scene: scene.scene, map: scene.map.clone() });
        }
        let signals = Signals::new(map, &input.settings.traffic, scene.seed, u64::from(scene.scene));
        let paths = Paths::new(map, &net);
        let mut tiles = BTreeSet::new();
        let planned: Vec<Point3<f64>> = input.agents.iter().map(|a| a.xyz_m.into()).collect();
        let fixed = near(input, &planned, &mut tiles)?;
        let first_frame = -(lead as i32);
        let initial = InitialActors::draw(input, first_frame, &fixed, &net, &paths)?;
        let routes = Routes::new(&paths, &initial.agents, destination_radius_m(scene, net.extent_m()));
        let mut log = SimulationLog { signal_groups: signals.groups(map), ..SimulationLog::default() };
        // Bodies are made in this order: vehicles, the objects in hazards, walkers, parked vehicles; those of
        // actors on given trajectories first.
        let middle = initial.agents.first().map_or([0.0; 3], |p| (*p).into());
        let mut bodies = Bodies::new(LocalOrigin::near(middle));
        let in_hazards = initial.hazard_actors();
        let mut given = initial.given;
        let [agent_ids, other_ids] = &initial.ids.given;
        given.embody(&mut bodies, first_frame, [agent_ids, other_ids]);
        let [given_agents, given_others] = given.actor_rows();
        log.actors.extend(given_agents);
        log_vehicles(&mut log, &initial.ids, &initial.starts, &initial.rsus);
        let mut right_of_way = RightOfWay::new(net.lanes.len());
        let vehicles = place_vehicles(&net, &initial.starts, input, &mut bodies, &mut right_of_way);
        let in_the_way = fixed.iter().chain(log.actors.iter().filter(|a| a.fixed));
        let mut fixtures = Fixtures::default();
        in_the_way.filter_map(footprint).for_each(|place| {
            fixtures.add(&place);
        });
        let ids = initial.ids;
        let standing = Obstacles::new(&ids.hazards, initial.hazards.things, &mut bodies, &mut fixtures);
        let waiting = WaitingPlaces::new(&paths, &fixed);
        let streets = Streets {
            paths: &paths,
            routes: &routes,
            fixtures: &fixtures,
            waiting: &waiting,
            given: &given,
            frame: first_frame,
        };
        let walkers = place_walkers(input, &streets, &initial.walkers, &mut bodies);
        log_walkers(&mut log, &ids, &walkers);
        log.actors.extend(in_hazards);
        log_towed(&mut log, &ids, &initial.starts);
        log.actors.extend(given_others);
        log.hazards = initial.hazards.placed;
        let mut occupancy = Occupancy::new(net.lanes.len());
        add_parked(&fixed, &net, &mut occupancy.kerbside, &mut bodies);
        let mut simulation = Self {
            lamps: lamps(map, &fixed),
            tiles,
            rsus: initial.rsus.iter().map(|rsu| rsu.xyz_m.into()).collect(),
            bends: Bends::new(&net, vehicles.len()),
            activation: Activation {
                distance_m: input.settings.traffic.active_distance_m,
                agents: ids.agents.len(),
                given: given.agents_at(first_frame),
            },
            sweeps: SweptPaths::new(),
            standing,
            occupancy,
            before: Vec::new(),
            input,
            net,
            signals,
            paths,
            routes,
            fixtures,
            vehicles,
            walkers: walkers.into_iter().map(|(walker, _)| walker).collect(),
            given,
            lead,
            vehicle_ids: [ids.agents, ids.background].concat(),
            walker_ids: ids.walkers,
            towed_ids: ids.towed,
            right_of_way,
            bodies,
            log,
        };
        simulation.see_standing();
        if input.settings.traffic.moving_start {
            let Self { net, occupancy, bends, vehicles, given, .. } = &mut simulation;
            let mark = |occupancy: &mut Occupancy| given.mark(net, occupancy, first_frame);
            set_rolling(net, occupancy, bends, vehicles, &mark);
        } else {
            simulation.bends.start(&simulation.net, &mut simulation.vehicles);
        }
        simulation.remember();
        Ok(simulation)
    }

    /// Lets drivers know where the obstacles of hazards are now.
    fn see_standing(&mut self) {
        let things = self.standing.things().map(|thing| (thing.footprint(), thing.class()));
        self.sweeps.set_things(things);
        let on_lanes = self.standing.things().filter(|thing| thing.is_on_lane());
        self.occupancy.stand(&self.net, on_lanes.map(|thing| (thing.footprint(), thing.class())));
    }

    /// One step of time, from `step` to `step + 1`.
    fn step(&mut self, step: u32) {
        let frame = step as i32 - self.lead as i32;
        self.remember();
        let time_s = f64::from(step) * FRAME_PERIOD_S;
        self.perceive(step, frame);
        let wishes = self.wishes(step, time_s);
        self.given.add_vehicles(&mut self.sweeps, frame);
        self.drive(&wishes);
        self.given.drive(&mut self.bodies, frame + 1);
        self.walk(time_s, frame);
        self.standing.skid(&mut self.bodies);
        self.bodies.step();
        self.take_hits();
        for vehicle in self.vehicles.iter_mut().filter(|v| v.wake() != Activity::Asleep) {
            vehicle.move_doors();
        }
    }

    /// Takes in what stands where agents came near.
    fn meet_fixed(&mut self, frame: i32) -> Result<(), TrafficError> {
        let agents = self.vehicles[..self.activation.agents].iter().map(|v| v.motion().position());
        let given = self.given.agents_at(frame);
        let places: Vec<Point3<f64>> = agents.chain(self.rsus.iter().copied()).chain(given).collect();
        let fixed = near(self.input, &places, &mut self.tiles)?;
        if !fixed.is_empty() {
            add_parked(&fixed, &self.net, &mut self.occupancy.kerbside, &mut self.bodies);
            for place in fixed.iter().filter_map(footprint) {
                self.fixtures.add(&place);
            }
            self.lamps.extend(lamps(self.input.map, &fixed));
        }
        Ok(())
    }

    /// Updates perception: which vehicles are active, what drivers overlook, which vehicles are on the lanes
    /// or about to be.
    fn perceive(&mut self, step: u32, frame: i32) {
        if Activation::is_due(step) {
            self.activation.given = self.given.agents_at(frame);
            let reservations = self.right_of_way.reservations();
            self.activation.update(
                &self.net,
                reservations,
                &self.bends,
                &mut self.vehicles,
                &mut self.bodies,
            );
            self.activation.look_at_walkers(&self.vehicles, &mut self.walkers, &mut self.bodies);
        }
        for vehicle in self.vehicles.iter_mut().filter(|v| !v.is_crashed()) {
            vehicle.perceive(step);
        }
        self.occupancy.fill(&self.net, &self.vehicles);
        self.given.mark(&self.net, &mut self.occupancy, frame);
        change_lanes(&self.net, &mut self.occupancy, &mut self.vehicles, step);
        self.sweeps.clear();
        for walker in &self.walkers {
            walker.mark(&self.net, &mut self.occupancy);
            self.sweeps.add_walker(walker.position(), walker.radius_m());
        }
        self.given.add_walkers(&mut self.sweeps, frame);
    }

    /// The accelerations that drivers wish for, as vehicles can, m/s2.
    fn wishes(&mut self, step: u32, time_s: f64) -> Vec<f64> {
        let (net, signals, occupancy) = (&self.net, &self.signals, &self.occupancy);
        let now = Junctions { net, signals, occupancy, step, time_s };
        let approaches = self.right_of_way.serve(&now, &mut self.vehicles);
        let bends = self.bends.serve(net, &self.vehicles);
        let mut wishes = Vec::with_capacity(self.vehicles.len());
        for ((me, approach), bend_m) in approaches.iter().enumerate().zip(bends) {
            let vehicle = &self.vehicles[me];
            let wish = if vehicle.is_crashed() {
                self.sweeps.add_wreck(vehicle);
                0.0
            } else {
                let touching_m = self.sweeps.gaps_m(net, &self.vehicles, me);
                let wish =
                    || wished_acceleration(net, occupancy, &self.vehicles, me, approach, bend_m, &touching_m);
                match vehicle.wake() {
                    Activity::Asleep => 0.0,
                    Activity::Halting => wish().min(-COMFORT_BRAKING),
                    Activity::Awake | Activity::Drowsy => wish(),
                }
            };
            wishes.push(wish.clamp(-MAX_BRAKING, MAX_ACCELERATION));
        }
        wishes
    }

    /// Moves the vehicles, and tells their bodies where to be after the step.
    fn drive(&mut self, wishes: &[f64]) {
        for (vehicle, wish) in self.vehicles.iter_mut().zip(wishes) {
            if vehicle.is_crashed() {
                vehicle.bodies().for_each(|body| self.bodies.skid(body));
            } else if vehicle.wake() != Activity::Asleep {
                let kerbside = &self.occupancy.kerbside;
                if !kerbside.is_empty() && !vehicle.driver().is_away(Class::Vehicles) {
                    vehicle.make_room(&self.net, kerbside);
                }
                vehicle.drive(&self.net, *wish);
                for ((at, yaw_rad, size_m), body) in vehicle.sections().zip(vehicle.bodies()) {
                    self.bodies.drive(body, &at, yaw_rad, 0.5 * size_m[2]);
                }
            }
        }
    }

    /// Moves the walkers, and tells their bodies where to be after the step.
    fn walk(&mut self, time_s: f64, frame: i32) {
        let mut crowd = Crowd::default();
        for walker in &self.walkers {
            crowd.add(walker.position(), walker.velocity_mps(), walker.radius_m());
        }
        self.given.join(&mut crowd, frame);
        self.sweeps.settle();
        keep_together(&mut self.walkers);
        let surroundings = Surroundings {
            paths: &self.paths,
            routes: &self.routes,
            fixtures: &self.fixtures,
            net: &self.net,
            occupancy: &self.occupancy,
            vehicles: &self.vehicles,
            sweeps: &self.sweeps,
            signals: &self.signals,
            time_s,
        };
        for (me, walker) in self.walkers.iter_mut().enumerate().filter(|(_, w)| !w.is_asleep()) {
            let was_on_road = walker.is_on_road();
            walker.step(&surroundings, &mut crowd, me);
            let body = walker.body();
            if walker.is_on_road() != was_on_road {
                self.bodies.set_on_road(body, walker.is_on_road());
            }
            if walker.is_struck() {
                self.bodies.skid(body);
            } else {
                let height_m = walker.model().size_m[2];
                self.bodies.drive(body, &walker.position(), walker.yaw_rad(), 0.5 * height_m);
            }
        }
    }

    /// Ends the drive of vehicles that had an accident, and follows bodies that no driver steers or that were
    /// pushed.
    fn take_hits(&mut self) {
        for hit in self.bodies.hits() {
            let is_accident = self.is_accident(&hit);
            for owner in hit.owners {
                match owner {
                    Owner::Vehicle(i) => self.touch(i as usize, is_accident),
                    Owner::Walker(i) => {
                        if let Some(walker) = self.walkers.get_mut(i as usize) {
                            walker.strike();
                        }
                    }
                    Owner::Obstacle(i) => self.standing.hit(i),
                    Owner::Parked | Owner::Given(_) => {}
                }
            }
        }
        if self.standing.follow(&self.bodies, &mut self.fixtures) {
            self.see_standing();
        }
        for vehicle in self.vehicles.iter_mut().filter(|v| v.is_crashed()) {
            if let Some(body) = self.bodies.motion(vehicle.motion().body()) {
                vehicle.skid_to(&body);
            }
            if let Some(body) = vehicle.towed().and_then(|towed| self.bodies.motion(towed.body())) {
                vehicle.towed_skids_to(&body);
            }
        }
        for walker in self.walkers.iter_mut().filter(|w| w.is_struck()) {
            if let Some(body) = self.bodies.motion(walker.body()) {
                walker.skid_to(&body);
            }
        }
    }

    /// Whether those who hit each other stay where that leads them. Otherwise they drive on: who grazes
    /// something at its side, and one that pushes something light away.
    fn is_accident(&self, hit: &Hit) -> bool {
        let hurts = |owner: &Owner| match owner {
            Owner::Walker(_) => true,
            Owner::Given(i) => self.given.is_person(*i),
            Owner::Obstacle(i) => self.standing.get(*i).is_some_and(Obstacle::is_person),
            _ => false,
        };
        if hit.owners.iter().any(hurts) {
            return true;
        }
        let moves = hit.owners.iter().any(|owner| matches!(owner, Owner::Obstacle(_)));
        hit.owners.iter().zip(hit.change_mps).any(|(owner, change_mps)| {
            let Owner::Vehicle(i) = owner else { return false };
            let Some(vehicle) = self.vehicles.get(*i as usize).filter(|v| !v.is_crashed()) else {
                return false;
            };
            let (sin, cos) = frames::math::sin_cos(vehicle.motion().yaw_rad());
            let ahead = (cos * hit.along[0] + sin * hit.along[1]).abs();
            change_mps > HARMLESS_MPS || (!moves && ahead > BESIDE && !vehicle.stands())
        })
    }

    /// A vehicle was pushed: it has had an accident, or goes on from where that leaves it.
    fn touch(&mut self, index: usize, is_accident: bool) {
        let Some(vehicle) = self.vehicles.get_mut(index).filter(|v| !v.is_crashed()) else { return };
        let body = vehicle.motion().body();
        if is_accident {
            vehicle.crash();
            vehicle.bodies().for_each(|body| self.bodies.set_adrift(body));
        } else if let Some(at) = self.bodies.motion(body) {
            vehicle.nudge(&self.net, &at);
        }
    }

    /// Keeps the poses of this moment for the next one's velocities.
    fn remember(&mut self) {
        self.before.clear();
        self.before.extend(self.vehicles.iter().map(|v| v.motion().world_from_object()));
        self.before.extend(self.walkers.iter().map(Walker::world_from_object));
        self.before.extend(self.vehicles.iter().filter_map(Vehicle::towed).map(Towed::world_from_object));
        self.standing.remember();
    }

    fn record(&mut self, frame: i32) {
        let scene = self.input.scene;
        let weather = scene.weather_at(self.input.weather, frame);
        if frame >= 0 {
            let lights = &self.input.settings.lights;
            let night = weather.is_night();
            let row = FrameRow::new(
                frame as u32,
                &weather,
                night && !lights.street_lamps_off,
                night && !lights.buildings_off,
            );
            self.log.frames.push(row);
        }
        let rows = self.states(frame, weather_lamps(&weather));
        if frame == 0 {
            // Actor rows give the pose at frame 0.
            for actor in self.log.actors.iter_mut().filter(|a| !a.fixed) {
                if let Ok(i) = rows.binary_search_by_key(&actor.id, |r| r.id) {
                    (actor.xyz_m, actor.quaternion) = (rows[i].xyz_m, rows[i].quaternion);
                }
            }
        }
        self.log.states.extend(rows);
    }

    /// What the lights showed at frames -1 to the last, frame 0 being `lead` steps after the start. Programs
    /// follow the clock alone, so lights are known before anybody came near them, too.
    fn log_signals(&mut self, lead: usize) {
        self.lamps.sort_by_key(|lamp| lamp.id);
        for frame in -1..self.input.scene.frames as i32 {
            let time_s = f64::from(frame + lead as i32) * FRAME_PERIOD_S;
            let rows = self.lamps.iter().map(|lamp| lamp.row(&self.signals, frame, time_s));
            self.log.signals.extend(rows);
        }
    }

    /// The states of all that moves or has lamps, given the lamps that the weather asks for.
    fn states(&mut self, frame: i32, lamps: u32) -> Vec<StateRow> {
        let [mut rows, given] = self.given.states(frame, lamps);
        rows.reserve(self.before.len() + given.len());
        for (i, vehicle) in self.vehicles.iter().enumerate() {
            let motion = vehicle.motion();
            let snapshot = Snapshot {
                id: self.vehicle_ids[i],
                world_from_object: motion.world_from_object(),
                world_from_object_before: self.before[i],
                lean_rad: motion.lean_rad(vehicle.model()),
                steer_rad: motion.steer_rad(),
                phase_rad: motion.rolled_m() / vehicle.model().wheel_radius_m.max(0.05),
                seat_m: 0.0,
                lights: vehicle_lamps(&self.net, vehicle, lamps),
                door_rad: vehicle.doors().angles_rad(),
                dormant: vehicle.wake() == Activity::Asleep,
            };
            rows.push(snapshot.row(frame));
        }
        for (i, walker) in self.walkers.iter().enumerate() {
            let snapshot = Snapshot {
                id: self.walker_ids[i],
                world_from_object: walker.world_from_object(),
                world_from_object_before: self.before[self.vehicles.len() + i],
                lean_rad: [0.0; 2],
                steer_rad: 0.0,
                phase_rad: walker.wheel_angle_rad(),
                seat_m: walker.seat_m(),
                lights: 0,
                door_rad: [0.0; 4],
                dormant: walker.is_asleep(),
            };
            rows.push(snapshot.row(frame));
        }
        rows.extend(self.standing.states(frame, lamps));
        let first = self.vehicles.len() + self.walkers.len();
        let towed = self.vehicles.iter().filter_map(|v| Some((v, v.towed()?)));
        for (i, (vehicle, towed)) in towed.enumerate() {
            let snapshot = Snapshot {
                id: self.towed_ids[i],
                world_from_object: towed.world_from_object(),
                world_from_object_before: self.before[first + i],
                lean_rad: towed.lean_rad(),
                seat_m: 0.0,
                steer_rad: 0.0,
                phase_rad: towed.rolled_m() / towed.train().towed.wheel_radius_m,
                lights: vehicle_lamps(&self.net, vehicle, lamps),
                door_rad: [0.0; 4],
                dormant: vehicle.wake() == Activity::Asleep,
            };
            rows.push(snapshot.row(frame));
        }
        rows.extend(given);
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn destinations_are_as_far_as_published_and_nearer_on_large_maps() {
        // Durations, published radii of starts, and of destinations on small and on large maps.
        for (duration_s, spawn_radius_m, small, large) in
            [(8.0, 300.0, 480.0, 350.0), (16.0, 450.0, 720.0, 630.0), (32.0, 680.0, 1088.0, 1088.0)]
        {
            let scene = PlanSceneRow { duration_s, spawn_radius_m, warmup_s: 2.0, ..PlanSceneRow::default() };
            assert_eq!(destination_radius_m(&scene, 2900.0), small);
            assert_eq!(destination_radius_m(&scene, 10_000.0), large);
        }
    }
}
