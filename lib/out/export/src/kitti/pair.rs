//! The camera and the lidar that stand for an agent.

use nalgebra::Isometry3;
use scene::SensorEntry;
use serde::{Deserialize, Serialize};

use crate::SceneSource;

/// Scenes and frames that six digits can number: 1000 of 1000.
pub(super) const MOST: u32 = 1000;

/// The camera and lidar of an agent, and its other sensors.
pub(super) struct Pair {
    pub(super) camera: SensorEntry,
    pub(super) lidar: SensorEntry,
    pub(super) others: Vec<SensorEntry>,
}

impl Pair {
    /// Pixels from directions in the camera's optical frame, row by row.
    pub(super) fn intrinsics(&self) -> [[f64; 3]; 3] {
        self.camera.about.intrinsics.unwrap_or_default()
    }

    pub(super) fn optical_from_lidar(&self) -> Isometry3<f64> {
        isometry(&self.camera).inverse() * isometry(&self.lidar)
    }

    /// Where a sensor's agent is from the camera.
    pub(super) fn optical_from_agent(&self) -> Isometry3<f64> {
        isometry(&self.camera).inverse()
    }

    pub(super) fn lidar_from_agent(&self) -> Isometry3<f64> {
        isometry(&self.lidar).inverse()
    }

    /// Frames that both have, of those that are wanted.
    pub(super) fn frames(&self, scene: &SceneSource) -> Vec<u32> {
        let rates = [
            self.camera.about.every_n_frames,
            self.lidar.about.every_n_frames,
            scene.info().label_every_n_frames,
        ];
        scene.frames().filter(|frame| rates.iter().all(|rate| schema::rate::is_due(*frame, *rate))).collect()
    }
}

fn isometry(sensor: &SensorEntry) -> Isometry3<f64> {
    *sensor.about.agent_from_sensor.agent_from_sensor::<frames::Sensor>().isometry()
}

/// What a unit leaves for the lists of the end.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Sequence {
    pub(super) split: String,
    pub(super) frames: u32,
}
