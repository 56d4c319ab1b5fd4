//! The scene's meshes, and which of them are where at a moment.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use catalogue::{RSU_MODEL, street_lamps};
use frames::math::f32::pow;
use frames::{LocalOrigin, Object, Pose, World};
use glam::{Affine3A, Mat3A, Quat, Vec3A};
use meshes::actors::{ActorMesh, Cabin, Coarser, Joint, Piece, Posture, Rig, actor_mesh, has_variants};
use rayon::prelude::*;
use schema::geometry::{HORIZON, Instance, ObjectMotion, Snapshot, SurfaceMesh, TriMesh};
use schema::tables::{ActorRow, FrameRow, LampRow, SignalRow, StateRow};
use schema::{ActorKind, Layer, ObjectId, SignalState, lights};

use crate::error::WorldError;
use crate::state::{flashing, local_from_level, local_from_state, usable};

/// What the log says about one frame.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// States of the moving objects at this frame.
    pub states: &'a [StateRow],
    /// Their states one frame earlier; an object without one is taken to have stood still.
    pub previous: &'a [StateRow],
    /// Traffic lights at this frame.
    pub signals: &'a [SignalRow],
    /// Whether lamps and windows are lit.
    pub frame: &'a FrameRow,
}

/// Lamps of something that never moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StaticLights {
    None,
    Signal,
    StreetLamp,
    Building,
    /// A work light: burns in the dark.
    Work,
}

/// An instance that never moves.
#[derive(Clone, Debug)]
struct Fixed {
    mesh: u32,
    object: ObjectId,
    /// Where its object's origin is.
    object_m: [f64; 3],
    seen: Range,
    origin_m: [f64; 3],
    rotation: Mat3A,
    paint: [f32; 3],
    lights: StaticLights,
    glow: [f32; 3],
}

impl Fixed {
    fn placed(&self, origin: &LocalOrigin, lights: u32) -> Instance {
        let zero = origin.world_xyz();
        let translation = Vec3A::from_array([0, 1, 2].map(|k| (self.origin_m[k] - zero[k]) as f32));
        let pose = Affine3A { matrix3: self.rotation, translation };
        Instance {
            mesh: self.mesh,
            object: self.object,
            local_from_object: pose,
            previous_local_from_object: pose,
            paint: self.paint,
            lights,
            glow: self.glow,
        }
    }
}

/// Bounding sphere in the world, metres; kept apart from [`Fixed`] so that culling reads little memory.
#[derive(Clone, Copy, Debug)]
struct Sphere {
    centre: [f64; 3],
    radius: f64,
}

impl Sphere {
    fn reaches(&self, centre: [f64; 3], radius: f64) -> bool {
        let d = [0, 1, 2].map(|k| self.centre[k] - centre[k]);
        let reach = radius + self.radius;
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= reach * reach
    }
}

/// Distances from the snapshot's centre to the object's origin at which a piece is there: all of an object
/// are then of one level.
#[derive(Clone, Copy, Debug)]
struct Range {
    from_m: f64,
    to_m: f64,
}

impl Range {
    const ALL: Self = Self { from_m: 0.0, to_m: f64::INFINITY };

    fn holds(&self, distance_m: f64) -> bool {
        self.from_m <= distance_m && distance_m < self.to_m
    }
}

/// The pieces of a model as mesh numbers and joints, and how far they reach around its origin.
#[derive(Clone, Debug)]
struct Pieces {
    pieces: Arc<[(u32, Joint, Range)]>,
    rig: Option<Arc<Rig>>,
    /// What is behind its panes: what nobody drives has the first, others all.
    cabin: Vec<u32>,
    reach_m: f64,
}

impl Pieces {
    fn posed(&self, posture: Posture) -> Posture {
        self.rig.as_ref().map_or(posture, |rig| rig.posed(posture))
    }
}

/// The lights that work sites are lit with.
const WORK_LIGHT: &str = "prop.construction_light";

/// Bounding radius of somebody with limbs, as a share of the sum of length, width and height.
const RIGGED_REACH: f64 = 1.0;

/// What a model's meshes depend on: name, bits of the size, variant.
type ModelKey = (String, [u64; 3], u32);

