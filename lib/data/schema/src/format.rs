//! What every store has in common.

/// Version of the store's layout. A reader refuses a store with another number.
pub const FORMAT_VERSION: u32 = 1;

/// Seconds between frames: frame `k` is at `k * FRAME_PERIOD_S` after warm-up, for every agent.
pub const FRAME_PERIOD_S: f64 = 0.05;
