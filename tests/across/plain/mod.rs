//! Masks and voxel grids of real frames, computed a second time: every triangle against every cell that it
//! may touch, in double precision, without the code that draws them. Crossings and markings are read from the
//! map's file by a reader of its own. Triangles, their tags, the log's hazards and the container are shared.

mod grid;
mod masks;
mod paint;
mod roads;
mod soup;
mod voxels;

use std::path::Path;

use convoy_tests::Bench;
use nalgebra::Vector3;
use replay::Replay;
use scene::{ArrayReader, SceneReader};
use schema::arrays::{BEV_MASKS, VOXEL_GRIDS};
use schema::{AgentId, BevClass};
use settings::OccupancySettings;
use store::Store;

const RANGE_M: f64 = 40.0;
const VOXEL_M: f64 = 0.5;
const UPPER_M: f64 = 7.0;
/// The last of the twenty frames of a second; labels are made at it and the first alone.
const LAST: u32 = 19;

/// What roads have outside of towns, and inside.
const MARKED: [BevClass; 3] = [BevClass::Road, BevClass::RoadLine, BevClass::Hazard];
const PAVED: [BevClass; 5] =
    [BevClass::Road, BevClass::RoadLine, BevClass::Sidewalk, BevClass::Crosswalk, BevClass::Hazard];

fn config(map: &str) -> String {
    format!(
        "name = \"plain\"\nseed = 5\n[scenes.train]\n\"{map}\" = 1\n[agents]\nmin_vehicles = 1\nmax_vehicles = 1\n\
         min_rsus = 1\nmax_rsus = 1\n[timing]\nwarmup_s = 2\nmin_duration_s = 1\nmax_duration_s = 1\n\
         [traffic]\nvehicles = 40\n[walkers]\ncount = 60\n[hazards]\nshare = 0.2\n\
         [bev]\nevery_n_frames = {LAST}\n\
         [vehicle.occupancy]\nrange_m = {RANGE_M}\nvoxel_m = {VOXEL_M}\nevery_n_frames = {LAST}\n\
         [rsu.occupancy]\nrange_m = {RANGE_M}\nvoxel_m = {VOXEL_M}\nevery_n_frames = {LAST}\n"
    )
}

/// The array of an agent at a frame.
fn array(scene: &SceneReader, kind: &schema::arrays::ArrayKind, agent: AgentId, frame: u32) -> Vec<u8> {
    ArrayReader::open(scene, kind, agent, 1 << 30).and_then(|mut all| all.read(frame)).expect("reads").bytes
}

/// What a map's file says.
fn map_text(store: &Path, map: &str, maps: Option<&Path>) -> String {
    let Some(maps) = maps else {
        let packed =
            std::fs::read(store.join("maps").join(format!("{map}.xodr.zst"))).expect("is in the store");
        return String::from_utf8(zstd::decode_all(&packed[..]).expect("is packed")).expect("is text");
    };
    std::fs::read_to_string(maps.join(format!("{map}.xodr"))).expect("is text")
}

/// Makes a scene on a map and holds two frames of each agent against a second computation; `classes` of the
/// ground must come up.
fn labels_are_those_of_the_triangles(map: &str, maps: Option<&Path>, classes: &[BevClass]) {
    let bench = Bench::new(&config(map));
    let folder = maps.map(|maps| maps.display().to_string());
    let args: Vec<&str> = folder.iter().flat_map(|maps| ["--maps", maps.as_str()]).collect();
    bench.run("spawn-planner", &args).expect_done();
    for stage in ["simulate-and-log", "bev-gt", "occupancy-gt"] {
        bench.run(stage, &[]).expect_done();
    }
    let store = Store::open(bench.store()).expect("is a folder");
    let stages = ["simulate-and-log", "bev-gt", "occupancy-gt"];
    let scene = SceneReader::open(&store, 0, &stages).expect("is done");
    let replay = Replay::open(&scene).expect("is a log");
    let hazards = replay.log.info.hazards.iter();
    let hazards = hazards.map(|h| h.area_m.iter().map(|&p| Vector3::from(p)).collect()).collect();
    let ground = masks::Ground { roads: roads::read(&map_text(&bench.store(), map, maps)), hazards };
    let mut compared = [0; BevClass::COUNT];
    let grid = OccupancySettings {
        range_m: RANGE_M,
        voxel_m: VOXEL_M,
        upper_m: UPPER_M,
        ..OccupancySettings::default()
    };
    for (position, &agent) in replay.log.agent_ids().iter().enumerate() {
        for frame in [0, LAST] {
            let place = format!("{map} {agent} frame {frame}");
            let pose = replay.log.world_from_agent(position, frame);
            let snapshot = replay.snapshot(frame, pose.xyz(), 210.0);
            let pieces = soup::pieces(&snapshot);
            let tags = array(&scene, &VOXEL_GRIDS, agent, frame);
            voxels::check(&pieces, &pose, &grid, &tags, &place);
            let bits = array(&scene, &BEV_MASKS, agent, frame);
            let counts = masks::check(&ground, &snapshot, &pieces, &pose, &bits, &place);
            compared.iter_mut().zip(counts).for_each(|(all, count)| *all += count);
        }
    }
    for class in classes {
        assert!(compared[*class as usize] >= 100, "{map}: too little of {}: {compared:?}", class.name());
    }
}

#[test]
fn labels_of_the_demo_town_are_those_of_its_triangles() {
    labels_are_those_of_the_triangles("convoy/demo", None, &PAVED);
}

#[test]
fn labels_of_a_motorway_are_those_of_its_triangles() {
    labels_are_those_of_the_triangles("convoy/06", None, &MARKED);
}

#[test]
fn labels_of_mountain_roads_are_those_of_their_triangles() {
    labels_are_those_of_the_triangles("convoy/07", None, &MARKED);
}

#[test]
fn labels_of_real_towns_are_those_of_their_triangles() {
    let Some(maps) = testkit::maps_folder() else { return };
    let maps = maps.join("carla");
    labels_are_those_of_the_triangles("Town03", Some(&maps), &PAVED);
    labels_are_those_of_the_triangles("Town04", Some(&maps), &MARKED);
}
