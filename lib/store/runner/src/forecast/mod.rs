//! What a plan will cost: frames exactly, bytes and hours by rates measured on whole datasets.

mod machine;
mod rates;

use std::collections::{BTreeMap, BTreeSet};

use indicatif::{DecimalBytes, HumanCount};
use schema::tables::{PlanAgentRow, PlanSceneRow};
use schema::{AgentId, AgentKind, ImageKind};
use settings::{BevSettings, DatasetSettings, Lens, Rig, Split};
use store::{Scope, kind_names};

use crate::editions::Editions;

pub use machine::Machine;

/// Bytes as stored, measured on four datasets of 240 agent-frames each (the demo town and three of CARLA's).
/// Busy places take more: good within a factor of two.
mod bytes {
    pub(super) const BEV_CELL: f64 = 0.08;
    /// Beside a mask, by its cells: heights of the ground, whose each cell is, paint.
    pub(super) const BEV_LAYER_CELL: [f64; 3] = [2.25, 0.008, 0.006];
    /// One grid, by column of voxels: what is stored is a surface.
    pub(super) const VOXEL_COLUMN: f64 = 0.75;
    /// The list of occupied voxels instead, whose they are, and how they move.
    pub(super) const LISTED_COLUMN: f64 = 5.8;
    pub(super) const ID_COLUMN: f64 = 0.19;
    pub(super) const FLOW_COLUMN: f64 = 0.23;
    /// What lidars saw of voxels, by ray: what is stored is where rays went.
    pub(super) const OBSERVED_RAY: f64 = 11.3;
    /// Boxes as collected and as valid, their share of tracks, log, map record, position and motion.
    pub(super) const AGENT_FRAME: f64 = 20e3;
}

/// Seconds of one core, from the table of docs/performance.md (two cores) and the demo dataset's stages: good
/// within a factor of two.
mod core_seconds {
    pub(super) const VISIBILITY_PX: f64 = 19e-9;
    /// The same of a lens that bends: a ray a pixel.
    pub(super) const BENT_PX: f64 = 200e-9;
    pub(super) const BEV_CELL: f64 = 20e-9;
    pub(super) const VOXEL: f64 = 0.9e-9;
    /// Reading a grid, filling it, writing it.
    pub(super) const FILLED_VOXEL: f64 = 0.7e-9;
    /// What is told of each occupied voxel (its place, whose it is, how it moves), by column of voxels.
    pub(super) const ROWS_COLUMN: f64 = 0.27e-6;
    /// What lidars saw of voxels, by ray.
    pub(super) const OBSERVED_RAY: f64 = 4e-6;
    /// Simulation and boxes of a frame.
    pub(super) const SIMULATED: f64 = 0.004;
    /// A frame's world for what looks at it: its triangles and the trees over them.
    pub(super) const WORLD: f64 = 0.015;
    /// Light and shadow maps of a frame in colour.
    pub(super) const LIGHT: f64 = 0.12;
    /// What is valid of a frame's boxes.
    pub(super) const JUDGED: f64 = 0.01;
    /// Tracks of a frame's boxes.
    pub(super) const TRACKED: f64 = 0.01;
}

/// Work of a stage, or of several.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Seconds of one core.
    pub core_s: f64,
    /// Bytes as stored.
    pub bytes: f64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.core_s += other.core_s;
        self.bytes += other.bytes;
    }
}

const SIMULATION: &str = "simulate-and-log";
const SENSORS: &str = "render-sensors";
const MASKS: &str = "bev-gt";
const VOXELS: &str = "occupancy-gt";
const VALIDITY: &str = "postprocess-valid";
const TRACKS: &str = "merge-tracks";

/// Amount and bytes of one kind of output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Share {
    count: u64,
    bytes: f64,
}

/// What is planned.
#[derive(Clone, Copy, Debug)]
pub struct Planned<'a> {
    /// The scenes.
    pub scenes: &'a [PlanSceneRow],
    /// Their agents.
    pub agents: &'a [PlanAgentRow],
}

/// What to expect.
#[derive(Clone, Debug, Default, PartialEq)]
struct Forecast {
    outputs: BTreeMap<&'static str, Share>,
    stages: BTreeMap<&'static str, Work>,
    agent_frames: [u64; 2],
}

