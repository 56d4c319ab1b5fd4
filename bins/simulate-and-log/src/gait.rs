//! How walkers walk: from where they are at each frame follows the phase of their stride, and the box about
//! their pose. While somebody stands or sits, the phase goes on with the time, and with it what they do then.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use catalogue::{Model, benches};
use frames::{Object, Pose, World};
use meshes::people::{APPEARANCES, Appearance, Walker};
use random::Stream;
use replay::packed::ModelError;
use schema::tables::{ActorRow, PlanModelRow, StateRow};
use schema::{ActorKind, ActorRole, FRAME_PERIOD_S, ObjectId};
use store::Store;

/// Share of the way to their speed that they come within a frame: strides get longer and shorter over some
/// four steps of it.
const EASE: f64 = 0.2;
/// Slower than this they stand, m/s.
const STANDS_MPS: f64 = 0.03;

/// A standing person shifts the weight to and fro in this time, seconds.
const IDLES_S: f64 = 4.5;

/// A pedestrian.
struct Pacer {
    body: Arc<Walker>,
    phase_rad: f64,
    gait_mps: Option<f64>,
}

/// The bodies of a scene's walkers.
#[derive(Default)]
pub(crate) struct Bodies {
    /// Those of packs, by model.
    own: BTreeMap<String, Arc<Walker>>,
    /// The others by model and variant.
    known: BTreeMap<(&'static str, u32), Arc<Walker>>,
    pacers: BTreeMap<ObjectId, Pacer>,
}

impl Bodies {
    /// With those of packs, as far as a scene has them.
    ///
    /// # Errors
    /// A model is missing, broken or another one.
    pub(crate) fn new(
        store: &Store,
        models: &[PlanModelRow],
        actors: &[ActorRow],
    ) -> Result<Self, ModelError> {
        let walks =
            |row: &&PlanModelRow| actors.iter().any(|a| a.kind == ActorKind::Walker && a.model == row.name);
        let read = |row: &PlanModelRow| {
            let model = replay::packed::read(store, [&row.name, &row.page, &row.hash])?;
            Ok(model.walker.map(|walker| (row.name.clone(), Arc::new(walker))))
        };
        let own = models.iter().filter(walks).filter_map(|row| read(row).transpose());
        Ok(Self { own: own.collect::<Result<_, ModelError>>()?, ..Self::default() })
    }

    /// Gives a walker the size of its body. Where a stride begins is drawn; those who stand in hazards take
    /// none.
    pub(crate) fn add(&mut self, actor: &mut ActorRow, model: &'static Model, seed: u64, scene: u32) {
        // A person in a wheelchair is as large as the wheelchair.
        if model.wheel_radius_m > 0.0 {
            return;
        }
        let make = || Arc::new(Walker::new(model, actor.variant));
        let body = match self.own.get(model.name) {
            Some(own) => Arc::clone(own),
            None => Arc::clone(self.known.entry((model.name, actor.variant)).or_insert_with(make)),
        };
        let [length_m, width_m, height_m] = body.size_m().to_array().map(f64::from);
        (actor.length_m, actor.width_m, actor.height_m) = (length_m, width_m, height_m);
        if actor.role != ActorRole::Hazard {
            let mut draw = Stream::new(seed, scene.into(), "simulate/gait", actor.id.into());
            let phase_rad = draw.uniform(0.0, TAU);
            self.pacers.insert(actor.id, Pacer { body, phase_rad, gait_mps: None });
        }
    }

    /// Puts those who sit so far before the back rest that they lean at it: traffic, which does not know
    /// their bodies, has all of them as far before it.
    pub(crate) fn seat(&self, states: &mut [StateRow]) {
        for state in states.iter_mut().filter(|state| state.seat_m > 0.0) {
            let Some(pacer) = self.pacers.get(&state.id) else { continue };
            let length_m = pacer.body.posed_box_m(&pacer.body.bones(0.0, 0.0, state.seat_m)).x;
            let pose = Pose::<World, Object>::from_xyz_wxyz(state.xyz_m, state.quaternion);
            let by = pose.forward() * (0.5 * f64::from(length_m) - benches::SITS_M);
            state.xyz_m = [0, 1, 2].map(|k| state.xyz_m[k] + by[k]);
        }
    }

    /// Says phase, stride and box of each walker; states come by frame.
    pub(crate) fn walk(&mut self, states: &mut [StateRow]) {
        for state in states {
            if let Some(pacer) = self.pacers.get_mut(&state.id) {
                pacer.step(state);
            }
        }
    }
}

/// The first variant from some on in which somebody of a model is dressed so as to sit.
pub(crate) fn seated_variant(model: &Model, variant: u32) -> u32 {
    let variants = (0..APPEARANCES).map(|k| (variant + k) % APPEARANCES);
    variants.into_iter().find(|v| Appearance::new(model, *v).may_sit()).unwrap_or(variant)
}

impl Pacer {
    fn step(&mut self, state: &mut StateRow) {
        let [x, y, _] = state.velocity_mps.map(f64::from);
        let speed_mps = (x * x + y * y).sqrt();
        let before = self.gait_mps.unwrap_or(speed_mps);
        let eased = before + EASE * (speed_mps - before);
        let gait_mps = if eased.max(speed_mps) < STANDS_MPS { 0.0 } else { eased };
        self.gait_mps = Some(gait_mps);
        let stride_m = f64::from(self.body.figure().stride_m(gait_mps as f32));
        if stride_m > 0.0 {
            // A foot stays where it is while the body goes on: a stride is a cycle.
            self.phase_rad += TAU * speed_mps * FRAME_PERIOD_S / stride_m;
        } else if self.body.idles() {
            self.phase_rad += TAU * FRAME_PERIOD_S / IDLES_S;
        }
        (state.phase_rad, state.gait_mps) = (self.phase_rad as f32, gait_mps as f32);
        let bones = self.body.bones(state.phase_rad, state.gait_mps, state.seat_m);
        state.size_m = self.body.posed_box_m(&bones).to_array();
    }
}
