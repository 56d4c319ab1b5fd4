//! Walkers, signs before hazards, and RSUs that a user placed, on the ground that is drawn under them.
//!
//! Traffic knows the map's surfaces alone. What is drawn differs from them: kerbs where the map states none,
//! sidewalks cut away where a road crosses them, asphalt between the lanes of a junction, grass beside the
//! road. Walkers and signs are put on the triangles themselves.

use std::collections::BTreeMap;

use frames::LocalOrigin;
use glam::Vec3;
use nalgebra::Point3;
use schema::geometry::SurfaceMesh;
use schema::tables::{ActorRow, StateRow};
use schema::{ActorKind, ActorRole, FRAME_PERIOD_S, Layer, ObjectId};

/// Surfaces that are walked on; paint, bridge walls and guard rails are not.
const WALKED: [Layer; 4] = [Layer::Road, Layer::Sidewalk, Layer::Median, Layer::Terrain];
/// Side of a cell of the grid of triangles, metres.
const CELL_M: f64 = 2.0;
/// Triangles steeper than this (the normal's upward share) are faces of kerbs and walls.
const LEAST_UP: f64 = 0.3;
/// Ground this far above or below where the map has its surface is on another level, metres.
const ABOVE_M: f64 = 1.0;
const BELOW_M: f64 = 1.5;
/// A walker steps onto a kerb, or down from it, over twice this way, metres.
const HALF_STEP_M: f64 = 0.25;
/// Samples of the ground on either side; the next one would be at the end of that way.
const TAPS: i32 = 10;

/// Feet stand on the ground where the seat is no lower or higher over it than this, metres.
const LEAST_SEAT_M: f64 = 0.33;
const MOST_SEAT_M: f64 = 0.52;

/// Triangles by the cells of a grid that they touch.
type Cells = BTreeMap<(i32, i32), Vec<[Point3<f64>; 3]>>;

/// The triangles of the ground.
struct Ground(Cells);

fn cell(x_m: f64, y_m: f64) -> (i32, i32) {
    ((x_m / CELL_M).floor() as i32, (y_m / CELL_M).floor() as i32)
}

impl Ground {
    /// The ground in the cells that hold a place of `track`, of some tiles.
    fn under<E>(
        tiles: impl Iterator<Item = Result<Vec<SurfaceMesh>, E>>,
        track: &[[f64; 3]],
    ) -> Result<Self, E> {
        let mut cells: Cells = track.iter().map(|p| (cell(p[0], p[1]), Vec::new())).collect();
        let origin = LocalOrigin::near(track.first().copied().unwrap_or_default());
        for tile in tiles {
            for piece in tile?.iter().filter(|piece| WALKED.contains(&piece.layer)) {
                add_piece(&mut cells, piece, &origin);
            }
        }
        Ok(Self(cells))
    }

    /// Height of the uppermost triangle on the level of a point that the map has on its surface; the point's
    /// own where nothing is drawn (beyond the scene's tiles, or over a gap in a bridge).
    fn height(&self, at: [f64; 3]) -> f64 {
        let [x, y, z] = at;
        let over =
            self.0.get(&cell(x, y)).into_iter().flatten().filter_map(|corners| height_in(corners, x, y));
        over.filter(|h| (z - BELOW_M..=z + ABOVE_M).contains(h)).max_by(f64::total_cmp).unwrap_or(z)
    }
}

/// Adds a piece's triangles that are no walls to those cells that they touch.
fn add_piece(cells: &mut Cells, piece: &SurfaceMesh, origin: &LocalOrigin) {
    let zero = origin.world_xyz();
    // Rounded as cameras see them: relative to the origin.
    let shift = Vec3::from_array([0, 1, 2].map(|k| (piece.origin_m[k] - zero[k]) as f32));
    for i in 0..piece.mesh.triangles.len() {
        let corners = piece.mesh.corners(i).map(|v| Point3::from(origin.world_from_local(v + shift)));
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        if normal.z <= LEAST_UP * normal.norm() {
            continue;
        }
        let [xs, ys] = [0, 1].map(|k| corners.map(|p| p[k]));
        let low = cell(xs.into_iter().fold(f64::MAX, f64::min), ys.into_iter().fold(f64::MAX, f64::min));
        let high = cell(xs.into_iter().fold(f64::MIN, f64::max), ys.into_iter().fold(f64::MIN, f64::max));
        for column in low.0..=high.0 {
            for (_, found) in cells.range_mut((column, low.1)..=(column, high.1)) {
                found.push(corners);
            }
        }
    }
}