impl Forecast {
    fn of(editions: &Editions, plan: &Planned<'_>) -> Self {
        let frames: BTreeMap<u32, u64> = plan.scenes.iter().map(|s| (s.scene, u64::from(s.frames))).collect();
        let mut forecast = Self::default();
        for agent in plan.agents {
            let Some(frames) = frames.get(&agent.scene) else { continue };
            forecast.add(editions.of(Scope::Scene(agent.scene)), agent.agent, *frames);
        }
        forecast
    }

    fn add(&mut self, settings: &DatasetSettings, agent: AgentId, frames: u64) {
        self.agent_frames[usize::from(agent.kind == AgentKind::Rsu)] += frames;
        let annotated = due(frames, settings.annotation.every_n_frames);
        self.output(SIMULATION, "boxes, log, tracks", annotated, bytes::AGENT_FRAME);
        self.work(SIMULATION, frames, core_seconds::SIMULATED);
        self.work(VALIDITY, annotated, core_seconds::JUDGED);
        self.work(TRACKS, annotated, core_seconds::TRACKED);
        let rigs = settings.scenario.rigs();
        let rig = rigs.of(agent);
        self.sensors(rig, frames);
        if settings.bev.enabled {
            let cells = f64::from(settings.bev.cells) * f64::from(settings.bev.cells);
            let masks = due(frames, settings.bev.every_n_frames);
            self.output(MASKS, "BEV masks", masks, cells * bytes::BEV_CELL);
            self.work(MASKS, masks, core_seconds::WORLD + cells * core_seconds::BEV_CELL);
            let BevSettings { heights, ids, paint, .. } = settings.bev;
            let layers = [("BEV heights", heights), ("BEV ids", ids), ("BEV paint", paint)];
            for ((name, _), bytes) in layers.iter().zip(bytes::BEV_LAYER_CELL).filter(|(layer, _)| layer.1) {
                self.output(MASKS, name, masks, cells * bytes);
            }
        }
        let grids = settings.scenario.occupancy();
        let occupancy = grids.of(agent);
        if occupancy.enabled {
            let [x, y, z] = occupancy.shape().map(|n| n as f64);
            let frames = due(frames, occupancy.every_n_frames);
            let grid = x * y * bytes::VOXEL_COLUMN;
            if occupancy.sparse {
                self.output(VOXELS, "listed voxels", frames, x * y * bytes::LISTED_COLUMN);
            } else {
                self.output(VOXELS, "voxel grids", frames, grid);
                self.output(VALIDITY, "voxel grids", frames, grid);
            }
            if occupancy.ids {
                self.output(VOXELS, "voxel ids", frames, x * y * bytes::ID_COLUMN);
            }
            if occupancy.flow {
                self.output(VOXELS, "voxel flow", frames, x * y * bytes::FLOW_COLUMN);
            }
            if occupancy.observed {
                let plain = rig.lidars.iter().filter(|lidar| !lidar.semantic);
                let rays: f64 = plain.map(|lidar| lidar.scan.rays() as f64).sum();
                self.output(VALIDITY, "observed voxels", frames, rays * bytes::OBSERVED_RAY);
                self.work(VALIDITY, frames, rays * core_seconds::OBSERVED_RAY);
            }
            if occupancy.sparse || occupancy.ids || occupancy.flow {
                self.work(VOXELS, frames, x * y * core_seconds::ROWS_COLUMN);
            }
            let voxels = x * y * z;
            self.work(VOXELS, frames, core_seconds::WORLD + voxels * core_seconds::VOXEL);
            if !occupancy.sparse {
                self.work(VALIDITY, frames, voxels * core_seconds::FILLED_VOXEL);
            }
        }
    }

    fn sensors(&mut self, rig: &Rig, frames: u64) {
        self.work(SENSORS, frames_looked_at(rig, frames), core_seconds::WORLD);
        self.cameras(rig, due(frames, rig.camera.every_n_frames));
        for cost in rates::reading_costs(rig) {
            let readings = due(frames, cost.every_n_frames);
            self.output(SENSORS, cost.output, readings, cost.bytes);
            self.work(SENSORS, readings, cost.core_s);
        }
    }