/// An object that moves.
#[derive(Clone, Debug)]
struct Mover {
    model: Pieces,
    paint: [f32; 3],
}

/// The world of one scene.
#[derive(Debug)]
pub struct SceneWorld {
    meshes: Arc<[Arc<TriMesh>]>,
    fixed: Vec<Fixed>,
    spheres: Vec<Sphere>,
    /// What is behind the panes of what never moves.
    fixed_cabins: Vec<Fixed>,
    /// What cameras see beyond all that.
    horizon: Vec<Fixed>,
    /// By object id.
    movers: BTreeMap<ObjectId, Mover>,
}

/// Models that are not made by rule, by name: they stand for the built-in ones of that name.
pub type OwnModels = BTreeMap<String, ActorMesh>;

/// What is known of the light on models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Light {
    /// None: needed only where pictures are painted.
    #[default]
    Any,
    /// What reaches them past themselves ([`TriMesh::corner_visibility`]).
    AmbientOcclusion,
}

/// Meshes while they are gathered: identical models share theirs.
#[derive(Default)]
struct Library {
    /// Models that nobody asked for yet.
    made: BTreeMap<ModelKey, ActorMesh>,
    meshes: Vec<Arc<TriMesh>>,
    models: BTreeMap<ModelKey, Pieces>,
}

fn model_key(actor: &ActorRow, own: &OwnModels) -> ModelKey {
    // Road-side units may carry any model name: their body is a pole.
    let model = if actor.kind == ActorKind::Rsu { RSU_MODEL } else { actor.model.as_str() };
    let size = [actor.length_m, actor.width_m, actor.height_m];
    // A model of a pack has one shape.
    let varies = !own.contains_key(model) && has_variants(model);
    let variant = if varies { street_lamps::shape_variant(actor) } else { 0 };
    (model.to_owned(), size.map(f64::to_bits), variant)
}

impl Library {
    fn add(&mut self, mesh: Arc<TriMesh>) -> u32 {
        self.meshes.push(mesh);
        (self.meshes.len() - 1) as u32
    }

    /// A library with the models of some rows at hand: they are made side by side, and numbered when they are
    /// asked for.
    fn with_models_of(rows: &[&ActorRow], own: &OwnModels, light: Light) -> Self {
        let keys: BTreeSet<ModelKey> = rows.iter().map(|actor| model_key(actor, own)).collect();
        let make = |key: ModelKey| {
            let made = match own.get(&key.0) {
                Some(own) => own.clone(),
                None => actor_mesh(&key.0, key.1.map(f64::from_bits), key.2)?,
            };
            let made = if light == Light::AmbientOcclusion { made.with_ambient_occlusion() } else { made };
            Some((key, made))
        };
        let keys: Vec<ModelKey> = keys.into_iter().collect();
        Self { made: keys.into_par_iter().filter_map(make).collect(), ..Self::default() }
    }

    fn pieces(&mut self, actor: &ActorRow, own: &OwnModels) -> Option<Pieces> {
        let key = model_key(actor, own);
        if let Some(known) = self.models.get(&key) {
            return Some(known.clone());
        }
        let size = key.1.map(f64::from_bits);
        let made = self.made.remove(&key)?;
        // A bone is nowhere farther than the box and a stride let it be.
        let mut reach = if made.rig.is_some() { RIGGED_REACH * size.iter().sum::<f64>() } else { 0.0 };
        let mut shared: Vec<(Arc<TriMesh>, u32)> = Vec::new();
        let mut pieces = Vec::new();
        for (seen, piece) in levels(made.pieces, made.coarser) {
            let joint_m = f64::from(piece.joint.at().length());
            let radius = piece.mesh.positions.iter().map(|p| p.length_squared()).fold(0.0, f32::max).sqrt();
            reach = reach.max(joint_m + f64::from(radius));
            // Wheels of a vehicle share one mesh.
            let known =
                shared.iter().find(|(mesh, _)| Arc::ptr_eq(mesh, &piece.mesh)).map(|(_, index)| *index);
            let index = known.unwrap_or_else(|| {
                let index = self.add(Arc::clone(&piece.mesh));
                shared.push((Arc::clone(&piece.mesh), index));
                index
            });
            pieces.push((index, piece.joint, seen));
        }
        let mut cabin = Vec::new();
        if let Some(Cabin { seats, driver }) = made.cabin {
            cabin.push(self.add(seats));
            cabin.extend(driver.map(|driver| self.add(driver)));
        }
        let entry = Pieces { pieces: pieces.into(), rig: made.rig, cabin, reach_m: reach };
        self.models.insert(key, entry.clone());
        Some(entry)
    }
}

