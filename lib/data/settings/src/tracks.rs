//! Objects followed over a scene.

use serde::Serialize;

use schema::FRAME_PERIOD_S;

/// Windows of the past and the future of every object that may move, as forecasting learns from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackSettings {
    /// Write windows.
    pub windows: bool,
    /// How far windows reach back, seconds (2).
    pub past_s: f64,
    /// How far windows reach ahead, seconds (6).
    pub future_s: f64,
    /// Time between two places of a window, seconds (0.5).
    pub step_s: f64,
    /// Time between two windows of an object, seconds (0.5).
    pub every_s: f64,
}

impl Default for TrackSettings {
    fn default() -> Self {
        Self { windows: true, past_s: 2.0, future_s: 6.0, step_s: 0.5, every_s: 0.5 }
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