    fn cameras(&mut self, rig: &Rig, frames: u64) {
        let wanted = &rig.camera.images;
        if wanted.has(ImageKind::Rgb) && !rig.cameras.is_empty() {
            self.work(SENSORS, frames, core_seconds::LIGHT);
        }
        for optics in rig.cameras.iter().map(|camera| &camera.optics) {
            let pixels = f64::from(optics.width) * f64::from(optics.height);
            let mut per_pixel_s = match optics.lens {
                _ if wanted.is_empty() => 0.0,
                Lens::Pinhole => core_seconds::VISIBILITY_PX,
                _ => core_seconds::BENT_PX,
            };
            for kind in wanted.iter() {
                let cost = rates::pixel_cost(kind);
                let is_half = kind == ImageKind::Flow && rig.camera.flow_half;
                let bytes = if is_half { rates::HALF_FLOW_PX } else { cost.bytes };
                self.output(SENSORS, kind.spec().plural, frames, pixels * bytes);
                per_pixel_s += cost.core_s;
            }
            self.work(SENSORS, frames, pixels * per_pixel_s);
        }
    }

    fn output(&mut self, stage: &'static str, name: &'static str, count: u64, bytes_each: f64) {
        let share = self.outputs.entry(name).or_default();
        share.count += count;
        share.bytes += count as f64 * bytes_each;
        self.stages.entry(stage).or_default().bytes += count as f64 * bytes_each;
    }

    fn work(&mut self, stage: &'static str, count: u64, core_s_each: f64) {
        self.stages.entry(stage).or_default().core_s += count as f64 * core_s_each;
    }

    fn core_s(&self) -> f64 {
        self.stages.values().map(|work| work.core_s).sum()
    }
}

/// How many scenes each edition and group has, where there are several.
fn kinds(editions: &Editions, plan: &Planned<'_>) -> Vec<String> {
    let kinds = plan.scenes.iter().map(|scene| (scene.scene, editions.kind_of(scene.scene)));
    let names = kind_names(&kinds.collect());
    let mut counts: BTreeMap<&str, (usize, u64)> = BTreeMap::new();
    for scene in plan.scenes {
        let Some(name) = names.get(&scene.scene) else { continue };
        let (scenes, frames) = counts.entry(name).or_default();
        (*scenes, *frames) = (*scenes + 1, *frames + u64::from(scene.frames));
    }
    let line = |(name, (scenes, frames)): (&str, (usize, u64))| {
        format!("  {name}: {scenes} scenes, {} frames", HumanCount(frames))
    };
    counts.into_iter().map(line).collect()
}

/// The work of each stage on an agent's frames, by the stage's name.
#[must_use]
pub fn work_by_stage(
    settings: &DatasetSettings,
    agent: AgentId,
    frames: u32,
) -> BTreeMap<&'static str, Work> {
    let mut forecast = Forecast::default();
    forecast.add(settings, agent, frames.into());
    forecast.stages
}

/// The work of rendering an agent's frames with some sensors.
#[must_use]
pub fn work_of_sensors(rig: &Rig, frames: u32) -> Work {
    let mut forecast = Forecast::default();
    forecast.sensors(rig, frames.into());
    forecast.stages.remove(SENSORS).unwrap_or_default()
}

/// At how many of some frames a sensor of a rig looks at the world.
fn frames_looked_at(rig: &Rig, frames: u64) -> u64 {
    let has_images = !rig.cameras.is_empty() && !rig.camera.images.is_empty();
    let cameras = has_images.then_some(rig.camera.every_n_frames);
    let rates: BTreeSet<u64> = rates::reading_costs(rig)
        .map(|cost| cost.every_n_frames)
        .chain(cameras)
        .map(|every| u64::from(every.max(1)))
        .collect();
    (0..frames).filter(|frame| rates.iter().any(|every| frame.is_multiple_of(*every))).count() as u64
}

/// How many of some frames something is made at.
fn due(frames: u64, every_n_frames: u32) -> u64 {
    frames.div_ceil(u64::from(every_n_frames.max(1)))
}

fn size(bytes: f64) -> DecimalBytes {
    DecimalBytes(bytes.round() as u64)
}

