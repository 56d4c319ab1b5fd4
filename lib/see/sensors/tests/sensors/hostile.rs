//! Settings and worlds that make no sense, and renderers that fail: answered by errors or readings, never by
//! panics.

use std::sync::Arc;

use crate::common::{first_frame, optics, picture, set_view, standing_view, street, with_scene};
use frames::{Agent, Pose, World};
use glam::{Affine3A, Vec3};
use nalgebra::Vector3;
use random::Stream;
use render::CameraError;
use render::{CameraQuery, Hits, RayQuery, RenderError, Renderer, Scene, VisibilityBuffer};
use schema::geometry::{Snapshot, TriMesh};
use schema::tables::Weather;
use schema::{AgentId, ImageKind, ImageSet};
use sensors::{
    AgentState, Camera, Cameras, GeoOrigin, Lidar, LidarMoment, Motion, Observation, RadarMotion, RadarQuery,
    Sensor, SensorContext, SensorError, SensorVisitor, radars,
};
use settings::{
    BeamSpec, CameraSettings, CameraSpec, GnssSpec, ImuSpec, LidarSpec, Mount, Optics, Rig, RollingScan,
    ScanPattern, WeatherSpec,
};
use shading::CpuPainter;

const ODD: [f64; 7] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 1e300, 1e-300];

fn stream() -> Stream {
    Stream::new(27, 0, "test/hostile", 1)
}

#[test]
fn cameras_that_cannot_be_are_refused() {
    let of = |optics| {
        let spec = CameraSpec { name: "CAM".into(), mount: Mount::upright([0.0; 3], 0.0), optics };
        Camera::new(&spec, &CameraSettings::default())
    };
    let view = |width, height, horizontal_fov_rad| of(Optics::pinhole(width, height, horizontal_fov_rad));
    for (width, height) in [(0, 10), (10, 0), (1 << 20, 10), (10, u32::MAX)] {
        assert!(matches!(
            view(width, height, 1.0),
            Err(SensorError::Camera(CameraError::PictureSize { .. }))
        ));
    }
    for fov in ODD.into_iter().chain([3.2, std::f64::consts::PI]).filter(|fov| *fov != 1e-300) {
        assert!(
            matches!(view(10, 10, fov), Err(SensorError::Camera(CameraError::Intrinsics { .. }))),
            "{fov}"
        );
    }
    for odd in ODD.into_iter().filter(|odd| !(*odd > 0.0 && *odd < 1e300)) {
        let good = Optics::pinhole(10, 10, 1.0);
        assert!(of(Optics { fy: odd, ..good.clone() }).is_err(), "{odd}");
        assert!(odd.abs() < 1e300 || of(Optics { cx: odd, ..good }).is_err(), "{odd}");
    }
}

#[test]
fn odd_lenses_and_weathers_still_give_pictures() {
    let street = street(true);
    let (settings, optics) = (CameraSettings::default(), optics(24, 14));
    for odd in ODD {
        let lens = CameraSettings { f_stop: odd, ..settings.clone() };
        let view = set_view([0.0, -5.0, 0.0], [0.0; 3], optics.clone(), &lens);
        let p = picture(&street, &view, &Weather::default());
        assert_eq!(p.rgb.len(), 3 * 24 * 14);
        let weather = Weather {
            cloudiness: odd,
            precipitation: odd,
            precipitation_deposits: odd,
            wind_intensity: odd,
            sun_azimuth_deg: odd,
            sun_altitude_deg: odd,
            fog_density: odd,
            fog_distance_m: odd,
            wetness: odd,
            fog_falloff: odd,
            scattering_intensity: odd,
            mie_scattering_scale: odd,
            rayleigh_scattering_scale: odd,
            dust_storm: odd,
        };
        let view = standing_view([0.0, -5.0, 0.0], [0.0; 3], optics.clone());
        assert_eq!(picture(&street, &view, &weather).rgb.len(), 3 * 24 * 14);
    }
    // A camera at no place sees nothing or something, and a quality beyond 1 to 100 is the nearest.
    for quality in [0, 255] {
        let lost = CameraSettings { jpeg_quality: quality, ..settings.clone() };
        let mut view = set_view([0.0; 3], [0.0; 3], optics.clone(), &lost);
        view.local_from_optical.translation.x = f32::NAN;
        let sight = with_scene(&street, |scene| crate::common::sight(scene, &view, &Weather::default()));
        assert!(!crate::common::encoded::<schema::images::Rgb>(&street, &sight).is_empty());
    }
}

