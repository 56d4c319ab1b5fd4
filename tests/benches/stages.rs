//! Whole stages as users run them: seconds and processor seconds an agent-frame with writing, and memory at
//! its peak.
//!
//! Run by `make bench` on the release build: the programs themselves make scenes of a second with the full
//! default suite on two threads. Numbers mean something on an idle machine only.

use std::path::PathBuf;

use convoy_tests::measured::run;
use runner::{Graph, UnitKind};

/// Frames of a scene of one second.
const FRAMES: f64 = 20.0;

/// A scene of a second by day or night.
struct Kind {
    name: &'static str,
    map: &'static str,
    agents: u32,
    vehicles: u32,
    walkers: u32,
    sun_altitude_deg: f64,
}

const KINDS: [Kind; 4] = [
    Kind { name: "day", map: "convoy/demo", agents: 2, vehicles: 400, walkers: 480, sun_altitude_deg: 40.0 },
    Kind {
        name: "night",
        map: "convoy/demo",
        agents: 2,
        vehicles: 400,
        walkers: 480,
        sun_altitude_deg: -30.0,
    },
    Kind { name: "day", map: "convoy/08", agents: 8, vehicles: 200, walkers: 150, sun_altitude_deg: 40.0 },
    Kind { name: "day", map: "Town10HD", agents: 2, vehicles: 200, walkers: 150, sun_altitude_deg: 40.0 },
];

impl Kind {
    fn config(&self) -> String {
        let Self { map, agents, vehicles, walkers, sun_altitude_deg, .. } = self;
        let weather = format!("sun_altitude_deg = {sun_altitude_deg}\nfog_density = 0\nprecipitation = 0\n");
        format!(
            "seed = 27\n[scenes.train]\n\"{map}\" = 1\n[agents]\nmin_vehicles = {agents}\nmax_vehicles = {agents}\n\
             min_rsus = 0\nmax_rsus = 0\n[timing]\nmin_duration_s = 1\nmax_duration_s = 1\n[traffic]\n\
             vehicles = {vehicles}\n[walkers]\ncount = {walkers}\n[weather.initial]\n{weather}[weather.final]\n{weather}"
        )
    }
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn main() {
    let maps: PathBuf = convoy_tests::workspace().join("../shared/maps/carla");
    println!("\nWhole stages, an agent-frame of the full default suite, written, two threads");
    println!("| scene | stage | seconds | processor seconds | peak MB |\n|---|---|---|---|---|");
    for kind in &KINDS {
        let Kind { name, map, agents, .. } = kind;
        let scene = format!("{map}, {name}, {agents} agents");
        if !map.contains('/') && !maps.is_dir() {
            println!("| {scene} | skipped: there is no {} | | | |", maps.display());
            continue;
        }
        let folder = tempfile::tempdir().expect("there is room");
        let (config, store) = (folder.path().join("bench.toml"), folder.path().join("store"));
        std::fs::write(&config, kind.config()).expect("there is room");
        let (config, store) = (config.display().to_string(), store.display().to_string());
        let maps = maps.display().to_string();
        let mut arguments = vec!["--config", &config, "--store", &store, "--threads", "2"];
        if !map.contains('/') {
            arguments.extend(["--maps", &maps]);
        }
        let _ = run("spawn-planner", &arguments);
        let (mut wall_s, mut cpu_s) = (0.0, 0.0);
        let frames = f64::from(*agents) * FRAMES;
        let of_scenes = Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene);
        for stage in of_scenes.map(|stage| stage.name) {
            let taken = run(stage, &arguments);
            let (wall, cpu) = (taken.wall_s / frames, taken.core_s / frames);
            println!("| {scene} | {stage} | {wall:.4} | {cpu:.4} | {:.0} |", taken.peak_mb);
            // The simulation is shared by all agents of a scene.
            if stage != "simulate-and-log" {
                (wall_s, cpu_s) = (wall_s + wall, cpu_s + cpu);
            }
        }
        println!("| {scene} | **agent-frame, written** | **{wall_s:.3}** | {cpu_s:.3} | |");
    }
}