impl SceneWorld {
    /// Builds the meshes of a scene: actors from their rows, and the ground, of which each layer is the
    /// object that the row of kind `surface` and of its name stands for. A layer without a row is left out.
    ///
    /// # Errors
    /// An id is used twice, a model is unknown, or a row has numbers that are not usable.
    pub fn new(actors: &[ActorRow], ground: Vec<SurfaceMesh>) -> Result<Self, WorldError> {
        Self::with_models(actors, ground, &OwnModels::new(), Light::Any)
    }

    /// The same, with models of packs, and with what light matters for.
    ///
    /// # Errors
    /// As [`SceneWorld::new`].
    pub fn with_models(
        actors: &[ActorRow],
        ground: Vec<SurfaceMesh>,
        own: &OwnModels,
        light: Light,
    ) -> Result<Self, WorldError> {
        let mut rows: Vec<&ActorRow> = actors.iter().collect();
        rows.sort_by_key(|a| a.id);
        if let Some(pair) = rows.windows(2).find(|p| p[0].id == p[1].id) {
            return Err(WorldError::DuplicateId { id: pair[0].id });
        }
        let layers = layers(&rows)?;
        rows.retain(|actor| actor.kind != ActorKind::Surface);
        rows.iter().try_for_each(|actor| check(actor))?;
        let mut library = Library::with_models_of(&rows, own, light);
        let mut world = Self {
            meshes: Arc::new([]),
            fixed: Vec::new(),
            spheres: Vec::new(),
            fixed_cabins: Vec::new(),
            horizon: Vec::new(),
            movers: BTreeMap::new(),
        };
        world.add_ground(&layers, ground, &mut library);
        for actor in rows {
            let unknown = || WorldError::UnknownModel { id: actor.id, model: actor.model.clone() };
            let model = library.pieces(actor, own).ok_or_else(unknown)?;
            let paint = linear_rgb(&actor.color);
            if actor.fixed {
                world.add_fixed(actor, &model, paint, &library);
            } else {
                world.movers.insert(actor.id, Mover { model, paint });
            }
        }
        world.meshes = library.meshes.into();
        Ok(world)
    }

    fn add_ground(
        &mut self,
        layers: &BTreeMap<Layer, ObjectId>,
        ground: Vec<SurfaceMesh>,
        library: &mut Library,
    ) {
        for SurfaceMesh { layer, origin_m, mesh } in ground {
            let Some(object) = layers.get(&layer).copied() else { continue };
            let mesh = library.add(Arc::new(mesh));
            let fixed = Fixed {
                mesh,
                object,
                object_m: origin_m,
                seen: Range::ALL,
                origin_m,
                rotation: Mat3A::IDENTITY,
                paint: [0.5; 3],
                lights: StaticLights::None,
                glow: [0.0; 3],
            };
            self.push_fixed(fixed, &library.meshes[mesh as usize]);
        }
    }

    fn add_fixed(&mut self, actor: &ActorRow, model: &Pieces, paint: [f32; 3], library: &Library) {
        let lights = match actor.kind {
            ActorKind::TrafficLight => StaticLights::Signal,
            ActorKind::Building => StaticLights::Building,
            _ if actor.model == WORK_LIGHT => StaticLights::Work,
            _ if street_lamps::is_street_lamp(actor) && !street_lamps::has_failed(actor) => {
                StaticLights::StreetLamp
            }
            _ => StaticLights::None,
        };
        let glow = match lights {
            StaticLights::StreetLamp | StaticLights::Work => linear_rgb(&lights::STREET_LAMP_RGB),
            StaticLights::Building => linear_rgb(&lights::WINDOW_RGB),
            _ => [0.0; 3],
        };
        let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
        let rotation = rotation(&pose);
        let posture = model.posed(Posture::default());
        for (mesh, joint, seen) in model.pieces.iter() {
            let Some(joint) = joint.object_from_piece(&posture) else { continue };
            let offset = rotation * joint.translation;
            let origin_m = [0, 1, 2].map(|k| actor.xyz_m[k] + f64::from(offset[k]));
            let fixed = Fixed {
                mesh: *mesh,
                object: actor.id,
                object_m: actor.xyz_m,
                seen: *seen,
                origin_m,
                rotation: rotation * joint.matrix3,
                paint,
                lights,
                glow,
            };
            self.push_fixed(fixed, &library.meshes[*mesh as usize]);
        }
        if let Some(mesh) = model.cabin.first() {
            self.fixed_cabins.push(Fixed {
                mesh: *mesh,
                object: actor.id,
                object_m: actor.xyz_m,
                seen: Range { from_m: 0.0, to_m: Cabin::UNTIL_M },
                origin_m: actor.xyz_m,
                rotation,
                paint,
                lights,
                glow,
            });
        }
    }

