//! A pack of models through the whole pipeline: what is drawn, logged, boxed, rendered and seen by lidar.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use convoy_tests::{Bench, Outcome, TINY, program, workspace};
use frames::{Agent, Object, Pose, World};
use nalgebra::Point3;
use replay::Replay;
use runner::{Graph, UnitKind};
use scene::{SceneReader, agent_rows};
use schema::tables::{CameraRow, SemanticLidarRow};
use schema::{AgentId, Attribute, ObjectId};
use store::Store;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;

const VAN: &str = "van.kiosk";
const ADA: &str = "walker.ada";
const STAGES: [&str; 2] = ["simulate-and-log", "render-sensors"];
/// A camera that looks at the vehicle which carries it, and nothing else that is yellow and blue.
const ITSELF: &str = "
[[vehicle.cameras]]
name = \"CAM_ITSELF\"
xyz_m = [0, 2.6, 2.4]
rpy_deg = [0, 35, -90]
";

fn config() -> String {
    let seconds = TINY.replace("max_vehicles = 1\n", "max_vehicles = 2\nvehicle_models = [\"van.kiosk\"]\n");
    let seconds = seconds.replace("min_vehicles = 1\n", "min_vehicles = 2\n");
    let seconds = seconds.replace("[walkers]\ncount = 12\n", "[walkers]\ncount = 60\nwaiting = 0\n");
    let clear = "sun_altitude_deg = 30\ncloudiness = 0\nprecipitation = 0\nfog_density = 0\ndust_storm = 0\n";
    let seconds = seconds.replace("sun_altitude_deg = 30\n", clear).replace("vehicles = 12", "vehicles = 30");
    // The van is higher than the cars whose roofs lidars are made for: from here the lowest beams just pass
    // its roof.
    let seconds = seconds.replace("[vehicle.lidar]\n", "[vehicle.lidar]\nxyz_m = [0, 0, 4.2]\n");
    format!("{seconds}{ITSELF}[models]\npacks = [\"pack\"]\n")
}

/// A copy of the example where maps would be.
fn pack(bench: &Bench) -> (PathBuf, String) {
    let maps = bench.folder.path().join("maps");
    let pack = maps.join("pack");
    std::fs::create_dir_all(&pack).expect("makes the folder");
    for file in std::fs::read_dir(workspace().join("tests/packs/example")).expect("is there") {
        let file = file.expect("is listed");
        std::fs::copy(file.path(), pack.join(file.file_name())).expect("copies");
    }
    (pack, maps.display().to_string())
}

