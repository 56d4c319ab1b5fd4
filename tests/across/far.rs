//! The world is the same wherever agents come from, and is there as far as they drive.

use std::collections::BTreeMap;
use std::path::PathBuf;

use convoy_tests::{Bench, SMALL};
use frames::{Agent, Pose, World};
use labels::bev::{Areas, BevRasterizer};
use opendrive::{LaneType, MarkType, Network, Road, RoadMark, RoadType, Speed, SpeedUnit};
use replay::Replay;
use scene::SceneReader;
use schema::geometry::Snapshot;
use schema::tables::{ActorRow, SceneTileRow};
use schema::{ActorKind, BevClass, ObjectId};
use settings::BevSettings;
use store::Store;

/// Where the other scene starts, metres along the road.
const FAR_M: f64 = 1100.0;

/// A fast street of 3 km to the north-east, with sidewalks, a broken line in its middle and another street
/// across it at 1.1 km.
fn network() -> Network {
    let lanes = [(LaneType::Driving, 3.5), (LaneType::Shoulder, 1.5), (LaneType::Sidewalk, 3.0)];
    let mut section = testkit::both_ways(&lanes);
    section.centre.marks =
        vec![RoadMark { mark_type: MarkType::Broken, width_m: Some(0.15), ..RoadMark::default() }];
    let fast = Speed { max: 130.0, unit: SpeedUnit::KilometresPerHour };
    let road = Road {
        types: vec![RoadType { s: 0.0, kind: "motorway".into(), speed: Some(fast), ..RoadType::default() }],
        ..testkit::road("1", [0.0, 0.0], 0.4, 3000.0, section)
    };
    let side = testkit::road("2", [1000.0, 500.0], 2.0, 400.0, testkit::both_ways(&lanes[..1]));
    let mut network = Network { roads: vec![road, side], ..Network::default() };
    network.header.revision = (1, 7);
    network
}

/// A scene of one car that starts so far along the road and drives on for some seconds.
fn driven(from_m: f64, seconds: u32) -> (Bench, SceneReader) {
    let (sin, cos) = frames::math::sin_cos(0.4);
    let (x, y) = (from_m * cos + 1.75 * sin, from_m * sin - 1.75 * cos);
    let config = SMALL
        .replace("convoy/demo", "far")
        .replace("rsus = 1", "rsus = 0")
        .replace("vehicles = 12", "vehicles = 0")
        .replace("count = 12", "count = 0")
        .replace("duration_s = 1", &format!("duration_s = {seconds}"))
        .replace("radius_m = 120", "radius_m = 150")
        + &format!(
            "\n[hazards]\nshare = 0\n\n[annotation]\nbox_radius_m = 120\n\n[[agents.starts]]\nmap = \"far\"\nxyz_m = [{x}, {y}, 0]\nyaw_deg = 22.9\n"
        );
    let bench = Bench::new(&config);
    let maps: PathBuf = bench.folder.path().join("maps");
    std::fs::create_dir(&maps).expect("makes the folder");
    std::fs::write(maps.join("far.xodr"), opendrive::write(&network())).expect("writes");
    bench.run("spawn-planner", &["--maps", maps.to_str().expect("is UTF-8")]).expect_done();
    bench.run("simulate-and-log", &[]).expect_done();
    let store = Store::open(bench.store()).expect("is a folder");
    let scene = SceneReader::open(&store, 0, &["simulate-and-log"]).expect("is done");
    (bench, scene)
}

/// Static objects in a snapshot: the bits of every triangle's corners in its frame, with its tag.
fn still(snapshot: &Snapshot, moving: &[ObjectId]) -> Vec<(u8, [[u32; 3]; 3])> {
    let mut triangles = Vec::new();
    for instance in snapshot.instances.iter().filter(|i| !moving.contains(&i.object)) {
        let mesh = snapshot.mesh(instance);
        for i in 0..mesh.triangles.len() {
            let corners = mesh.corners(i).map(|p| instance.local_from_object.transform_point3(p));
            triangles.push((mesh.part(i).tag as u8, corners.map(|p| p.to_array().map(f32::to_bits))));
        }
    }
    triangles.sort_unstable();
    triangles
}