    fn push_fixed(&mut self, fixed: Fixed, mesh: &TriMesh) {
        let bounds = mesh.aabb();
        let (middle, half) = (0.5 * (bounds.min + bounds.max), 0.5 * (bounds.max - bounds.min));
        let centre = fixed.rotation * Vec3A::from(middle);
        let centre = [0, 1, 2].map(|k| fixed.origin_m[k] + f64::from(centre[k]));
        self.spheres.push(Sphere { centre, radius: f64::from(half.length()) });
        self.fixed.push(fixed);
    }

    /// Gives street lamps and windows the light that the log says. Without it they have their nominal one;
    /// lamps that do not work stay dark.
    pub fn set_lamps(&mut self, rows: &[LampRow]) {
        let rows: BTreeMap<ObjectId, &LampRow> = rows.iter().map(|row| (row.id, row)).collect();
        for fixed in &mut self.fixed {
            let Some(row) = rows.get(&fixed.object) else { continue };
            if !matches!(fixed.lights, StaticLights::StreetLamp | StaticLights::Building) {
                continue;
            }
            if !row.works {
                fixed.lights = StaticLights::None;
            }
            let strength =
                row.flux_lm.map_or(1.0, |flux| (flux / lights::STREET_LAMP_LM).clamp(0.0, 1e6) as f32);
            fixed.glow = linear_rgb(&row.color).map(|c| c * strength);
        }
    }

    /// Adds what cameras see between two distances from an agent, metres: meshes, each with the place of its
    /// origin in the world, which its distance counts by. They are the last ones of snapshots, of no object.
    pub fn add_horizon(&mut self, pieces: Vec<([f64; 3], TriMesh)>, between_m: [f64; 2]) {
        let mut meshes = self.meshes.to_vec();
        for (origin_m, mesh) in pieces {
            self.horizon.push(Fixed {
                mesh: meshes.len() as u32,
                object: HORIZON,
                object_m: origin_m,
                seen: Range { from_m: between_m[0], to_m: between_m[1] },
                origin_m,
                rotation: Mat3A::IDENTITY,
                paint: [0.5; 3],
                lights: StaticLights::Building,
                glow: linear_rgb(&lights::WINDOW_RGB),
            });
            meshes.push(Arc::new(mesh));
        }
        self.meshes = meshes.into();
    }

    /// All meshes of the scene; the same list in every snapshot.
    #[must_use]
    pub fn meshes(&self) -> Arc<[Arc<TriMesh>]> {
        Arc::clone(&self.meshes)
    }

