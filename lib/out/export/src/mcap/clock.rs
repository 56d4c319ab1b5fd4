//! Time in files: frame k is k periods after a fixed moment, whenever and wherever the scene was made.

use schema::FRAME_PERIOD_S;

use super::messages::{Duration, Timestamp};

/// Seconds since 1970 at frame 0: 2001-09-09 01:46:40 UTC. Not 0, which stands for "whenever" in some
/// readers.
pub(crate) const EPOCH_S: u32 = 1_000_000_000;
const NANOS: u64 = 1_000_000_000;

fn period_ns() -> u64 {
    (FRAME_PERIOD_S * NANOS as f64).round() as u64
}

/// Time of a frame, nanoseconds since 1970.
pub(crate) fn time_ns(frame: u32) -> u64 {
    u64::from(EPOCH_S) * NANOS + u64::from(frame) * period_ns()
}

impl Timestamp {
    /// Time of a frame.
    pub(crate) fn at(frame: u32) -> Self {
        let time = time_ns(frame);
        Self { seconds: (time / NANOS) as i64, nanos: (time % NANOS) as i32 }
    }
}

impl Duration {
    /// So many frames.
    pub(crate) fn of_frames(frames: u32) -> Self {
        let time = u64::from(frames) * period_ns();
        Self { seconds: (time / NANOS) as i64, nanos: (time % NANOS) as i32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_fifty_milliseconds_apart() {
        assert_eq!(time_ns(0), 1_000_000_000_000_000_000);
        assert_eq!(Timestamp::at(21), Timestamp { seconds: 1_000_000_001, nanos: 50_000_000 });
        assert_eq!(Duration::of_frames(3), Duration { seconds: 0, nanos: 150_000_000 });
    }
}
