//! Sensors: cameras (colour, semantic, instance, depth, flow), lidar, radar, GNSS, IMU.
//!
//! Everything is computed from what a [`render::Renderer`] sees in one snapshot of the world, so that images,
//! points and labels agree to the triangle. Nothing here reads or writes files: readings are table rows.
//!
//! * An [`Observation`] holds what the sensors of one agent are given at one frame. [`see`] looks through
//!   cameras; each kind of [`Image`] is read from a [`Sight`](shading::Sight). Colour is put into it by a
//!   [`Painter`](shading::Painter), the second, optional seam beside [`render::Renderer`], which may look as
//!   well.
//! * [`Lidar`] holds a lidar's rays; [`Lidar::sweep`] follows them. [`radars`] draws and follows those of
//!   radars.
//! * [`gnss`] and [`imu`] need only the agent's motion.
//! * Every sensor of a rig is a [`Sensor`]; [`visit_sensors`] shows them all.
//!
//! Random numbers are read by frame and ray from the stream that the caller names, so readings do not depend
//! on threads or on which frames were made before.
//!
//! ```
//! use std::sync::Arc;
//! use frames::{Agent, LocalOrigin, Pose, World};
//! use glam::{Affine3A, Vec3};
//! use schema::geometry::{Instance, MeshPart, Snapshot, Surface, TriMesh};
//! use settings::{CameraSettings, CameraSpec, LidarSpec, Mount, Optics};
//! use schema::{Tag, images};
//! use sensors::{Camera, Image, Lidar, LidarMoment};
//! use shading::{CpuPainter, FrameWeather};
//! use render::Renderer;
//! use render::cpu::CpuRenderer;
//!
//! // Level ground of 400 m.
//! let corner = |x: f32, y: f32| Vec3::new(200.0 * x, 200.0 * y, 0.0);
//! let ground = Arc::new(TriMesh {
//!     positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     triangle_part: vec![0, 0],
//!     parts: vec![MeshPart { tag: Tag::Road, surface: Surface::Asphalt, rgb: [0.1; 3] }],
//!     ..TriMesh::default()
//! });
//! let snapshot = Snapshot {
//!     origin: LocalOrigin::near([0.0; 3]),
//!     meshes: vec![ground].into(),
//!     instances: vec![Instance {
//!         mesh: 0,
//!         object: 1,
//!         local_from_object: Affine3A::IDENTITY,
//!         previous_local_from_object: Affine3A::IDENTITY,
//!         paint: [0.5; 3],
//!         lights: 0,
//!         glow: [1.0; 3],
//!     }],
//!     cabins: Vec::new(),
//!     motions: Vec::new(),
//! };
//! let mut renderer = CpuRenderer::default();
//! renderer.prepare(&snapshot.meshes)?;
//! let scene = renderer.place(&snapshot)?;
//!
//! // A camera 1.6 m above the ground that looks along x.
//! let spec = CameraSpec {
//!     name: "CAM_FRONT".into(),
//!     mount: Mount::upright([0.0, 0.0, 1.6], 0.0),
//!     optics: Optics::pinhole(64, 36, frames::deg(80.0)),
//! };
//! let pose = Pose::<World, Agent>::from_xyz_rpy([0.0; 3], [0.0; 3]);
//! let view = Camera::new(&spec, &CameraSettings::default())?.view(&snapshot.origin, &pose, &pose);
//! let painter = CpuPainter::default();
//! let noon = FrameWeather { frame: 0, time_s: 0.0, weather: Default::default(), is_steady: true };
//! let sight = sensors::see(&*scene, Some(&painter), &noon, Vec3::ZERO, vec![view])?.remove(0);
//! let row = images::Rgb::of(&snapshot, &sight, 0)?;
//! assert_eq!(row.image.0[..2], [0xff, 0xd8], "a JPEG");
//!
//! // A lidar at the same place: what comes back lies on the ground.
//! let lidar = Lidar::new(&LidarSpec::rsu().semantic())?;
//! let stream = random::Stream::new(1, 0, "docs", 0);
//! let moment = LidarMoment::standing(0, Affine3A::from_translation(Vec3::Z * 1.6));
//! let sweep = lidar.sweep(&*scene, &moment, &stream)?;
//! assert!(!sweep.is_empty() && sweep.z_m.iter().all(|z| (z + 1.6).abs() < 1e-3));
//! # Ok::<(), sensors::SensorError>(())
//! ```

mod camera;
mod echo;
mod error;
mod geo;
mod gnss;
mod imu;
mod lidar;
mod metadata;
mod motion;
mod noise;
mod observation;
mod radar;
mod registry;
mod sensor;
mod surface_hit;

pub use camera::{Camera, Cameras, Image, decode_depth_m, pixel_counts};
pub use error::SensorError;
pub use geo::GeoOrigin;
pub use gnss::gnss;
pub use imu::imu;
pub use lidar::{Lidar, LidarMoment, LidarSweep, OfBeam, Scan, SensorPath, SharedBeams};
pub use metadata::{camera_metadata, sensor_metadata};
pub use motion::Motion;
pub use observation::{AgentState, Observation, see};
pub use radar::{RadarMotion, RadarQuery, RadarReturns, Radars, radars};
pub use registry::visit_sensors;
pub use sensor::{Amount, Layout, Sensor, SensorContext, SensorTable, SensorVisitor};

/// Time of a frame, seconds after frame 0.
pub(crate) fn frame_time_s(frame: u32) -> f64 {
    f64::from(frame) * schema::FRAME_PERIOD_S
}
