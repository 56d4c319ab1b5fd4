//! What a store of thousands of scenes costs those who only ask about it: status, runs with nothing to do,
//! statistics, planning. Run by `make scale` on the release build.
//!
//! One small scene is made by the stages themselves; all others are copies of it: links to its shards, and
//! manifests of their own with digests that fit. Half as many scenes should take half the time.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use convoy_tests::measured::{Taken, run};
use runner::{Graph, UnitKind};
use store::{Manifest, Scope, Store, hash_bytes, keys};

/// Scenes, if the environment (`SCENES`) names no other number.
const SCENES: u32 = 10_000;

/// A scene of a second without pictures.
fn config(scenes: u32) -> String {
    format!(
        "name = \"scale\"\nseed = 3\n[scenes.train]\n\"convoy/demo\" = {scenes}\n[agents]\nmin_vehicles = 2\nmax_vehicles = 2\n\
         min_rsus = 1\nmax_rsus = 1\n[timing]\nmin_duration_s = 1\nmax_duration_s = 1\nwarmup_s = 1\n[traffic]\nvehicles = 6\n\
         [walkers]\ncount = 3\n[vehicle.camera]\nenabled = false\n[rsu.camera]\nenabled = false\n[bev]\ncells = 40\n\
         [vehicle.occupancy]\nvoxel_m = 1.0\n[rsu.occupancy]\nvoxel_m = 1.0\n"
    )
}

/// Makes scene 0 of a store, and of it all others.
fn multiply(root: &Path, arguments: &[&str], scenes: u32) -> usize {
    let stages: Vec<&str> =
        Graph::get().stages.iter().filter(|s| s.unit == UnitKind::Scene).map(|s| s.name).collect();
    for stage in &stages {
        let _ = run(stage, &[arguments, &["--scenes", "0"]].concat());
    }
    let store = Store::open(root).expect("is a store");
    let planner = Graph::get().planner().name;
    let plan = store.manifest(Scope::Plan, planner).expect("reads").expect("is planned");
    let first: Vec<Manifest> = stages
        .iter()
        .map(|stage| store.manifest(Scope::Scene(0), stage).expect("reads").expect("is made"))
        .collect();
    let described = fs::read_to_string(root.join(keys::scene(0, "log/scene.json"))).expect("is text");
    for scene in 1..scenes {
        let mut digests: BTreeMap<String, String> = BTreeMap::new();
        let section = plan.sections.get(&format!("scene/{scene:04}")).expect("is planned");
        digests.insert(planner.to_owned(), section.clone());
        for manifest in &first {
            let mut manifest = manifest.clone();
            for output in &mut manifest.outputs {
                let from = root.join(&output.key);
                output.key = output.key.replacen("scenes/0000/", &format!("scenes/{scene:04}/"), 1);
                let to = root.join(&output.key);
                fs::create_dir_all(to.parent().expect("is in a folder")).expect("there is room");
                if output.key.ends_with("log/scene.json") {
                    let text = described.replacen("\"scene\": 0", &format!("\"scene\": {scene}"), 1);
                    (output.bytes, output.blake3) = (text.len() as u64, hash_bytes(text.as_bytes()));
                    fs::write(to, text).expect("there is room");
                } else {
                    fs::hard_link(from, to).expect("there is room");
                }
            }
            for (name, digest) in &mut manifest.inputs {
                if let Some(now) = digests.get(name) {
                    digest.clone_from(now);
                }
            }
            digests.insert(manifest.stage.clone(), manifest.digest());
            let to = root.join(Scope::Scene(scene).manifest(&manifest.stage));
            fs::create_dir_all(to.parent().expect("is in a folder")).expect("there is room");
            fs::write(to, serde_json::to_vec_pretty(&manifest).expect("is a record")).expect("there is room");
        }
    }
    first.iter().map(|manifest| manifest.outputs.len()).sum()
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn main() {
    let scenes = std::env::var("SCENES").ok().and_then(|text| text.parse().ok()).unwrap_or(SCENES);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("\nStores of many scenes, by programs of their own, {cores} cores");
    println!("| scenes | objects a scene | what | seconds | core seconds | peak MB | wanted |");
    println!("|---|---|---|---|---|---|---|");
    for scenes in [scenes / 2, scenes] {
        let folder = tempfile::tempdir().expect("there is room");
        let (file, store): (PathBuf, PathBuf) =
            (folder.path().join("scale.toml"), folder.path().join("store"));
        fs::write(&file, config(scenes)).expect("there is room");
        let (config, root) = (file.display().to_string(), store.display().to_string());
        let arguments = ["--config", &config, "--store", &root];
        let quiet = [&arguments[..], &["--progress", "none"]].concat();
        let planned = run("spawn-planner", &quiet);
        let objects = multiply(&store, &quiet, scenes);
        let tell = |what: &str, Taken { wall_s, core_s, peak_mb }: Taken, wanted: &str| {
            println!(
                "| {scenes} | {objects} | {what} | {wall_s:.1} | {core_s:.1} | {peak_mb:.0} | {wanted} |"
            );
        };
        tell("planning", planned, "15 s");
        tell("statistics", run("stats", &quiet), "180 s");
        tell("status", run("convoy", &[&["status"], &arguments[..]].concat()), "15 s, 500 MB");
        tell("run with nothing to do", run("convoy", &[&["run"], &quiet[..]].concat()), "60 s");
    }
}
