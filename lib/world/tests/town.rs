//! A whole town: scenery keeps off the roads, lanes are covered by road, nothing hangs over them.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests may stop and say that they were skipped.

use std::collections::BTreeSet;

use frames::{Object, Pose, World as WorldFrame};
use glam::Vec3;
use nalgebra::Point3;
use opendrive::{LaneInfo, LaneType, Map};
use random::Stream;
use schema::Tag;
use schema::geometry::Snapshot;
use schema::settings::WorldSettings;
use schema::tables::{ActorRow, FrameRow, SignalRow, StateRow};
use world::{Moment, World, WorldError, place};

fn demo() -> Map {
    Map::new(town::generate(&town::named("convoy/demo").unwrap()).unwrap())
}

fn carla(name: &str) -> Option<Map> {
    let path = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/maps/carla/{}.xodr"), name);
    match std::fs::read(&path) {
        Ok(bytes) => Some(Map::new(opendrive::read_bytes(&bytes).unwrap())),
        Err(_) => {
            println!("skipped: no map {path}");
            None
        }
    }
}

fn settings() -> WorldSettings {
    WorldSettings { radius_m: 150.0, ..WorldSettings::default() }
}

/// Some place on a driving lane.
fn start(map: &Map) -> [f64; 3] {
    let hit = map.nearest_driving_lane(Point3::origin()).unwrap();
    map.lane_point(hit.lane, hit.s, 0.0).unwrap().position.coords.into()
}

fn empty_moment(frame: &FrameRow) -> Moment<'_> {
    Moment { states: &[], previous: &[], signals: &[], frame }
}

/// Heights and tags of everything on a vertical line, by brute force.
fn column(snapshot: &Snapshot, x: f64, y: f64) -> Vec<(f64, Tag)> {
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

fn check_town(map: &Map, name: &str) {
    let centre = start(map);
    let actors = place(map, &settings(), 5, &[centre], 10).unwrap();
    // Ids: dense from the first one.
    assert!(actors.iter().enumerate().all(|(i, a)| usize::from(a.id) == i + 10 && a.fixed));
    let kinds: BTreeSet<&str> = actors.iter().map(|a| a.kind.as_str()).collect();
    assert!(
        ["surface", "building", "vegetation", "pole", "prop"].iter().all(|k| kinds.contains(k)),
        "{name}: {kinds:?}"
    );

    // No building on any lane: exact lane geometry, not the meshes.
    let built = |l: &LaneInfo| l.lane_type != LaneType::None;
    for building in actors.iter().filter(|a| a.kind == "building") {
        let pose = Pose::<WorldFrame, Object>::from_xyz_wxyz(building.xyz_m, building.quaternion);
        for i in 0..=8 {
            for j in 0..=8 {
                let share = |k: i32| f64::from(k) / 8.0 - 0.5;
                let p = pose * Point3::new(share(i) * building.length_m, share(j) * building.width_m, 0.0);
                for hit in map.lanes_within(p, 9.0, built) {
                    let beyond = hit.distance_m > 0.5 * hit.width_m + 0.02 || !hit.is_inside();
                    // Beyond a lane's end its nearest place has no offset but a distance.
                    assert!(
                        beyond || (hit.distance_m - hit.t_m.abs()).abs() > 0.05,
                        "{name}: building {} on {hit:?}",
                        building.id
                    );
                }
            }
        }
    }

    let world = World::new(map, &actors).unwrap();
    let frame = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&frame), centre, 400.0);
    let lanes: Vec<&LaneInfo> = map.lanes().iter().filter(|l| l.lane_type.is_drivable()).collect();
    let mut random = Stream::new(3, 0, "test/lanes", 0);
    let mut tested = 0;
    for _ in 0..4000 {
        let lane = random.choose(&lanes).unwrap();
        let s = random.uniform(lane.s_start, lane.s_end);
        let side = random.uniform(-0.45, 0.45);
        let middle = map.lane_point(lane.id, s, 0.0).unwrap();
        let point = map.lane_point(lane.id, s, side * middle.width_m).unwrap().position;
        let near = (point.x - centre[0]).abs() < 140.0 && (point.y - centre[1]).abs() < 140.0;
        if !near || middle.width_m < 0.5 || tested >= 150 {
            continue;
        }
        tested += 1;
        let hits = column(&snapshot, point.x, point.y);
        let road = |t: Tag| matches!(t, Tag::Road | Tag::RoadLine);
        assert!(
            hits.iter().any(|(z, t)| road(*t) && (z - point.z).abs() < 0.02),
            "{name}: no road at {point} ({:?}, s {s}): {hits:?}",
            lane.id
        );
        for (z, tag) in &hits {
            let clear = road(*tag)
                || matches!(tag, Tag::Pole | Tag::TrafficLight | Tag::Vegetation)
                || *z < point.z + 0.02
                || *z > point.z + 4.0;
            assert!(
                clear,
                "{name}: {tag:?} {:.3} m over the lane at {point} ({:?}, s {s})",
                z - point.z,
                lane.id
            );
        }
        let ground = world.ground_height(point.x, point.y, point.z);
        assert!((ground - point.z).abs() < 0.03, "{name}: ground {ground} at {point}");
    }
    assert!(tested > 100, "{name}: only {tested} points");
}

