//! How long scenes last.

use serde::Serialize;

/// Warm-up and durations. The frame period is fixed: [`schema::FRAME_PERIOD_S`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimingSettings {
    /// Simulated before the first frame, seconds (2).
    pub warmup_s: f64,
    /// Shortest scene, seconds (8).
    pub min_duration_s: f64,
    /// Longest scene, seconds (32).
    pub max_duration_s: f64,
}

impl Default for TimingSettings {
    fn default() -> Self {
        Self { warmup_s: 2.0, min_duration_s: 8.0, max_duration_s: 32.0 }
    }
}
