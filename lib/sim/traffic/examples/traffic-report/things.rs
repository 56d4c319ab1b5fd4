//! Walkers and vehicles in buildings, parked cars, poles and other things that stand: by the triangles that
//! are drawn, not by what the simulator takes for them.

use std::collections::{BTreeMap, BTreeSet};

use catalogue::benches;
use frames::{Object, Pose, World};
use nalgebra::Point3;
use schema::geometry::Surface;
use schema::tables::ActorRow;
use schema::{ActorKind, Tag};

use super::film::{Body, Film};

/// What of a thing is lower than this over its foot is in the way, metres.
const HIGH_M: f64 = 1.6;
/// What is lower is stepped on, metres.
const STEP_M: f64 = 0.06;
/// Feet are looked for this far below the ground, metres.
const LOW_M: f64 = 0.5;
/// Poles of lights and signs are drawn this far into the ground, metres.
const SUNK_M: f64 = 0.15;
/// Walkers who touch a thing by less than this do not, metres.
const ROUNDING_M: f64 = 0.02;
/// Half the diagonal of the longest vehicle, metres.
const REACH_M: f64 = 7.0;
const CELL_M: f64 = 8.0;

/// A walker in a thing: state, walker, thing, the thing's model.
pub(crate) type Inside = (usize, u16, u16, String);

/// Triangles of a thing at walking height, in plan, and the ground that it stands on.
struct Thing<'a> {
    actor: &'a ActorRow,
    ground_m: f64,
    triangles: Vec<[[f64; 2]; 3]>,
}

impl<'a> Thing<'a> {
    fn new(actor: &'a ActorRow) -> Option<Self> {
        let size = [actor.length_m, actor.width_m, actor.height_m];
        let mesh = meshes::actors::actor_mesh(&actor.model, size, actor.variant)?;
        let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
        let lowest = mesh.pieces.iter().map(|p| f64::from(p.mesh.aabb().min.z)).fold(f64::INFINITY, f64::min);
        let hung = matches!(actor.kind, ActorKind::TrafficLight | ActorKind::Sign);
        let ground_m = if hung { lowest + SUNK_M } else { 0.0 };
        let mut triangles = Vec::new();
        for piece in &mesh.pieces {
            let Some(from_piece) = piece.joint.object_from_piece(&meshes::actors::Posture::default()) else {
                continue;
            };
            for i in 0..piece.mesh.triangles.len() {
                // Twigs give way; hedges do not.
                let twigs = actor.model.starts_with("tree") && piece.mesh.part(i).surface == Surface::Foliage;
                let corners = piece.mesh.corners(i).map(|p| from_piece.transform_point3(p));
                let [low, high] = [f32::min, f32::max]
                    .map(|pick| f64::from(pick(pick(corners[0].z, corners[1].z), corners[2].z)));
                if twigs || low > ground_m + HIGH_M || high < ground_m - LOW_M {
                    continue;
                }
                triangles.push(corners.map(|p| {
                    let at = pose * Point3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z));
                    [at.x, at.y]
                }));
            }
        }
        Some(Self { actor, ground_m: actor.xyz_m[2] + ground_m, triangles })
    }

    fn holds(&self, body: &Body, i: usize) -> bool {
        let at = body.track[i].at;
        let level = (self.ground_m - 2.0..self.ground_m + self.actor.height_m.max(2.0)).contains(&at.z);
        level && self.triangles.iter().any(|t| meets(body, i, t))
    }
}

/// Whether a body's footprint and a triangle overlap (separating axes).
fn meets(body: &Body, i: usize, triangle: &[[f64; 2]; 3]) -> bool {
    let snap = &body.track[i];
    // Bodies that crash are kept a little apart.
    let margin_m = if body.wheelbase_m > 0.0 { ROUNDING_M } else { -ROUNDING_M };
    let half = body.size_m.map(|v| 0.5 * v + margin_m);
    let corners = triangle.map(|[x, y]| snap.local(&Point3::new(x, y, 0.0)));
    let apart_of = |axis: [f64; 2]| {
        let reach = half[0] * axis[0].abs() + half[1] * axis[1].abs();
        let along = corners.map(|[x, y]| x * axis[0] + y * axis[1]);
        along.iter().all(|a| *a > reach) || along.iter().all(|a| *a < -reach)
    };
    let edges =
        [(0, 1), (1, 2), (2, 0)].map(|(a, b)| [corners[a][1] - corners[b][1], corners[b][0] - corners[a][0]]);
    !([[1.0, 0.0], [0.0, 1.0]].into_iter().chain(edges).any(apart_of))
}

/// Whether something is ground: a surface, paving, or what is flatter than a step.
fn is_stepped_on(actor: &ActorRow) -> bool {
    let is_paving = actor.semantic_tags == [Tag::Sidewalk as u8];
    actor.kind == ActorKind::Surface || is_paving || actor.height_m < STEP_M
}

/// People and vehicles inside obstacles.
#[derive(Debug, Default)]
pub(crate) struct Things {
    /// Walkers, not struck before.
    pub(crate) walkers: Vec<Inside>,
    /// Vehicles of ordinary drivers who had not crashed before.
    pub(crate) vehicles: Vec<Inside>,
}

/// Walkers and ordinary drivers in things: each pair once.
pub(crate) fn measure(film: &Film<'_>, fixed: &[&ActorRow]) -> Things {
    let things: Vec<Thing<'_>> =
        fixed.iter().filter(|actor| !is_stepped_on(actor)).filter_map(|actor| Thing::new(actor)).collect();
    let cell = |x: f64, y: f64| ((x / CELL_M).floor() as i32, (y / CELL_M).floor() as i32);
    let mut cells: BTreeMap<(i32, i32), Vec<usize>> = BTreeMap::new();
    for (n, thing) in things.iter().enumerate() {
        let reach = thing
            .triangles
            .iter()
            .flatten()
            .fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
                [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
            });
        if reach[0][0] > reach[1][0] {
            continue;
        }
        let (low, high) = (
            cell(reach[0][0] - REACH_M, reach[0][1] - REACH_M),
            cell(reach[1][0] + REACH_M, reach[1][1] + REACH_M),
        );
        for column in low.0..=high.0 {
            for row in low.1..=high.1 {
                cells.entry((column, row)).or_default().push(n);
            }
        }
    }
    let mut seen: BTreeSet<(u16, u16)> = BTreeSet::new();
    let mut found = Things::default();
    for i in film.samples() {
        let drivers = film.vehicles.iter().filter(|b| b.ordinary);
        for body in film.walkers.iter().chain(drivers).filter(|b| !b.is_wrecked(i)) {
            let at = body.track[i].at;
            for &n in cells.get(&cell(at.x, at.y)).into_iter().flatten() {
                let thing = &things[n];
                let pair = (body.id, thing.actor.id);
                // A person on a bench is over it.
                let seat = body.sits && thing.actor.model == benches::MODEL;
                if !seat && !seen.contains(&pair) && thing.holds(body, i) {
                    seen.insert(pair);
                    let list = if body.wheelbase_m > 0.0 { &mut found.vehicles } else { &mut found.walkers };
                    list.push((i, pair.0, pair.1, thing.actor.model.clone()));
                }
            }
        }
    }
    found
}