#[test]
fn models_of_a_pack_are_seen_by_all() {
    let bench = Bench::new(&config());
    let (pack, maps) = pack(&bench);
    bench.run("spawn-planner", &["--maps", &maps]).expect_done();
    // From here on the store is complete by itself.
    std::fs::remove_dir_all(&pack).expect("removes it");
    for stage in Graph::get().stages.iter().filter(|stage| stage.unit != UnitKind::Plan) {
        bench.run(stage.name, &[]).expect_done();
    }
    // Boxes, points, pixels, masks and voxels say the same of each object, its model or not.
    let mut check = Command::new(program("check"));
    check.arg("--store").arg(bench.store()).args(["--every", "5", "--threads", "1"]);
    Outcome::of(&check.output().expect("the program starts")).expect_done();

    let store = Store::open(bench.store()).expect("is a folder");
    let scene = SceneReader::open(&store, 0, &STAGES).expect("is done");
    let replay = Replay::open(&scene).expect("is a log");
    let vans: BTreeSet<ObjectId> =
        replay.log.actors.iter().filter(|a| a.model == VAN).map(|a| a.id).collect();
    assert!(vans.len() > 2, "two agents and others: {vans:?}");
    let info = &replay.log.info;
    assert!(info.models.iter().any(|m| m.name == VAN && m.page == "van.toml"), "{:?}", info.models);
    let own = replay.log.actors.iter().find(|a| a.role.to_string() == "vehicle_0").expect("is there");
    assert_eq!((own.model.as_str(), own.height_m, own.width_m), (VAN, 2.5, 2.0));
    boxes_hold_the_mesh(&replay, own.id, [own.length_m, own.width_m, own.height_m]);
    let points = points_lie_in_boxes(&scene, &replay, &vans);
    assert!(points > 100, "only {points} lidar points on vans");
    let people: BTreeSet<ObjectId> =
        replay.log.actors.iter().filter(|a| a.model == ADA).map(|a| a.id).collect();
    assert!(people.len() > 8, "as common as six built-in ones of eight: {people:?}");
    assert!(info.models.iter().any(|m| m.name == ADA && m.page == "ada.toml"), "{:?}", info.models);
    for actor in replay.log.actors.iter().filter(|a| a.model == ADA) {
        let said = |attribute| actor.attributes.get(&attribute).map(str::to_owned);
        assert_eq!(said(Attribute::Gender).as_deref(), Some("female"));
        assert_eq!(said(Attribute::Age).as_deref(), Some("adult"));
    }
    boxes_follow_the_pose(&replay, &people);
    let points = points_lie_in_boxes(&scene, &replay, &people);
    assert!(points > 30, "only {points} lidar points on people");
    let [yellow, blue] = livery(&scene);
    assert!(yellow > 800 && blue > 150, "the picture of the van has {yellow} yellow and {blue} blue pixels");
}

/// Every corner of an object's triangles lies in its box, and some on each of its sides.
fn boxes_hold_the_mesh(replay: &Replay, id: ObjectId, size_m: [f64; 3]) {
    let pose = replay.log.world_from_agent(0, 3);
    let snapshot = replay.snapshot(3, pose.xyz(), 20.0);
    let motion = snapshot.motion(id).expect("moves");
    let object_from_local = motion.local_from_object.inverse();
    let (mut low, mut high, mut pieces) = (glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY, 0);
    for instance in snapshot.instances.iter().filter(|instance| instance.object == id) {
        let object_from_piece = object_from_local * instance.local_from_object;
        for corner in &snapshot.mesh(instance).positions {
            let at = object_from_piece.transform_point3(*corner);
            (low, high) = (low.min(at), high.max(at));
        }
        pieces += 1;
    }
    // Body, four wheels, two doors.
    assert_eq!(pieces, 7);
    let half = glam::Vec3::from_array(size_m.map(|v| 0.5 * v as f32));
    // Wheels are drums of 24 sides, and may have turned by half of one.
    let near = |a: f32, b: f32| (a - b).abs() < 5e-3;
    assert!(near(low.x, -half.x) && near(high.x, half.x), "{low} {high}");
    assert!(near(low.y, -half.y) && near(high.y, half.y), "{low} {high}");
    // They stand on the road while body and box lean.
    let [roll_rad, pitch_rad] =
        replay.log.states_at(3).iter().find(|s| s.id == id).expect("has a state").lean_rad.map(f32::abs);
    let lifted_m = half.x * pitch_rad + half.y * roll_rad;
    assert!(low.z > -5e-3 - lifted_m && low.z < 0.01 + lifted_m, "{low} {high}, {lifted_m}");
    assert!(near(high.z, 2.0 * half.z), "{low} {high}");
}