    /// The instances within `radius_m` (by bounding spheres) of a place: first what never moves, by id and
    /// piece, then moving objects, by id and piece; then the [horizon](Self::add_horizon), if there is one.
    ///
    /// Rows of objects that are not among the scene's moving actors, or whose numbers are not finite, are
    /// passed over; moving actors without a state are absent.
    #[must_use]
    pub fn snapshot(&self, moment: &Moment<'_>, centre_world_m: [f64; 3], radius_m: f64) -> Snapshot {
        let origin = LocalOrigin::near(centre_world_m);
        let signals: BTreeMap<ObjectId, u32> =
            moment.signals.iter().map(|row| (row.id, signal_bits(row.state))).collect();
        let burning = |fixed: &Fixed| match fixed.lights {
            StaticLights::None => 0,
            StaticLights::Signal => signals.get(&fixed.object).copied().unwrap_or(0),
            StaticLights::StreetLamp if moment.frame.street_lamps => lights::STREET_LAMP,
            StaticLights::Work if moment.frame.weather().is_night() => lights::WORK_LAMP,
            StaticLights::Building if moment.frame.building_lights => lights::BUILDING,
            _ => 0,
        };
        let level = |fixed: &Fixed| fixed.seen.holds(distance_m(fixed.object_m, centre_world_m));
        let mut instances = self.fixed_around(&origin, centre_world_m, radius_m, level, burning);
        let mut previous: Vec<&StateRow> = moment.previous.iter().collect();
        previous.sort_by_key(|s| s.id);
        let mut states: Vec<&StateRow> = moment.states.iter().collect();
        states.sort_by_key(|s| s.id);
        states.dedup_by_key(|s| s.id);
        let parked = self.fixed_cabins.iter().filter(|cabin| level(cabin));
        let mut cabins: Vec<Instance> = parked.map(|cabin| cabin.placed(&origin, 0)).collect();
        let mut motions = Vec::new();
        for state in states {
            let Some(mover) = self.movers.get(&state.id) else { continue };
            let sphere = Sphere { centre: state.xyz_m, radius: mover.model.reach_m };
            if !usable(state) || !sphere.reaches(centre_world_m, radius_m) {
                continue;
            }
            let before = previous.binary_search_by_key(&state.id, |s| s.id).ok().map(|i| previous[i]);
            let before = before.filter(|s| usable(s)).unwrap_or(state);
            let now = local_from_state(&origin, state);
            let then = local_from_state(&origin, before);
            let [level_now, level_then] =
                [(state, now), (before, then)].map(|(state, pose)| local_from_level(&origin, state, pose));
            let [posture, posture_before] =
                [state, before].map(|state| mover.model.posed(Posture::from(state)));
            let lamps = flashing(state, moment.frame.time_s);
            motions.push(ObjectMotion {
                object: state.id,
                local_from_object: now,
                previous_local_from_object: then,
            });
            let distance_m = distance_m(state.xyz_m, centre_world_m);
            for (mesh, joint, seen) in mover.model.pieces.iter() {
                if !seen.holds(distance_m) {
                    continue;
                }
                let Some(piece_now) = joint.object_from_piece(&posture) else { continue };
                // A door that was still closed has swung from there.
                let piece_then = joint.object_from_piece(&posture_before).unwrap_or_else(|| joint.at_rest());
                let [body_now, body_then] =
                    if joint.stays_on_road() { [level_now, level_then] } else { [now, then] };
                instances.push(Instance {
                    mesh: *mesh,
                    object: state.id,
                    local_from_object: body_now * piece_now,
                    previous_local_from_object: body_then * piece_then,
                    paint: mover.paint,
                    lights: lamps,
                    glow: [0.0; 3],
                });
            }
            if distance_m < Cabin::UNTIL_M {
                cabins.extend(mover.model.cabin.iter().map(|mesh| Instance {
                    mesh: *mesh,
                    object: state.id,
                    local_from_object: now,
                    previous_local_from_object: then,
                    paint: mover.paint,
                    lights: 0,
                    glow: [0.0; 3],
                }));
            }
        }
        cabins.sort_by_key(|cabin| cabin.object);
        let far_off = self.horizon.iter().filter(|piece| level(piece));
        instances.extend(far_off.map(|piece| piece.placed(&origin, burning(piece))));
        Snapshot { origin, meshes: self.meshes(), instances, cabins, motions }
    }

    /// What never moves within `radius_m` (by bounding spheres) of a place, by id and piece, as detailed as
    /// it is at `detail_m` from an agent; no lamp burns.
    #[must_use]
    pub fn still(&self, centre_world_m: [f64; 3], radius_m: f64, detail_m: f64) -> Snapshot {
        let origin = LocalOrigin::near(centre_world_m);
        let instances =
            self.fixed_around(&origin, centre_world_m, radius_m, |fixed| fixed.seen.holds(detail_m), |_| 0);
        let near = self.fixed_cabins.iter().filter(|c| distance_m(c.object_m, centre_world_m) <= radius_m);
        let mut cabins: Vec<Instance> = near.map(|cabin| cabin.placed(&origin, 0)).collect();
        cabins.sort_by_key(|cabin| cabin.object);
        Snapshot { origin, meshes: self.meshes(), instances, cabins, motions: Vec::new() }
    }

