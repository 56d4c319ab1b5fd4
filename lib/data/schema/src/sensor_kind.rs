//! What sensors' tables hold.

use crate::ImageKind;

/// What kind of readings a sensor's table holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SensorKind {
    /// Images of a kind of a camera.
    Image(ImageKind),
    /// Sweeps of a lidar.
    Lidar,
    /// Sweeps of a semantic lidar.
    SemanticLidar,
    /// Returns of a radar.
    Radar,
    /// Fixes of a GNSS receiver.
    Gnss,
    /// Readings of an IMU.
    Imu,
}