/// Height of a triangle at a point of its plan; none outside.
fn height_in([a, b, c]: &[Point3<f64>; 3], x: f64, y: f64) -> Option<f64> {
    let (ab, ac, at) = (b - a, c - a, Point3::new(x, y, 0.0) - a);
    let area = ab.x * ac.y - ac.x * ab.y;
    let (u, v) = ((at.x * ac.y - ac.x * at.y) / area, (ab.x * at.y - at.x * ab.y) / area);
    // Points on a shared edge belong to both triangles, whatever the rounding.
    (u >= -1e-6 && v >= -1e-6 && u + v <= 1.0 + 1e-6).then(|| a.z + u * ab.z + v * ac.z)
}

/// Whether it is a warning sign before a hazard: it stands on a sidewalk, say.
fn is_warning(actor: &ActorRow) -> bool {
    actor.role == ActorRole::Hazard && actor.kind == ActorKind::Sign
}

/// Whether it is an RSU that stands where the user says, at no signal: the place may be beside all lanes.
fn is_given_rsu(actor: &ActorRow) -> bool {
    actor.kind == ActorKind::Rsu && actor.opendrive_id.is_none()
}

/// Puts walkers, warning signs and RSUs on the ground that is drawn under them. What follows from their
/// heights follows again: velocities are differences of the final positions, and actor rows have the pose at
/// frame 0.
///
/// `states` are sorted by frame.
///
/// `tiles`: the ground that is drawn.
///
/// # Errors
/// A tile cannot be had.
pub(crate) fn stand<E>(
    tiles: impl Iterator<Item = Result<Vec<SurfaceMesh>, E>>,
    actors: &mut [ActorRow],
    states: &mut [StateRow],
) -> Result<(), E> {
    let mut tracks: BTreeMap<ObjectId, Vec<usize>> =
        actors.iter().filter(|a| a.kind == ActorKind::Walker).map(|a| (a.id, Vec::new())).collect();
    for (i, state) in states.iter().enumerate() {
        if let Some(track) = tracks.get_mut(&state.id) {
            track.push(i);
        }
    }
    let is_put = |actor: &ActorRow| is_warning(actor) || is_given_rsu(actor);
    let put = actors.iter().filter(|a| is_put(a)).map(|a| a.xyz_m);
    let places: Vec<[f64; 3]> = tracks.values().flatten().map(|&i| states[i].xyz_m).chain(put).collect();
    let ground = Ground::under(tiles, &places)?;
    for track in tracks.values() {
        let mut way_m = 0.0;
        let profile: Vec<[f64; 2]> = (0..track.len())
            .map(|k| {
                let [x, y, z] = states[track[k]].xyz_m;
                let [x0, y0, _] = states[track[k.saturating_sub(1)]].xyz_m;
                way_m += ((x - x0) * (x - x0) + (y - y0) * (y - y0)).sqrt();
                [way_m, ground.height([x, y, z])]
            })
            .collect();
        let heights: Vec<f64> = profile.iter().map(|[way_m, _]| stepped(&profile, *way_m)).collect();
        for (k, &i) in track.iter().enumerate() {
            let state = &mut states[i];
            let seat_z = state.xyz_m[2] + f64::from(state.seat_m);
            state.xyz_m[2] = heights[k];
            if state.seat_m > 0.0 {
                // The seat stays where it is, whatever the ground before it does.
                state.seat_m = (seat_z - heights[k]).clamp(LEAST_SEAT_M, MOST_SEAT_M) as f32;
                state.xyz_m[2] = seat_z - f64::from(state.seat_m);
            }
            // The first state has none before it: it moves on as it is going to.
            let (from, to) = if k == 0 { (0, 1.min(heights.len() - 1)) } else { (k - 1, k) };
            states[i].velocity_mps[2] = ((heights[to] - heights[from]) / FRAME_PERIOD_S) as f32;
        }
    }
    for actor in actors.iter_mut().filter(|a| is_put(a)) {
        actor.xyz_m[2] = ground.height(actor.xyz_m);
    }
    for actor in actors.iter_mut() {
        let at_start = tracks.get(&actor.id).and_then(|t| t.iter().find(|&&i| states[i].frame == 0));
        if let Some(&i) = at_start {
            actor.xyz_m = states[i].xyz_m;
        }
    }
    Ok(())
}

/// Height of a walker after some way: the mean of the ground within [`HALF_STEP_M`] before and behind,
/// weighted by a triangle over it. So a kerb is stepped up in an S of two parabolas. `profile`: way and
/// height of the ground, the way ascending; level before and behind it.
fn stepped(profile: &[[f64; 2]], way_m: f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for tap in -TAPS..=TAPS {
        let weight = f64::from(TAPS + 1 - tap.abs());
        sum += weight * interpolated(profile, way_m + HALF_STEP_M * f64::from(tap) / f64::from(TAPS + 1));
        weights += weight;
    }
    sum / weights
}

