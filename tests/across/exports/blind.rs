//! Scenes in which nobody has a camera, in an export of others in which somebody has.

use std::path::Path;

use convoy_tests::{Bench, TINY, digests};
use schema::table::Row;
use schema::tables::{PlanAgentRow, PlanSceneRow};
use store::{Scope, Store, keys};

use super::export;

/// The second vehicle of a scene has cameras, the first one has none; some scenes have one vehicle.
fn store() -> (Bench, [u32; 2]) {
    let cameras = |views: &[(&str, i32)]| {
        let camera = |(name, yaw_deg): &(&str, i32)| {
            format!("{{ name = \"{name}\", xyz_m = [0, 0, 1.8], rpy_deg = [0, 0, {yaw_deg}] }}")
        };
        views.iter().map(camera).collect::<Vec<_>>().join(", ")
    };
    let four = cameras(&[("A", 0), ("B", -100), ("C", 100), ("D", 180)]);
    let sizes = "camera = { width = 160, height = 90 }\nlidar = { channels = 16, columns = 256 }\n\
                 occupancy = { voxel_m = 1 }\nradars = []\n";
    let config = TINY.split("[vehicle.camera]").next().unwrap_or_default();
    let config = config
        .replace("\"convoy/demo\" = 1", "\"convoy/demo\" = 6")
        .replace("max_vehicles = 1", "max_vehicles = 2")
        .replace("_rsus = 1", "_rsus = 0");
    let rigs = format!(
        "[vehicle]\ncameras = []\n{sizes}\n[[rigs]]\nagents = [\"vehicle_1\"]\ncameras = [{four}]\n{sizes}"
    );
    let bench = Bench::new(&(config + &rigs));
    bench.run("spawn-planner", &[]).expect_done();
    let store = Store::open(bench.store()).expect("is a folder");
    let plan = store.manifest(Scope::Plan, PlanSceneRow::STAGE).expect("reads").expect("is planned");
    let agents: Vec<PlanAgentRow> = store.read_rows(&plan, keys::PLAN_AGENTS).expect("reads");
    let of = |count: usize| {
        let in_scene = |scene: &u32| agents.iter().filter(|agent| agent.scene == *scene).count();
        (0..6).find(|scene| in_scene(scene) == count).expect("there is such a scene")
    };
    let scenes = [of(1), of(2)];
    let list = scenes.map(|scene| scene.to_string()).join(",");
    bench.run("convoy", &["run", "--scenes", &list, "--progress", "none"]).expect_done();
    (bench, scenes)
}

#[test]
fn a_scene_without_cameras_has_black_pictures_beside_scenes_with_some() {
    let (bench, [blind, seeing]) = store();
    let (whole, outcome) = export(&bench, "opv2v", "whole", &[]);
    outcome.expect_done();
    assert!(outcome.stdout.contains("note: pictures of vehicle_0 are black"), "{}", outcome.stdout);
    let bytes = digests(&whole);
    let pictures = |scene: u32| -> Vec<&String> {
        let place = format!("/scene_{scene:04}/");
        bytes.keys().filter(|name| name.contains(&place) && name.ends_with("_camera3.png")).collect()
    };
    // Ten frames of one vehicle, and of two.
    assert_eq!((pictures(blind).len(), pictures(seeing).len()), (10, 20));
    let size = |path: &Path| {
        let png = std::fs::read(path).expect("is there");
        [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes")))
    };
    assert_eq!(size(&whole.join(pictures(blind)[0])), [160, 90]);
    // Whichever scene comes first, and alone.
    for order in [[blind, seeing], [seeing, blind]] {
        let name = format!("first-{}", order[0]);
        for scene in order {
            export(&bench, "opv2v", &name, &["--scenes", &scene.to_string()]).1.expect_done();
        }
        assert!(digests(&bench.folder.path().join(name)) == bytes, "scene {} first", order[0]);
    }
}
