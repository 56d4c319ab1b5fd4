//! Worlds of towns for tests, and readers of their triangles that share nothing with the crate.
#![expect(clippy::unwrap_used, reason = "helpers of tests: a town of ours that cannot be built fails them")]

use glam::Vec3;
use land::tiles::{Surroundings, TileMaker};
use nalgebra::Point3;
use opendrive::Map;
use schema::geometry::Snapshot;
use schema::tables::{ActorRow, FrameRow};
use schema::{ActorKind, Tag};
use settings::SceneryRules;
use world::{Moment, SceneWorld};

pub(crate) fn named(name: &str) -> Map {
    Map::new(town::generate(&town::named(name).unwrap()).unwrap())
}

pub(crate) fn demo() -> Map {
    named("convoy/demo")
}

pub(crate) fn rules() -> SceneryRules {
    SceneryRules { seed: 5, ..SceneryRules::default() }
}

/// What is within some 150 m of a place; ids from `first_id` on.
pub(crate) fn place(map: &Map, rules: &SceneryRules, centre: [f64; 3], first_id: usize) -> Surroundings {
    TileMaker::new(map, rules, catalogue::Catalogue::built_in()).around(&[centre], 100.0, first_id).unwrap()
}

/// Some place on a driving lane.
pub(crate) fn start(map: &Map) -> [f64; 3] {
    let hit = map.nearest_driving_lane(Point3::origin()).unwrap();
    map.lane_point(hit.lane, hit.s, 0.0).unwrap().position.coords.into()
}

pub(crate) fn empty_moment(frame: &FrameRow) -> Moment<'_> {
    Moment { states: &[], previous: &[], signals: &[], frame }
}

/// Heights and tags of everything on a vertical line, by brute force.
pub(crate) fn column(snapshot: &Snapshot, x: f64, y: f64) -> Vec<(f64, Tag)> {
    let p = snapshot.origin.local_from_world([x, y, 0.0]);
    let base = snapshot.origin.world_xyz()[2];
    let mut hits = Vec::new();
    for instance in &snapshot.instances {
        let mesh = snapshot.mesh(instance);
        let bounds = frames::Aabb::from_points(
            &mesh.aabb().corners().map(|c| instance.local_from_object.transform_point3(c)),
        );
        if p.x < bounds.min.x || p.x > bounds.max.x || p.y < bounds.min.y || p.y > bounds.max.y {
            continue;
        }
        for i in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(i).map(|v| instance.local_from_object.transform_point3(v));
            let det = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
            if det.abs() < 1e-9 {
                continue;
            }
            let u = ((p.x - a.x) * (c.y - a.y) - (c.x - a.x) * (p.y - a.y)) / det;
            let v = ((b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y)) / det;
            if u >= -1e-4 && v >= -1e-4 && u + v <= 1.0001 {
                let z: Vec3 = a + (b - a) * u + (c - a) * v;
                hits.push((f64::from(z.z) + base, mesh.part(i).tag));
            }
        }
    }
    hits
}

/// The world around a place of a generated town.
pub(crate) fn around(map: &Map, centre: [f64; 3]) -> (Vec<ActorRow>, SceneWorld) {
    let Surroundings { actors, ground } = place(map, &rules(), centre, 10);
    let world = SceneWorld::new(&actors, ground).unwrap();
    (actors, world)
}

/// The surfaces within some 100 m around a place, without anything on them.
pub(crate) fn bare(map: &Map, centre: [f64; 3]) -> SceneWorld {
    let rules = SceneryRules { building_density: 0.0, tree_density: 0.0, ..rules() };
    let Surroundings { mut actors, ground } = place(map, &rules, centre, 10);
    actors.retain(|a| a.kind == ActorKind::Surface);
    SceneWorld::new(&actors, ground).unwrap()
}

/// The tag of what is seen from above at each cell of a square, row by row from the south.
pub(crate) fn from_above(
    snapshot: &Snapshot,
    centre: [f64; 2],
    half_m: f64,
    cell_m: f64,
) -> (Vec<Option<Tag>>, usize) {
    let n = (2.0 * half_m / cell_m) as usize;
    let mut seen: Vec<(f32, Option<Tag>)> = vec![(f32::NEG_INFINITY, None); n * n];
    let corner = snapshot.origin.local_from_world([centre[0] - half_m, centre[1] - half_m, 0.0]);
    for instance in &snapshot.instances {
        let mesh = snapshot.mesh(instance);
        for i in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(i).map(|v| {
                let p = instance.local_from_object.transform_point3(v) - corner;
                Vec3::new(p.x / cell_m as f32 - 0.5, p.y / cell_m as f32 - 0.5, p.z)
            });
            let det = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let edge = n as f32 - 1.0;
            if det.abs() < 1e-9 || high.x < 0.0 || high.y < 0.0 || low.x > edge || low.y > edge {
                continue;
            }
            for y in (low.y.max(0.0).ceil() as usize)..=(high.y.min(edge) as usize) {
                for x in (low.x.max(0.0).ceil() as usize)..=(high.x.min(edge) as usize) {
                    let (dx, dy) = (x as f32 - a.x, y as f32 - a.y);
                    let u = (dx * (c.y - a.y) - (c.x - a.x) * dy) / det;
                    let v = ((b.x - a.x) * dy - dx * (b.y - a.y)) / det;
                    let z = a.z + u * (b.z - a.z) + v * (c.z - a.z);
                    let cell = &mut seen[y * n + x];
                    if u >= -1e-4 && v >= -1e-4 && u + v <= 1.0001 && z > cell.0 {
                        *cell = (z, Some(mesh.part(i).tag));
                    }
                }
            }
        }
    }
    (seen.into_iter().map(|(_, tag)| tag).collect(), n)
}
