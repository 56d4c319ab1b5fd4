//! A whole town: scenery keeps off the roads, lanes are covered by road, nothing hangs over them.
#![allow(clippy::unwrap_used, reason = "tests may stop")]

use std::collections::BTreeSet;

use crate::common::{Columns, demo, empty_moment, named, place, rules, start};
use frames::{Object, Pose, World};
use land::surfaces::{Atlas, Region};
use land::tiles::Surroundings;
use nalgebra::Point3;
use opendrive::{LaneInfo, LaneType, Map};
use random::Stream;
use schema::tables::{ActorRow, FrameRow, LampRow, SignalRow, StateRow};
use schema::{ActorKind, ActorRole, LampKind, SignalState, Tag};
use settings::SceneryRules;
use testkit::real_maps;
use world::{Moment, SceneWorld, WorldError};

fn check_town(map: &Map, name: &str) {
    let centre = start(map);
    let Surroundings { actors, ground } = place(map, &rules(), centre, 10);
    // Ids: dense from the first one.
    assert!(actors.iter().enumerate().all(|(i, a)| usize::from(a.id) == i + 10 && a.fixed));
    let kinds: BTreeSet<ActorKind> = actors.iter().map(|a| a.kind).collect();
    assert!(
        {
            use ActorKind::*;
            [Surface, Building, Vegetation, Pole, Prop].iter().all(|k| kinds.contains(k))
        },
        "{name}: {kinds:?}"
    );

    // No building on any lane: exact lane geometry, not the meshes.
    let built = |l: &LaneInfo| l.lane_type != LaneType::None;
    for building in actors.iter().filter(|a| a.kind == ActorKind::Building) {
        let pose = Pose::<World, Object>::from_xyz_wxyz(building.xyz_m, building.quaternion);
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

    let world = SceneWorld::new(&actors, ground).unwrap();
    let frame = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&frame), centre, 400.0);
    let columns = Columns::new(&snapshot);
    // What scenery is placed by is what is drawn.
    let low = [0, 1].map(|k| (centre[k] / 16.0).floor() * 16.0);
    let atlas = Atlas::new(map);
    let levels = atlas.ground(&Region { min: low.map(|v| v - 160.0), max: low.map(|v| v + 160.0) }).levels;
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
        let hits = columns.at(point.x, point.y);
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
        let ground = levels.height(point.x, point.y, point.z);
        assert!((ground - point.z).abs() < 0.03, "{name}: ground {ground} at {point}");
    }
    assert!(tested > 100, "{name}: only {tested} points");
}

#[test]
fn generated_towns_are_sound() {
    for name in ["convoy/demo", "convoy/01", "convoy/03", "convoy/11"] {
        check_town(&named(name), name);
    }
}

#[test]
fn real_towns_are_sound() {
    for (name, map) in real_maps(&["Town10HD", "Town03"]) {
        check_town(&map, name);
    }
}

#[test]
fn the_same_seed_gives_the_same_world() {
    let map = demo();
    let make = |seed| place(&map, &SceneryRules { seed, ..rules() }, start(&map), 1);
    let (a, b, other) = (make(1), make(1), make(2));
    assert_eq!(a.actors, b.actors);
    assert_ne!(a.actors, other.actors);
    let [w, v] = [a, b].map(|s| SceneWorld::new(&s.actors, s.ground).unwrap());
    assert_eq!(w.meshes().len(), v.meshes().len());
    assert!(w.meshes().iter().zip(v.meshes().iter()).all(|(m, n)| m == n));
}