#[test]
fn odd_lidars_and_radars_return_something_or_nothing() {
    let street = street(false);
    let plain = LidarSpec {
        scan: ScanPattern { channels: 4, columns: 16, ..LidarSpec::vehicle().scan },
        ..LidarSpec::vehicle()
    };
    with_scene(&street, |scene| {
        for odd in ODD {
            let scan = |upper_rad, lower_rad, horizontal_fov_rad| ScanPattern {
                upper_rad,
                lower_rad,
                horizontal_fov_rad,
                ..plain.scan.clone()
            };
            let specs = [
                LidarSpec { scan: scan(odd, -0.3, 1.0), ..plain.clone() },
                LidarSpec { scan: scan(0.1, odd, 1.0), ..plain.clone() },
                LidarSpec { scan: scan(0.1, -0.3, odd), ..plain.clone() },
                LidarSpec { range_m: odd, ..plain.clone() },
                LidarSpec { dropoff_rate: odd, ..plain.clone() },
                LidarSpec { dropoff_intensity_limit: odd, dropoff_zero_intensity: odd, ..plain.clone() },
                LidarSpec { attenuation_per_m: odd, noise_m: odd, ..plain.clone() },
                LidarSpec {
                    beam: BeamSpec { rays: 7, divergence_rad: odd, ..plain.beam.clone() },
                    ..plain.clone()
                },
                LidarSpec { weather: Some(WeatherSpec { detected: odd }), ..plain.clone() },
                LidarSpec { weather: Some(WeatherSpec { detected: 0.1 }), range_m: odd, ..plain.clone() },
                LidarSpec { rolling: Some(RollingScan { slices: 0, compensated: true }), ..plain.clone() },
            ];
            for spec in specs {
                let lidar = Lidar::new(&spec).expect("its number of rays is possible");
                let mut moment = LidarMoment::standing(0, Affine3A::IDENTITY);
                moment.weather = Weather { fog_density: odd, precipitation: 60.0, ..Weather::default() };
                moment.path.previous_local_from_agent.translation.x = odd as f32;
                let sweep = lidar.sweep(scene, &moment, &stream()).expect("has no device");
                assert!(sweep.len() <= 64);
            }
            let base = &Rig::vehicle().radars[0];
            for spec in [
                settings::RadarSpec { rays: 50, range_m: odd, ..base.clone() },
                settings::RadarSpec { rays: 50, horizontal_fov_rad: odd, ..base.clone() },
                settings::RadarSpec { rays: 50, vertical_fov_rad: odd, ..base.clone() },
                settings::RadarSpec { rays: 0, ..base.clone() },
            ] {
                let pose = Affine3A::from_translation(Vec3::Z);
                let motion =
                    RadarMotion { local_from_sensor: pose, previous_local_from_sensor: pose, own: Some(1) };
                let query = RadarQuery { spec: &spec, motion, stream: &stream() };
                let returns = radars(scene, &[query], 0).expect("has no device");
                assert!(returns[0].len() <= 50);
            }
        }
    });
}

#[test]
fn odd_receivers_answer_numbers_of_some_kind() {
    let motion = Motion {
        world_from_agent: Pose::<World, Agent>::from_xyz_rpy([1e9, -1e9, 0.0], [0.0; 3]),
        velocity_mps: Vector3::repeat(f64::INFINITY),
        angular_velocity_radps: Vector3::zeros(),
    };
    for odd in ODD {
        let origin = GeoOrigin { latitude_deg: odd, longitude_deg: odd, altitude_m: odd };
        let spec = GnssSpec { noise_deg: [odd; 2], noise_altitude_m: odd, ..GnssSpec::default() };
        assert_eq!(sensors::gnss(&spec, &origin, &motion.world_from_agent, &stream(), 3).frame, 3);
        let spec = ImuSpec { noise_accel_mps2: odd, gyro_bias_radps: odd, ..ImuSpec::default() };
        assert_eq!(sensors::imu(&spec, &motion, Some(&motion), &stream(), 4).frame, 4);
    }
}

