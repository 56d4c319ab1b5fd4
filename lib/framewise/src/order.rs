//! Frames computed in parallel, handed over in order.

use pipeline::{Progress, StageError};
use rayon::prelude::*;

/// Computes `frame` for `0..frames` on all threads and hands the results to `take` in frame order. At most as
/// many results as there are threads are held at a time, so memory stays bounded; the result does not depend on
/// the number of threads.
///
/// # Errors
/// The first error in frame order, from either function, or a wish to stop.
pub fn in_frame_order<T: Send>(
    frames: u32,
    progress: &Progress,
    frame: impl Fn(u32) -> Result<T, StageError> + Sync,
    mut take: impl FnMut(u32, T) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let batch = rayon::current_num_threads().max(1) as u32;
    let mut start = 0;
    while start < frames {
        let end = frames.min(start + batch);
        let results: Vec<Result<T, StageError>> = (start..end).into_par_iter().map(&frame).collect();
        for (number, result) in (start..end).zip(results) {
            take(number, result?)?;
            progress.advance(1)?;
        }
        start = end;
    }
    Ok(())
}
