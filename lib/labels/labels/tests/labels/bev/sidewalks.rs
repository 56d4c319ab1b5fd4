//! Sidewalks of whole maps: whoever stands on one, or at its kerb, has it in the mask.

use std::collections::BTreeMap;
use std::sync::Arc;

use frames::{Agent, LocalOrigin, Pose, World};
use glam::{Affine3A, Vec3};
use labels::bev::{Areas, BevMask, BevRasterizer};
use land::surfaces::{Atlas, Region};
use opendrive::{LaneType, Map};
use schema::geometry::{Instance, Snapshot, SurfaceMesh, TriMesh};
use schema::tile::{TILE_M, TileIndex};
use schema::{BevClass, Tag};
use settings::BevSettings;

/// Agents stand so far apart along lanes, metres.
const APART_M: f64 = 400.0;
/// Places on triangles are at most so far apart, metres.
const STEP_M: f64 = 0.1;
/// Places this near to an agent, in plan and in height, must be in its mask: `convoy check` looks farther.
const NEAR_M: [f64; 2] = [20.0, 1.0];
/// A place is on the mask if a cell of its class has its centre this near, cells.
const OFF_CELLS: f64 = 1.5;
/// What lies this much below another surface is not seen, metres.
const HIDDEN_M: f64 = 0.004;

/// A place in the world, metres.
type Place = [f64; 3];

/// A tile of the ground.
struct Tile {
    meshes: Vec<(Affine3A, Arc<TriMesh>)>,
    /// Places all over its sidewalks that can be seen.
    places: Vec<Place>,
}

/// Corners of the triangles of a piece of ground in the world, with their tags.
fn triangles(piece: &SurfaceMesh) -> impl Iterator<Item = ([Place; 3], Tag)> {
    (0..piece.mesh.triangles.len()).map(|i| {
        let corner = |p: Vec3| [0, 1, 2].map(|k| piece.origin_m[k] + f64::from(p.to_array()[k]));
        (piece.mesh.corners(i).map(corner), piece.mesh.part(i).tag)
    })
}

/// Places all over a triangle.
fn places([a, b, c]: [Place; 3], found: &mut Vec<Place>) {
    let sub = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| p[k] - q[k]);
    let norm = |p: [f64; 3]| p.iter().map(|v| v * v).sum::<f64>().sqrt();
    let (u, v) = (sub(b, a), sub(c, a));
    let steps = |edge: [f64; 3]| (norm(edge) / STEP_M).ceil().clamp(1.0, 500.0) as usize;
    let (m, n) = (steps(u), steps(v));
    for i in 0..m {
        for j in 0..n {
            let (s, t) = ((i as f64 + 0.5) / m as f64, (j as f64 + 0.5) / n as f64);
            if s + t < 1.0 {
                found.push([0, 1, 2].map(|k| a[k] + s * u[k] + t * v[k]));
            }
        }
    }
}

/// Height of a triangle over a place of the plan, if it lies there.
fn height_at([a, b, c]: [Place; 3], [x, y, _]: [f64; 3]) -> Option<f64> {
    let cross = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area.abs() < 1e-9 {
        return None;
    }
    let weights = [cross(b, c), cross(c, a), cross(a, b)].map(|w| w / area);
    weights.iter().all(|w| *w >= 0.0).then(|| weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2])
}

/// The ground of a map, tile by tile as it is asked for.
struct Lands<'a> {
    atlas: Atlas<'a>,
    tiles: BTreeMap<TileIndex, Tile>,
}

