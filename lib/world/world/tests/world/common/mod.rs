//! Worlds of towns for tests, and readers of their triangles that share nothing with the crate.
#![expect(clippy::unwrap_used, reason = "helpers of tests: a town of ours that cannot be built fails them")]

use std::collections::HashMap;

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

/// Everything on vertical lines. Each is tried on all triangles that reach its cell.
pub(crate) struct Columns<'a> {
    snapshot: &'a Snapshot,
    /// Triangles as instance and number, by the cells that their bounds overlap.
    cells: HashMap<[i32; 2], Vec<[u32; 2]>>,
    /// Triangles of many cells: each line is tried on all of them.
    large: Vec<[u32; 2]>,
}

impl<'a> Columns<'a> {
    const CELL_M: f32 = 2.0;
    /// More than so many cells are large.
    const MOST_CELLS: i32 = 400;

    pub(crate) fn new(snapshot: &'a Snapshot) -> Self {
        let mut columns = Self { snapshot, cells: HashMap::new(), large: Vec::new() };
        for (number, instance) in (0..).zip(&snapshot.instances) {
            for triangle in 0..snapshot.mesh(instance).triangles.len() {
                let at = [number, triangle as u32];
                let [a, b, c] = columns.corners(at);
                // Wider by what a line may miss a triangle by.
                let low = ((a.min(b).min(c) - 0.01) / Self::CELL_M).floor().as_ivec3();
                let high = ((a.max(b).max(c) + 0.01) / Self::CELL_M).floor().as_ivec3();
                if (high.x - low.x + 1) * (high.y - low.y + 1) > Self::MOST_CELLS {
                    columns.large.push(at);
                    continue;
                }
                for cell in (low.x..=high.x).flat_map(|x| (low.y..=high.y).map(move |y| [x, y])) {
                    columns.cells.entry(cell).or_default().push(at);
                }
            }
        }
        columns
    }

    fn corners(&self, [instance, triangle]: [u32; 2]) -> [Vec3; 3] {
        let instance = &self.snapshot.instances[instance as usize];
        let corners = self.snapshot.mesh(instance).corners(triangle as usize);
        corners.map(|v| instance.local_from_object.transform_point3(v))
    }

    /// Heights and tags of everything at a place.
    pub(crate) fn at(&self, x: f64, y: f64) -> Vec<(f64, Tag)> {
        let p = self.snapshot.origin.local_from_world([x, y, 0.0]);
        let base = self.snapshot.origin.world_xyz()[2];
        let cell = [p.x, p.y].map(|v| (v / Self::CELL_M).floor() as i32);
        let hit = |at: &[u32; 2]| {
            let [a, b, c] = self.corners(*at);
            let det = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
            let u = ((p.x - a.x) * (c.y - a.y) - (c.x - a.x) * (p.y - a.y)) / det;
            let v = ((b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y)) / det;
            (det.abs() >= 1e-9 && u >= -1e-4 && v >= -1e-4 && u + v <= 1.0001).then(|| {
                let z = a.z + (b.z - a.z) * u + (c.z - a.z) * v;
                let mesh = self.snapshot.mesh(&self.snapshot.instances[at[0] as usize]);
                (f64::from(z) + base, mesh.part(at[1] as usize).tag)
            })
        };
        self.cells.get(&cell).into_iter().flatten().chain(&self.large).filter_map(hit).collect()
    }

    /// What is highest at a place.
    pub(crate) fn top(&self, x: f64, y: f64) -> (f64, Tag) {
        self.at(x, y).into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }
}

/// The world around a place of a generated town.
pub(crate) fn around(map: &Map, centre: [f64; 3]) -> (Vec<ActorRow>, SceneWorld) {
    let Surroundings { actors, ground } = place(map, &rules(), centre, 10);
    let world = SceneWorld::new(&actors, ground).unwrap();
    (actors, world)
}

/// The surfaces within some 100 m around a place, without anything on them.
pub(crate) fn bare(map: &Map, centre: [f64; 3]) -> SceneWorld {
    let rules = SceneryRules { density: 0.0, building_density: 0.0, tree_density: 0.0, ..rules() };
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
