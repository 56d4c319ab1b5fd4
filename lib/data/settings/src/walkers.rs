//! Pedestrians.

use serde::Serialize;

/// Pedestrians.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WalkerSettings {
    /// Walkers per scene; drawn from 0..=`max_count` when absent.
    pub count: Option<u32>,
    /// Most walkers when drawn (480).
    pub max_count: u32,
    /// Slowest walking speed, m/s (0.8).
    pub min_speed_mps: f64,
    /// Share of walkers who may cross roads anywhere, 0 to 1; drawn per scene from Beta(2.4, 1.6) when absent.
    pub cross_factor: Option<f64>,
    /// Share of walkers who use a wheelchair, 0 to 1 (0.04).
    pub wheelchair: f64,
    /// Share of walkers who walk in groups of two or three, 0 to 1 (0.3).
    pub in_groups: f64,
    /// Share of the other walkers who stand and wait when the scene begins, 0 to 1 (0.1): at crossings, benches (where most sit), buildings. Twice
    /// that share of groups stands and talks.
    pub waiting: f64,
}

impl Default for WalkerSettings {
    fn default() -> Self {
        Self {
            count: None,
            max_count: 480,
            min_speed_mps: 0.8,
            cross_factor: None,
            wheelchair: 0.04,
            in_groups: 0.3,
            waiting: 0.1,
        }
    }
}