impl Lands<'_> {
    fn make(&mut self, index: TileIndex) {
        if self.tiles.contains_key(&index) {
            return;
        }
        let min = index.low_m();
        let surfaces = self.atlas.ground(&Region { min, max: min.map(|v| v + TILE_M) }).surfaces();
        // Triangles by the metre over which they lie, to see what hides what.
        let mut over: BTreeMap<[i64; 2], Vec<[Place; 3]>> = BTreeMap::new();
        let mut all = Vec::new();
        for (corners, tag) in surfaces.iter().flat_map(triangles) {
            let ends = |k: usize| {
                let values = corners.map(|p| p[k]);
                let low = values.iter().copied().fold(f64::INFINITY, f64::min).floor() as i64;
                (low, values.iter().copied().fold(f64::NEG_INFINITY, f64::max).floor() as i64)
            };
            let ((west, east), (south, north)) = (ends(0), ends(1));
            for x in west..=east {
                for y in south..=north {
                    over.entry([x, y]).or_default().push(corners);
                }
            }
            if tag == Tag::Sidewalk {
                places(corners, &mut all);
            }
        }
        let is_hidden = |place: &Place| {
            let [x, y, z] = *place;
            let near = over.get(&[x.floor() as i64, y.floor() as i64]).into_iter().flatten();
            near.filter_map(|corners| height_at(*corners, *place)).any(|top| top > z + HIDDEN_M)
        };
        all.retain(|place| !is_hidden(place));
        // Origins of the pieces are moved to the tile's: its numbers stay small.
        let meshes = surfaces.into_iter().map(|piece| {
            let [x, y, z] = piece.origin_m;
            let at = Vec3::new((x - min[0]) as f32, (y - min[1]) as f32, z as f32);
            (Affine3A::from_translation(at), Arc::new(piece.mesh))
        });
        let tile = Tile { meshes: meshes.collect(), places: all };
        self.tiles.insert(index, tile);
    }

    /// The world about a place, as stages see it.
    fn snapshot(&mut self, [x, y, z]: [f64; 3], reach_m: f64) -> (Snapshot, Vec<TileIndex>) {
        let near = TileIndex::near(x, y, reach_m);
        near.iter().for_each(|index| self.make(*index));
        let origin = LocalOrigin::near([x, y, z]);
        let (mut meshes, mut instances) = (Vec::new(), Vec::new());
        for index in &near {
            let low = index.low_m();
            let moved = origin.local_from_body(&Pose::<World, frames::Object>::from_xyz_rpy(
                [low[0], low[1], 0.0],
                [0.0; 3],
            ));
            for (placed, mesh) in &self.tiles[index].meshes {
                let local_from_object = moved * *placed;
                instances.push(Instance {
                    mesh: meshes.len() as u32,
                    object: 1,
                    local_from_object,
                    previous_local_from_object: local_from_object,
                    paint: [0.5; 3],
                    lights: 0,
                    glow: [1.0; 3],
                });
                meshes.push(Arc::clone(mesh));
            }
        }
        let snapshot =
            Snapshot { origin, meshes: meshes.into(), instances, cabins: Vec::new(), motions: Vec::new() };
        (snapshot, near)
    }
}

/// Whether a place is on the mask of an agent; none where it is too far to tell.
fn is_on(mask: &BevMask, place: &Place, agent: &Pose<World, Agent>, cell_m: f64) -> Option<bool> {
    let at = agent.xyz();
    let way = [0, 1, 2].map(|k| place[k] - at[k]);
    if way[0] * way[0] + way[1] * way[1] > NEAR_M[0] * NEAR_M[0] || way[2].abs() > NEAR_M[1] {
        return None;
    }
    let (sin, cos) = frames::math::sin_cos(agent.yaw());
    let (ahead, left) = (cos * way[0] + sin * way[1], cos * way[1] - sin * way[0]);
    let middle = 0.5 * mask.cells() as f64 - 0.5;
    let [row, column] = [middle - ahead / cell_m, middle - left / cell_m];
    let ends = |at: f64| ((at - OFF_CELLS).ceil().max(0.0) as usize, (at + OFF_CELLS) as usize);
    let ((top, bottom), (first, last)) = (ends(row), ends(column));
    let mut cells = (top..=bottom).flat_map(|r| (first..=last).map(move |c| (r, c)));
    Some(cells.any(|(r, c)| {
        let (dr, dc) = (r as f64 - row, c as f64 - column);
        dr * dr + dc * dc <= OFF_CELLS * OFF_CELLS && mask.get(BevClass::Sidewalk, r, c)
    }))
}

