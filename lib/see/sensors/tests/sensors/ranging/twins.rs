//! Lidars that fire the same beams: what they make of rays that were followed once for all is what each makes
//! of its own.

use std::sync::atomic::{AtomicUsize, Ordering};

use frames::{Agent, Pose, World};
use nalgebra::Vector3;
use render::{CameraQuery, Hits, RayQuery, RenderError, Renderer, Scene, VisibilityBuffer};
use schema::geometry::{Instance, Snapshot, Surface};
use schema::table::{Column, Row};
use schema::tables::Weather;
use schema::{AgentId, ImageSet, ObjectId, Tag};
use sensors::{
    AgentState, Cameras, GeoOrigin, Lidar, LidarMoment, Motion, Observation, Radars, Sensor, SensorContext,
    SensorError, SensorPath, SensorVisitor, SharedBeams,
};
use settings::{BeamSpec, LidarSpec, Mount, Returned, Rig, RollingScan, ScanPattern, WeatherSpec};
use shading::FrameWeather;

use super::{small, stream};
use crate::common::{at, block, first_frame, instance, prepared, street};

/// The street, with a car-sized shell of glass that drives by and holds a seat.
fn glassy() -> Snapshot {
    let street = street(false);
    let mut meshes = street.meshes.to_vec();
    meshes.push(block([4.0, 2.0, 1.5], Tag::Car, Surface::Window));
    meshes.push(block([0.5, 0.5, 1.0], Tag::Car, Surface::Cloth));
    let shell = meshes.len() - 2;
    let placed = |mesh: usize| Instance {
        previous_local_from_object: at(4.0, -1.5, 0.0, 0.0),
        ..instance(mesh as u32, 77, at(5.0, -1.5, 0.0, 0.0))
    };
    let mut instances = street.instances.clone();
    instances.push(placed(shell));
    Snapshot { meshes: meshes.into(), instances, cabins: vec![placed(shell + 1)], ..street }
}

#[test]
fn sweeps_of_shared_rays_are_those_of_own_rays() {
    let world = glassy();
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let plain = small(LidarSpec::vehicle());
    let seven = BeamSpec {
        rays: 7,
        divergence_rad: 0.003,
        returned: Returned { first: true, strongest: true, last: true },
    };
    let rolling = Some(RollingScan { slices: 8, compensated: true });
    let specs = [
        plain.clone(),
        LidarSpec { rolling: rolling.clone(), ..plain.clone() },
        LidarSpec { beam: seven.clone(), weather: Some(WeatherSpec { detected: 0.1 }), ..plain.clone() },
        LidarSpec { glass: true, ..plain.clone() },
        LidarSpec { glass: true, beam: seven, rolling, ..plain },
    ];
    let here = at(0.0, -5.0, 1.8, 0.2);
    let path =
        SensorPath { previous_local_from_agent: at(-0.5, -5.0, 1.8, 0.15), ..SensorPath::standing(here) };
    let weather = Weather { precipitation: 60.0, fog_density: 20.0, wetness: 50.0, ..Weather::default() };
    let moment = LidarMoment { frame: 3, path, weather };
    for spec in specs {
        let semantic = Lidar::new(&spec.clone().semantic()).expect("is small");
        let noisy = Lidar::new(&spec).expect("is small");
        let scan = semantic.scan(scene, &moment).expect("has no device");
        for lidar in [&noisy, &semantic] {
            let own = lidar.sweep(scene, &moment, &stream()).expect("has no device");
            assert!(own.len() > 1000, "{}", own.len());
            assert!(lidar.sweep_of(&scan, scene, &moment, &stream()) == own, "{spec:?}");
        }
        assert!(noisy.sweep_of(&scan, scene, &moment, &stream()).len() < 8 * 32 * 256);
    }
}

/// A scene that counts questions about rays, and the rays that are followed at the frame's time.
struct Counting<'a> {
    scene: &'a dyn Scene,
    rays: AtomicUsize,
    questions: AtomicUsize,
}

impl<'a> Counting<'a> {
    fn of(scene: &'a dyn Scene) -> Self {
        Self { scene, rays: AtomicUsize::new(0), questions: AtomicUsize::new(0) }
    }
}

impl Scene for Counting<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.scene.snapshot()
    }

    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        self.scene.render(queries)
    }

    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        let now = queries.iter().filter(|query| query.before == 0.0 && !query.cabins);
        self.questions.fetch_add(1, Ordering::Relaxed);
        self.rays.fetch_add(now.map(|query| query.rays.directions.len()).sum(), Ordering::Relaxed);
        self.scene.trace(queries)
    }
}

/// What the due sensors of a rig read, as columns.
struct Readings<'a>(&'a Observation<'a>, Vec<Vec<Column>>);

impl SensorVisitor for Readings<'_> {
    type Error = SensorError;

    fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), SensorError> {
        if schema::rate::is_due(self.0.frame, sensor.table().every_n_frames) {
            self.1.push(S::Row::to_columns(&sensor.sense(self.0)?));
        }
        Ok(())
    }
}

