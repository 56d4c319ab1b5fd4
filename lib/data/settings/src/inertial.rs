//! GNSS and IMU.

use serde::Serialize;

use super::mount::Mount;

/// A GNSS receiver.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GnssSpec {
    /// Where its antenna sits.
    pub mount: Mount,
    /// Standard deviation of latitude and longitude, degrees (4e-7).
    pub noise_deg: [f64; 2],
    /// Standard deviation of the altitude, metres (0.04).
    pub noise_altitude_m: f64,
    /// Fixes are taken at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
}

impl Default for GnssSpec {
    fn default() -> Self {
        Self {
            mount: Mount::upright([0.0; 3], 0.0),
            noise_deg: [4e-7, 4e-7],
            noise_altitude_m: 0.04,
            every_n_frames: 1,
        }
    }
}

/// An inertial measurement unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImuSpec {
    /// Where it sits.
    pub mount: Mount,
    /// Standard deviation of each acceleration, m/s2 (1.7e-4).
    pub noise_accel_mps2: f64,
    /// Constant bias of each rate, rad/s (1.7e-4).
    pub gyro_bias_radps: f64,
    /// Standard deviation of each rate, rad/s (5.6e-6).
    pub noise_gyro_radps: f64,
    /// It is read at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
}

impl Default for ImuSpec {
    fn default() -> Self {
        Self {
            mount: Mount::upright([0.0; 3], 0.0),
            noise_accel_mps2: 1.7e-4,
            gyro_bias_radps: 1.7e-4,
            noise_gyro_radps: 5.6e-6,
            every_n_frames: 1,
        }
    }
}