    /// Whether an object may move; if not it is among what stands [`still`](Self::still).
    #[must_use]
    pub fn moves(&self, object: ObjectId) -> bool {
        self.movers.contains_key(&object)
    }

    fn fixed_around(
        &self,
        origin: &LocalOrigin,
        centre_world_m: [f64; 3],
        radius_m: f64,
        level: impl Fn(&Fixed) -> bool,
        burning: impl Fn(&Fixed) -> u32,
    ) -> Vec<Instance> {
        let near = self.fixed.iter().zip(&self.spheres);
        near.filter(|(fixed, sphere)| sphere.reaches(centre_world_m, radius_m) && level(fixed))
            .map(|(fixed, _)| fixed.placed(origin, burning(fixed)))
            .collect()
    }
}

fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    [0, 1, 2].map(|k| (a[k] - b[k]) * (a[k] - b[k])).iter().sum::<f64>().sqrt()
}

/// The pieces of all levels, each with the distances at which it is there.
fn levels(nearest: Vec<Piece>, coarser: Vec<Coarser>) -> Vec<(Range, Piece)> {
    let mut levels = vec![(0.0, nearest)];
    levels.extend(coarser.into_iter().map(|level| (level.from_m, level.pieces)));
    let ends: Vec<f64> = levels.iter().skip(1).map(|(from_m, _)| *from_m).chain([f64::INFINITY]).collect();
    let ranged = levels.into_iter().zip(ends);
    ranged
        .flat_map(|((from_m, pieces), to_m)| pieces.into_iter().map(move |p| (Range { from_m, to_m }, p)))
        .collect()
}

/// The objects that layers of the ground are.
fn layers(rows: &[&ActorRow]) -> Result<BTreeMap<Layer, ObjectId>, WorldError> {
    let surfaces = rows.iter().filter(|a| a.kind == ActorKind::Surface);
    let layer = |actor: &&&ActorRow| {
        let unknown = |_| WorldError::UnknownModel { id: actor.id, model: actor.model.clone() };
        Ok((actor.model.parse().map_err(unknown)?, actor.id))
    };
    surfaces.map(|actor| layer(&actor)).collect()
}

fn bad(actor: &ActorRow, problem: &'static str) -> WorldError {
    WorldError::BadActor { id: actor.id, model: actor.model.clone(), problem }
}

fn check(actor: &ActorRow) -> Result<(), WorldError> {
    let size = [actor.length_m, actor.width_m, actor.height_m];
    if !size.iter().all(|v| *v > 0.0 && *v < 1000.0) {
        return Err(bad(actor, "length, width and height must be between 0 and 1000 m"));
    }
    if !actor.xyz_m.iter().all(|v| v.abs() < 1e8) {
        return Err(bad(actor, "its position is not finite"));
    }
    let norm: f64 = actor.quaternion.iter().map(|q| q * q).sum();
    if !(0.5..2.0).contains(&norm) {
        return Err(bad(actor, "its orientation is no unit quaternion"));
    }
    Ok(())
}

fn rotation(pose: &Pose<World, Object>) -> Mat3A {
    let [w, x, y, z] = pose.wxyz();
    Mat3A::from_quat(Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32).normalize())
}

fn signal_bits(state: SignalState) -> u32 {
    match state {
        SignalState::Red => lights::SIGNAL_RED,
        SignalState::Yellow => lights::SIGNAL_YELLOW,
        SignalState::Green => lights::SIGNAL_GREEN,
        SignalState::Off => 0,
    }
}

/// sRGB bytes to linear light (IEC 61966-2-1); grey where a colour is incomplete.
fn linear_rgb(color: &[u8]) -> [f32; 3] {
    let [r, g, b] = *color else { return [0.2; 3] };
    [r, g, b].map(|byte| {
        let v = f32::from(byte) / 255.0;
        if v <= 0.040_45 { v / 12.92 } else { pow((v + 0.055) / 1.055, 2.4) }
    })
}
