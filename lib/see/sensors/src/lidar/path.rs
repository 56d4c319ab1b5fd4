//! Where a lidar is while it turns.

use glam::Affine3A;
use render::pose_before;
use schema::tables::Weather;

/// Where a sensor is at a frame, and how its agent came there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPath {
    /// Sensor frame to the snapshot's local frame at the frame's time.
    pub local_from_sensor: Affine3A,
    /// The agent's frame to the same, at the frame's time.
    pub local_from_agent: Affine3A,
    /// The same one frame period ago.
    pub previous_local_from_agent: Affine3A,
}

impl SensorPath {
    /// A sensor that does not move.
    #[must_use]
    pub fn standing(local_from_sensor: Affine3A) -> Self {
        Self {
            local_from_sensor,
            local_from_agent: local_from_sensor,
            previous_local_from_agent: local_from_sensor,
        }
    }

    /// Sensor frame to local frame at a moment before the frame: 0 at its time, 1 a period ago. The agent
    /// moves as [`pose_before`] says, and so does its body.
    pub(crate) fn before(&self, before: f32) -> Affine3A {
        if before == 0.0 {
            return self.local_from_sensor;
        }
        let agent = pose_before(&self.previous_local_from_agent, &self.local_from_agent, before);
        agent * (self.local_from_agent.inverse() * self.local_from_sensor)
    }
}

/// What a sweep depends on besides the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarMoment {
    /// Number of the frame.
    pub frame: u32,
    /// Where the lidar is and was.
    pub path: SensorPath,
    /// The weather, for lidars that feel it.
    pub weather: Weather,
}

impl LidarMoment {
    /// A frame at which the lidar stands, in clear air.
    #[must_use]
    pub fn standing(frame: u32, local_from_sensor: Affine3A) -> Self {
        Self { frame, path: SensorPath::standing(local_from_sensor), weather: Weather::default() }
    }
}
