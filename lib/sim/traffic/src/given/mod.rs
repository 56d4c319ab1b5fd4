//! Actors on trajectories that the user gave: they go where these say, whatever happens, and all others keep
//! off them.

mod actor;

use nalgebra::{Point3, Vector2};
use random::Stream;
use schema::tables::{ActorRow, StateRow};
use schema::{ActorKind, ActorRole, AgentId, AgentKind, FRAME_PERIOD_S, ObjectId};

use self::actor::GivenActor;
use crate::bodies::{Bodies, Body, Owner};
use crate::error::TrafficError;
use crate::input::SceneInput;
use crate::occupancy::{CrossingWalker, GIVEN, Occupancy, STANDING};
use crate::road::net::Net;
use crate::scene::free_space::Taken;
use crate::scene::rows::{actor_lamps, moving};
use crate::swept_path::SweptPaths;
use crate::vehicle::attention::Class;
use crate::walking::crowd::{Crowd, radius_m};

/// Others look out for where such an actor is going to be within so many frames, at places this far apart,
/// metres.
const AHEAD_FRAMES: i32 = 60;
const AHEAD_EVERY_M: f64 = 2.0;
/// Who reaches this far over the edge of a lane is not yet on it, metres.
const OVER_EDGE_M: f64 = 0.4;
/// Lanes whose direction differs by more than this from the actor's are crossed, radians.
const CROSSES_RAD: f64 = 0.5;
/// Nobody starts where such a vehicle passes; places are this far apart, metres.
const KEPT_EVERY_M: f64 = 2.0;
/// Walkers are on lanes within this distance of their middle, metres.
const LANE_REACH_M: f64 = 0.3;
/// Walkers do not step before a vehicle that comes within so many frames, looked at in such steps.
const SOON_FRAMES: i32 = 30;
const SOON_STEP: usize = 5;

/// All of them, agents first.
#[derive(Debug, Default)]
pub(crate) struct GivenActors {
    actors: Vec<GivenActor>,
    bodies: Vec<Body>,
    ids: Vec<ObjectId>,
    /// The first so many are agents.
    agents: usize,
}

impl GivenActors {
    /// Those of a scene's plan.
    ///
    /// # Errors
    /// A model is not in the catalogue.
    pub(crate) fn new(input: &SceneInput<'_>) -> Result<Self, TrafficError> {
        let scene = input.scene;
        let mut actors = Vec::new();
        for (number, rows) in input.trajectories.chunk_by(|a, b| a.actor == b.actor).enumerate() {
            let (name, wanted) = (&rows[0].actor, &rows[0].model);
            let model = input.catalogue.find(wanted).ok_or_else(|| TrafficError::UnknownGivenModel {
                scene: scene.scene,
                actor: name.clone(),
                model: wanted.clone(),
            })?;
            let agent: Option<AgentId> = name.parse().ok();
            let agent = input.agents.iter().find(|a| Some(a.agent) == agent);
            let mut paint = Stream::new(scene.seed, u64::from(scene.scene), "traffic/given", number as u64);
            let color = match agent {
                Some(agent) => agent.color.clone(),
                None => paint.choose(model.paints).copied().unwrap_or([128; 3]).to_vec(),
            };
            let role = match agent {
                Some(agent) => ActorRole::Agent(agent.agent),
                None if model.wheelbase_m > 0.0 => ActorRole::Background,
                None => ActorRole::Walker,
            };
            actors.push(GivenActor::new(model, color, role, rows));
        }
        let is_agent = |actor: &&GivenActor| matches!(actor.role(), ActorRole::Agent(_));
        let agents = actors.iter().take_while(is_agent).count();
        Ok(Self { actors, agents, ..Self::default() })
    }

    /// Whether an agent is among them.
    pub(crate) fn has(&self, agent: AgentId) -> bool {
        agent.kind == AgentKind::Vehicle
            && self.actors[..self.agents].iter().any(|a| a.role() == ActorRole::Agent(agent))
    }