/// The box of each frame is that of the mesh as it walks: on five faces, and on the ground.
fn boxes_follow_the_pose(replay: &Replay, ids: &BTreeSet<ObjectId>) {
    let (mut looked, mut walked) = (0, BTreeSet::new());
    for frame in [0_u32, 3, 6, 9] {
        let snapshot = replay.snapshot(frame, replay.log.world_from_agent(0, frame).xyz(), 500.0);
        for state in replay.log.states_at(frame.into()).iter().filter(|state| ids.contains(&state.id)) {
            let Some(motion) = snapshot.motion(state.id) else { continue };
            let object_from_local = motion.local_from_object.inverse();
            let mut around = frames::Aabb::EMPTY;
            for instance in snapshot.instances.iter().filter(|instance| instance.object == state.id) {
                let object_from_piece = object_from_local * instance.local_from_object;
                let places =
                    snapshot.mesh(instance).positions.iter().map(|p| object_from_piece.transform_point3(*p));
                around = places.fold(around, |around, place| around.with(place));
            }
            let reach = around.max.max(-around.min);
            let size = glam::Vec3::new(2.0 * reach.x, 2.0 * reach.y, around.max.z);
            let off = (size - glam::Vec3::from_array(state.size_m)).abs().max_element();
            // A runner is in the air at times.
            let highest = if state.gait_mps > 2.0 { 0.1 } else { 0.02 };
            let stands = (-0.02..highest).contains(&around.min.z);
            assert!(
                off < 0.02 && stands,
                "frame {frame}: {size} from {} m on at {} m/s is not {:?}",
                around.min.z,
                state.gait_mps,
                state.size_m
            );
            looked += 1;
            if state.gait_mps > 0.3 {
                walked.insert((state.id, state.phase_rad.to_bits()));
            }
        }
    }
    assert!(looked > 8 && walked.len() > 8, "{looked} looked at, {} poses of a walk", walked.len());
}

/// How many lidar points lie on objects; each of them lies in its object's box.
fn points_lie_in_boxes(scene: &SceneReader, replay: &Replay, ids: &BTreeSet<ObjectId>) -> usize {
    let settings = settings::parse(&config(), "test").expect("is valid");
    let lidar = settings.scenario.vehicle_rig.lidars.iter().find(|l| l.semantic).expect("has one");
    let mut count = 0;
    for (position, agent) in [AgentId::vehicle(0), AgentId::vehicle(1)].into_iter().enumerate() {
        for row in agent_rows::<SemanticLidarRow>(scene, agent, "SEG-LIDAR").expect("reads") {
            let world_from_agent: Pose<World, Agent> = replay.log.world_from_agent(position, row.frame);
            for i in (0..row.id.len()).filter(|i| ids.contains(&row.id[*i])) {
                let actor = replay.log.actors.iter().find(|a| a.id == row.id[i]).expect("is logged");
                let states = replay.log.states_at(row.frame.into());
                let state = states.iter().find(|s| s.id == actor.id);
                let (xyz, turn) =
                    state.map_or((actor.xyz_m, actor.quaternion), |state| (state.xyz_m, state.quaternion));
                let mount = lidar.mount.xyz_m;
                let [x, y, z] = [row.x[i], row.y[i], row.z[i]].map(f64::from);
                let at = world_from_agent * Point3::new(x + mount[0], y + mount[1], z + mount[2]);
                let at = Pose::<World, Object>::from_xyz_wxyz(xyz, turn).inverse() * at;
                let over = 0.03;
                // A walker has a box of its own in each frame.
                let walks = state.filter(|_| actor.model == ADA);
                let size_m = walks.map_or([actor.length_m, actor.width_m, actor.height_m], |state| {
                    state.size_m.map(f64::from)
                });
                let inside = at.x.abs() < 0.5 * size_m[0] + over
                    && at.y.abs() < 0.5 * size_m[1] + over
                    && at.z > -over
                    && at.z < size_m[2] + over;
                assert!(inside, "{agent}, frame {}: a point of {} at {at}", row.frame, actor.model);
                count += 1;
            }
        }
    }
    count
}

