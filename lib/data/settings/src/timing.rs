//! How long scenes last.

use crate::key::settings;
use crate::reader::Section;

settings! {
    /// Warm-up and durations. The frame period is fixed: [`schema::FRAME_PERIOD_S`].
    pub struct TimingSettings {
        /// Simulated before frame 0, s.
        warmup_s: f64 = 2.0, within(0.0..=600.0), yaml("warmup_duration");
        /// Shortest scene, s.
        min_duration_s: f64 = 8.0, within(1.0..=3600.0), yaml("min_scene_duration");
        /// Longest scene, s.
        max_duration_s: f64 = 32.0, within(1.0..=3600.0), yaml("max_scene_duration");
    }
    rule in_order;
}

fn in_order(s: &Section<'_>, read: &TimingSettings) {
    if read.min_duration_s > read.max_duration_s {
        s.fault_at("min_duration_s", "`timing.min_duration_s` is more than `timing.max_duration_s`".into());
    }
}
