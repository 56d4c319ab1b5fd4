//! Seconds per agent-frame, part by part, beside the budgets of the design: the full default sensor suite on
//! our own town; and how fast road networks are. Run by `make bench`; numbers mean something on an idle
//! machine only.

mod features;
mod materials;
mod on_device;
mod roads;

use device::{Choice, Device, DeviceRenderer};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use codecs::{DEFAULT_LEVEL, Scalar, encode_member};
use features::{Feature, VARIANTS};
use frames::{Agent, Pose, World};
use labels::annotation::boxes::{ObservedObject, Observer};
use labels::bev::{Areas, BevRasterizer};
use labels::bev_map::Reach;
use labels::fill::Filler;
use labels::validity::{Evidence, PointCloud};
use labels::voxel_grid::VoxelGrid;
use labels::voxels::{CpuVoxelRenderer, GridPlacement};
use land::tiles::{Surroundings, TileMaker};
use materials::Material;
use on_device::OnDevice;
use opendrive::Map;
use plan::PlanMap;
use random::Stream;
use rayon::prelude::*;
use render::CameraView;
use render::{CameraQuery, Renderer, Scene, VoxelRenderer};
use runner::StageSettings;
use schema::geometry::Snapshot;
use schema::images::{Depth, Flow, Instance, Rgb, Semantic};
use schema::tables::{ActorRow, BoxRow};
use schema::{ActorRole, AgentId, BevClass, DetectionClass, ObjectId};
use sensors::{Camera, Image, Lidar, LidarMoment, RadarMotion, RadarQuery};
use settings::stages::{PlanSettings, SimulationSettings};
use settings::{DatasetSettings, LidarSpec};
use shading::{FrameWeather, Shot, Sight, StillWorld};
use traffic::{SceneInput, SimulationLog};
use world::{Light, Moment, OwnModels, SceneWorld};

const CONFIG: &str = "seed = 27\n[scenes.train]\n\"convoy/demo\" = 1\n[agents]\nmin_vehicles = 2\nmax_vehicles = 2\n\
                      min_rsus = 0\nmax_rsus = 0\n[timing]\nmin_duration_s = 4\nmax_duration_s = 4\n\
                      [traffic]\nvehicles = 400\n[walkers]\ncount = 480\n\
                      [weather.initial]\nsun_altitude_deg = 40\nfog_density = 0\nprecipitation = 0\n";

/// What something took.
#[derive(Clone, Copy, Default)]
struct Taken {
    wall_s: f64,
    /// Of all threads.
    cpu_s: f64,
}

/// Processor seconds of this program so far.
fn cpu_s() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// What the fastest of some runs took: the one least disturbed by other work.
fn best<T>(runs: u32, mut work: impl FnMut() -> T) -> Taken {
    (0..runs)
        .map(|_| {
            let (start, before_s) = (Instant::now(), cpu_s());
            black_box(work());
            Taken { wall_s: start.elapsed().as_secs_f64(), cpu_s: cpu_s() - before_s }
        })
        .min_by(|a, b| a.wall_s.total_cmp(&b.wall_s))
        .unwrap_or_default()
}

struct Row {
    part: String,
    taken: Taken,
    budget_s: f64,
}

