//! Frames computed in parallel, handed over in order.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, TryRecvError};

use pipeline::{Progress, StageError};
use rayon::Yield;

/// Frames in hand beyond those that threads work on: one may wait to be taken while others are begun.
const WAITING: usize = 1;

/// Computes `frame` for the frames of `due` (ascending, of `0..frames`) on all threads and hands the results to `take` in
/// their order, on the calling thread, while further frames are computed. At most one frame more than there are threads is
/// in hand at a time, so memory stays bounded; the result does not depend on the number of threads. Frames that are passed
/// over count as done.
///
/// # Errors
/// The first error in frame order, from either function, or a wish to stop.
///
/// # Panics
/// As `frame` does.
pub fn in_frame_order<T: Send>(
    (due, frames): (&[u32], u32),
    progress: &Progress,
    frame: impl Fn(u32) -> Result<T, StageError> + Sync,
    mut take: impl FnMut(u32, T) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let most = rayon::current_num_threads() + WAITING;
    let is_over = AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        let mut coming = VecDeque::with_capacity(most);
        let mut numbers = due.iter();
        let mut done = 0;
        let mut take_all = || {
            loop {
                while coming.len() < most
                    && let Some(&number) = numbers.next()
                {
                    let (give, result) = mpsc::channel();
                    let (frame, is_over) = (&frame, &is_over);
                    scope.spawn(move |_| {
                        if !is_over.load(Ordering::Relaxed) {
                            // Who no longer listens has met an error.
                            let _ = give.send(frame(number));
                        }
                    });
                    coming.push_back((number, result));
                }
                let Some((number, result)) = coming.pop_front() else { break };
                // Nothing comes of a frame that panicked; the scope passes that on.
                let Some(result) = await_result(&result) else { break };
                take(number, result?)?;
                progress.advance(u64::from(number + 1).saturating_sub(done))?;
                done = u64::from(number + 1);
            }
            progress.advance(u64::from(frames).saturating_sub(done))
        };
        let outcome = take_all();
        is_over.store(true, Ordering::Relaxed);
        outcome
    })
}

/// Waits for what another thread sends; one of the pool's own threads works on meanwhile.
fn await_result<T>(result: &Receiver<T>) -> Option<T> {
    loop {
        match result.try_recv() {
            Ok(value) => return Some(value),
            Err(TryRecvError::Disconnected) => return None,
            Err(TryRecvError::Empty) => {}
        }
        match rayon::yield_now() {
            None => return result.recv().ok(),
            Some(Yield::Idle) => std::thread::yield_now(),
            Some(Yield::Executed) => {}
        }
    }
}
