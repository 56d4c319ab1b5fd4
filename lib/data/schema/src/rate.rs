//! Sensors and labels that are made at a part of the frames: at frames 0, n, 2 n, ...
//!
//! A sensor's table says its n in its metadata ([`crate::calibration::Calibration::every_n_frames`]), an
//! archive of arrays in its comment, the annotation in `log/scene.json`. Frames between have neither rows nor
//! members. An n of 0 counts as 1.

/// Whether a frame is one of every `every_n_frames`.
#[must_use]
pub fn is_due(frame: u32, every_n_frames: u32) -> bool {
    frame.is_multiple_of(every_n_frames.max(1))
}

/// Those of the frames `0..frames`.
pub fn due(frames: u32, every_n_frames: u32) -> impl Iterator<Item = u32> {
    (0..frames).step_by(every_n_frames.max(1) as usize)
}

/// How many of the frames `0..frames` they are.
#[must_use]
pub fn count(frames: u32, every_n_frames: u32) -> u32 {
    frames.div_ceil(every_n_frames.max(1))
}

/// One of every frame: what is said where nothing is.
#[must_use]
pub fn every_frame() -> u32 {
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_frame_is_always_due() {
        assert_eq!(due(7, 3).collect::<Vec<_>>(), [0, 3, 6]);
        assert_eq!([0, 1, 3, 4, 6, 7].map(|frames| count(frames, 3)), [0, 1, 1, 2, 2, 3]);
        for every in [0, 1, 2, 5] {
            assert!((0..20).filter(|f| is_due(*f, every)).eq(due(20, every)));
            assert_eq!(due(20, every).count() as u32, count(20, every));
        }
    }
}
