//! Frames computed in parallel, handed over in order.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, TryRecvError};

use pipeline::{Progress, StageError};
use rayon::Yield;

/// Frames in hand beyond those that threads work on: one may wait to be taken while others are begun.
const WAITING: usize = 1;

/// Frames that belong together, as those of an agent.
#[derive(Debug)]
pub struct Part<S, W> {
    /// Those that are computed, ascending.
    pub due: Vec<u32>,
    /// What computing them needs; any thread sees it.
    pub seen: S,
    /// What takes them; it stays on the calling thread.
    pub writer: W,
}

/// What is done with the results of frames.
pub trait Taking<W, T> {
    /// Takes the result of a part's next frame.
    ///
    /// # Errors
    /// It cannot be written.
    fn take(&mut self, writer: &mut W, frame: u32, result: T) -> Result<(), StageError>;

    /// Ends a part, all of whose frames were taken.
    ///
    /// # Errors
    /// It cannot be written.
    fn finish(&mut self, writer: W) -> Result<(), StageError>;
}

/// What comes next, in order.
enum Step<T> {
    Frame(u32, Receiver<Result<T, StageError>>),
    /// The part is over.
    End,
    /// The next part could not be opened.
    Broken(StageError),
}

/// Computes `frame` for the due frames of some parts on all threads and hands the results to `taking` in their order, part by
/// part, on the calling thread, while further frames are computed: those of the next part, too, so that no thread waits for
/// the end of a part to be written. A part is taken from `parts` when its first frame is begun. At most one frame more than there
/// are threads is in hand at a time, so memory stays bounded; the result does not depend on the number of threads.
/// Each part counts for `frames` in `progress`.
///
/// # Errors
/// The first error in order, of any of the functions, or a wish to stop.
///
/// # Panics
/// As `frame` does.
pub fn in_turn<S: Send + Sync, W, T: Send>(
    parts: impl IntoIterator<Item = Result<Part<S, W>, StageError>>,
    frames: u32,
    progress: &Progress,
    frame: impl Fn(&S, u32) -> Result<T, StageError> + Sync,
    mut taking: impl Taking<W, T>,
) -> Result<(), StageError> {
    let most = rayon::current_num_threads() + WAITING;
    let is_over = AtomicBool::new(false);
    let mut parts = parts.into_iter();
    rayon::in_place_scope(|scope| {
        let (mut coming, mut writers) = (VecDeque::new(), VecDeque::new());
        let mut open: Option<(Arc<S>, std::vec::IntoIter<u32>)> = None;
        let (mut in_hand, mut done, mut is_last) = (0, 0, false);
        let mut take_all = || {
            loop {
                while in_hand < most && !is_last {
                    let Some((seen, due)) = &mut open else {
                        match parts.next() {
                            None => is_last = true,
                            Some(Err(error)) => {
                                coming.push_back(Step::Broken(error));
                                is_last = true;
                            }
                            Some(Ok(Part { due, seen, writer })) => {
                                writers.push_back(writer);
                                open = Some((Arc::new(seen), due.into_iter()));
                            }
                        }
                        continue;
                    };
                    let Some(number) = due.next() else {
                        coming.push_back(Step::End);
                        open = None;
                        continue;
                    };
                    let (give, result) = mpsc::channel();
                    let (seen, frame, is_over) = (Arc::clone(seen), &frame, &is_over);
                    scope.spawn(move |_| {
                        if !is_over.load(Ordering::Relaxed) {
                            // Who no longer listens has met an error.
                            let _ = give.send(frame(&seen, number));
                        }
                    });
                    coming.push_back(Step::Frame(number, result));
                    in_hand += 1;
                }
                match coming.pop_front() {
                    None => return Ok(()),
                    Some(Step::Broken(error)) => return Err(error),
                    Some(Step::Frame(number, result)) => {
                        // Nothing comes of a frame that panicked; the scope passes that on.
                        let Some(result) = await_result(&result) else { return Ok(()) };
                        in_hand -= 1;
                        let Some(writer) = writers.front_mut() else { return Ok(()) };
                        taking.take(writer, number, result?)?;
                        progress.advance(u64::from(number + 1).saturating_sub(done))?;
                        done = u64::from(number + 1);
                    }
                    Some(Step::End) => {
                        let Some(writer) = writers.pop_front() else { return Ok(()) };
                        taking.finish(writer)?;
                        progress.advance(u64::from(frames).saturating_sub(done))?;
                        done = 0;
                    }
                }
            }
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
