//! The loop: signals, drivers, walkers, bodies, log.

use std::ops::ControlFlow;

use frames::{LocalOrigin, Object, Pose, World};
use random::Stream;
use schema::footprint::footprint;
use schema::scene_info::DriverInfo;
use schema::tables::{FrameRow, PlanSceneRow, SignalRow, StateRow, Weather};
use schema::{FRAME_PERIOD_S, ObjectId};

use crate::attention::Class;
use crate::bends::Bends;
use crate::bodies::Bodies;
use crate::change::change_lanes;
use crate::crowd::Crowd;
use crate::doors::Doors;
use crate::driver::{COMFORT_BRAKING, MAX_ACCELERATION, MAX_BRAKING};
use crate::fixtures::Fixtures;
use crate::hazards::Thing;
use crate::log::{Snapshot, rsu_actor, vehicle_actor, vehicle_lamps, walker_actor, weather_lamps};
use crate::net::Net;
use crate::occupancy::Occupancy;
use crate::paths::Paths;
use crate::placing::{WALKERS, add_fixed, lamps, place_vehicles, place_walkers};
use crate::reservations::Reservations;
use crate::routes::Routes;
use crate::signals::Signals;
use crate::sleep::{Wake, Watch};
use crate::spawn::{Start, ids, vehicle_starts};
use crate::sweep::Sweeps;
use crate::vehicles::{Vehicle, wished_acceleration};
use crate::walkers::{Place, Walker};
use crate::{SceneInput, SceneLog, TrafficError};

/// Walkers' destinations are at most this many times as far from an agent's start as walkers' starts, and on large maps at
/// most so many metres for each second that is simulated.
const DESTINATION_RADII: f64 = 1.6;
const LARGE_DESTINATION_MPS: f64 = 35.0;
/// Maps that extend farther than this are large, metres: CARLA's large ones are 10 km long, the others less than 3 km.
const LARGE_M: f64 = 5000.0;
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
) -> Result<SceneLog, TrafficError> {
    let scene = input.scene;
    let warmup = scene.warmup_s;
    if !(0.0..=MAX_WARMUP_S).contains(&warmup) {
        return Err(TrafficError::BadPlan {
            scene: scene.scene,
            field: "warmup_s",
            value: warmup.to_string(),
        });
    }
    let mut simulation = Simulation::new(input)?;
    // Frame -1 is the state one step before frame 0, so at least one step comes first.
    let lead = ((warmup / FRAME_PERIOD_S).round() as usize).max(1);
    let total = lead + (scene.frames as usize).saturating_sub(1);
    for done in 0..=total {
        if done > 0 {
            simulation.step(done as u32 - 1);
        }
        if done + 1 >= lead {
            simulation.record(done as i32 - lead as i32, done);
        }
        if on_step(done, total).is_break() {
            return Err(TrafficError::Interrupted { scene: scene.scene });
        }
    }
    Ok(simulation.log)
}

struct Simulation<'a> {
    input: &'a SceneInput<'a>,
    net: Net,
    signals: Signals,
    paths: Paths,
    routes: Routes,
    fixtures: Fixtures,
    vehicles: Vec<Vehicle>,
    starts: Vec<Start>,
    walkers: Vec<Walker>,
    vehicle_ids: Vec<ObjectId>,
    walker_ids: Vec<ObjectId>,
    /// Doors of each vehicle.
    doors: Vec<Doors>,
    /// Vehicles that stand in hazards.
    standing: Vec<(ObjectId, Thing)>,
    /// Traffic lights of the scene: object id, signal of the map.
    lamps: Vec<(ObjectId, usize)>,
    occupancy: Occupancy,
    reservations: Reservations,
    bodies: Bodies,
    sweeps: Sweeps,
    bends: Bends,
    watch: Watch,
    /// Poses one step ago, for velocities: vehicles, then walkers.
    before: Vec<Pose<World, Object>>,
    log: SceneLog,
}

