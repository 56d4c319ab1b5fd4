//! Lidars.

use frames::deg;
use serde::{Deserialize, Serialize};

use crate::key::{Name, settings};
use crate::mount::Mount;
use crate::reader::Section;

settings! {
    /// The rays of a lidar.
    pub struct ScanPattern {
        /// Beams, the highest first.
        channels: u32 = 128, within(1..=1024), yaml("lidar_channels");
        /// Azimuth steps per beam and frame.
        columns: u32 = 2048, within(1..=65_536);
        /// Highest beam above the horizon.
        upper_rad: f64 = deg(10.67), named("upper_fov_deg"), degrees(-90.0..=90.0), yaml_in("lidar_properties", "upper_fov");
        /// Lowest beam above the horizon.
        lower_rad: f64 = deg(-30.67), named("lower_fov_deg"), degrees(-90.0..=90.0), yaml_in("lidar_properties", "lower_fov");
        /// Horizontal field of view, centred ahead.
        horizontal_fov_rad: f64 = deg(360.0), named("horizontal_fov_deg"), degrees(1.0..=360.0),
            yaml_in("lidar_properties", "horizontal_fov");
    }
    rule possible;
}

fn possible(s: &Section<'_>, scan: &ScanPattern) {
    if scan.lower_rad > scan.upper_rad {
        let keys = ["lower_fov_deg", "upper_fov_deg"];
        s.fault_at_any(&keys, format!("`{}` is above upper_fov_deg", s.path_of("lower_fov_deg")));
    }
    if let Some(problem) = scan.problem() {
        s.fault_at_any(&["columns", "channels"], format!("`{}`: {problem}", s.path()));
    }
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

settings! {
    /// A revolution that takes the whole frame: its last column is fired at the frame's time, the first one a
    /// period before.
    pub struct RollingScan {
        /// With `rolling`: moments at which rays leave, at most one a column; neighbouring columns share one,
        /// the middle of theirs, so that rays leave at most `period / (2 slices)` from when a steadily
        /// turning lidar would send them.
        slices: u32 = 64, named("rolling_slices"), within(1..=65_536);
        /// With `rolling`: points are given from where the sensor is at the frame's time (its motion taken
        /// out), not from where it was when the ray left.
        compensated: bool = true, named("rolling_compensated");
    }
}

/// Which echoes of a beam are returned; one that is several of these is returned once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Returned {
    /// The nearest.
    pub first: bool,
    /// The one of the greatest power.
    pub strongest: bool,
    /// The farthest.
    pub last: bool,
}

settings! {
    /// A beam.
    pub struct BeamSpec {
        /// Rays a beam: 1 along its axis, or 7 over its cross-section, whose surfaces 1 m apart make echoes
        /// of their own.
        rays: u32 = 1, named("beam_rays"), within(1..=7);
        /// Full angle of a beam with `beam_rays` 7 or `weather`.
        divergence_rad: f64 = 0.003, named("beam_divergence_mrad"), milli(0.01..=50.0, "mrad");
        /// Which echoes of a beam are returned: `first`, `strongest`, `last`; one that is several of these
        /// comes once.
        returned: Returned = Returned { first: false, strongest: true, last: false }, named("returns"), by(returned);
    }
    rule of_some_rays;
}

fn of_some_rays(s: &Section<'_>, beam: &BeamSpec) {
    let rays = beam.rays;
    if !BeamSpec::RAYS.contains(&rays) {
        s.fault_at("beam_rays", format!("`{}` is {rays}, expected 1 or 7", s.path_of("beam_rays")));
    }
}

fn returned(s: &Section<'_>, name: &Name, usual: Returned) -> Returned {
    const WORDS: [&str; 3] = ["first", "strongest", "last"];
    let usually = [usual.first, usual.strongest, usual.last];
    let default: Vec<String> =
        WORDS.iter().zip(usually).filter(|(_, is_on)| *is_on).map(|(word, _)| (*word).to_owned()).collect();
    let words = s.texts(name.key, &default, name.doc);
    let path = s.path_of(name.key);
    if let Some(word) = words.iter().find(|word| !WORDS.contains(&word.as_str())) {
        s.fault_at(name.key, format!("`{path}`: `{word}` is none of first, strongest, last"));
        return usual;
    } else if words.is_empty() {
        s.fault_at(name.key, format!("`{path}` is empty: the lidar would return nothing"));
        return usual;
    }
    let [first, strongest, last] = WORDS.map(|wanted| words.iter().any(|word| word == wanted));
    Returned { first, strongest, last }
}

