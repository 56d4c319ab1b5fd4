//! Whole stages as users run them: seconds and processor seconds an agent-frame with writing, and memory at
//! its peak.
//!
//! Run by `make bench` on the release build: the programs themselves make scenes of a second with the full
//! default suite on two threads. Numbers mean something on an idle machine only.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use runner::{Graph, UnitKind};

/// Clock ticks a second in `/proc` (fixed on Linux).
const TICKS: f64 = 100.0;
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

/// What a program took.
struct Taken {
    wall_s: f64,
    cpu_s: f64,
    peak_mb: f64,
}

/// Processor seconds of all programs that ended.
fn children_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name in brackets, which may hold anything: user and system time of children are the 14th and
    // 15th.
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(13) + ticks(14)) / TICKS
}

/// Most memory that a running program had so far, megabytes.
fn peak_mb(child: &Child) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| kib * 1024.0 / 1e6)
}

fn run(program: &Path, arguments: &[&str]) -> Taken {
    let (before_s, start) = (children_s(), Instant::now());
    let mut child = Command::new(program)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut most_mb: f64 = 0.0;
    let status = loop {
        most_mb = most_mb.max(peak_mb(&child).unwrap_or(0.0));
        if let Some(status) = child.try_wait().expect("the program is ours") {
            break status;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(status.success(), "{} failed", program.display());
    Taken { wall_s: start.elapsed().as_secs_f64(), cpu_s: children_s() - before_s, peak_mb: most_mb }
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
        run(&convoy_tests::program("spawn-planner"), &arguments);
        let (mut wall_s, mut cpu_s) = (0.0, 0.0);
        let frames = f64::from(*agents) * FRAMES;
        let of_scenes = Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene);
        for stage in of_scenes.map(|stage| stage.name) {
            let taken = run(&convoy_tests::program(stage), &arguments);
            let (wall, cpu) = (taken.wall_s / frames, taken.cpu_s / frames);
            println!("| {scene} | {stage} | {wall:.4} | {cpu:.4} | {:.0} |", taken.peak_mb);
            // The simulation is shared by all agents of a scene.
            if stage != "simulate-and-log" {
                (wall_s, cpu_s) = (wall_s + wall, cpu_s + cpu);
            }
        }
        println!("| {scene} | **agent-frame, written** | **{wall_s:.3}** | {cpu_s:.3} | |");
    }
}
