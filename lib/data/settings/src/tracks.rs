//! Objects followed over a scene.

use schema::FRAME_PERIOD_S;

use crate::key::settings;

settings! {
    /// Windows of the past and the future of every object that may move, as forecasting learns from.
    pub struct TrackSettings {
        /// Write windows of the past and the future of what may move, for forecasting.
        windows: bool = true;
        /// How far a window reaches back, s.
        past_s: f64 = 2.0, within(0.0..=60.0);
        /// How far a window reaches ahead, s.
        future_s: f64 = 6.0, within(0.0..=60.0);
        /// Time between two places of a window, s.
        step_s: f64 = 0.5, within(FRAME_PERIOD_S..=60.0);
        /// Time between two windows of an object, s.
        every_s: f64 = 0.5, within(FRAME_PERIOD_S..=60.0);
    }
}

/// A time as whole frames, at least one.
fn frames(time_s: f64) -> u32 {
    (time_s / FRAME_PERIOD_S).round().max(1.0) as u32
}

impl TrackSettings {
    /// Frames between two places of a window.
    #[must_use]
    pub fn step_frames(&self) -> u32 {
        frames(self.step_s)
    }

    /// Frames between two windows of an object.
    #[must_use]
    pub fn every_frames(&self) -> u32 {
        frames(self.every_s)
    }

    /// Places before and after the present one.
    #[must_use]
    pub fn places(&self) -> [u32; 2] {
        [self.past_s, self.future_s].map(|time_s| (time_s / self.step_s + 1e-9).floor() as u32)
    }
}