impl<'a> Simulation<'a> {
    fn new(input: &'a SceneInput<'a>) -> Result<Self, TrafficError> {
        let (map, scene) = (input.map, input.scene);
        let number = u64::from(scene.scene);
        let net = Net::new(map);
        if net.lanes.is_empty() {
            return Err(TrafficError::NoDrivingLanes { scene: scene.scene, map: scene.map.clone() });
        }
        let signals = Signals::new(map, &input.settings.traffic, scene.seed, number);
        let paths = Paths::new(map, &net);
        let (starts, hazards) = vehicle_starts(input, &net)?;
        let agents = starts.iter().filter(|s| s.role != "background").map(|s| s.point).collect::<Vec<_>>();
        let routes = Routes::new(&paths, &agents, destination_radius_m(scene, net.extent_m()));
        let middle = agents.first().map_or([0.0; 3], |p| (*p).into());
        let mut bodies = Bodies::new(LocalOrigin::near(middle));

        let rsus: Vec<_> = input.agents.iter().filter(|a| a.agent.starts_with("rsu")).collect();
        let places = paths.draw_starts(scene.walkers, &agents, scene.spawn_radius_m, &|i| {
            Stream::new(scene.seed, number, "traffic/walker/place", i)
        });
        let all = ids(
            scene.scene,
            input.first_id,
            starts.len() + rsus.len() + places.len() + hazards.things.len(),
        )?;
        let (agent_ids, rest) = all.split_at(agents.len());
        let (rsu_ids, rest) = rest.split_at(rsus.len());
        let (background_ids, rest) = rest.split_at(starts.len() - agents.len());
        let (walker_ids, hazard_ids) = rest.split_at(places.len());

        let mut log = SceneLog::default();
        let vehicle_ids = [agent_ids, background_ids].concat();
        for (id, start) in agent_ids.iter().zip(&starts) {
            log.actors.push(vehicle_actor(*id, start));
        }
        for (id, agent) in rsu_ids.iter().zip(&rsus) {
            log.actors.push(rsu_actor(*id, agent));
        }
        for (id, start) in background_ids.iter().zip(&starts[agents.len()..]) {
            log.actors.push(vehicle_actor(*id, start));
            log.n_vehicles += 1;
            log.n_reckless += u32::from(start.driver.reckless);
            log.n_distracted += u32::from(start.driver.distracted);
            log.drivers.push(DriverInfo {
                id: *id,
                speed_difference: start.driver.speed_difference,
                standstill_gap_m: start.driver.idm.standstill_gap_m,
                reckless: start.driver.reckless,
                distracted: start.driver.distracted,
            });
        }
        let mut reservations = Reservations::new(net.lanes.len());
        let vehicles = place_vehicles(&net, &starts, input, &mut bodies, &mut reservations);
        let standing: Vec<_> =
            hazard_ids.iter().zip(&hazards.things).map(|(id, thing)| thing.actor(*id)).collect();
        let fixed = input.fixed.iter().chain(log.actors.iter().filter(|a| a.fixed)).chain(&standing);
        let fixtures = Fixtures::new(fixed.filter_map(footprint));
        let walkers = place_walkers(input, &paths, &routes, &fixtures, &places, &mut bodies);
        for ((walker, anywhere), id) in walkers.iter().zip(walker_ids) {
            log.actors.push(walker_actor(*id, walker, *anywhere));
            log.n_walkers += 1;
        }
        log.actors.extend(standing);
        add_fixed(input, &net, &mut bodies);
        let mut occupancy = Occupancy::new(net.lanes.len());
        for (i, thing) in hazards.things.iter().enumerate() {
            if thing.is_on_lane() {
                occupancy.stand(&net, &thing.point, thing.yaw_rad(), thing.size_m);
            }
            if thing.solid {
                bodies.fixed(&thing.point, thing.yaw_rad(), thing.size_m, 3 * WALKERS + i as u32);
            }
        }
        let sweeps = Sweeps::new(hazards.things.iter().map(|t| (t.point, t.yaw_rad(), t.size_m)));
        log.hazards = hazards.placed;
        log.signal_groups = signals.groups(map);
        let standing =
            hazard_ids.iter().copied().zip(hazards.things).filter(|(_, t)| t.has_states()).collect();
        let doors = starts.iter().enumerate().map(|(i, start)| {
            let chance = if start.role == "background" { input.settings.traffic.door_open } else { 0.0 };
            Doors::new(start.model, chance, Stream::new(scene.seed, number, "traffic/doors", i as u64))
        });
        let doors = doors.collect();
        let bends = Bends::new(&net, vehicles.len());
        let watch = Watch { distance_m: input.settings.traffic.active_distance_m, agents: agents.len() };
        let mut simulation = Self {
            lamps: lamps(map, input),
            doors,
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
            starts,
            walkers: walkers.into_iter().map(|(walker, _)| walker).collect(),
            vehicle_ids,
            walker_ids: walker_ids.to_vec(),
            reservations,
            bodies,
            sweeps,
            bends,
            watch,
            log,
        };
        simulation.remember();
        Ok(simulation)
    }

