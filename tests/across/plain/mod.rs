//! Masks and voxel grids of real frames, computed a second time: every triangle against every cell that it may touch, in
//! double precision, without the code that draws them. Geometry, tags, the middles of the map's markings and the
//! container are shared.

mod masks;
mod soup;
mod voxels;

use std::path::Path;

use convoy_tests::Bench;
use replay::Replay;
use scene::{ArrayReader, SceneReader};
use schema::AgentId;
use schema::arrays::{BEV_MASKS, VOXEL_GRIDS};
use schema::settings::OccupancySettings;
use store::Store;

const RANGE_M: f64 = 40.0;
const VOXEL_M: f64 = 0.5;
const UPPER_M: f64 = 7.0;

fn config(map: &str) -> String {
    format!(
        "name = \"plain\"\nseed = 5\n[scenes.train]\n\"{map}\" = 1\n[agents]\nmin_vehicles = 1\nmax_vehicles = 1\n\
         min_rsus = 1\nmax_rsus = 1\n[timing]\nwarmup_s = 2\nmin_duration_s = 1\nmax_duration_s = 1\n\
         [traffic]\nvehicles = 40\n[walkers]\ncount = 60\n[hazards]\nshare = 0.2\n\
         [vehicle.occupancy]\nrange_m = {RANGE_M}\nvoxel_m = {VOXEL_M}\n\
         [rsu.occupancy]\nrange_m = {RANGE_M}\nvoxel_m = {VOXEL_M}\n"
    )
}

/// The array of an agent at a frame.
fn array(scene: &SceneReader, kind: &schema::arrays::ArrayKind, agent: AgentId, frame: u32) -> Vec<u8> {
    ArrayReader::open(scene, kind, agent, 1 << 30).and_then(|mut all| all.read(frame)).expect("reads").bytes
}

/// Makes a scene on a map and holds two frames of each agent against a second computation.
fn labels_are_those_of_the_triangles(map: &str, maps: Option<&Path>) {
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
    let grid = OccupancySettings {
        range_m: RANGE_M,
        voxel_m: VOXEL_M,
        upper_m: UPPER_M,
        ..OccupancySettings::default()
    };
    for (position, &agent) in replay.log.agent_ids().iter().enumerate() {
        for frame in [0, replay.log.frame_count() - 1] {
            let place = format!("{map} {agent} frame {frame}");
            let pose = replay.log.world_from_agent(position, frame);
            let snapshot = replay.snapshot(frame, pose.xyz(), 130.0);
            let pieces = soup::pieces(&snapshot);
            let tags = array(&scene, &VOXEL_GRIDS, agent, frame);
            voxels::check(&pieces, &pose, &grid, &tags, &place);
            let bits = array(&scene, &BEV_MASKS, agent, frame);
            masks::check(&replay, &snapshot, &pieces, &pose, &bits, &place);
        }
    }
}

#[test]
fn labels_of_the_demo_town_are_those_of_its_triangles() {
    labels_are_those_of_the_triangles("convoy/demo", None);
}

#[test]
fn labels_of_a_motorway_are_those_of_its_triangles() {
    labels_are_those_of_the_triangles("convoy/06", None);
}

#[test]
fn labels_of_mountain_roads_are_those_of_their_triangles() {
    labels_are_those_of_the_triangles("convoy/07", None);
}

#[test]
fn labels_of_real_towns_are_those_of_their_triangles() {
    let Some(maps) = testkit::maps_folder() else { return };
    for town in ["Town03", "Town04"] {
        labels_are_those_of_the_triangles(town, Some(&maps.join("carla")));
    }
}
