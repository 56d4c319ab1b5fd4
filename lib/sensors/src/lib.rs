//! Sensors: cameras (colour, semantic, instance, depth, flow), lidar, radar, GNSS, IMU.
//!
//! Everything is computed from what `visibility` sees in one snapshot of the world, so that images, points and
//! labels agree to the triangle. Nothing here reads or writes files: readings are table rows and encoded bytes.
//!
//! * Cameras: [`render_camera`] sees once and reads all five images from it. Colour needs a [`Lighting`], made once
//!   per agent and frame (its shadow maps) over a [`Sky`], made once per frame.
//! * [`Lidar`] holds a lidar's rays; [`Lidar::sweep`] follows them. [`radar`] draws and follows a radar's.
//! * [`gnss`] and [`imu`] need only the agent's motion.
//!
//! Random numbers are read by frame and ray from the stream that the caller names, so readings do not depend on
//! threads or on which frames were made before.

mod camera;
mod error;
mod inertial;
mod lidar;
mod light;
mod look;
mod metadata;
mod radar;

pub use camera::{CameraFrame, CameraView, Flow, Picture, decode_depth_m, render_camera};
pub use error::SensorError;
pub use inertial::{GeoOrigin, Motion, gnss, imu};
pub use lidar::{Lidar, LidarSweep};
pub use light::{Lighting, Sky};
pub use metadata::{SENSOR_METADATA_KEY, camera_metadata, intrinsics, sensor_metadata};
pub use radar::{RadarMotion, RadarReturns, radar};

/// Time of a frame, seconds after frame 0.
pub(crate) fn frame_time_s(frame: u32) -> f64 {
    f64::from(frame) * schema::FRAME_PERIOD_S
}