fn main() {
    let settings = settings::parse(CONFIG, "bench").expect("the configuration is valid");
    let network = town::generate(&town::named("convoy/demo").expect("is named")).expect("is generated");
    let map = Map::new(network);
    let mut maps = BTreeMap::from([("convoy/demo".to_owned(), PlanMap { map, hash: String::new() })]);
    let plan = plan::plan(&PlanSettings::of(&settings), &maps).expect("is planned");
    let map = maps.remove("convoy/demo").expect("is there").map;
    let centres: Vec<[f64; 3]> = plan.agents.iter().map(|a| a.xyz_m).collect();
    let reach_m = SimulationSettings::of(&settings).reach_m;
    let maker = TileMaker::new(&map, &settings.world.scenery, catalogue::Catalogue::built_in());
    let Surroundings { actors: fixed, ground } = maker.around(&centres, reach_m, 1).expect("there are ids");

    let input = SceneInput {
        catalogue: catalogue::Catalogue::built_in(),
        map: &map,
        scene: &plan.scenes[0],
        agents: &plan.agents,
        hazards: &[],
        weather: &[],
        routes: &[],
        trajectories: &[],
        settings: &SimulationSettings::of(&settings),
        fixed: &fixed,
        first_id: fixed.last().map_or(1, |a| a.id + 1),
    };
    let mut rows = Vec::new();
    let log = simulation(&input, &mut rows);
    let mut actors = fixed.clone();
    actors.extend(log.actors.iter().cloned());
    let made = |light| {
        SceneWorld::with_models(&actors, ground.clone(), &OwnModels::new(), light).expect("has meshes")
    };
    let bare_start = best(3, || made(Light::Any));
    let start = best(3, || made(Light::AmbientOcclusion));
    let world = made(Light::AmbientOcclusion);
    let scene = Agentframe::new(&settings, &map, &actors, &log, &world);
    let (materials, on_device) = scene.measure(&mut rows);
    for (what, taken) in [("without", bare_start), ("with", start)] {
        let part = format!("a scene's models and meshes, {what} the sky's light on bodies (once a scene)");
        rows.push(Row { part, taken, budget_s: f64::NAN });
    }
    print(&rows, scene.triangles());
    if let Some(name) = scene.device.name() {
        on_device::print(&name, &on_device, &scene.renderer);
    }
    print_materials(&materials);
    print_features(&scene.features(&made(Light::Any)));
    let mut rows = Vec::new();
    roads::measure(&mut rows);
    print_roads(&rows);
}

/// Steps per second against real time, with all the traffic that fits.
fn simulation(input: &SceneInput<'_>, rows: &mut Vec<Row>) -> SimulationLog {
    let start = Instant::now();
    let mut first_step = None;
    let mut steps = 0;
    let log = traffic::simulate(input, &mut |done, _| {
        first_step.get_or_insert_with(Instant::now);
        steps = done;
        ControlFlow::Continue(())
    })
    .expect("is simulated");
    let from = first_step.unwrap_or(start);
    let per_step = from.elapsed().as_secs_f64() / f64::from(u32::try_from(steps).unwrap_or(1)).max(1.0);
    let (vehicles, walkers) = (log.n_vehicles, log.n_walkers);
    rows.push(Row {
        part: format!("simulation step, {vehicles} vehicles + {walkers} walkers, one core"),
        taken: Taken { wall_s: per_step, cpu_s: per_step },
        budget_s: schema::FRAME_PERIOD_S / 20.0,
    });
    log
}

/// What cameras took.
struct CameraTimes {
    raster: Taken,
    shade: Taken,
    encode: Taken,
    others: [(&'static str, Taken); 3],
    materials: Vec<Material>,
    on_device: Vec<OnDevice>,
}

struct Agentframe<'a> {
    settings: &'a DatasetSettings,
    map: &'a Map,
    actors: &'a [ActorRow],
    log: &'a SimulationLog,
    world: &'a SceneWorld,
    device: Device,
    renderer: DeviceRenderer,
    pose: Pose<World, Agent>,
    own: u16,
}

const FRAME: i32 = 40;

impl StillWorld for Agentframe<'_> {
    fn around(&self, centre_world_m: [f64; 3], nearer_m: f64, detail_m: f64) -> Snapshot {
        self.world.still(centre_world_m, 1000.0 - nearer_m, detail_m)
    }

    fn moves(&self, object: ObjectId) -> bool {
        self.world.moves(object)
    }
}

