//! Radars.

use frames::deg;

use crate::key::settings;
use crate::mount::Mount;

settings! {
    /// A radar: what all of a rig share, and its place.
    pub struct RadarSpec {
        /// `RAD_FRONT` and so on.
        name: String = "RAD_FRONT".into(), apart();
        /// Where it sits.
        mount: Mount = Mount::default(), apart();
        /// Reach, m.
        range_m: f64 = 120.0, within(1.0..=1000.0), yaml("radar_range");
        /// Width of the cone.
        horizontal_fov_rad: f64 = deg(100.0), named("horizontal_fov_deg"), degrees(0.1..=179.0), yaml("radar_horizontal_fov");
        /// Height of the cone.
        vertical_fov_rad: f64 = deg(20.0), named("vertical_fov_deg"), degrees(0.1..=179.0), yaml("radar_vertical_fov");
        /// Rays per frame.
        rays: u32 = 2000, within(1..=1_000_000);
        /// Velocities are those of the surfaces hit, turning wheels and swinging limbs too, not of the
        /// bodies.
        micro_motion: bool = false;
        /// Signal to noise of a target of 1 m2 at 100 m, dB.
        snr_db: f64 = 10.0, within(-50.0..=100.0);
        /// They measure at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
    }
}

settings! {
    /// Where a radar of a rig sits.
    pub(crate) struct RadarPlace {
        /// Radar name, part of the file names.
        name: String = "RAD_FRONT".into();
        /// Where it sits.
        mount: Mount = Mount::default(), flat();
    }
}
