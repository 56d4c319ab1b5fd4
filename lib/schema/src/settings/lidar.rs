//! Lidars.

use frames::deg;
use serde::Serialize;

use super::mount::Mount;

/// The rays of a lidar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScanPattern {
    /// Beams, the highest first (128).
    pub channels: u32,
    /// Azimuth steps per beam and frame (2048 vehicle, 1024 RSU).
    pub columns: u32,
    /// Highest beam, radians above the horizon.
    pub upper_rad: f64,
    /// Lowest beam, radians.
    pub lower_rad: f64,
    /// Horizontal field of view, radians, centred ahead.
    pub horizontal_fov_rad: f64,
}

impl ScanPattern {
    /// Most rays of a sweep: a fixed bound on memory, 16 times the densest published lidar.
    pub const MAX_RAYS: u64 = 1 << 22;
    /// Most beams: rings are numbered in 16 bits.
    pub const MAX_CHANNELS: u32 = 65_535;

    /// Rays of a sweep.
    #[must_use]
    pub fn rays(&self) -> u64 {
        u64::from(self.channels) * u64::from(self.columns)
    }

    /// Why no lidar can have this pattern, if none can.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let Self { channels, columns, .. } = self;
        (self.rays() > Self::MAX_RAYS || *channels > Self::MAX_CHANNELS).then(|| {
            format!(
                "{channels} channels x {columns} columns are {} rays a frame, at most {} are possible",
                self.rays(),
                Self::MAX_RAYS
            )
        })
    }
}

/// A lidar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LidarSpec {
    /// `LIDAR` or `SEG-LIDAR`.
    pub name: String,
    /// Where it sits.
    pub mount: Mount,
    /// Its rays.
    pub scan: ScanPattern,
    /// Reach, metres (120).
    pub range_m: f64,
    /// Share of rays that return nothing at random (0.14; semantic 0).
    pub dropoff_rate: f64,
    /// Returns with an intensity above this are never dropped for weakness (0.8).
    pub dropoff_intensity_limit: f64,
    /// Chance that a return of intensity 0 is dropped (0.4; semantic 0).
    pub dropoff_zero_intensity: f64,
    /// Attenuation per metre (0.004): intensity is `exp(-attenuation * distance)` times the surface's reflectance
    /// in the dataset's `intensity` column; the drop rule uses the bare exponential.
    pub attenuation_per_m: f64,
    /// Standard deviation of the distance, metres (0.03; semantic 0).
    pub noise_m: f64,
    /// A semantic lidar: no drops, no noise, and the incidence cosine is written.
    pub semantic: bool,
    /// It sweeps at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
}

impl LidarSpec {
    /// The published vehicle lidar.
    #[must_use]
    pub fn vehicle() -> Self {
        Self {
            name: "LIDAR".into(),
            mount: Mount::upright([0.0, 0.0, 1.8], 0.0),
            scan: ScanPattern {
                channels: 128,
                columns: 2048,
                upper_rad: deg(10.67),
                lower_rad: deg(-30.67),
                horizontal_fov_rad: deg(360.0),
            },
            range_m: 120.0,
            dropoff_rate: 0.14,
            dropoff_intensity_limit: 0.8,
            dropoff_zero_intensity: 0.4,
            attenuation_per_m: 0.004,
            noise_m: 0.03,
            semantic: false,
            every_n_frames: 1,
        }
    }

    /// The published RSU lidar.
    #[must_use]
    pub fn rsu() -> Self {
        Self {
            mount: Mount::upright([0.0, 0.0, 3.2], 0.0),
            scan: ScanPattern {
                channels: 128,
                columns: 1024,
                upper_rad: 0.0,
                lower_rad: deg(-45.0),
                horizontal_fov_rad: deg(180.0),
            },
            ..Self::vehicle()
        }
    }

    /// The semantic lidar that goes with this one: the same rays, every return kept, nothing added.
    #[must_use]
    pub fn semantic(&self) -> Self {
        Self {
            name: format!("SEG-{}", self.name),
            dropoff_rate: 0.0,
            dropoff_zero_intensity: 0.0,
            noise_m: 0.0,
            semantic: true,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_rays_are_allowed_and_no_more() {
        let (lidar, rays) = (LidarSpec::vehicle().scan, ScanPattern::MAX_RAYS as u32);
        assert_eq!(ScanPattern { channels: 1024, columns: rays / 1024, ..lidar.clone() }.problem(), None);
        let more = ScanPattern { channels: 1024, columns: rays / 1024 + 1, ..lidar };
        assert!(more.problem().is_some_and(|p| p.contains("4195328 rays")));
    }
}