    /// One step of time, from `step` to `step + 1`.
    fn step(&mut self, step: u32) {
        self.remember();
        let time_s = f64::from(step) * FRAME_PERIOD_S;
        if Watch::is_due(step) {
            self.watch.look(&self.net, &self.reservations, &self.bends, &mut self.vehicles, &mut self.bodies);
            self.watch.look_at_walkers(&self.vehicles, &mut self.walkers, &mut self.bodies);
        }
        for vehicle in self.vehicles.iter_mut().filter(|v| !v.crashed) {
            vehicle.attention.look(step);
        }
        self.occupancy.fill(&self.net, &self.vehicles);
        change_lanes(&self.net, &mut self.occupancy, &mut self.vehicles, step);
        self.sweeps.clear();
        for walker in &self.walkers {
            walker.mark(&self.net, &mut self.occupancy);
            self.sweeps.add_walker(walker.point, walker.radius_m());
        }
        let approaches = self.reservations.serve(
            &self.net,
            &self.signals,
            &self.occupancy,
            &mut self.vehicles,
            step,
            time_s,
        );
        let bends = self.bends.serve(&self.net, &self.vehicles);
        let mut wishes = Vec::with_capacity(self.vehicles.len());
        for (me, approach) in approaches.iter().enumerate() {
            let wish = if self.vehicles[me].crashed {
                0.0
            } else {
                let vehicle = &self.vehicles[me];
                let sees = !vehicle.attention.is_away(Class::Walkers);
                let touching_m = sees.then(|| self.sweeps.gap_m(&self.net, vehicle)).flatten();
                let gaps = [bends[me], touching_m];
                let wish =
                    || wished_acceleration(&self.net, &self.occupancy, &self.vehicles, me, approach, gaps);
                match vehicle.wake {
                    Wake::Asleep => 0.0,
                    Wake::Halting => wish().min(-COMFORT_BRAKING),
                    Wake::Awake | Wake::Drowsy => wish(),
                }
            };
            wishes.push(wish.clamp(-MAX_BRAKING, MAX_ACCELERATION));
        }
        for (vehicle, wish) in self.vehicles.iter_mut().zip(&wishes) {
            if vehicle.crashed {
                self.bodies.skid(vehicle.body);
            } else if vehicle.wake != Wake::Asleep {
                vehicle.advance(&self.net, *wish);
                self.bodies.drive(
                    vehicle.body,
                    &vehicle.place.point,
                    vehicle.yaw_rad,
                    0.5 * vehicle.model.size_m[2],
                );
            }
        }
        let mut crowd = Crowd::default();
        for walker in &self.walkers {
            crowd.add(walker.point, walker.velocity_mps, walker.radius_m());
        }
        self.sweeps.settle();
        let place = Place {
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
        for (me, walker) in self.walkers.iter_mut().enumerate().filter(|(_, w)| !w.asleep) {
            let was_on_road = walker.is_on_road();
            walker.step(&place, &mut crowd, me);
            if walker.is_on_road() != was_on_road {
                self.bodies.set_on_road(walker.body, walker.is_on_road());
            }
            if walker.is_struck() {
                self.bodies.skid(walker.body);
            } else {
                self.bodies.drive(walker.body, &walker.point, walker.yaw_rad, 0.5 * walker.model.size_m[2]);
            }
        }
        self.bodies.step();
        self.take_hits();
        let vehicles = self.doors.iter_mut().zip(&self.vehicles);
        for (doors, vehicle) in vehicles.filter(|(_, v)| v.wake != Wake::Asleep) {
            doors.step(vehicle.speed_mps);
        }
    }

    /// Ends the drive of whoever touched something, and follows bodies that nobody steers.
    fn take_hits(&mut self) {
        for (a, b) in self.bodies.hits() {
            for owner in [a, b] {
                if let Some(vehicle) = self.vehicles.get_mut(owner as usize) {
                    vehicle.crashed = true;
                } else if let Some(walker) =
                    owner.checked_sub(WALKERS).and_then(|w| self.walkers.get_mut(w as usize))
                {
                    walker.strike();
                }
            }
        }
        for vehicle in self.vehicles.iter_mut().filter(|v| v.crashed) {
            let Some(motion) = self.bodies.motion(vehicle.body) else { continue };
            vehicle.slide_to(motion.x_m, motion.y_m);
            vehicle.yaw_rad = motion.yaw_rad;
            let [x, y] = motion.velocity_mps;
            vehicle.speed_mps = (x * x + y * y).sqrt();
            vehicle.acceleration_mps2 = -COMFORT_BRAKING;
        }
        for walker in self.walkers.iter_mut().filter(|w| w.is_struck()) {
            let Some(motion) = self.bodies.motion(walker.body) else { continue };
            (walker.point.x, walker.point.y, walker.yaw_rad) = (motion.x_m, motion.y_m, motion.yaw_rad);
        }
    }

    /// Keeps the poses of this moment for the next one's velocities.
    fn remember(&mut self) {
        self.before.clear();
        self.before.extend(self.vehicles.iter().map(vehicle_pose));
        self.before.extend(self.walkers.iter().map(walker_pose));
    }

    fn record(&mut self, frame: i32, step: usize) {
        let scene = self.input.scene;
        let (initial, last) =
            (Weather::from_array(scene.initial_weather), Weather::from_array(scene.final_weather));
        // Frame 0 has moved one part already; the last frame has the final weather.
        let share = (f64::from(frame) + 1.0) / f64::from(scene.frames.max(1));
        let weather = if scene.dynamic_weather { initial.mix(&last, share) } else { initial };
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
        let lamps = weather_lamps(&weather);
        let mut rows: Vec<StateRow> = Vec::with_capacity(self.before.len());
        for (i, vehicle) in self.vehicles.iter().enumerate() {
            let emergency = self.starts[i].emergency;
            let snapshot = Snapshot {
                id: self.vehicle_ids[i],
                world_from_object: vehicle_pose(vehicle),
                world_from_object_before: self.before[i],
                steer_rad: vehicle.steer_rad,
                phase_rad: vehicle.rolled_m / vehicle.model.wheel_radius_m.max(0.05),
                lights: vehicle_lamps(&self.net, vehicle, lamps, emergency),
                door_rad: self.doors[i].angles_rad(),
            };
            rows.push(snapshot.row(frame));
        }
        for (i, walker) in self.walkers.iter().enumerate() {
            let snapshot = Snapshot {
                id: self.walker_ids[i],
                world_from_object: walker_pose(walker),
                world_from_object_before: self.before[self.vehicles.len() + i],
                steer_rad: 0.0,
                phase_rad: walker.gait_phase_rad(),
                lights: 0,
                door_rad: [0.0; 4],
            };
            rows.push(snapshot.row(frame));
        }
        rows.extend(self.standing.iter().map(|(id, thing)| thing.snapshot(*id, lamps).row(frame)));
        if frame == 0 {
            // Actor rows give the pose at frame 0.
            for actor in self.log.actors.iter_mut().filter(|a| !a.fixed) {
                if let Ok(i) = rows.binary_search_by_key(&actor.id, |r| r.id) {
                    (actor.xyz_m, actor.quaternion) = (rows[i].xyz_m, rows[i].quaternion);
                }
            }
        }
        self.log.states.extend(rows);
        let time_s = step as f64 * FRAME_PERIOD_S;
        let map_signals = self.input.map.signals();
        self.log.signals.extend(self.lamps.iter().map(|&(id, signal)| SignalRow {
            frame,
            id,
            state: self.signals.state(signal, time_s).name().into(),
            opendrive_id: map_signals[signal].id.clone(),
        }));
    }
}

/// Pose of a vehicle on the slope under it, leaning on its springs: the slope is given along the road, the body may be
/// askew.
fn vehicle_pose(vehicle: &Vehicle) -> Pose<World, Object> {
    let place = &vehicle.place;
    let (sin, cos) = frames::math::sin_cos(vehicle.yaw_rad - place.heading_rad);
    let pitch = place.pitch_rad * cos - place.roll_rad * sin;
    let roll = place.roll_rad * cos + place.pitch_rad * sin;
    let sway = &vehicle.sway;
    Pose::from_xyz_rpy(place.point.into(), [roll + sway.roll_rad, pitch + sway.pitch_rad, vehicle.yaw_rad])
}

fn walker_pose(walker: &Walker) -> Pose<World, Object> {
    Pose::from_xyz_rpy(walker.point.into(), [0.0, 0.0, walker.yaw_rad])
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
