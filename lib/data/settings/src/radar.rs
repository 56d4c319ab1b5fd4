//! Radars.

use serde::Serialize;

use super::mount::Mount;

/// A radar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RadarSpec {
    /// `RAD_FRONT` and so on.
    pub name: String,
    /// Where it sits.
    pub mount: Mount,
    /// Reach, metres (120).
    pub range_m: f64,
    /// Width of the cone, radians (100 degrees; RSU 120).
    pub horizontal_fov_rad: f64,
    /// Height of the cone, radians (20 degrees).
    pub vertical_fov_rad: f64,
    /// Rays per frame (2000; RSU 2400).
    pub rays: u32,
    /// Whether velocities are those of the surfaces hit, turning wheels and swinging limbs too, and not of the bodies.
    pub micro_motion: bool,
    /// Signal to noise of a target of 1 m2 at 100 m, dB (10).
    pub snr_db: f64,
    /// It measures at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
}