/// Height of the ground after some way, between the samples of a profile.
fn interpolated(profile: &[[f64; 2]], way_m: f64) -> f64 {
    let after = profile.partition_point(|[w, _]| *w <= way_m);
    match (after.checked_sub(1).and_then(|i| profile.get(i)), profile.get(after)) {
        (Some([w0, z0]), Some([w1, z1])) => z0 + (z1 - z0) * ((way_m - w0) / (w1 - w0)),
        (Some([_, z]), None) | (None, Some([_, z])) => *z,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::ops::ControlFlow;

    use opendrive::Map;
    use plan::PlanMap;
    use replay::tiles::{TileError, TileStore};
    use runner::StageSettings;
    use schema::tables::FrameRow;
    use settings::stages::{PlanSettings, SimulationSettings};
    use store::Store;
    use traffic::{SceneInput, SimulationLog};
    use world::{Moment, SceneWorld};

    use crate::world::{Nearby, SceneTiles};

    #[test]
    fn a_kerb_is_stepped_up_in_an_s() {
        // Samples 2 cm apart, a kerb of 0.15 m at 3 m.
        let profile: Vec<[f64; 2]> =
            (0..300).map(|i| 0.02 * f64::from(i)).map(|w| [w, if w < 3.0 { 0.0 } else { 0.15 }]).collect();
        for [way_m, _] in &profile {
            let u = ((way_m - 2.99) / 0.25).clamp(-1.0, 1.0);
            let share = if u < 0.0 { 0.5 * (1.0 + u) * (1.0 + u) } else { 1.0 - 0.5 * (1.0 - u) * (1.0 - u) };
            let got = stepped(&profile, *way_m);
            assert!((got - 0.15 * share).abs() < 0.003, "{got} instead of {} at {way_m}", 0.15 * share);
        }
    }

    #[test]
    fn a_slope_is_followed_and_standing_still_is_level() {
        let slope: Vec<[f64; 2]> =
            (0..100).map(|i| 0.06 * f64::from(i)).map(|w| [w, 5.0 - 0.1 * w]).collect();
        for [way_m, z] in &slope[5..95] {
            assert!((stepped(&slope, *way_m) - z).abs() < 1e-12);
        }
        let standing = [[1.0, 0.3]; 20];
        assert!(standing.iter().all(|[w, _]| (stepped(&standing, *w) - 0.3).abs() < 1e-12));
    }

    /// A scene of walkers around two agents: world, actors and log, walkers on the ground.
    fn walked(name: &str, map: Map) -> (SceneWorld, Vec<ActorRow>, SimulationLog) {
        let text = format!(
            "name = \"test\"\n[scenes.train]\n\"{name}\" = 1\n[agents]\nmin_vehicles = 2\nmax_vehicles = 2\n\
             max_rsus = 0\n[timing]\nmin_duration_s = 20\nmax_duration_s = 20\n[traffic]\nvehicles = 10\n\
             spawn_radius_m = 120\n[walkers]\ncount = 80\n[hazards]\nshare = 0.1\n[world]\n\
             radius_m = 120\n"
        );
        let whole = settings::parse(&text, "test").expect("good settings");
        let (wishes, settings) = (PlanSettings::of(&whole), SimulationSettings::of(&whole));
        let maps = BTreeMap::from([(name.to_owned(), PlanMap { map, hash: String::new() })]);
        let plan = plan::plan(&wishes, &maps).expect("a plan");
        let (scene, map) = (&plan.scenes[0], &maps[name].map);
        let store = Store::open("memory:").expect("a store");
        let tiles =
            TileStore::new(&store, (map, ""), (&settings.scenery, catalogue::Catalogue::built_in()), "test")
                .expect("a place for tiles");
        let nearby = Nearby::new(&tiles, settings.reach_m);
        let input = SceneInput {
            catalogue: catalogue::Catalogue::built_in(),
            map,
            scene,
            agents: &plan.agents,
            hazards: &plan.hazards,
            weather: &[],
            routes: &[],
            trajectories: &[],
            settings: &settings,
            fixed: &nearby,
            first_id: 1,
        };
        let mut log = traffic::simulate(&input, &mut |_, _| ControlFlow::Continue(())).expect("a log");
        let place = runner::Place::default();
        let of_scene = SceneTiles::of(&tiles, &log, settings.reach_m, &place).expect("tiles");
        let mut actors = log.actors.clone();
        actors.extend(of_scene.actors.iter().cloned());
        let ground: Vec<_> = of_scene.indices().map(|index| tiles.surfaces(index).expect("a tile")).collect();
        let world = SceneWorld::new(&actors, ground.concat()).expect("a world");
        let drawn = ground.into_iter().map(Ok::<_, TileError>);
        stand(drawn, &mut actors, &mut log.states).expect("ground");
        (world, actors, log)
    }

    /// How far a place is above or below what is drawn under it, by all triangles of the place; of some
    /// objects only.
    fn off_ground_m(world: &SceneWorld, at: [f64; 3], of: impl Fn(ObjectId) -> bool) -> f32 {
        let frame = FrameRow::default();
        let moment = Moment { states: &[], previous: &[], signals: &[], frame: &frame };
        let snapshot = world.snapshot(&moment, at, 30.0);
        let at = snapshot.origin.local_from_world(at);
        let mut nearest = f32::INFINITY;
        for instance in snapshot.instances.iter().filter(|i| of(i.object)) {
            let mesh = snapshot.mesh(instance);
            for i in 0..mesh.triangles.len() {
                let [a, b, c] = mesh.corners(i).map(|v| instance.local_from_object.transform_point3(v));
                let (ab, ac, to) = ((b - a).truncate(), (c - a).truncate(), (at - a).truncate());
                let area = ab.perp_dot(ac);
                let (u, v) = (to.perp_dot(ac) / area, ab.perp_dot(to) / area);
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                    nearest = nearest.min((a.z + u * (b.z - a.z) + v * (c.z - a.z) - at.z).abs());
                }
            }
        }
        nearest
    }

    fn check(name: &str, map: Map) {
        let (world, actors, log) = walked(name, map);
        let surfaces: BTreeSet<ObjectId> =
            actors.iter().filter(|a| a.kind == ActorKind::Surface).map(|a| a.id).collect();
        let (mut signs, mut things, mut beyond) = (0, 0, 0);
        for thing in actors.iter().filter(|a| a.role == ActorRole::Hazard) {
            let off = off_ground_m(&world, thing.xyz_m, |id| surfaces.contains(&id));
            // Beyond the drawn scenery nothing is drawn under it.
            let most = if is_warning(thing) { 0.005 } else { 0.05 };
            assert!(off < most || off == f32::INFINITY, "{name}: {thing:?} is {off} m off the ground");
            signs += u32::from(is_warning(thing) && off < most);
            things += 1;
            beyond += u32::from(off == f32::INFINITY);
        }
        assert!(
            signs > 0 && 2 * beyond < things,
            "{name}: {signs} signs, {beyond} of {things} things beyond"
        );
        let (mut up, mut steps, mut walkers, mut between) = (0, 0, 0, 0);
        for walker in actors.iter().filter(|a| a.kind == ActorKind::Walker && a.role != ActorRole::Hazard) {
            let track: Vec<&StateRow> = log.states.iter().filter(|s| s.id == walker.id).collect();
            assert_eq!(walker.xyz_m, track[1].xyz_m);
            for pair in track.windows(2) {
                let moved: [f64; 3] = std::array::from_fn(|k| pair[1].xyz_m[k] - pair[0].xyz_m[k]);
                for (velocity, way) in pair[1].velocity_mps.iter().zip(moved) {
                    assert!((f64::from(*velocity) - way / 0.05).abs() < 1e-4, "{name}: {:?}", pair[1]);
                }
                // Kerbs of up to 0.3 m over a step of half a metre: 1.2 at the steepest, and the land's
                // slope.
                let flat = (moved[0] * moved[0] + moved[1] * moved[1]).sqrt();
                assert!(moved[2].abs() <= 1.5 * flat + 1e-9, "{name}: {:?} {:?}", pair[0], pair[1]);
                steps += 1;
                up += u32::from(moved[2].abs() > 0.2 * flat + 0.002);
            }
            // Feet are on what is drawn: within the height of a step while one is taken, else exactly.
            let state = track[track.len() / 2];
            let off = off_ground_m(&world, state.xyz_m, |id| surfaces.contains(&id));
            assert!(off < 0.16, "{name}: walker {} is {off} m off the ground at {state:?}", walker.id);
            walkers += 1;
            between += u32::from(off > 0.005);
        }
        assert!(10 * between < walkers, "{name}: {between} of {walkers} walkers are off the ground");
        assert!(steps > 10_000 && up > 20, "{name}: {up} of {steps} steps up or down");
    }

    #[test]
    fn walkers_of_our_town_step_up_and_down_kerbs() {
        let town = town::generate(&town::named("convoy/demo").expect("our town")).expect("a town");
        check("convoy/demo", Map::new(town));
    }

    #[test]
    fn walkers_of_a_real_town_stand_on_what_is_drawn() {
        if let Some(map) = testkit::real_map("Town03") {
            check("Town03", map);
        }
    }
}