/// A renderer whose device was unplugged once the instances were placed.
struct Unplugged;

struct Nothing<'a>(&'a Snapshot);

impl Renderer for Unplugged {
    fn prepare(&mut self, _: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        Ok(())
    }

    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError> {
        Ok(Box::new(Nothing(snapshot)))
    }
}

fn unplugged<T>() -> Result<T, RenderError> {
    Err(RenderError::Device("it was unplugged".into()))
}

impl Scene for Nothing<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.0
    }

    fn render(&self, _: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        unplugged()
    }

    fn trace(&self, _: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        unplugged()
    }
}

/// Reads every sensor that needs the scene and counts those that fail with their device.
struct Failures<'a> {
    at: &'a Observation<'a>,
    failed: Vec<String>,
    others: usize,
}

impl SensorVisitor for Failures<'_> {
    type Error = SensorError;

    fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), SensorError> {
        match sensor.sense(self.at) {
            Err(e) => {
                assert_eq!(e.to_string(), "the renderer's device failed");
                let cause = std::error::Error::source(&e).map(ToString::to_string);
                assert_eq!(cause.as_deref(), Some("it was unplugged"));
                self.failed.push(sensor.table().name);
            }
            Ok(_) => self.others += 1,
        }
        Ok(())
    }
}

#[test]
fn a_renderer_that_fails_fails_its_sensors_and_no_others() {
    let snapshot = street(false);
    let motion = Motion {
        world_from_agent: Pose::<World, Agent>::from_xyz_rpy([0.0, -5.0, 0.0], [0.0; 3]),
        velocity_mps: Vector3::zeros(),
        angular_velocity_radps: Vector3::zeros(),
    };
    let agent = AgentState { own: 1, motion, previous: None };
    let scene = Unplugged.place(&snapshot).expect("places anything");
    let when = first_frame(&Weather::default());
    let mut rig = Rig::vehicle();
    let painter = CpuPainter::default();
    let cameras = Cameras::of(&rig).expect("are cameras");
    let looked = Observation::new(&*scene, Some(&painter), &cameras, &when, agent);
    assert!(matches!(looked.err(), Some(SensorError::Render(RenderError::Device(_)))));

    rig.camera.images = ImageSet::NONE;
    let cameras = Cameras::of(&rig).expect("are cameras");
    let at = Observation::new(&*scene, None, &cameras, &when, agent).expect("nobody looks");
    let geo_origin = GeoOrigin::default();
    let carrier = SensorContext { seed: 1, scene: 0, agent: AgentId::vehicle(0), geo_origin };
    let mut failures = Failures { at: &at, failed: Vec::new(), others: 0 };
    sensors::visit_sensors(&rig, &carrier, &mut failures).expect("all can be made");
    assert_eq!(failures.failed, ["LIDAR", "RAD_LEFT", "RAD_FRONT", "RAD_RIGHT", "RAD_BACK"]);
    assert_eq!(failures.others, 2, "GNSS and IMU need nobody's eyes");
}

#[test]
fn colour_needs_a_painter() {
    let snapshot = street(false);
    let rig = {
        let mut rig = Rig::rsu();
        rig.cameras.iter_mut().for_each(|camera| camera.optics = optics(16, 9));
        rig.camera.images = ImageSet::of(&[ImageKind::Rgb]);
        rig
    };
    let motion = Motion {
        world_from_agent: Pose::<World, Agent>::from_xyz_rpy([0.0; 3], [0.0; 3]),
        velocity_mps: Vector3::zeros(),
        angular_velocity_radps: Vector3::zeros(),
    };
    let agent = AgentState { own: 1, motion, previous: None };
    let cameras = Cameras::of(&rig).expect("are cameras");
    with_scene(&snapshot, |scene| {
        let when = first_frame(&Weather::default());
        let none = Observation::new(scene, None, &cameras, &when, agent);
        assert!(matches!(none.err(), Some(SensorError::NoPainter)));
        let painter = CpuPainter::default();
        let at = Observation::new(scene, Some(&painter), &cameras, &when, agent).expect("all is there");
        assert_eq!(at.sights.len(), rig.cameras.len());
        assert!(at.sights.iter().flatten().all(|sight| sight.picture.is_some()));
    });
}
