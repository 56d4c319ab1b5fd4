//! What the sensors of an agent are given at one frame.

use std::collections::BTreeMap;

use frames::LocalOrigin;
use glam::Affine3A;
use render::Scene;
use schema::tables::Weather;
use schema::{ObjectId, rate};
use settings::Mount;

use crate::camera::Cameras;
use crate::error::SensorError;
use crate::lidar::{LidarMoment, SensorPath, SharedBeams, SharedScan};
use crate::motion::Motion;
use crate::radar::{RadarMotion, RadarReturns, Radars};
use render::CameraView;
use shading::{FrameWeather, Painter, Sight, wants_colour};

/// An agent at one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgentState {
    /// Its own object.
    pub own: ObjectId,
    /// Where it is and how it moves.
    pub motion: Motion,
    /// The same one frame before, if that is known.
    pub previous: Option<Motion>,
}

/// Everything that the sensors of one agent look at, at one frame.
pub struct Observation<'a> {
    /// Number of the frame.
    pub frame: u32,
    /// The world around the agent.
    pub scene: &'a dyn Scene,
    /// The agent.
    pub agent: AgentState,
    /// The weather.
    pub weather: Weather,
    /// What the cameras of the rig see, in the rig's order; none of a camera of which nothing is wanted, and
    /// empty when nothing is wanted at this frame.
    pub sights: Vec<Option<Sight>>,
    /// What rays met that several lidars of the agent fire.
    pub(crate) scans: Vec<SharedScan>,
    /// What radars of the agent read that followed their rays together, by name.
    pub(crate) radar_returns: BTreeMap<String, RadarReturns>,
}

impl<'a> Observation<'a> {
    /// Looks through cameras, all at once, and has their pictures painted when colour is wanted.
    ///
    /// # Errors
    /// Colour is wanted and `painter` is missing, or renderer or painter failed.
    pub fn new(
        scene: &'a dyn Scene,
        painter: Option<&dyn Painter>,
        cameras: &Cameras,
        when: &FrameWeather,
        agent: AgentState,
    ) -> Result<Self, SensorError> {
        let origin = &scene.snapshot().origin;
        let now = &agent.motion.world_from_agent;
        let before = agent.previous.as_ref().map_or(now, |previous| &previous.world_from_agent);
        let looks = cameras.list.iter().any(Option::is_some);
        let sights = if !looks || !rate::is_due(when.frame, cameras.every_n_frames) {
            Vec::new()
        } else {
            let looking = cameras.list.iter().flatten();
            let views = looking.map(|camera| camera.view(origin, now, before)).collect();
            let seen = see(scene, painter, when, origin.local_from_world(now.xyz()), views)?;
            let mut seen = seen.into_iter();
            cameras.list.iter().map(|camera| camera.as_ref().and_then(|_| seen.next())).collect()
        };
        let (scans, radar_returns) = (Vec::new(), BTreeMap::new());
        Ok(Self { frame: when.frame, scene, agent, weather: when.weather, sights, scans, radar_returns })
    }

    /// Follows the rays that several lidars of the agent fire once for all of them. Without it each follows
    /// its own; what they sense is the same.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn with_scans(mut self, beams: &SharedBeams) -> Result<Self, SensorError> {
        self.scans = beams.scans(self.scene, self.frame, |mount| self.lidar_moment(mount))?;
        Ok(self)
    }

    /// Follows the rays of all radars that are due together. Without it each follows its own; what they read
    /// is the same.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn with_radars(mut self, radars: &Radars) -> Result<Self, SensorError> {
        self.radar_returns = radars.read(self.scene, self.frame, |mount| self.radar_motion(mount))?;
        Ok(self)
    }

    /// Where the agent is: its frame to the snapshot's local frame, now and one frame before.
    #[must_use]
    pub fn local_from_agent(&self) -> [Affine3A; 2] {
        let origin: &LocalOrigin = &self.scene.snapshot().origin;
        let now = origin.local_from_body(&self.agent.motion.world_from_agent);
        let before = self.agent.previous.as_ref();
        [now, before.map_or(now, |previous| origin.local_from_body(&previous.world_from_agent))]
    }

    /// Where a sensor is: its frame to the snapshot's local frame, now and one frame before.
    #[must_use]
    pub fn local_from_sensor(&self, mount: &Mount) -> [Affine3A; 2] {
        let origin: &LocalOrigin = &self.scene.snapshot().origin;
        let local_from =
            |m: &Motion| origin.local_from_body(&(m.world_from_agent * mount.agent_from_sensor()));
        let now = local_from(&self.agent.motion);
        [now, self.agent.previous.as_ref().map_or(now, local_from)]
    }

    /// Where a radar on a mount is and was.
    pub(crate) fn radar_motion(&self, mount: &Mount) -> RadarMotion {
        let [local_from_sensor, previous_local_from_sensor] = self.local_from_sensor(mount);
        RadarMotion { local_from_sensor, previous_local_from_sensor, own: Some(self.agent.own) }
    }

    /// What a lidar on a mount sweeps at.
    pub(crate) fn lidar_moment(&self, mount: &Mount) -> LidarMoment {
        let [local_from_sensor, _] = self.local_from_sensor(mount);
        let [local_from_agent, previous_local_from_agent] = self.local_from_agent();
        let path = SensorPath { local_from_sensor, local_from_agent, previous_local_from_agent };
        LidarMoment { frame: self.frame, path, weather: self.weather }
    }
}

/// Looks through cameras and has the pictures of those painted that want colour.
///
/// # Errors
/// As [`Observation::new`].
pub fn see(
    scene: &dyn Scene,
    painter: Option<&dyn Painter>,
    when: &FrameWeather,
    place_local: glam::Vec3,
    views: Vec<CameraView>,
) -> Result<Vec<Sight>, SensorError> {
    match painter {
        Some(painter) => Ok(painter.see(scene, when, place_local, views)?),
        None if views.iter().any(wants_colour) => Err(SensorError::NoPainter),
        None => Ok(Sight::all(scene, views)?),
    }
}
