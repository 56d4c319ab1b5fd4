//! Frames computed in parallel, handed over in order.

use pipeline::{Progress, StageError};
use rayon::prelude::*;

/// Computes `frame` for the frames of `due` (ascending, of `0..frames`) on all threads and hands the results to `take` in
/// their order. At most as many results as there are threads are held at a time, so memory stays bounded; the result does not
/// depend on the number of threads. Frames that are passed over count as done.
///
/// # Errors
/// The first error in frame order, from either function, or a wish to stop.
pub fn in_frame_order<T: Send>(
    (due, frames): (&[u32], u32),
    progress: &Progress,
    frame: impl Fn(u32) -> Result<T, StageError> + Sync,
    mut take: impl FnMut(u32, T) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let mut done = 0;
    for batch in due.chunks(rayon::current_num_threads().max(1)) {
        let results: Vec<Result<T, StageError>> = batch.par_iter().map(|&number| frame(number)).collect();
        for (&number, result) in batch.iter().zip(results) {
            take(number, result?)?;
            progress.advance(u64::from(number + 1).saturating_sub(done))?;
            done = u64::from(number + 1);
        }
    }
    progress.advance(u64::from(frames).saturating_sub(done))
}
