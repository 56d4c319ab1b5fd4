//! Rows of a table that is sorted by frame.

use std::ops::Range;

use schema::table::Framed;

/// Where in a table the rows of each frame are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameRanges {
    first: i64,
    ranges: Vec<Range<usize>>,
}

impl FrameRanges {
    /// Of rows that are sorted by frame, for `frames` frames from `first` on. Rows of other frames are left
    /// out.
    ///
    /// # Errors
    /// The number of the first row that stands after one of a later frame.
    pub fn new<R: Framed>(rows: &[R], first: i64, frames: u32) -> Result<Self, usize> {
        if let Some(i) = rows.windows(2).position(|pair| pair[1].frame() < pair[0].frame()) {
            return Err(i + 1);
        }
        let mut ranges = Vec::with_capacity(frames as usize);
        let mut start = rows.partition_point(|row| row.frame() < first);
        for frame in first..first + i64::from(frames) {
            let end = start + rows[start..].iter().take_while(|row| row.frame() == frame).count();
            ranges.push(start..end);
            start = end;
        }
        Ok(Self { first, ranges })
    }

    /// Rows of a frame; none for a frame that is not among them.
    #[must_use]
    pub fn of(&self, frame: i64) -> Range<usize> {
        let position = usize::try_from(frame - self.first).ok();
        position.and_then(|i| self.ranges.get(i)).cloned().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct At(i64);

    impl Framed for At {
        fn frame(&self) -> i64 {
            self.0
        }
    }

    #[test]
    fn each_frame_has_its_rows() {
        let rows = [-1, -1, 0, 2, 2, 2, 5].map(At);
        let ranges = FrameRanges::new(&rows, -1, 4).expect("sorted");
        assert_eq!([-1, 0, 1, 2].map(|frame| ranges.of(frame)), [0..2, 2..3, 3..3, 3..6]);
        assert!(ranges.of(-2).is_empty() && ranges.of(3).is_empty() && ranges.of(5).is_empty());
        assert_eq!(FrameRanges::new(&rows, 2, 4).expect("sorted").of(5), 6..7);
    }

    #[test]
    fn unsorted_rows_are_refused() {
        assert_eq!(FrameRanges::new(&[0, 1, 0].map(At), 0, 2), Err(2));
    }
}