/// What to expect of a plan on a machine, line by line.
#[must_use]
pub fn lines(editions: &Editions, plan: &Planned<'_>, machine: Machine) -> Vec<String> {
    let forecast = Forecast::of(editions, plan);
    let maps = plan.scenes.iter().map(|s| &s.map).collect::<BTreeSet<_>>().len();
    let of_split = |split: Split| {
        let count = plan.scenes.iter().filter(|s| s.split == split.name()).count();
        format!("{count} {}", split.name())
    };
    let frames: u64 = plan.scenes.iter().map(|s| u64::from(s.frames)).sum();
    let seconds: f64 = plan.scenes.iter().map(|s| s.duration_s).sum();
    let [vehicles, rsus] = forecast.agent_frames;
    let mut lines = vec![
        format!(
            "{} scenes ({}) on {maps} maps, {} s, {} frames",
            plan.scenes.len(),
            Split::ALL.map(of_split).join(", "),
            HumanCount(seconds.round() as u64),
            HumanCount(frames)
        ),
        format!(
            "{} agent-frames: {} of vehicles, {} of RSUs",
            HumanCount(vehicles + rsus),
            HumanCount(vehicles),
            HumanCount(rsus)
        ),
    ];
    lines.extend(kinds(editions, plan));
    let total: f64 = forecast.outputs.values().map(|share| share.bytes).sum();
    for (name, share) in &forecast.outputs {
        // No `comfy-table`: the names are known, so one format string does what three crates would.
        let (count, size) = (HumanCount(share.count).to_string(), size(share.bytes).to_string());
        lines.push(format!("  {name:<22} {count:>13} {size:>10}"));
    }
    let (core_s, cores) = (forecast.core_s() * machine.times, machine.cores.max(1));
    let ((all, unit), (shared, shared_unit)) = (span(core_s), span(core_s / cores as f64));
    lines.push(format!("about {} on disk", size(total)));
    lines.push(format!(
        "about {all} core-{unit}: {shared} {shared_unit} on {cores} cores of this machine, without a GPU"
    ));
    lines
}

/// Seconds as an amount of a fitting unit.
#[must_use]
pub fn span(seconds: f64) -> (String, &'static str) {
    match seconds {
        s if s < 90.0 => (format!("{s:.0}"), "s"),
        s if s < 5400.0 => (format!("{:.0}", s / 60.0), "minutes"),
        s => (format!("{:.1}", s / 3600.0), "hours"),
    }
}

#[cfg(test)]
mod tests {
    use settings::SceneCount;

    use super::*;
    use crate::graph::{Graph, UnitKind};

    /// Rows of scenes and of their agents.
    #[derive(Clone)]
    struct Plan {
        scenes: Vec<PlanSceneRow>,
        agents: Vec<PlanAgentRow>,
    }