#[test]
fn generated_towns_are_sound() {
    for name in ["convoy/demo", "convoy/01", "convoy/03", "convoy/11"] {
        check_town(&Map::new(town::generate(&town::named(name).unwrap()).unwrap()), name);
    }
}

/// The world around a place of a generated town.
fn around(map: &Map, centre: [f64; 3]) -> (Vec<ActorRow>, World) {
    let actors = place(map, &settings(), 5, &[centre], 10).unwrap();
    let world = World::new(map, &actors).unwrap();
    (actors, world)
}

#[test]
fn rivers_lie_under_bridges() {
    let map = Map::new(town::generate(&town::named("convoy/01").unwrap()).unwrap());
    let river = map.objects().iter().find(|o| o.is_water()).unwrap();
    let water_m = river.outlines[0].base[0].z;
    let bridged = map.network().roads.iter().position(|r| !r.bridges.is_empty()).unwrap();
    let bridge = &map.network().roads[bridged].bridges[0];
    let at = |s: f64, t: f64| map.road_point(bridged as u32, s, t, 0.0).unwrap();
    let middle = at(bridge.s + 0.5 * bridge.length_m, 1.5);
    let (actors, world) = around(&map, middle.coords.into());
    let frame = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&frame), middle.coords.into(), 400.0);
    let heights = |hits: &[(f64, Tag)], tag: Tag| -> Vec<f64> {
        hits.iter().filter(|(_, t)| *t == tag).map(|(z, _)| *z).collect()
    };

    let hits = column(&snapshot, middle.x, middle.y);
    assert!(heights(&hits, Tag::Road).iter().any(|z| (z - middle.z).abs() < 0.02), "{hits:?}");
    assert!(heights(&hits, Tag::Water).iter().any(|z| (z - water_m).abs() < 0.01), "{hits:?}");
    assert!(heights(&hits, Tag::Terrain).iter().all(|z| *z < water_m), "{hits:?}");
    assert!(middle.z - water_m > 3.0, "the deck is {} m over the water", middle.z - water_m);
    assert!(!heights(&hits, Tag::Bridge).is_empty(), "{hits:?}");

    // Beside the bridge there is water, and nothing over it.
    let beside = at(bridge.s + 0.5 * bridge.length_m, 20.0);
    let hits = column(&snapshot, beside.x, beside.y);
    let top = hits.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert_eq!(top.1, Tag::Water, "{hits:?}");
    // The shore follows the outline, and nothing stands in the water.
    let ring: Vec<Point3<f64>> = river.outlines[0].base.clone();
    let mut tested = 0;
    for (a, b) in ring.iter().zip(&ring[1..]) {
        let along = (b - a) / (b - a).norm();
        let left = nalgebra::Vector3::new(-along.y, along.x, 0.0);
        let edge = nalgebra::center(a, b);
        if (edge - middle).norm() > 140.0 {
            continue;
        }
        let tops = [-1.2, 1.2].map(|aside| {
            let p = edge + left * aside;
            column(&snapshot, p.x, p.y).into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        });
        if tops.iter().all(|(_, t)| matches!(t, Tag::Water | Tag::Terrain)) {
            tested += 1;
            let water = tops.iter().filter(|(_, t)| *t == Tag::Water).count();
            assert_eq!(water, 1, "at {edge} {tops:?}");
            let [right, left] = tops.map(|(z, _)| z);
            assert!((left - right).abs() < 1.5, "the shore at {edge} is a step: {tops:?}");
        }
    }
    assert!(tested > 10, "only {tested} places on the shore");
    let wet = |x: f64, y: f64| column(&snapshot, x, y).iter().any(|(_, t)| *t == Tag::Water);
    for thing in actors.iter().filter(|a| a.kind != "surface" && a.kind != "sign") {
        let pose = Pose::<WorldFrame, Object>::from_xyz_wxyz(thing.xyz_m, thing.quaternion);
        let share = if thing.kind == "building" { 0.5 } else { 0.0 };
        for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (0.0, 0.0)] {
            let p = pose * Point3::new(share * u * thing.length_m, share * v * thing.width_m, 0.0);
            assert!(
                !wet(p.x, p.y) || p.z > water_m + 2.0,
                "{} {} stands in the river",
                thing.model,
                thing.id
            );
        }
    }
}

