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

/// A revolution that takes the whole frame: its last column is fired at the frame's time, the first one a period before.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RollingScan {
    /// Moments at which rays are fired (64), at most as many as there are columns. Neighbouring columns share one, the middle of
    /// theirs, so that rays are fired at most `period / (2 slices)` from when a steadily turning lidar would.
    pub slices: u32,
    /// Whether points are given from where the sensor is at the frame's time (its own motion taken out), not from where it was
    /// when the ray was fired.
    pub compensated: bool,
}

/// Which echoes of a beam are returned; one that is several of these is returned once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Returned {
    /// The nearest.
    pub first: bool,
    /// The one of the greatest power.
    pub strongest: bool,
    /// The farthest.
    pub last: bool,
}

/// A beam.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BeamSpec {
    /// Rays that stand for it: 1 along its axis, or 7 over its cross-section.
    pub rays: u32,
    /// Full angle of its cone, radians (0.003).
    pub divergence_rad: f64,
    /// Which of its echoes are returned.
    pub returned: Returned,
}

impl BeamSpec {
    /// Numbers of rays that a beam can have.
    pub const RAYS: [u32; 2] = [1, 7];
}

/// A lidar that rain and fog weaken and send light back to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WeatherSpec {
    /// Reflectance of the surface, met straight on in clear air at the lidar's reach, whose echo it just detects (0.1).
    pub detected: f64,
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
    /// A semantic lidar: no drops, no noise, no weather.
    pub semantic: bool,
    /// It sweeps at frames 0, n, 2 n, ... (1).
    pub every_n_frames: u32,
    /// A revolution that takes time; none fires all rays at the frame's time.
    pub rolling: Option<RollingScan>,
    /// The beams.
    pub beam: BeamSpec,
    /// Rain, fog and wet ground; none sees through them.
    pub weather: Option<WeatherSpec>,
    /// Whether light passes the panes of vehicles, and returns from behind them are told apart (no).
    pub glass: bool,
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
            rolling: None,
            beam: BeamSpec {
                rays: 1,
                divergence_rad: 0.003,
                returned: Returned { first: false, strongest: true, last: false },
            },
            weather: None,
            glass: false,
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
            weather: None,
            ..self.clone()
        }
    }

    /// Whether a beam can have several echoes, or some that are no surface's or from behind glass: then the table says of each return which it is.
    #[must_use]
    pub fn tells_returns(&self) -> bool {
        self.beam.rays > 1 || self.weather.is_some() || self.glass
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