/// Places on sidewalks near to some agents that are off the mask of one of them, and how many there are.
fn strays(map: &Map, agents: &[Pose<World, Agent>]) -> (Vec<Place>, u64) {
    let settings = BevSettings { cells: 150, ..BevSettings::default() };
    let mut rasterizer = BevRasterizer::new(&settings).expect("usual masks");
    let mut lands = Lands { atlas: Atlas::new(map), tiles: BTreeMap::new() };
    let reach_m = settings.half_extent_m() * std::f64::consts::SQRT_2 + BevSettings::BEYOND_M;
    let (mut found, mut looked) = (Vec::new(), 0);
    for agent in agents {
        let (snapshot, near) = lands.snapshot(agent.xyz(), reach_m);
        let mask = rasterizer.rasterize(&snapshot, agent, Areas::default());
        for place in near.iter().flat_map(|index| &lands.tiles[index].places) {
            let Some(is_on) = is_on(&mask, place, agent, settings.cell_m) else { continue };
            looked += 1;
            if !is_on {
                found.push(*place);
            }
        }
    }
    (found, looked)
}

/// Agents at a place whose masks' rows lie along a direction, and across, each a part of a cell beside the
/// other.
fn about([x, y, z]: Place, heading_rad: f64) -> Vec<Pose<World, Agent>> {
    let offsets = (0..4).map(|k| 0.1 * f64::from(k));
    let poses = offsets.flat_map(|off| {
        [0.0, 0.5].map(|turn| Pose::from_xyz_rpy([x + off, y + off, z], [0.0, 0.0, heading_rad + turn]))
    });
    poses.collect()
}

/// Where sidewalks of a map are narrower than a cell of the masks, with their direction.
fn narrow(map: &Map) -> Vec<(Place, f64)> {
    let mut found = Vec::new();
    for lane in map.lanes().iter().filter(|lane| lane.lane_type == LaneType::Sidewalk) {
        let steps = ((lane.s_end - lane.s_start) / 0.5).ceil().max(1.0) as usize;
        let at = |k: usize| lane.s_start + (lane.s_end - lane.s_start) * k as f64 / steps as f64;
        let is_narrow =
            |s: &f64| map.lane_width(lane.id, *s).is_some_and(|width_m| (0.05..0.3).contains(&width_m));
        if let Some(s) = (0..=steps).map(at).find(is_narrow) {
            let line = map.lane_polyline_at(lane.id, &[s, s + 0.1]);
            let [from, to] = [0, 1].map(|k| line.left[k]);
            let heading_rad = frames::math::atan2(to.y - from.y, to.x - from.x);
            found.push((nalgebra::center(&line.left[0], &line.right[0]).into(), heading_rad));
        }
    }
    found
}

/// A street whose sidewalk becomes narrow and ends.
fn tapered() -> Map {
    let lanes = [(LaneType::Driving, 3.5), (LaneType::Sidewalk, 2.0)];
    let mut road = testkit::road("1", [0.0, 0.0], 0.0, 60.0, testkit::one_way(&lanes));
    let widths = &mut road.sections[0].right[1].widths;
    (widths[0].a, widths[0].b) = (2.0, -2.0 / 60.0);
    testkit::map(vec![road])
}

#[test]
fn whatever_is_a_sidewalk_is_on_the_mask() {
    let demo = town::generate(&town::named("convoy/demo").expect("is known")).expect("is made");
    let mut maps = vec![("tapered", tapered()), ("convoy/demo", Map::new(demo))];
    // Two sidewalks of junctions taper away there.
    maps.extend(testkit::real_maps(&["Town03"]));
    for (name, map) in &maps {
        let narrow = narrow(map);
        assert_eq!(narrow.is_empty(), *name == "convoy/demo", "{name}");
        let along = map.spawn_points(APART_M).into_iter().filter_map(|at| map.point_at(at));
        let along = along.map(|p| Pose::from_xyz_rpy(p.position.into(), [0.0, 0.0, p.heading_rad]));
        let mut agents: Vec<Pose<World, Agent>> = along.take(20).collect();
        agents.extend(narrow.iter().flat_map(|(place, heading_rad)| about(*place, *heading_rad)));
        let (found, looked) = strays(map, &agents);
        assert!(looked > 1000, "{name}: {looked}");
        let first = found.first();
        assert!(found.is_empty(), "{name}: {} of {looked} are off, the first at {first:?}", found.len());
    }
}