impl BeamSpec {
    /// Numbers of rays that a beam can have.
    pub const RAYS: [u32; 2] = [1, 7];
}

settings! {
    /// A lidar that rain and fog weaken and send light back to.
    pub struct WeatherSpec {
        /// With `weather`: reflectance of the surface, met straight on in clear air at `range_m`, whose echo
        /// is just detected.
        detected: f64 = 0.1, named("weather_detected"), within(0.001..=1.0);
    }
}

settings! {
    /// A lidar. Its defaults are those of the published vehicle lidar.
    pub struct LidarSpec {
        /// `LIDAR` or `SEG-LIDAR`.
        name: String = "LIDAR".into(), apart();
        /// Where it sits.
        mount: Mount = Mount::upright([0.0, 0.0, 1.8], 0.0), flat();
        /// Its rays.
        scan: ScanPattern = ScanPattern::default(), flat();
        /// Reach, m.
        range_m: f64 = 120.0, within(1.0..=1000.0), yaml("lidar_range");
        /// Share of rays that return nothing (semantic 0).
        dropoff_rate: f64 = 0.14, share(), yaml_in("lidar_properties", "dropoff_general_rate");
        /// Returns stronger than this are never dropped for weakness.
        dropoff_intensity_limit: f64 = 0.8, share(), yaml_in("lidar_properties", "dropoff_intensity_limit");
        /// Chance that a return of no intensity is dropped (semantic 0).
        dropoff_zero_intensity: f64 = 0.4, share(), yaml_in("lidar_properties", "dropoff_zero_intensity");
        /// Loss of intensity, per m: intensity is `exp(-attenuation * distance)` times the surface's
        /// reflectance; the drop rule uses the bare exponential.
        attenuation_per_m: f64 = 0.004, within(0.0..=1.0), yaml_in("lidar_properties", "atmosphere_attenuation_rate");
        /// Standard deviation of the distance, m (semantic 0).
        noise_m: f64 = 0.03, within(0.0..=10.0), yaml_in("lidar_properties", "noise_stddev");
        /// A semantic lidar: no drops, no noise, no weather.
        semantic: bool = false, apart();
        /// It sweeps at frames 0, n, 2 n, ...
        every_n_frames: u32 = 1, within(1..=1000);
        /// Rays leave over the frame, the last column at the frame's time, while agent and objects move; else
        /// all at once.
        rolling: Option<RollingScan> = None, switched();
        /// The beams.
        beam: BeamSpec = BeamSpec::default(), flat();
        /// Rain and fog of the scene weaken echoes and send light back themselves, and wet ground sends back
        /// less; not for the semantic lidar.
        weather: Option<WeatherSpec> = None, switched();
        /// Light passes the panes of vehicles within 50 m of the agent; returns from behind them are of a
        /// kind of their own.
        glass: bool = false;
    }
    rule consistent;
}

fn consistent(s: &Section<'_>, lidar: &LidarSpec) {
    let columns = lidar.scan.columns;
    if let Some(RollingScan { slices, .. }) = lidar.rolling
        && slices > columns
    {
        let message = format!("`{}` is {slices}, there are {columns} columns", s.path_of("rolling_slices"));
        s.fault_at_any(&["rolling_slices", "columns"], message);
    }
    let (beam, has_echoes) = (&lidar.beam, lidar.weather.is_some() || lidar.glass);
    if beam.returned != BeamSpec::default().returned && beam.rays == 1 && !has_echoes {
        let path = s.path_of("returns");
        let message =
            format!("`{path}`: a beam has one echo; set beam_rays = 7, weather = true or glass = true, too");
        s.fault_at("returns", message);
    }
}

impl LidarSpec {
    /// The published vehicle lidar.
    #[must_use]
    pub fn vehicle() -> Self {
        Self::default()
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

    /// Whether a beam can have several echoes, or some that are no surface's or from behind glass: then the
    /// table says of each return which it is.
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