    /// How many are agents, and how many are not.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [self.agents, self.actors.len() - self.agents]
    }

    /// Where the agents among them are.
    pub(crate) fn agents_at(&self, frame: i32) -> Vec<Point3<f64>> {
        self.actors[..self.agents].iter().map(|actor| actor.position(frame)).collect()
    }

    /// The pedestrians, as discs.
    pub(crate) fn walkers_at(&self, frame: i32) -> impl Iterator<Item = (Point3<f64>, Vector2<f64>, f64)> {
        let walkers = self.actors.iter().filter(|actor| !actor.is_vehicle());
        walkers.map(move |a| (a.position(frame), a.velocity_mps(frame).xy(), radius_m(a.model().size_m)))
    }

    /// Keeps the way of the vehicles free of whatever starts or stands there.
    pub(crate) fn keep_free(&self, taken: &mut Taken, frames: std::ops::Range<i32>) {
        for actor in self.actors.iter().filter(|actor| actor.is_vehicle()) {
            let mut kept: Option<Point3<f64>> = None;
            for frame in frames.clone() {
                let at = actor.position(frame);
                if kept.is_none_or(|kept| (kept - at).norm() > KEPT_EVERY_M) {
                    taken.insert(at, actor.yaw_rad(frame), actor.model().size_m);
                    kept = Some(at);
                }
            }
        }
    }

    /// Gives them bodies and ids: those of agents, and of the others.
    pub(crate) fn embody(&mut self, bodies: &mut Bodies, frame: i32, ids: [&[ObjectId]; 2]) {
        self.ids = ids.concat();
        for (i, actor) in self.actors.iter().enumerate() {
            let (at, owner) = (actor.position(frame), Owner::Given(i as u32));
            let body = if actor.is_vehicle() {
                bodies.vehicle(&at, actor.yaw_rad(frame), actor.model().size_m, owner)
            } else {
                let body = bodies.walker(&at, actor.model().size_m, owner);
                bodies.set_on_road(body, true);
                body
            };
            self.bodies.push(body);
        }
    }

    /// Whether one of them is a pedestrian.
    pub(crate) fn is_person(&self, number: u32) -> bool {
        self.actors.get(number as usize).is_some_and(|actor| !actor.is_vehicle())
    }

    /// Rows of the log: of agents, and of the others.
    pub(crate) fn actor_rows(&self) -> [Vec<ActorRow>; 2] {
        let row = |(actor, id): (&GivenActor, &ObjectId)| {
            let kind = if actor.is_vehicle() { ActorKind::Vehicle } else { ActorKind::Walker };
            let (model, pose) = (actor.model(), actor.pose(0));
            moving(*id, kind, actor.role(), model, actor.color(), &pose, model.facts())
        };
        let mut agents: Vec<ActorRow> = self.actors.iter().zip(&self.ids).map(row).collect();
        let others = agents.split_off(self.agents);
        [agents, others]
    }

    /// Lets drivers know where they are and are going to be: what they drive along on, they are on like any
    /// vehicle; others give way where they cross.
    pub(crate) fn mark(&self, net: &Net, occupancy: &mut Occupancy, frame: i32) {
        for actor in &self.actors {
            if actor.is_vehicle() {
                let stays = actor.stays_from(frame);
                let who = if stays { STANDING } else { GIVEN };
                let place = (&actor.position(frame), actor.yaw_rad(frame), actor.model().size_m);
                occupancy.add_body(net, place, actor.velocity_mps(frame), who, Class::Vehicles);
            }
            let mut marked: Option<Point3<f64>> = None;
            for then in frame..=frame + AHEAD_FRAMES {
                let at = actor.position(then);
                if marked.is_some_and(|marked| (marked - at).norm() < AHEAD_EVERY_M) {
                    continue;
                }
                marked = Some(at);
                let half_m = 0.5 * actor.model().size_m[1] - OVER_EDGE_M;
                let reach_m = if actor.is_vehicle() { half_m.max(0.0) } else { LANE_REACH_M };
                let in_s = f64::from(then - frame) * FRAME_PERIOD_S;
                for (lane, along_m) in net.lanes_at(&at, reach_m) {
                    let lane_rad = net.lanes[lane].centre.place(along_m).heading_rad;
                    let askew_rad = frames::wrap_pi(lane_rad - actor.yaw_rad(then)).abs();
                    if !actor.is_vehicle() || (then > frame && askew_rad > CROSSES_RAD) {
                        occupancy.add_walker(lane, CrossingWalker { along_m, in_s });
                    }
                }
                if actor.stays_from(then) {
                    break;
                }
            }
        }
    }

    /// Lets drivers and walkers know what ground they take: pedestrians, numbered after the others.
    pub(crate) fn add_walkers(&self, sweeps: &mut SweptPaths, frame: i32) {
        for (at, _, radius_m) in self.walkers_at(frame) {
            sweeps.add_walker(at, radius_m);
        }
    }

    /// The same of vehicles, for walkers.
    pub(crate) fn add_vehicles(&self, sweeps: &mut SweptPaths, frame: i32) {
        for actor in self.actors.iter().filter(|actor| actor.is_vehicle()) {
            let size_m = actor.model().size_m;
            let place = |frame: i32| (actor.position(frame), actor.yaw_rad(frame), size_m);
            sweeps.add_body(place(frame));
            (frame..=frame + SOON_FRAMES).step_by(SOON_STEP).for_each(|soon| sweeps.add_soon(place(soon)));
        }
    }

    /// The pedestrians among walkers.
    pub(crate) fn join(&self, crowd: &mut Crowd, frame: i32) {
        for (at, velocity_mps, radius_m) in self.walkers_at(frame) {
            crowd.add(at, velocity_mps, radius_m);
        }
    }

    /// Tells their bodies where to be after the step.
    pub(crate) fn drive(&self, bodies: &mut Bodies, frame: i32) {
        for (actor, body) in self.actors.iter().zip(&self.bodies) {
            let half_m = 0.5 * actor.model().size_m[2];
            bodies.drive(*body, &actor.position(frame), actor.yaw_rad(frame), half_m);
        }
    }

    /// Their states, given the lamps that the weather asks for: of agents, and of the others.
    pub(crate) fn states(&self, frame: i32, lamps: u32) -> [Vec<StateRow>; 2] {
        let row = |(actor, id): (&GivenActor, &ObjectId)| {
            let lamps = if actor.is_vehicle() {
                actor_lamps(lamps, actor.along_mps2(frame), actor.speed_mps(frame))
            } else {
                0
            };
            actor.snapshot(*id, frame, lamps).row(frame)
        };
        let mut agents: Vec<StateRow> = self.actors.iter().zip(&self.ids).map(row).collect();
        let others = agents.split_off(self.agents);
        [agents, others]
    }
}
