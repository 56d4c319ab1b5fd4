//! Pedestrians.

use crate::key::settings;

settings! {
    /// Pedestrians.
    pub struct WalkerSettings {
        /// Walkers in a scene.
        count: Option<u32> = None, within(0..=20_000), or("drawn from 0 to max_count"), yaml("n_walkers");
        /// Most walkers when drawn.
        max_count: u32 = 480, within(0..=20_000), yaml("max_n_walkers");
        /// Slowest walking speed, m/s.
        min_speed_mps: f64 = 0.8, within(0.1..=5.0), yaml("walker_speed_min");
        /// Share of walkers who may cross roads anywhere.
        cross_factor: Option<f64> = None, within(0.0..=1.0), or("drawn per scene, Beta(2.4, 1.6)"), yaml("walker_cross_factor");
        /// Share of walkers who use a wheelchair.
        wheelchair: f64 = 0.04, share(), yaml_percent("wheelchair_use_percentage");
        /// Share of walkers who walk in groups of two or three.
        in_groups: f64 = 0.3, share();
        /// Share of the others who stand and wait when the scene begins: at crossings, benches (where most
        /// sit), buildings; twice that share of groups stands and talks.
        waiting: f64 = 0.1, share();
    }
}