    impl Plan {
        fn rows(&self) -> Planned<'_> {
            Planned { scenes: &self.scenes, agents: &self.agents }
        }
    }

    fn plan() -> Plan {
        let scene = |scene, frames: u32, split: &str| PlanSceneRow {
            scene,
            frames,
            split: split.into(),
            duration_s: f64::from(frames) / 20.0,
            ..PlanSceneRow::default()
        };
        let agent = |scene, agent: AgentId| PlanAgentRow { scene, agent, ..PlanAgentRow::default() };
        Plan {
            scenes: vec![scene(0, 200, "train"), scene(3, 400, "test")],
            agents: vec![
                agent(0, AgentId::vehicle(0)),
                agent(0, AgentId::vehicle(1)),
                agent(3, AgentId::vehicle(0)),
                agent(3, AgentId::rsu(0)),
            ],
        }
    }

    fn settings() -> DatasetSettings {
        DatasetSettings::with_scenes(Vec::<SceneCount>::new())
    }

    #[test]
    fn every_stage_of_scenes_costs_something() {
        let agent = AgentId::vehicle(0);
        let forecast = work_by_stage(&settings(), agent, 200);
        for stage in Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene) {
            assert!(forecast.contains_key(stage.name), "say what {} costs", stage.name);
        }
    }

    #[test]
    fn frames_and_images_are_exact() {
        let forecast = Forecast::of(&Editions::only(&settings()), &plan().rows());
        assert_eq!(forecast.agent_frames, [800, 400]);
        let count = |name| forecast.outputs.get(name).map_or(0, |share: &Share| share.count);
        // Six cameras a vehicle, three an RSU; four radars and one.
        assert_eq!([count("RGB images"), count("instance images"), count("depth images")], [6000, 6000, 0]);
        assert_eq!(
            [count("lidar sweeps"), count("radar readings"), count("voxel grids")],
            [1200, 3600, 2400]
        );
    }

    #[test]
    fn what_is_made_seldom_costs_little() {
        let mut less = settings();
        // Of 200 frames 20 and 67; of 400 frames 40 and 134.
        less.annotation.every_n_frames = 10;
        less.bev.every_n_frames = 10;
        less.scenario.vehicle_rig.camera.every_n_frames = 10;
        less.scenario.vehicle_rig.lidars[0].every_n_frames = 3;
        less.scenario.rsu_occupancy.every_n_frames = 3;
        let (all, some) = (
            Forecast::of(&Editions::only(&settings()), &plan().rows()),
            Forecast::of(&Editions::only(&less), &plan().rows()),
        );
        let count = |name| some.outputs.get(name).map_or(0, |share: &Share| share.count);
        assert_eq!([count("boxes, log, tracks"), count("BEV masks")], [20 + 20 + 40 + 40; 2]);
        assert_eq!(count("RGB images"), 6 * (20 + 20 + 40) + 3 * 400);
        assert_eq!(count("lidar sweeps"), 67 + 67 + 134 + 400);
        assert_eq!(count("voxel grids"), 2 * (800 + 134));
        assert_eq!(some.agent_frames, all.agent_frames);
        assert!(some.core_s() < all.core_s());
    }

    #[test]
    fn what_is_switched_off_costs_nothing() {
        let mut less = settings();
        less.bev.enabled = false;
        less.scenario.vehicle_occupancy.enabled = false;
        less.scenario.rsu_rig.lidars.clear();
        less.scenario.vehicle_rig.camera.images.set(ImageKind::Rgb, false);
        let (all, some) = (
            Forecast::of(&Editions::only(&settings()), &plan().rows()),
            Forecast::of(&Editions::only(&less), &plan().rows()),
        );
        let count = |name| some.outputs.get(name).map_or(0, |share: &Share| share.count);
        assert_eq!([count("BEV masks"), count("voxel grids"), count("lidar sweeps")], [0, 800, 800]);
        assert_eq!([count("RGB images"), count("instance images")], [1200, 6000]);
        assert!(some.core_s() < all.core_s());
    }

    /// Core-seconds of one frame of a default vehicle, with nothing but what `keep` puts back.
    fn core_s(keep: impl Fn(&mut DatasetSettings)) -> f64 {
        let mut settings = settings();
        settings.scenario.vehicle_rig.cameras.clear();
        settings.scenario.vehicle_rig.lidars.clear();
        settings.scenario.vehicle_rig.radars.clear();
        settings.bev.enabled = false;
        settings.scenario.vehicle_occupancy.enabled = false;
        keep(&mut settings);
        let mut one = plan();
        one.agents.truncate(1);
        Forecast::of(&Editions::only(&settings), &one.rows()).core_s() / 200.0
    }

    /// Core-seconds of a row of the table of docs/performance.md.
    fn measured_s(row: &str) -> f64 {
        let table = include_str!("../../../../../docs/performance.md");
        let cells = table.lines().find_map(|line| line.strip_prefix(&format!("| {row} | ")));
        let seconds = cells.and_then(|cells| cells.split(" | ").nth(1)?.parse().ok());
        seconds.unwrap_or_else(|| panic!("docs/performance.md has no row `{row}`"))
    }

    #[test]
    fn rates_are_those_that_were_measured() {
        let rig = settings().scenario.vehicle_rig;
        let nothing = core_s(|_| {});
        let cameras = |rgb, instance| {
            core_s(|s| {
                s.scenario.vehicle_rig.cameras = rig.cameras.clone();
                s.scenario.vehicle_rig.camera.images.set(ImageKind::Rgb, rgb);
                s.scenario.vehicle_rig.camera.images.set(ImageKind::Instance, instance);
            })
        };
        assert_eq!(cameras(false, false), nothing, "cameras without images");
        let rays = core_s(|s| {
            (s.scenario.vehicle_rig.lidars, s.scenario.vehicle_rig.radars) =
                (rig.lidars.clone(), rig.radars.clone());
        });
        let pictures =
            measured_s("shading, 6 cameras") + measured_s("image encoding, RGB + instance, 6 cameras");
        let visibility = measured_s("camera visibility, 6 cameras");
        let voxels = 2.0 * measured_s("voxel npz, one grid (two are written)")
            + measured_s("voxels, exact overlap")
            + measured_s("voxel fill");
        let (world, light) = (core_seconds::WORLD, core_seconds::LIGHT);
        let parts = [
            ("cameras", cameras(true, true) - nothing - world - light, visibility + pictures),
            ("pictures", cameras(true, true) - cameras(false, true) - light, pictures),
            ("camera visibility", cameras(false, true) - nothing - world, visibility),
            ("lidar and radars", rays - nothing - world, measured_s("lidar 262,144 rays + 4 radars")),
            ("BEV", core_s(|s| s.bev.enabled = true) - nothing - world, measured_s("BEV")),
            ("voxels", core_s(|s| s.scenario.vehicle_occupancy.enabled = true) - nothing - world, voxels),
        ];
        for (part, expected, measured) in parts {
            let ratio = expected / measured;
            assert!(
                (0.8..1.25).contains(&ratio),
                "{part}: {expected:.4} core-seconds, measured {measured:.4}"
            );
        }
    }

    /// Measured: the demo's two scenes of 40 frames, 2 vehicles and an RSU each, are 1.57 GB.
    #[test]
    fn the_demo_is_as_large_as_it_is() {
        let demo = settings::parse(include_str!("../../../../../configs/demo.toml"), "demo.toml");
        let agents = [0, 1].iter().flat_map(|&scene| {
            let row = move |agent: AgentId| PlanAgentRow { scene, agent, ..PlanAgentRow::default() };
            [AgentId::vehicle(0), AgentId::vehicle(1), AgentId::rsu(0)].map(row)
        });
        let scene = |scene| PlanSceneRow { scene, frames: 40, ..PlanSceneRow::default() };
        let plan = Plan { scenes: vec![scene(0), scene(1)], agents: agents.collect() };
        let forecast = Forecast::of(&Editions::only(&demo.expect("is valid")), &plan.rows());
        let bytes: f64 = forecast.outputs.values().map(|share| share.bytes).sum();
        assert!((0.9..1.1).contains(&(bytes / 1.57e9)), "{bytes}");
    }

    /// Bytes of one file of each kind at a frame, measured: the tiny dataset (160 x 90 pixels, 16 x 256 rays,
    /// voxels of 0.5 m; mean of seven maps), and one of the default's rays and grids with 640 x 360 pixels
    /// (mean of two).
    #[test]
    fn options_are_as_large_as_they_are() {
        let measured: [&[(&str, f64)]; 2] = [
            &[
                ("listed voxels", 296_670.0),
                ("voxel ids", 12_012.0),
                ("voxel flow", 14_465.0),
                ("observed voxels", 38_432.0),
                ("BEV heights", 347_783.0),
                ("BEV ids", 1_122.0),
                ("BEV paint", 850.0),
            ],
            &[
                ("listed voxels", 12_047_000.0),
                ("voxel ids", 236_800.0),
                ("voxel flow", 367_400.0),
                ("observed voxels", 3_529_800.0),
                ("BEV heights", 371_100.0),
                ("BEV ids", 1_418.0),
                ("BEV paint", 946.0),
            ],
        ];
        for (is_tiny, rows) in [true, false].into_iter().zip(measured) {
            let mut settings = settings();
            let grid = &mut settings.scenario.vehicle_occupancy;
            (grid.sparse, grid.ids, grid.flow, grid.observed) = (true, true, true, true);
            (settings.bev.ids, settings.bev.heights, settings.bev.paint) = (true, true, true);
            if is_tiny {
                grid.voxel_m = 0.5;
                let scan = &mut settings.scenario.vehicle_rig.lidars[0].scan;
                (scan.channels, scan.columns) = (16, 256);
            }
            let mut one = plan();
            one.agents.truncate(1);
            let forecast = Forecast::of(&Editions::only(&settings), &one.rows());
            for (name, bytes) in rows {
                let Share { count, bytes: sum } = forecast.outputs[name];
                let ratio = sum / count as f64 / bytes;
                assert!((0.67..1.5).contains(&ratio), "{name}: {ratio}");
            }
            assert!(!forecast.outputs.contains_key("voxel grids"), "they are listed");
        }
    }

    #[test]
    fn lines_are_for_people() {
        insta::assert_snapshot!(lines(&Editions::only(&settings()), &plan().rows(), Machine { cores: 4, times: 1.0 }).join("\n"), @"
        2 scenes (1 train, 0 val, 1 test) on 1 maps, 30 s, 600 frames
        1,200 agent-frames: 800 of vehicles, 400 of RSUs
          BEV masks                      1,200   15.36 MB
          RGB images                     6,000    1.12 GB
          boxes, log, tracks             1,200   24.00 MB
          instance images                6,000  604.80 MB
          lidar sweeps                   1,200    2.41 GB
          radar readings                 3,600  150.14 MB
          voxel grids                    2,400    2.95 GB
        about 7.28 GB on disk
        about 19 core-minutes: 5 minutes on 4 cores of this machine, without a GPU
        ");
    }
}