/// How many pixels of a van's picture of itself are yellow and blue.
fn livery(scene: &SceneReader) -> [usize; 2] {
    let rows = agent_rows::<CameraRow>(scene, AgentId::vehicle(0), "RGB-CAM_ITSELF").expect("reads");
    let row = rows.first().expect("has pictures");
    let bytes: &[u8] = &row.image.0;
    let pixels = JpegDecoder::new(ZCursor::new(bytes)).decode().expect("is a JPEG");
    let (pixels, _) = pixels.as_chunks::<3>();
    let count = |is: fn(i32, i32, i32) -> bool| {
        pixels.iter().filter(|[r, g, b]| is((*r).into(), (*g).into(), (*b).into())).count()
    };
    [count(|r, g, b| r > 2 * b && g > 2 * b && r >= g), count(|r, g, b| b > 2 * r && b > g + 20 && r < 90)]
}

#[test]
fn a_changed_pack_makes_scenes_stale() {
    let bench = Bench::new(&config());
    let (pack, maps) = pack(&bench);
    let maps = ["--maps", maps.as_str()];
    bench.run("spawn-planner", &maps).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let first = bench.digests();
    bench.run("spawn-planner", &maps).expect_done();
    assert_eq!(first, bench.digests(), "nothing changed");
    let page = std::fs::read_to_string(pack.join("van.toml")).expect("is text");
    std::fs::write(pack.join("van.toml"), page.replace("weight = 6.0", "weight = 2.0")).expect("writes");
    let plan = bench.run("spawn-planner", &[maps[0], maps[1], "--dry-run"]);
    assert!(plan.stdout.contains("source/models/pack changed"), "{plan:?}");
    bench.run("spawn-planner", &maps).expect_done();
    let stale = bench.run("simulate-and-log", &["--dry-run"]);
    assert!(stale.stdout.contains("would run simulate-and-log scene 0000 (stale"), "{stale:?}");
}

#[test]
fn what_cannot_be_used_is_said_before_anything_is_planned() {
    let bench = Bench::new(&config());
    let none = bench.run("spawn-planner", &[]);
    assert_eq!(none.code, 2);
    assert!(none.stderr.contains("models.packs: there is no folder `pack`"), "{none:?}");
    let (pack, maps) = pack(&bench);
    std::fs::write(pack.join("stripes.png"), b"no picture").expect("writes");
    let broken = bench.run("spawn-planner", &["--maps", &maps]);
    assert_eq!(broken.code, 2);
    assert!(broken.stderr.contains("bollard.gltf: picture 0: is neither PNG nor JPEG"), "{broken:?}");
    assert!(!bench.store().join("plan/_manifest.json").exists());
    std::fs::remove_dir_all(&pack).expect("removes it");
    // A model that no pack has.
    let bench = Bench::new(&TINY.replace("[timing]", "vehicle_models = [\"van.kiosk\"]\n[timing]"));
    let unknown = bench.run("spawn-planner", &[]);
    assert_eq!(unknown.code, 2);
    assert!(unknown.stderr.contains("no vehicle model `van.kiosk`"), "{unknown:?}");
}

#[test]
fn without_packs_nothing_is_written_of_them() {
    let bench = Bench::new(TINY);
    bench.run("spawn-planner", &[]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let text = |path: &str| std::fs::read_to_string(bench.store().join(path)).expect("is text");
    for path in ["dataset.json", "scenes/0000/log/scene.json", "plan/_manifest.json"] {
        assert!(!text(path).contains("\"models\"") && !text(path).contains("models/"), "{path}");
    }
    assert!(!bench.store().join("models").exists() && !bench.store().join("plan/models.parquet").exists());
}

#[test]
fn the_page_shows_the_example() {
    let read = |path: &str| std::fs::read_to_string(workspace().join(path)).expect("is text");
    let page = read("docs/packs.md");
    for name in ["van.toml", "ada.toml"] {
        let shown = read(&format!("tests/packs/example/{name}"));
        assert!(page.contains(&format!("```toml\n{shown}```\n")), "docs/packs.md shows another {name}");
    }
    assert!(Path::new(&workspace()).join("tests/packs/example/van.glb").is_file());
}