#[test]
fn rails_lie_on_their_beds_and_in_level_crossings() {
    let map = Map::new(town::generate(&town::named("convoy/07").unwrap()).unwrap());
    let tracks: Vec<&LaneInfo> = map.lanes().iter().filter(|l| l.lane_type == LaneType::Rail).collect();
    let crossing = tracks.iter().find(|l| l.junction.is_some()).unwrap();
    let middle =
        |l: &LaneInfo, t: f64| map.lane_point(l.id, 0.5 * (l.s_start + l.s_end), t).unwrap().position;
    let centre = middle(crossing, 0.0);
    let (actors, world) = around(&map, centre.coords.into());
    let frame = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&frame), centre.coords.into(), 400.0);
    let top = |p: Point3<f64>| {
        let hits = column(&snapshot, p.x, p.y);
        hits.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    };
    // Half of 1505 mm to either side of the middle.
    for side in [-0.7525, 0.7525] {
        let rail = middle(crossing, side);
        let (z, tag) = top(rail);
        assert!(tag == Tag::RailTrack && (0.0..0.02).contains(&(z - rail.z)), "{tag:?} {}", z - rail.z);
    }
    assert_eq!(top(centre).1, Tag::Road, "between the rails of a crossing is road");
    let reach = |l: &&&LaneInfo| (middle(l, 0.0) - centre).norm() < 140.0 && l.junction.is_none();
    let open = tracks.iter().find(reach).unwrap();
    let rail = middle(open, 0.7525);
    let (z, tag) = top(rail);
    assert!(tag == Tag::RailTrack && (z - rail.z - 0.17).abs() < 0.02, "{tag:?} {}", z - rail.z);
    assert_eq!(top(middle(open, 0.0)).1, Tag::RailTrack, "ballast or a sleeper");
    // Neither crowns nor lamps reach over the rails, and no house looks at them.
    let track = |l: &LaneInfo| l.lane_type == LaneType::Rail;
    for thing in actors.iter().filter(|a| matches!(a.kind.as_str(), "vegetation" | "pole" | "building")) {
        let reach = 0.5 * thing.length_m.max(thing.width_m);
        let at = Point3::from(thing.xyz_m);
        for hit in map.lanes_within(at, reach + 3.0, track) {
            let clear = hit.distance_m - 0.5 * hit.width_m;
            let needed = if thing.kind == "vegetation" { 0.9 * reach } else { 0.3 };
            assert!(clear > needed, "{} {} is {clear:.2} m from the rails", thing.model, thing.id);
        }
    }
}

