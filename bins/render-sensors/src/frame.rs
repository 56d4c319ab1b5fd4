//! All sensors of one agent at one frame.

use std::collections::BTreeMap;

use frames::{Agent, LocalOrigin, Pose, World};
use glam::Affine3A;
use pipeline::{At, Place, StageError};
use random::Stream;
use replay::Replay;
use schema::settings::{Mount, Rig};
use schema::tables::{GnssRow, ImuRow, LidarRow, RadarRow, SemanticLidarRow};
use schema::{ObjectId, Tag};
use sensors::{CameraFrame, CameraView, GeoOrigin, Lidar, Lighting, Motion, RadarMotion, Sky};
use visibility::{Meshes, Scene};

/// Everything within this distance is handed to the sensors: scenery reaches no further, lidars see less.
const SIGHT_M: f64 = 1000.0;

/// An agent with its rig, ready to look around.
pub(crate) struct Station<'a> {
    replay: &'a Replay,
    meshes: &'a Meshes,
    position: usize,
    rig: &'a Rig,
    geo_origin: GeoOrigin,
    lidars: Vec<(Lidar, Stream)>,
    radars: Vec<Stream>,
    gnss: Stream,
    imu: Stream,
}

/// What one agent's sensors gave at one frame, in the order of the rig.
pub(crate) struct Readings {
    pub(crate) frame: u32,
    pub(crate) cameras: Vec<CameraFrame>,
    /// Pixels of every object and tag in all instance images.
    pub(crate) visible: BTreeMap<(ObjectId, Tag), u32>,
    pub(crate) lidars: Vec<LidarReading>,
    pub(crate) radars: Vec<RadarRow>,
    pub(crate) gnss: Option<GnssRow>,
    pub(crate) imu: Option<ImuRow>,
}

/// A sweep of either kind of lidar.
pub(crate) enum LidarReading {
    Plain(LidarRow),
    Semantic(SemanticLidarRow),
}

impl<'a> Station<'a> {
    /// Prepares an agent's rig.
    ///
    /// # Errors
    /// A sensor's settings are impossible.
    pub(crate) fn new(
        replay: &'a Replay,
        meshes: &'a Meshes,
        position: usize,
        rig: &'a Rig,
        seed: u64,
        geo_origin: GeoOrigin,
    ) -> Result<Self, StageError> {
        let agent = replay.log.agent_ids()[position];
        let scene = replay.log.info.scene;
        let stream = |sensor: &str| Stream::new(seed, scene.into(), &format!("sensors/{agent}/{sensor}"), 0);
        let lidars = rig
            .lidars
            .iter()
            .map(|spec| {
                let place = || Place::scene(scene).agent(agent).sensor(&spec.name);
                Ok((Lidar::new(spec).at(place)?, stream(&spec.name)))
            })
            .collect::<Result<_, StageError>>()?;
        let radars = rig.radars.iter().map(|spec| stream(&spec.name)).collect();
        let (gnss, imu) = (stream("GNSS"), stream("IMU"));
        Ok(Self { replay, meshes, position, rig, geo_origin, lidars, radars, gnss, imu })
    }

    /// Reads all sensors at a frame.
    ///
    /// # Errors
    /// An encoder refused; the message names scene, frame and agent.
    pub(crate) fn sense(&self, frame: u32) -> Result<Readings, StageError> {
        let log = &self.replay.log;
        let now = log.world_from_agent(self.position, frame);
        let before = log.previous_world_from_agent(self.position, frame);
        let snapshot = self.replay.snapshot(frame, now.xyz(), SIGHT_M);
        let scene = Scene::new(self.meshes, &snapshot);
        let origin = &snapshot.origin;
        let own = log.agent(self.position, frame).id;

        let cameras = self.cameras(frame, &scene, origin, &now, &before)?;
        let mut visible = BTreeMap::new();
        if self.rig.camera.instance {
            for (&part, &pixels) in cameras.iter().flat_map(|c| &c.pixel_counts) {
                *visible.entry(part).or_insert(0) += pixels;
            }
        }
        let local_from = |pose: &Pose<World, Agent>, mount: &Mount| -> Affine3A {
            origin.local_from_body(&(*pose * mount.agent_from_sensor()))
        };
        let lidars = self.lidars.iter().map(|(lidar, stream)| {
            let sweep = lidar.sweep(&scene, local_from(&now, &lidar.spec().mount), stream, frame);
            if lidar.spec().semantic {
                LidarReading::Semantic(sweep.into_semantic_row(frame))
            } else {
                LidarReading::Plain(sweep.into_row(frame))
            }
        });
        let radars = self.rig.radars.iter().zip(&self.radars).map(|(spec, stream)| {
            let motion = RadarMotion {
                local_from_sensor: local_from(&now, &spec.mount),
                previous_local_from_sensor: local_from(&before, &spec.mount),
                own: Some(own),
            };
            sensors::radar(&scene, spec, &motion, stream, frame).into_row(frame)
        });
        let motion = Motion::from_row(log.agent(self.position, frame));
        let previous = self.previous_motion(frame);
        let gnss = self.rig.gnss.as_ref();
        let imu = self.rig.imu.as_ref();
        Ok(Readings {
            frame,
            visible,
            lidars: lidars.collect(),
            radars: radars.collect(),
            gnss: gnss.map(|spec| sensors::gnss(spec, &self.geo_origin, &now, &self.gnss, frame)),
            imu: imu.map(|spec| sensors::imu(spec, &motion, previous.as_ref(), &self.imu, frame)),
            cameras,
        })
    }

    fn cameras(
        &self,
        frame: u32,
        scene: &Scene<'_>,
        origin: &LocalOrigin,
        now: &Pose<World, Agent>,
        before: &Pose<World, Agent>,
    ) -> Result<Vec<CameraFrame>, StageError> {
        let settings = &self.rig.camera;
        if !settings.any() {
            return Ok(Vec::new());
        }
        let row = &self.replay.log.frames[frame as usize];
        let weather = row.weather();
        let sky = settings.rgb.then(|| Sky::new(&weather, row.time_s));
        let lighting =
            sky.as_ref().map(|sky| Lighting::new(scene, sky, &weather, origin.local_from_world(now.xyz())));
        self.rig
            .cameras
            .iter()
            .map(|camera| {
                let view = CameraView::new(origin, now, before, &camera.mount, settings);
                sensors::render_camera(scene, &view, lighting.as_ref()).at(|| {
                    let log = &self.replay.log;
                    let agent = log.agent_ids()[self.position];
                    Place::scene(log.info.scene).frame(frame).agent(agent).sensor(&camera.name)
                })
            })
            .collect()
    }

    /// The agent's motion one period earlier; before frame 0 it is the log's frame -1.
    fn previous_motion(&self, frame: u32) -> Option<Motion> {
        let log = &self.replay.log;
        if frame > 0 {
            return Some(Motion::from_row(log.agent(self.position, frame - 1)));
        }
        let id = log.agent(self.position, frame).id;
        log.states_at(-1).iter().find(|s| s.id == id).map(|state| Motion {
            world_from_agent: Pose::from_xyz_wxyz(state.xyz_m, state.quaternion),
            velocity_mps: state.velocity_mps.map(f64::from).into(),
            angular_velocity_radps: state.angular_velocity_radps.map(f64::from).into(),
        })
    }
}
