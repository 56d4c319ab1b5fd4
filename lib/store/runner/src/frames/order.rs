//! Frames computed in parallel, handed over in order.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::thread;

use rayon::{Scope, Yield};
use store::{Aside, aside};

use crate::{Progress, StageError};

/// Frames in hand beyond those that threads work on: one is being taken and one may wait for that while
/// others are begun.
const WAITING: usize = 2;

/// Parts opened and not yet ended, beyond the one whose frames are being begun.
const MOST_PARTS: usize = 2;

/// Frames that belong together, as those of an agent.
#[derive(Debug)]
pub struct FrameGroup<S, W> {
    /// Those that are computed, ascending.
    pub due: Vec<u32>,
    /// What computing them needs; any thread sees it.
    pub seen: S,
    /// What takes their results.
    pub writer: W,
}

/// Takes the results of a part's frames.
pub trait Writer<T> {
    /// Takes the result of the next frame.
    ///
    /// # Errors
    /// It cannot be written.
    fn take(&mut self, frame: u32, result: T) -> Result<(), StageError>;

    /// Ends the part, all of whose frames were taken.
    ///
    /// # Errors
    /// It cannot be written.
    fn finish(self) -> Result<(), StageError>;
}

/// What comes next, in order.
enum Step<T> {
    Frame(u32, Receiver<Result<T, StageError>>),
    /// The part is over.
    End,
    /// The next part could not be opened.
    Broken(StageError),
}

/// Computes `frame` for the due frames of some parts on all threads and hands the results to the parts'
/// writers in their order, part by part, on the calling thread, while further frames are computed. Each part
/// is ended on a thread of its own while the next one's frames are computed and taken: no thread waits until
/// its files are synced. A part is taken from `parts` when its first frame is begun. At most two frames more
/// than there are threads are in hand at a time, so memory stays bounded; the result does not depend on the
/// number of threads. Each part counts for `frames` in `progress`.
///
/// # Errors
/// The first error in order, of any of the functions, or a wish to stop.
///
/// # Panics
/// As the functions do.
pub fn in_turn<S: Send + Sync, W: Writer<T> + Send, T: Send>(
    parts: impl IntoIterator<Item = Result<FrameGroup<S, W>, StageError>>,
    frames: u32,
    progress: &Progress,
    frame: impl Fn(&S, u32) -> Result<T, StageError> + Sync,
) -> Result<(), StageError> {
    let is_over = AtomicBool::new(false);
    thread::scope(|threads| {
        rayon::in_place_scope(|pool| {
            let mut coming = Coming::new(parts.into_iter(), &frame, &is_over);
            let (mut ending, mut done) = (None, 0);
            let mut take_all = || {
                while let Some(step) = coming.next(pool) {
                    match step {
                        Step::Broken(error) => return Err(error),
                        Step::Frame(number, result) => {
                            // Nothing comes of a frame that panicked; the scope passes that on.
                            let Some(result) = await_result(&result) else { break };
                            coming.in_hand -= 1;
                            let Some(writer) = coming.writers.front_mut() else { break };
                            writer.take(number, result?)?;
                            progress.advance(u64::from(number + 1).saturating_sub(done))?;
                            done = u64::from(number + 1);
                        }
                        Step::End => {
                            let Some(writer) = coming.writers.pop_front() else { break };
                            ended(ending.take())?;
                            ending = Some(aside(threads, move || writer.finish()));
                            progress.advance(u64::from(frames).saturating_sub(done))?;
                            done = 0;
                        }
                    }
                }
                Ok(())
            };
            let outcome = take_all();
            is_over.store(true, Ordering::Relaxed);
            // An error of a part comes before those of the next ones.
            ended(ending.take()).and(outcome)
        })
    })
}

/// Waits for a part that is being ended.
fn ended(ending: Option<Aside<'_, Result<(), StageError>>>) -> Result<(), StageError> {
    ending.map_or(Ok(()), Aside::join)
}

/// The steps that are begun and not yet taken.
struct Coming<'a, P, S, W, T, F> {
    parts: P,
    frame: &'a F,
    is_over: &'a AtomicBool,
    steps: VecDeque<Step<T>>,
    /// Those of parts whose frames are begun and not all taken.
    writers: VecDeque<W>,
    /// The part whose frames are being begun.
    open: Option<(Arc<S>, std::vec::IntoIter<u32>)>,
    /// No part follows.
    is_last: bool,
    /// Frames begun and not yet taken.
    in_hand: usize,
    most: usize,
}

impl<'a, P, S, W, T, F> Coming<'a, P, S, W, T, F>
where
    P: Iterator<Item = Result<FrameGroup<S, W>, StageError>>,
    S: Send + Sync + 'a,
    T: Send + 'a,
    F: Fn(&S, u32) -> Result<T, StageError> + Sync,
{
    fn new(parts: P, frame: &'a F, is_over: &'a AtomicBool) -> Self {
        let most = rayon::current_num_threads() + WAITING;
        let (steps, writers) = (VecDeque::new(), VecDeque::new());
        Self { parts, frame, is_over, steps, writers, open: None, is_last: false, in_hand: 0, most }
    }

    /// Begins what may be begun, and gives the next step.
    fn next<'s>(&mut self, pool: &Scope<'s>) -> Option<Step<T>>
    where
        'a: 's,
    {
        while self.in_hand < self.most && !self.is_last {
            match &mut self.open {
                // Parts without frames are not all opened at once.
                None if self.writers.len() > MOST_PARTS => break,
                None => self.open_part(),
                Some((seen, due)) => match due.next() {
                    Some(number) => {
                        let (give, result) = mpsc::channel();
                        let (seen, frame, is_over) = (Arc::clone(seen), self.frame, self.is_over);
                        pool.spawn(move |_| {
                            if !is_over.load(Ordering::Relaxed) {
                                // A receiver that no longer listens has met an error.
                                let _ = give.send(frame(&seen, number));
                            }
                        });
                        self.steps.push_back(Step::Frame(number, result));
                        self.in_hand += 1;
                    }
                    None => {
                        self.steps.push_back(Step::End);
                        self.open = None;
                    }
                },
            }
        }
        self.steps.pop_front()
    }

    fn open_part(&mut self) {
        match self.parts.next() {
            Some(Ok(FrameGroup { due, seen, writer })) => {
                self.writers.push_back(writer);
                self.open = Some((Arc::new(seen), due.into_iter()));
            }
            Some(Err(error)) => {
                self.steps.push_back(Step::Broken(error));
                self.is_last = true;
            }
            None => self.is_last = true,
        }
    }
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