fn moving(replay: &Replay) -> Vec<ObjectId> {
    replay.log.actors.iter().filter(|a| !a.fixed).map(|a| a.id).collect()
}

/// The objects within some metres of a place, apart from ids and from which lamps work.
fn standing(actors: &[ActorRow], at: [f64; 3], within_m: f64) -> Vec<ActorRow> {
    let near = |a: &&ActorRow| {
        let [dx, dy] = [a.xyz_m[0] - at[0], a.xyz_m[1] - at[1]];
        a.fixed && a.kind != ActorKind::Surface && dx * dx + dy * dy < within_m * within_m
    };
    let mut found: Vec<ActorRow> = actors.iter().filter(near).cloned().collect();
    for actor in &mut found {
        actor.id = 0;
        if catalogue::street_lamps::is_street_lamp(actor) {
            actor.variant = 0;
        }
    }
    found.sort_by(|a, b| a.xyz_m.partial_cmp(&b.xyz_m).expect("finite").then_with(|| a.model.cmp(&b.model)));
    found
}

#[test]
fn a_place_is_the_same_after_a_kilometre_as_from_the_start() {
    let (_far, driven_there) = driven(100.0, 42);
    let (_near, started_there) = driven(FAR_M, 1);
    let there = Replay::open(&driven_there).expect("is a log");
    let here = Replay::open(&started_there).expect("is a log");
    let last = there.log.frame_count() - 1;
    let start = there.log.agent(0, 0).xyz_m;
    let frame = (0..=last)
        .min_by(|a, b| {
            let off = |frame: u32| {
                let [dx, dy] =
                    [0, 1].map(|k| there.log.agent(0, frame).xyz_m[k] - here.log.agent(0, 0).xyz_m[k]);
                dx * dx + dy * dy
            };
            off(*a).total_cmp(&off(*b))
        })
        .expect("has frames");
    let pose: Pose<World, Agent> = there.log.world_from_agent(0, frame);
    let at = pose.xyz();
    let way = [0, 1].map(|k| at[k] - start[k]);
    assert!(way[0] * way[0] + way[1] * way[1] > 950.0 * 950.0, "went {way:?} m in {} frames", last + 1);

    // The same triangles, bit by bit, though the scenes have other ids.
    let [a, b] = [there.snapshot(frame, at, 140.0), here.snapshot(0, at, 140.0)];
    let [a_still, b_still] = [still(&a, &moving(&there)), still(&b, &moving(&here))];
    assert!(a_still.len() > 5000, "{}", a_still.len());
    assert!(a_still == b_still, "{} and {} triangles", a_still.len(), b_still.len());
    let things = [&there, &here].map(|replay| standing(&replay.log.actors, at, 140.0));
    assert!(things[0].len() > 50, "{}", things[0].len());
    assert_eq!(things[0], things[1]);

    // The same masks of what is static, and as much road everywhere on the way.
    let settings = BevSettings::default();
    let areas = || Areas { crosswalks: &[], hazards: &[], road_lines: &[] };
    let mut rasterizer = BevRasterizer::new(&settings).expect("good settings");
    let mut layer = |snapshot: &Snapshot, pose: &Pose<World, Agent>, class: BevClass| -> Vec<u8> {
        rasterizer.rasterize(snapshot, pose, areas()).to_bytes(&[class])
    };
    for class in [BevClass::Road, BevClass::Sidewalk] {
        let [there, here] = [layer(&a, &pose, class), layer(&b, &pose, class)];
        assert!(there.contains(&1) && there == here, "{class:?}");
    }
    let mut roads = Vec::new();
    for frame in (0..=last).step_by(40) {
        let pose = there.log.world_from_agent(0, frame);
        let snapshot = there.snapshot(frame, pose.xyz(), 140.0);
        roads.push(layer(&snapshot, &pose, BevClass::Road).iter().map(|c| usize::from(*c)).sum::<usize>());
    }
    // 160 m of road, 10 m wide, in cells of 0.16 m2; the side street adds to it.
    assert!(roads.len() > 10 && roads.iter().all(|n| (9_500..15_000).contains(n)), "{roads:?}");
}

