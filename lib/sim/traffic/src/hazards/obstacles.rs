//! The obstacles of a scene's hazards, and where they come to lie when something hits them.

use frames::{Object, Pose, World};
use schema::ObjectId;
use schema::footprint::footprint;
use schema::tables::StateRow;

use super::obstacle::Obstacle;
use crate::bodies::{Bodies, Body, Owner};
use crate::input::SimulationLog;
use crate::walking::fixtures::Fixtures;

/// Moved by less than this it lies still, metres and radians.
const STILL: f64 = 1e-4;

/// One thing among them.
#[derive(Debug)]
struct Placed {
    id: ObjectId,
    thing: Obstacle,
    body: Option<Body>,
    /// Its pose one step ago.
    before: Pose<World, Object>,
    /// Something hit it.
    is_hit: bool,
    fixture: Option<usize>,
}

/// All of them.
#[derive(Debug, Default)]
pub(crate) struct Obstacles {
    placed: Vec<Placed>,
    /// Those that were hit, with the first frame that was logged with them.
    adrift: Vec<(usize, Option<i32>)>,
}

impl Obstacles {
    /// Gives bodies to things, in the order of their ids, and puts them in the way of walkers.
    pub(crate) fn new(
        ids: &[ObjectId],
        things: Vec<Obstacle>,
        bodies: &mut Bodies,
        fixtures: &mut Fixtures,
    ) -> Self {
        let place = |(index, (id, thing)): (usize, (&ObjectId, Obstacle))| {
            let (at, yaw_rad, size_m) = thing.footprint();
            let owner = Owner::Obstacle(index as u32);
            let body = thing.solid.then(|| bodies.movable(&at, yaw_rad, size_m, thing.mass_kg, owner));
            let fixture = footprint(&thing.actor(*id)).map(|place| fixtures.add(&place));
            Placed { id: *id, body, before: thing.pose(), is_hit: false, fixture, thing }
        };
        let placed = ids.iter().zip(things).enumerate().map(place).collect();
        Self { placed, adrift: Vec::new() }
    }

    /// All of them, where they are.
    pub(crate) fn things(&self) -> impl Iterator<Item = &Obstacle> {
        self.placed.iter().map(|p| &p.thing)
    }

    pub(crate) fn get(&self, index: u32) -> Option<&Obstacle> {
        self.placed.get(index as usize).map(|p| &p.thing)
    }

    /// Something hit one of them: from now on it lies where that pushed it.
    pub(crate) fn hit(&mut self, index: u32) {
        if let Some(placed) = self.placed.get_mut(index as usize)
            && !placed.is_hit
        {
            placed.is_hit = true;
            self.adrift.push((index as usize, None));
        }
    }

    /// Lets those that were hit skid on.
    pub(crate) fn skid(&self, bodies: &mut Bodies) {
        self.adrift.iter().filter_map(|(i, _)| self.placed[*i].body).for_each(|body| bodies.skid(body));
    }

    /// Takes over where they have skidded to; whether any of them has moved.
    pub(crate) fn follow(&mut self, bodies: &Bodies, fixtures: &mut Fixtures) -> bool {
        let mut moved = false;
        for (i, _) in &self.adrift {
            let placed = &mut self.placed[*i];
            let Some(to) = placed.body.and_then(|body| bodies.motion(body)) else { continue };
            let thing = &mut placed.thing;
            let off = (to.x_m - thing.point.x).abs() + (to.y_m - thing.point.y).abs();
            if off + frames::wrap_pi(to.yaw_rad - thing.yaw_rad()).abs() < STILL {
                continue;
            }
            thing.move_to([to.x_m, to.y_m], to.yaw_rad);
            if let Some((index, place)) = placed.fixture.zip(footprint(&thing.actor(placed.id))) {
                fixtures.replace(index, &place);
            }
            moved = true;
        }
        moved
    }

    /// Keeps the poses of this moment for the next one's velocities.
    pub(crate) fn remember(&mut self) {
        for (i, _) in &self.adrift {
            self.placed[*i].before = self.placed[*i].thing.pose();
        }
    }

    /// The states of those that are logged at every frame: vehicles, and what was hit before. Rows come by
    /// id.
    pub(crate) fn states(&mut self, frame: i32, lamps: u32) -> impl Iterator<Item = StateRow> {
        for (_, first) in &mut self.adrift {
            first.get_or_insert(frame);
        }
        let logged = self.placed.iter().filter(|p| p.thing.has_states() || p.is_hit);
        logged.map(move |p| p.thing.snapshot(p.id, &p.before, lamps).row(frame))
    }

    /// Completes the log: what was hit has a state at every frame, too, and is not fixed.
    pub(crate) fn complete(&self, log: &mut SimulationLog) {
        let mut missing = Vec::new();
        for (i, first) in &self.adrift {
            let (placed, Some(first)) = (&self.placed[*i], *first) else { continue };
            let Ok(row) = log.actors.binary_search_by_key(&placed.id, |a| a.id) else { continue };
            let actor = &mut log.actors[row];
            if actor.fixed {
                let (xyz_m, quaternion) = (actor.xyz_m, actor.quaternion);
                let still =
                    |frame| StateRow { frame, id: actor.id, xyz_m, quaternion, ..StateRow::default() };
                missing.extend((-1..first).map(still));
                actor.fixed = false;
            }
        }
        if !missing.is_empty() {
            log.states.extend(missing);
            log.states.sort_by_key(|s| (s.frame, s.id));
        }
        let adrift: Vec<ObjectId> = self.adrift.iter().map(|(i, _)| self.placed[*i].id).collect();
        for state in log.states.iter().filter(|s| s.frame == 0 && adrift.contains(&s.id)) {
            if let Ok(row) = log.actors.binary_search_by_key(&state.id, |a| a.id) {
                (log.actors[row].xyz_m, log.actors[row].quaternion) = (state.xyz_m, state.quaternion);
            }
        }
    }
}