fn car(id: u16) -> ActorRow {
    ActorRow {
        id,
        kind: ActorKind::Vehicle,
        model: "car.sedan".into(),
        role: ActorRole::Background,
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
fn who_is_far_away_is_made_of_fewer_triangles() {
    let mut walker = car(7);
    let model = catalogue::models::find("walker.man").unwrap();
    (walker.model, walker.kind) = (model.name.to_owned(), ActorKind::Walker);
    [walker.length_m, walker.width_m, walker.height_m] = model.size_m;
    let world = SceneWorld::new(&[walker], Vec::new()).unwrap();
    let states = [state(0, 7, 0.0, 0.0)];
    let moment = Moment { states: &states, previous: &[], signals: &[], frame: &FrameRow::default() };
    let triangles = |x: f64| {
        let snapshot = world.snapshot(&moment, [x, 0.0, 0.0], 400.0);
        snapshot.instances.iter().map(|i| snapshot.mesh(i).triangles.len()).sum::<usize>()
    };
    let counts = [0.0, 10.0, 14.0, 30.0, 34.0, 300.0].map(triangles);
    assert_eq!([counts[0], counts[2], counts[4]], [counts[1], counts[3], counts[5]]);
    assert!(counts[0] > counts[2] && counts[2] > counts[4] && counts[4] > 0, "{counts:?}");
}

#[test]
fn moving_actors_carry_their_previous_place() {
    let world = SceneWorld::new(&[car(7), car(9)], Vec::new()).unwrap();
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
    let Surroundings { actors, ground } = place(&map, &rules(), start(&map), 1);
    let world = SceneWorld::new(&actors, ground).unwrap();
    let light = actors.iter().find(|a| a.kind == ActorKind::TrafficLight).unwrap();
    let signals =
        [SignalRow { frame: 0, id: light.id, state: SignalState::Yellow, opendrive_id: String::new() }];
    let frame = FrameRow { street_lamps: true, building_lights: true, ..FrameRow::default() };
    let moment = Moment { states: &[], previous: &[], signals: &signals, frame: &frame };
    let snapshot = world.snapshot(&moment, start(&map), 300.0);
    let lights_of = |kind: ActorKind| -> Vec<u32> {
        let ids: BTreeSet<u16> = actors.iter().filter(|a| a.kind == kind).map(|a| a.id).collect();
        snapshot.instances.iter().filter(|i| ids.contains(&i.object)).map(|i| i.lights).collect()
    };
    let shown = snapshot.instances.iter().find(|i| i.object == light.id).unwrap();
    assert_eq!(shown.lights, schema::lights::SIGNAL_YELLOW);
    assert!(lights_of(ActorKind::Building).iter().all(|l| *l == schema::lights::BUILDING));
    assert!(lights_of(ActorKind::Pole).contains(&schema::lights::STREET_LAMP));
    let day = FrameRow::default();
    let snapshot = world.snapshot(&empty_moment(&day), start(&map), 300.0);
    assert!(snapshot.instances.iter().all(|i| i.lights == 0));
}

#[test]
fn lamps_and_windows_have_the_light_of_the_log() {
    let map = demo();
    let Surroundings { actors, ground } = place(&map, &rules(), start(&map), 1);
    let mut world = SceneWorld::new(&actors, ground).unwrap();
    let near = |ids: Vec<u16>, world: &SceneWorld| -> Vec<(u32, [f32; 3])> {
        let frame = FrameRow { street_lamps: true, building_lights: true, ..FrameRow::default() };
        let snapshot = world.snapshot(&empty_moment(&frame), start(&map), 1e4);
        let of = |id| snapshot.instances.iter().find(|i| i.object == id).map(|i| (i.lights, i.glow)).unwrap();
        ids.into_iter().map(of).collect()
    };
    let lamps: Vec<u16> =
        actors.iter().filter(|a| catalogue::street_lamps::is_street_lamp(a)).map(|a| a.id).collect();
    let house = actors.iter().find(|a| a.kind == ActorKind::Building).unwrap().id;
    let row = |id, kind, works, flux_lm, color: [u8; 3]| LampRow {
        id,
        kind,
        works,
        flux_lm,
        color: color.to_vec(),
    };
    let nominal = near(vec![lamps[1]], &world)[0];
    world.set_lamps(&[
        row(lamps[0], LampKind::Street, false, Some(20_000.0), [255, 226, 183]),
        row(lamps[1], LampKind::Street, true, Some(50_000.0), [255, 226, 183]),
        row(house, LampKind::Building, true, None, [0, 255, 188]),
    ]);
    let found = near(vec![lamps[0], lamps[1], house, lamps[2]], &world);
    assert_eq!(found[0].0, 0);
    assert_eq!(found[1].0, schema::lights::STREET_LAMP);
    // Two and a half times as bright as the nominal 20,000 lm, of the same colour.
    assert!((0..3).all(|k| (found[1].1[k] - 2.5 * nominal.1[k]).abs() < 1e-5), "{found:?} {nominal:?}");
    // sRGB 188 is half of the light.
    let [r, g, b] = found[2].1;
    assert!(r == 0.0 && (g - 1.0).abs() < 1e-5 && (b - 0.503).abs() < 0.002, "{found:?}");
    assert_eq!(found[3], nominal);
}

#[test]
fn faults_are_named() {
    let new = |actors: &[ActorRow]| SceneWorld::new(actors, Vec::new());
    assert_eq!(new(&[car(1), car(1)]).unwrap_err(), WorldError::DuplicateId { id: 1 });
    let strange = ActorRow { model: "car.boat".into(), ..car(1) };
    assert!(matches!(new(&[strange]), Err(WorldError::UnknownModel { id: 1, .. })));
    let flat = ActorRow { height_m: f64::NAN, ..car(1) };
    assert!(matches!(new(&[flat]), Err(WorldError::BadActor { id: 1, .. })));
    let lava = ActorRow { kind: ActorKind::Surface, model: "surface.lava".into(), ..car(3) };
    assert!(matches!(new(&[car(1), lava]), Err(WorldError::UnknownModel { id: 3, .. })));
}

#[test]
fn blinkers_and_emergency_lights_flash_by_the_clock() {
    use schema::lights::{BLINK_LEFT, EMERGENCY, EMERGENCY_OTHER, LOW_BEAM};
    let world = SceneWorld::new(&[car(7), car(8)], Vec::new()).unwrap();
    let lamps = |frame: u32, id: u16| -> u32 {
        let lights = BLINK_LEFT | EMERGENCY | LOW_BEAM;
        let states = [7, 8].map(|id| StateRow { lights, ..state(frame as i32, id, 0.0, 0.0) });
        let row = FrameRow::new(frame, &schema::tables::Weather::default(), false, false);
        let moment = Moment { states: &states, previous: &states, signals: &[], frame: &row };
        let snapshot = world.snapshot(&moment, [0.0; 3], 50.0);
        let of: Vec<u32> = snapshot.instances.iter().filter(|i| i.object == id).map(|i| i.lights).collect();
        assert!(of.iter().all(|l| *l == of[0]));
        of[0]
    };
    // Forty seconds of twenty frames.
    let frames: Vec<u32> = (0..800).map(|frame| lamps(frame, 7)).collect();
    let starts = |bit: u32| frames.windows(2).filter(|w| w[0] & bit == 0 && w[1] & bit != 0).count();
    let share = |bit: u32| frames.iter().filter(|l| **l & bit != 0).count();
    assert!(starts(BLINK_LEFT).abs_diff(60) <= 1 && share(BLINK_LEFT).abs_diff(400) <= 10);
    assert!(starts(EMERGENCY).abs_diff(80) <= 1 && share(EMERGENCY).abs_diff(400) <= 10);
    // One side, then the other; beams burn on.
    assert!(frames.iter().all(|l| (l & EMERGENCY == 0) != (l & EMERGENCY_OTHER == 0)));
    assert!(frames.iter().all(|l| l & LOW_BEAM != 0));
    // Two cars do not flash in step.
    assert!((0..40).any(|frame| lamps(frame, 8) != frames[frame as usize]));
}

#[test]
fn the_motion_of_a_walker_is_that_of_its_limbs() {
    use std::f64::consts::TAU;
    let model = catalogue::models::find("walker.woman").unwrap();
    let body = meshes::people::Walker::new(model, 3);
    let [length_m, width_m, height_m] = body.size_m().to_array().map(f64::from);
    let (kind, name) = (ActorKind::Walker, model.name.to_owned());
    let walker = ActorRow { kind, model: name, length_m, width_m, height_m, variant: 3, ..car(7) };
    // And two alike share their meshes.
    let pair = [walker.clone(), ActorRow { id: 8, ..walker }];
    let world = SceneWorld::new(&pair, Vec::new()).unwrap();
    let alone = SceneWorld::new(&pair[..1], Vec::new()).unwrap();
    assert_eq!(world.meshes().len(), alone.meshes().len());
    let gait_mps = 1.3f32;
    let (step_m, stride_m) = (0.05 * f64::from(gait_mps), f64::from(body.figure().stride_m(gait_mps)));
    let frame = FrameRow::default();
    for k in 0..24 {
        let at = |frame: i32| {
            let way_m = step_m * f64::from(k + frame);
            StateRow { gait_mps, ..state(frame, 7, way_m, (TAU * way_m / stride_m) as f32) }
        };
        let moment = Moment { states: &[at(0)], previous: &[at(-1)], signals: &[], frame: &frame };
        let snapshot = world.snapshot(&moment, [0.0; 3], 50.0);
        assert_eq!(snapshot.instances.len(), body.meshes().len());
        let (mut fastest, mut slowest) = (0.0f32, f32::INFINITY);
        for instance in &snapshot.instances {
            for p in &snapshot.mesh(instance).positions {
                let [now, then] = [instance.local_from_object, instance.previous_local_from_object]
                    .map(|pose| pose.transform_point3(*p));
                let moved = (now - then).length();
                fastest = fastest.max(moved);
                slowest = if now.z < 1e-3 { slowest.min(moved) } else { slowest };
            }
        }
        // Objects on the ground do not move, and somewhere a limb is faster than the body.
        assert!(slowest < 0.004, "step {k}: {slowest}");
        assert!((0.9 * step_m as f32..5.0 * step_m as f32).contains(&fastest), "step {k}: {fastest}");
    }
}

#[test]
fn doors_are_there_while_they_stand_open() {
    let world = SceneWorld::new(&[car(7)], Vec::new()).unwrap();
    let frame = FrameRow::default();
    let with = |now: [f32; 4], before: [f32; 4]| {
        let states = [StateRow { door_rad: now, ..state(0, 7, 10.0, 0.0) }];
        let previous = [StateRow { door_rad: before, ..state(-1, 7, 10.0, 0.0) }];
        let moment = Moment { states: &states, previous: &previous, signals: &[], frame: &frame };
        world.snapshot(&moment, [10.0, 0.0, 0.0], 50.0).instances
    };
    let closed = with([0.0; 4], [0.0; 4]);
    let opening = with([0.3, 0.0, 0.0, 0.0], [0.0; 4]);
    // Body and wheels, and the leaf and the way in of one door.
    assert_eq!([closed.len(), opening.len(), with([1.1; 4], [1.1; 4]).len()], [5, 7, 13]);
    let leaf = opening[5];
    let [hinge, was] = [leaf.local_from_object, leaf.previous_local_from_object].map(|p| p.translation);
    assert!((hinge - was).length() < 1e-6);
    let turned = leaf.local_from_object.matrix3 * leaf.previous_local_from_object.matrix3.transpose();
    // By 0.3 rad about the vertical, clockwise from above.
    assert!((turned.x_axis.y + 0.29552).abs() < 1e-4 && (turned.z_axis.z - 1.0).abs() < 1e-6, "{turned}");
    let broken = with([f32::NAN, 0.0, 0.0, 0.0], [0.0; 4]);
    assert!(broken.is_empty(), "a state that cannot be is passed over");
}