#[test]
fn tiles_are_shared_counted_and_missed() {
    let (bench, scene) = driven(300.0, 1);
    let rows: Vec<SceneTileRow> = scene.rows().expect("is a table");
    let actors: Vec<ActorRow> = scene.rows().expect("is a table");
    // All things of the tiles, and no others, have the ids that the table says.
    let by_id: BTreeMap<ObjectId, &ActorRow> = actors.iter().map(|a| (a.id, a)).collect();
    let mut told = 0;
    for row in &rows {
        for id in (0..row.objects).map(|k| row.first_id + k as u16) {
            let [x, y, _] = by_id[&id].xyz_m;
            let off = [x - 256.0 * f64::from(row.x), y - 256.0 * f64::from(row.y)];
            assert!(off.iter().all(|v| (-10.0..266.0).contains(v)), "{id} at {x}, {y} in {row:?}");
            told += 1;
        }
    }
    let scenery = actors.iter().filter(|a| a.fixed && a.kind != ActorKind::Surface).count();
    assert_eq!(told, scenery);
    assert!(rows.len() > 3 && told > 100);

    let whole = bench.digests();
    let is_tile = |name: &str| name.starts_with("tiles/");
    let tile = whole.keys().find(|name| is_tile(name) && name.ends_with("surfaces.parquet")).expect("a tile");
    // Simulated again, the scene finds its tiles.
    let path = bench.store().join(tile);
    let before = std::fs::metadata(&path).and_then(|m| m.modified()).expect("is there");
    bench.run("simulate-and-log", &["--force"]).expect_done();
    assert_eq!(before, std::fs::metadata(&path).and_then(|m| m.modified()).expect("is there"));

    // A tile that was cut short is seen by verify; gone with its manifest, the stage that needs it says what
    // to do; and it comes back as it was.
    let folder = path.parent().expect("has a folder").to_owned();
    let bytes = std::fs::read(&path).expect("reads");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("truncates");
    let verify = bench.run("convoy", &["verify"]);
    assert!(verify.stdout.contains(tile.as_str()) && verify.stdout.contains("truncated"), "{verify:?}");
    std::fs::remove_dir_all(&folder).expect("removes");
    let missing = bench.run("bev-gt", &[]);
    let wanted = "is missing (run simulate-and-log for scene 0 again with --force)";
    assert!(missing.code == 1 && missing.stderr.contains(wanted), "{missing:?}");
    bench.run("simulate-and-log", &["--force"]).expect_done();
    bench.run("bev-gt", &[]).expect_done();
    let again = bench.digests();
    assert!(whole.iter().filter(|(name, _)| is_tile(name)).all(|(name, digest)| again[name] == *digest));

    // Other rules, other tiles; those before stay until they are tidied away.
    let text = std::fs::read_to_string(bench.config()).expect("reads");
    bench.configure(&text.replace("[world]\n", "[world]\nseed = 4\n"));
    bench.run("simulate-and-log", &[]).expect_done();
    let manifests = |files: BTreeMap<String, String>| -> Vec<String> {
        files.into_keys().filter(|name| is_tile(name) && name.ends_with("_manifest.json")).collect()
    };
    let both = manifests(bench.digests());
    let tidied = bench.run("convoy", &["tidy"]);
    tidied.expect_done();
    assert!(tidied.stdout.starts_with(&format!("{} tiles removed", rows.len())), "{tidied:?}");
    let left = manifests(bench.digests());
    assert_eq!(both.len(), rows.len() + left.len());
    bench.run("bev-gt", &["--force"]).expect_done();
}

#[test]
fn programs_that_make_the_same_tiles_at_once_agree() {
    // Two scenes of one small town, each simulated by a program of its own.
    let config = SMALL.replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 2");
    let together = Bench::new(&config);
    together.run("spawn-planner", &[]).expect_done();
    let mut runs = ["0", "1"].map(|scene| together.start("simulate-and-log", &["--scenes", scene]));
    assert!(runs.iter_mut().all(|run| run.wait().expect("ends").success()));
    let alone = Bench::new(&config);
    alone.run("spawn-planner", &[]).expect_done();
    alone.run("simulate-and-log", &[]).expect_done();
    assert_eq!(together.digests(), alone.digests());
    let tiles = |name: &&String| name.starts_with("tiles/") && name.ends_with("_manifest.json");
    assert!(together.digests().keys().filter(tiles).count() > 3);
}