/// An agent that stands in the street as an object.
fn standing(own: ObjectId) -> (SensorContext, AgentState) {
    let carrier =
        SensorContext { seed: 1, scene: 0, agent: AgentId::vehicle(0), geo_origin: GeoOrigin::default() };
    let motion = Motion {
        world_from_agent: Pose::<World, Agent>::from_xyz_rpy([0.0, -5.0, 0.0], [0.0; 3]),
        velocity_mps: Vector3::zeros(),
        angular_velocity_radps: Vector3::zeros(),
    };
    (carrier, AgentState { own, motion, previous: None })
}

#[test]
fn a_rolling_sweep_is_one_question() {
    let world = glassy();
    let renderer = prepared(&world);
    let scene = renderer.place(&world).expect("all meshes are prepared");
    let counting = Counting::of(&*scene);
    let rolling = Some(RollingScan { slices: 8, compensated: true });
    let lidar = Lidar::new(&LidarSpec { rolling, ..small(LidarSpec::vehicle()) }).expect("is small");
    let moment = LidarMoment::standing(3, at(0.0, -5.0, 1.8, 0.2));
    lidar.sweep(&counting, &moment, &stream()).expect("has no device");
    assert_eq!(counting.questions.load(Ordering::Relaxed), 1);
}

#[test]
fn radars_follow_their_rays_together_and_read_the_same() {
    let mut rig = Rig { cameras: Vec::new(), lidars: Vec::new(), ..Rig::vehicle() };
    rig.camera.images = ImageSet::NONE;
    rig.radars[0].every_n_frames = 2;
    let mut world = street(false);
    // A body around the radars, of several surfaces.
    let body = world.meshes.len() as u32;
    world.meshes = [&world.meshes[..], &[block([5.0, 2.0, 1.5], Tag::Car, Surface::Paint)]].concat().into();
    world.instances.push(instance(body, 900, at(0.0, -5.0, 0.0, 0.0)));
    let renderer = prepared(&world);
    let scene = renderer.place(&world).expect("all meshes are prepared");
    let (carrier, agent) = standing(900);
    let radars = Radars::for_tables(&rig, |name| carrier.stream(name), |_| true);
    for frame in [1, 2] {
        let counting = Counting::of(&*scene);
        let when = FrameWeather { frame, ..first_frame(&Weather::default()) };
        let cameras = Cameras::of(&rig).expect("has none");
        let read = |at: Result<Observation<'_>, SensorError>| {
            let at = at.expect("has no device");
            let mut readings = Readings(&at, Vec::new());
            sensors::visit_sensors(&rig, &carrier, &mut readings).expect("has no device");
            (readings.1, counting.questions.swap(0, Ordering::Relaxed))
        };
        let observed = || Observation::new(&counting, None, &cameras, &when, agent);
        let (alone, asked_alone) = read(observed());
        let (together, asked) = read(observed().and_then(|at| at.with_radars(&radars)));
        assert!(alone == together, "frame {frame}");
        // One question for all, and one for the rays that go on behind the body.
        assert!(asked == 2 && asked_alone > 4, "{asked} {asked_alone}");
    }
}

#[test]
fn rays_of_twins_are_followed_once_and_read_the_same() {
    let mut rig = Rig { cameras: Vec::new(), radars: Vec::new(), lidars: Vec::new(), ..Rig::vehicle() };
    rig.camera.images = ImageSet::NONE;
    let noisy = small(LidarSpec::vehicle());
    let low = Mount::upright([1.0, 0.0, 0.5], 0.0);
    rig.lidars = vec![
        noisy.clone(),
        LidarSpec { every_n_frames: 2, ..noisy.clone().semantic() },
        // Elsewhere, farther or finer: not the same beams.
        LidarSpec { name: "LOW".into(), mount: low, ..noisy.clone() },
        LidarSpec { name: "FAR".into(), range_m: 200.0, ..noisy.clone() },
        LidarSpec { name: "FINE".into(), scan: ScanPattern { columns: 300, ..noisy.scan.clone() }, ..noisy },
    ];
    let world = street(false);
    let renderer = prepared(&world);
    let scene = renderer.place(&world).expect("all meshes are prepared");
    let beams = SharedBeams::of(&rig).expect("are small");
    let (carrier, agent) = standing(1);
    for frame in [1, 2] {
        let counting = Counting::of(&*scene);
        let when = FrameWeather { frame, ..first_frame(&Weather::default()) };
        let cameras = Cameras::of(&rig).expect("has none");
        let observed = || Observation::new(&counting, None, &cameras, &when, agent).expect("nobody looks");
        let read = |at: &Observation<'_>| {
            let mut readings = Readings(at, Vec::new());
            sensors::visit_sensors(&rig, &carrier, &mut readings).expect("has no device");
            (readings.1, counting.rays.swap(0, Ordering::Relaxed))
        };
        let (alone, rays_alone) = read(&observed());
        let (together, rays) = read(&observed().with_scans(&beams).expect("has no device"));
        assert!(alone == together, "frame {frame}");
        // At odd frames the semantic lidar rests, so that its twin follows only the rays that it keeps.
        let one = 32 * 256;
        if frame == 1 {
            assert_eq!(rays, rays_alone);
        } else {
            assert!(rays < rays_alone - one * 4 / 5 && rays > 3 * one, "{rays} {rays_alone}");
        }
    }
}