impl<'a> Agentframe<'a> {
    fn new(
        settings: &'a DatasetSettings,
        map: &'a Map,
        actors: &'a [ActorRow],
        log: &'a SimulationLog,
        world: &'a SceneWorld,
    ) -> Self {
        let own = log
            .actors
            .iter()
            .find(|a| a.role == ActorRole::Agent(AgentId::vehicle(0)))
            .expect("is simulated")
            .id;
        let state = log.states.iter().find(|s| s.frame == FRAME && s.id == own).expect("has a state");
        let pose = Pose::from_xyz_wxyz(state.xyz_m, state.quaternion);
        let name = std::env::var("CONVOY_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
        let device = Device::open(&Choice::from(&*name), None).expect("is a device");
        let mut renderer = device.renderer();
        renderer.prepare(&world.meshes()).expect("has no device");
        Self { settings, map, actors, log, world, device, renderer, pose, own }
    }

    fn snapshot(&self, radius_m: f64) -> Snapshot {
        let states = |frame| {
            let first = self.log.states.partition_point(|s| s.frame < frame);
            let last = self.log.states.partition_point(|s| s.frame <= frame);
            &self.log.states[first..last]
        };
        let first = self.log.signals.partition_point(|s| s.frame < FRAME);
        let last = self.log.signals.partition_point(|s| s.frame <= FRAME);
        let moment = Moment {
            states: states(FRAME),
            previous: states(FRAME - 1),
            signals: &self.log.signals[first..last],
            frame: &self.log.frames[FRAME as usize],
        };
        self.world.snapshot(&moment, self.pose.xyz(), radius_m)
    }

    fn triangles(&self) -> usize {
        let snapshot = self.snapshot(1000.0);
        snapshot.instances.iter().map(|i| snapshot.mesh(i).triangles.len()).sum()
    }

    fn measure(&self, rows: &mut Vec<Row>) -> (Vec<Material>, Vec<OnDevice>) {
        let mut push =
            |part: &str, taken: Taken, budget_s: f64| rows.push(Row { part: part.into(), taken, budget_s });
        push(
            "snapshot and top-level tree",
            best(5, || {
                let snapshot = self.snapshot(1000.0);
                black_box(self.renderer.place(&snapshot).is_ok());
            }),
            0.01,
        );
        let snapshot = self.snapshot(1000.0);
        let scene = &*self.renderer.place(&snapshot).expect("all meshes are prepared");
        let cameras = self.cameras(scene);
        push("camera visibility, 6 cameras", cameras.raster, 0.35);
        push("shading, 6 cameras", cameras.shade, 0.15);
        push("image encoding, RGB + instance, 6 cameras", cameras.encode, 0.07);
        let mut on_device = cameras.on_device;
        push("lidar 262,144 rays + 4 radars", self.ranging(scene, &mut on_device), 0.04);
        push("BEV", self.bev(), 0.002);
        let [voxels, fill, npz] = self.occupancy();
        push("voxels, exact overlap", voxels, 0.1);
        push("voxel fill", fill, 0.05);
        push("voxel npz, one grid (two are written)", npz, 0.09);
        push("boxes and post-processing", self.post_processing(scene), 0.005);
        // Not in the default suite.
        for (name, taken) in cameras.others {
            push(&format!("{name}, 6 cameras (not in the sum)"), taken, f64::NAN);
        }
        (cameras.materials, on_device)
    }

    fn cameras(&self, scene: &dyn Scene) -> CameraTimes {
        let rig = &self.settings.scenario.vehicle_rig;
        let weather = self.log.frames[FRAME as usize].weather();
        // Its sun turns by some degrees a frame: nothing of what it sees is kept.
        let when = FrameWeather { frame: FRAME as u32, time_s: 2.0, weather, is_steady: false };
        let origin = scene.snapshot().origin;
        let views: Vec<CameraView> = rig
            .cameras
            .iter()
            .map(|spec| {
                Camera::new(spec, &rig.camera).expect("is a camera").view(&origin, &self.pose, &self.pose)
            })
            .collect();
        let pinholes: Vec<_> = views.iter().map(|view| CameraQuery::of(view.pinhole())).collect();
        let mut on_device = Vec::new();
        let raster = best(3, || scene.render(&pinholes));
        on_device::note(&mut on_device, "visibility, 6 cameras", &self.renderer, || scene.render(&pinholes));
        let seen = scene.render(&pinholes).expect("has no device");
        let shots: Vec<Shot<'_>> = views.iter().zip(&seen).map(|(view, seen)| Shot { view, seen }).collect();
        // The painter keeps the sky of a frame, and what the sun sees of all that stands still, which frames
        // and agents share.
        let painter = self.renderer.painter(Some(self));
        let place = origin.local_from_world(self.pose.xyz());
        let paint = || painter.paint(scene, &when, place, &shots).expect("has no device");
        paint();
        let shade = best(3, paint);
        on_device::note(&mut on_device, "shading's lights and panes, 6 cameras", &self.renderer, paint);
        let materials = materials::shares(scene.snapshot(), &views, &seen, |seen| {
            let shots: Vec<Shot<'_>> =
                views.iter().zip(seen).map(|(view, seen)| Shot { view, seen }).collect();
            black_box(painter.paint(scene, &when, place, &shots).is_ok());
        });
        let sights: Vec<Sight> = views
            .iter()
            .zip(&seen)
            .zip(paint())
            .map(|((view, seen), p)| Sight { view: view.clone(), seen: seen.clone(), picture: Some(p) })
            .collect();
        let snapshot = scene.snapshot();
        let encode = best(3, || {
            let images = sights.par_iter().map(|sight| {
                let counts = sensors::pixel_counts(snapshot, &sight.seen);
                (Rgb::of(snapshot, sight, 0).is_ok(), Instance::of(snapshot, sight, 0).is_ok(), counts)
            });
            images.collect::<Vec<_>>()
        });
        let each = |image: fn(&Snapshot, &Sight) -> bool| {
            best(3, || sights.par_iter().map(|sight| image(snapshot, sight)).collect::<Vec<_>>())
        };
        let others = [
            ("semantic images", each(|snapshot, sight| Semantic::of(snapshot, sight, 0).is_ok())),
            ("depth images", each(|snapshot, sight| Depth::of(snapshot, sight, 0).is_ok())),
            ("flow images", each(|snapshot, sight| Flow::of(snapshot, sight, 0).is_ok())),
        ];
        CameraTimes { raster, shade, encode, others, materials, on_device }
    }

    /// Shading with one feature of pictures after the other switched on or off; `bare` is the same world
    /// without the sky's light on bodies.
    fn features(&self, bare: &SceneWorld) -> Vec<Feature> {
        let rig = &self.settings.scenario.vehicle_rig;
        let before = self.log.states.iter().find(|s| s.frame == FRAME - 1 && s.id == self.own);
        let before = before.map_or(self.pose, |s| Pose::from_xyz_wxyz(s.xyz_m, s.quaternion));
        let painter = self.renderer.painter(Some(self));
        let mut features = Vec::new();
        for variant in &VARIANTS {
            let mut snapshot = self.snapshot(1000.0);
            if !variant.cabins {
                snapshot.cabins.clear();
            }
            if !variant.with_ambient_occlusion {
                snapshot.meshes = bare.meshes();
            }
            let scene = &*self.renderer.place(&snapshot).expect("all meshes are prepared");
            let origin = scene.snapshot().origin;
            let mut camera = rig.camera.clone();
            (variant.camera)(&mut camera);
            let views: Vec<CameraView> = rig
                .cameras
                .iter()
                .map(|spec| {
                    Camera::new(spec, &camera).expect("is a camera").view(&origin, &self.pose, &before)
                })
                .collect();
            let pinholes: Vec<_> = views.iter().map(|view| CameraQuery::of(view.pinhole())).collect();
            let seen = scene.render(&pinholes).expect("has no device");
            let shots: Vec<Shot<'_>> =
                views.iter().zip(&seen).map(|(view, seen)| Shot { view, seen }).collect();
            let mut weather = self.log.frames[FRAME as usize].weather();
            (variant.weather)(&mut weather);
            let is_steady = variant.is_steady;
            let when = FrameWeather { frame: FRAME as u32, time_s: 2.0, weather, is_steady };
            let place = origin.local_from_world(self.pose.xyz());
            let paint = || painter.paint(scene, &when, place, &shots).expect("has no device");
            paint();
            features.push(Feature { name: variant.name, taken: best(5, paint) });
        }
        features
    }

    fn ranging(&self, scene: &dyn Scene, on_device: &mut Vec<OnDevice>) -> Taken {
        let rig = &self.settings.scenario.vehicle_rig;
        let origin = scene.snapshot().origin;
        let lidar = Lidar::new(&rig.lidars[0]).expect("is a lidar");
        let stream = Stream::new(1, 2, "bench", 3);
        let range = || {
            let spec: &LidarSpec = lidar.spec();
            let at = origin.local_from_body(&(self.pose * spec.mount.agent_from_sensor()));
            black_box(lidar.sweep(scene, &LidarMoment::standing(0, at), &stream).is_ok());
            let radars = rig.radars.iter().map(|spec| {
                let at = origin.local_from_body(&(self.pose * spec.mount.agent_from_sensor()));
                let own = Some(self.own);
                let motion = RadarMotion { local_from_sensor: at, previous_local_from_sensor: at, own };
                RadarQuery { spec, motion, stream: &stream }
            });
            black_box(sensors::radars(scene, &radars.collect::<Vec<_>>(), 0).is_ok());
        };
        on_device::note(on_device, "lidar and radars", &self.renderer, range);
        best(3, range)
    }

    fn bev(&self) -> Taken {
        let settings = &self.settings.bev;
        let snapshot = self.snapshot(settings.half_extent_m() * 1.5);
        let crosswalks: Vec<_> = self.map.crosswalks().iter().map(|c| c.polygon.clone()).collect();
        let mut reach = Reach::default();
        reach.add([self.pose.xyz()].into_iter(), settings.half_extent_m() * 1.5);
        let road_lines = labels::bev_map::road_lines(self.map, &reach);
        let areas = Areas { crosswalks: &crosswalks, hazards: &[], road_lines: &road_lines };
        let mut rasterizer = BevRasterizer::new(settings).expect("is a grid");
        let mask = rasterizer.rasterize(&snapshot, &self.pose, areas);
        assert!(mask.counts()[BevClass::Road as usize] > 0, "there is road around a vehicle");
        best(10, || rasterizer.rasterize(&snapshot, &self.pose, areas))
    }

    fn occupancy(&self) -> [Taken; 3] {
        let settings = &self.settings.scenario.vehicle_occupancy;
        let snapshot = self.snapshot(settings.range_m * 1.5);
        let placement = GridPlacement::new(settings).expect("is a grid");
        let mut cpu = CpuVoxelRenderer::default();
        cpu.prepare(&snapshot.meshes).expect("has no device");
        let mut grid = VoxelGrid::default();
        let voxelize = |grid: &mut VoxelGrid| {
            placement.voxelize(&cpu, &snapshot, &self.pose, None, grid).expect("has no device");
        };
        voxelize(&mut grid);
        let voxels = best(3, || voxelize(&mut grid));
        let mut filler = Filler::default();
        let mut work = grid.clone();
        filler.fill(&mut work, settings.voxel_m, settings.fill_rule).expect("is filled");
        let runs = (0..3).map(|_| {
            work.data.copy_from_slice(&grid.data);
            best(1, || filler.fill(&mut work, settings.voxel_m, settings.fill_rule))
        });
        let fill = runs.min_by(|a, b| a.wall_s.total_cmp(&b.wall_s)).unwrap_or_default();
        let npz = best(3, || encode_member("0000.npy", Scalar::U8, &grid.shape, &grid.data, DEFAULT_LEVEL));
        [voxels, fill, npz]
    }

    fn post_processing(&self, scene: &dyn Scene) -> Taken {
        let objects: Vec<ObservedObject<'_>> = self
            .actors
            .iter()
            .map(|actor| {
                let state = self.log.states.iter().find(|s| s.frame == FRAME && s.id == actor.id);
                let (xyz, q) = state.map_or((actor.xyz_m, actor.quaternion), |s| (s.xyz_m, s.quaternion));
                ObservedObject {
                    actor,
                    size_m: [actor.length_m, actor.width_m, actor.height_m],
                    world_from_object: Pose::from_xyz_wxyz(xyz, q),
                    velocity_mps: [0.0; 3],
                    angular_velocity_radps: [0.0; 3],
                    signal_state: None,
                    dormant: false,
                }
            })
            .collect();
        let observer = Observer { agent: AgentId::vehicle(0), id: self.own, world_from_agent: self.pose };
        let rig = &self.settings.scenario.vehicle_rig;
        let lidar = Lidar::new(&rig.lidars[0]).expect("is a lidar");
        let mount = lidar.spec().mount.agent_from_sensor();
        let at = scene.snapshot().origin.local_from_body(&(self.pose * mount));
        let stream = Stream::new(1, 2, "bench", 3);
        let sweep = lidar.sweep(scene, &LidarMoment::standing(0, at), &stream).expect("has no device");
        let cloud =
            PointCloud { world_from_sensor: self.pose * mount, x: &sweep.x_m, y: &sweep.y_m, z: &sweep.z_m };
        let pixels = BTreeMap::new();
        best(5, || {
            let boxes: Vec<BoxRow> = labels::annotation::boxes::collect(0, &[observer], &objects, 200.0);
            assert!(boxes.iter().any(|b| b.class == DetectionClass::Car.name()));
            let evidence =
                Evidence { lidars: &[cloud], radars: &[], num_pixels: &pixels, valid_by_image: false };
            labels::validity::validate(&boxes, &evidence)
        })
    }
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn print(rows: &[Row], triangles: usize) {
    println!("\nconvoy/demo, {triangles} triangles in sight, {} threads", rayon::current_num_threads());
    print_rows(rows);
    // The second voxel grid is encoded too; the simulation is shared by all agents of a scene, and what has
    // no budget is not of the suite.
    let npz = rows.iter().filter(|r| r.part.starts_with("voxel npz"));
    let all = rows.iter().skip(1).filter(|r| r.budget_s.is_finite()).chain(npz);
    let (wall_s, cpu_s) = all.fold((0.0, 0.0), |(w, c), r| (w + r.taken.wall_s, c + r.taken.cpu_s));
    println!("| **agent-frame, part after part** | {wall_s:.3} | {cpu_s:.3} | 1.0 | {wall_s:.2} |");
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn print_materials(materials: &[Material]) {
    println!("\nShading of six cameras by material, without lights and edges");
    println!("| material | pixels | of a span | seconds | ns of a core a pixel |\n|---|---|---|---|---|");
    for Material { name, pixels, spans, taken } in materials {
        let (of_span, ns) = (*pixels as f64 / *spans as f64, 1e9 * taken.cpu_s / *pixels as f64);
        println!("| {name} | {pixels} | {of_span:.1} | {:.4} | {ns:.1} |", taken.wall_s);
    }
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn print_features(features: &[Feature]) {
    println!("\nShading of six cameras with one change each");
    println!("| change | seconds | processor seconds | more than by default |\n|---|---|---|---|");
    let plain = features.first().map_or(0.0, |feature| feature.taken.cpu_s);
    for Feature { name, taken: Taken { wall_s, cpu_s } } in features {
        println!("| {name} | {wall_s:.4} | {cpu_s:.4} | {:+.4} |", cpu_s - plain);
    }
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn print_roads(rows: &[Row]) {
    println!("\nRoad networks, one core");
    print_rows(rows);
}

#[expect(clippy::print_stdout, reason = "this is the benchmark's answer")]
fn print_rows(rows: &[Row]) {
    println!("| part | seconds | processor seconds | budget | ratio |\n|---|---|---|---|---|");
    for Row { part, taken: Taken { wall_s, cpu_s }, budget_s } in rows {
        let beside = if budget_s.is_finite() {
            format!("{budget_s:.4} | {:.2}", wall_s / budget_s)
        } else {
            "| ".to_owned()
        };
        println!("| {part} | {wall_s:.4} | {cpu_s:.4} | {beside} |");
    }
}