#[test]
fn real_towns_are_sound() {
    for name in ["Town10HD", "Town03"] {
        if let Some(map) = carla(name) {
            check_town(&map, name);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_world() {
    let map = demo();
    let make = |seed| place(&map, &settings(), seed, &[start(&map)], 1).unwrap();
    let (a, b, other) = (make(1), make(1), make(2));
    assert_eq!(a, b);
    assert_ne!(a, other);
    let (w, v) = (World::new(&map, &a).unwrap(), World::new(&map, &b).unwrap());
    assert_eq!(w.meshes().len(), v.meshes().len());
    assert!(w.meshes().iter().zip(v.meshes().iter()).all(|(m, n)| m == n));
}

fn car(id: u16) -> ActorRow {
    ActorRow {
        id,
        kind: "vehicle".into(),
        model: "car.sedan".into(),
        role: "background".into(),
        length_m: 4.7,
        width_m: 1.84,
        height_m: 1.44,
        color: vec![255, 0, 0],
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..ActorRow::default()
    }
}

fn state(frame: i32, id: u16, x: f64, phase_rad: f32) -> StateRow {
    StateRow {
        frame,
        id,
        xyz_m: [x, 0.0, 0.0],
        quaternion: [1.0, 0.0, 0.0, 0.0],
        phase_rad,
        ..StateRow::default()
    }
}

#[test]
fn moving_actors_carry_their_previous_place() {
    let map = demo();
    let world = World::new(&map, &[car(7), car(9)]).unwrap();
    let states = [state(0, 9, 5.0, 0.0), state(0, 7, 10.0, 0.5), state(0, 400, 0.0, 0.0)];
    let previous = [state(-1, 7, 9.5, 0.2)];
    let frame = FrameRow::default();
    let moment = Moment { states: &states, previous: &previous, signals: &[], frame: &frame };
    let snapshot = world.snapshot(&moment, [3.0, 0.0, 0.0], 50.0);
    // Five pieces each; the unknown object is passed over.
    assert_eq!(snapshot.instances.len(), 10);
    let of = |id: u16| snapshot.instances.iter().filter(move |i| i.object == id);
    for instance in of(7) {
        let moved = instance.local_from_object.translation - instance.previous_local_from_object.translation;
        assert!((moved - glam::Vec3A::X * 0.5).length() < 1e-5);
    }
    let wheels =
        of(7).filter(|i| i.local_from_object.matrix3 != i.previous_local_from_object.matrix3).count();
    assert_eq!(wheels, 4, "the wheels have turned");
    assert!(of(9).all(|i| i.local_from_object == i.previous_local_from_object));
    assert!((of(9).next().unwrap().paint[0] - 1.0).abs() < 1e-6);
    // Far from it there is nothing.
    assert!(world.snapshot(&moment, [500.0, 0.0, 0.0], 50.0).instances.is_empty());
}

#[test]
fn lights_follow_the_log() {
    let map = demo();
    let actors = place(&map, &settings(), 5, &[start(&map)], 1).unwrap();
    let world = World::new(&map, &actors).unwrap();
    let light = actors.iter().find(|a| a.kind == "traffic_light").unwrap();
    let signals = [SignalRow { frame: 0, id: light.id, state: "Yellow".into(), opendrive_id: String::new() }];
    let frame = FrameRow { street_lamps: true, building_lights: true, ..FrameRow::default() };
    let moment = Moment { states: &[], previous: &[], signals: &signals, frame: &frame };
    let snapshot = world.snapshot(&moment, start(&map), 300.0);
    let lights_of = |kind: &str| -> Vec<u32> {
        let ids: BTreeSet<u16> = actors.iter().filter(|a| a.kind == kind).map(|a| a.id).collect();
        snapshot.instances.iter().filter(|i| ids.contains(&i.object)).map(|i| i.lights).collect()
    };
    let shown = snapshot.instances.iter().find(|i| i.object == light.id).unwrap();
    assert_eq!(shown.lights, schema::lights::SIGNAL_YELLOW);
    assert!(lights_of("building").iter().all(|l| *l == schema::lights::BUILDING));
    assert!(lights_of("pole").contains(&schema::lights::STREET_LAMP));
    let day = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&day), start(&map), 300.0);
    assert!(snapshot.instances.iter().all(|i| i.lights == 0));
}

#[test]
fn faults_are_named() {
    let map = demo();
    assert_eq!(place(&map, &settings(), 1, &[], 1).unwrap_err(), WorldError::NoCentre);
    assert!(matches!(place(&map, &settings(), 1, &[[9e6, 0.0, 0.0]], 1), Err(WorldError::NoRoads { .. })));
    assert!(matches!(place(&map, &settings(), 1, &[start(&map)], 65_530), Err(WorldError::OutOfIds { .. })));
    assert_eq!(World::new(&map, &[car(1), car(1)]).unwrap_err(), WorldError::DuplicateId { id: 1 });
    let strange = ActorRow { model: "car.boat".into(), ..car(1) };
    assert!(matches!(World::new(&map, &[strange]), Err(WorldError::UnknownModel { id: 1, .. })));
    let flat = ActorRow { height_m: f64::NAN, ..car(1) };
    assert!(matches!(World::new(&map, &[flat]), Err(WorldError::BadActor { id: 1, .. })));
}
