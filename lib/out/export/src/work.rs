//! Units in pieces on all threads, in order.

use std::collections::BTreeMap;
use std::mem;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::Builder;

use crate::disk::write_error;
use crate::place::Finished;
use crate::unit::{ProgressWatch, UnitName};
use crate::{Destination, ExportError, UnitFiles};

/// A unit that is to be made, in pieces.
#[derive(Clone, Debug)]
pub(crate) struct Job {
    pub(crate) unit: UnitName,
    /// Digest of what it is made from.
    pub(crate) identity: String,
    /// At least one.
    pub(crate) pieces: u32,
}

/// Writes a piece of a unit, and says what it leaves for the end.
pub(crate) type Write<'a> = dyn Fn(&Job, u32, &mut UnitFiles<'_>) -> Result<Vec<u8>, ExportError> + Sync + 'a;

/// A unit, and what of it is made.
struct InHand<'a> {
    job: &'a Job,
    state: Mutex<State<'a>>,
}

#[derive(Default)]
struct State<'a> {
    /// Of the whole unit; none before its first piece.
    files: Option<UnitFiles<'a>>,
    /// What finished pieces left.
    fragments: BTreeMap<u32, Vec<u8>>,
    /// The first error in the order of pieces.
    failed: Option<(u32, ExportError)>,
}

impl<'a> State<'a> {
    /// The files of a piece.
    fn begin(
        &mut self,
        unit: UnitName,
        (place, watch): (&'a Destination, &'a dyn ProgressWatch),
    ) -> Result<UnitFiles<'a>, ExportError> {
        if watch.advance(0) {
            return Err(ExportError::Stopped);
        }
        let files = match self.files.take() {
            Some(files) => files,
            None => place.begin(unit, watch)?,
        };
        Ok(self.files.insert(files).of_piece())
    }

    fn fail(&mut self, piece: u32, error: ExportError) {
        if self.failed.as_ref().is_none_or(|(earlier, _)| piece < *earlier) {
            self.failed = Some((piece, error));
        }
    }
}

impl<'a> InHand<'a> {
    fn state(&self) -> MutexGuard<'_, State<'a>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes a piece; after the last one that was missing, the whole unit is handed over.
    fn make(
        &self,
        piece: u32,
        write: &Write<'_>,
        to: (&'a Destination, &'a dyn ProgressWatch),
    ) -> Option<Finished<'a>> {
        let begun = {
            let mut state = self.state();
            if state.failed.is_some() {
                return None;
            }
            state.begin(self.job.unit, to)
        };
        let made = begun.and_then(|mut files| Ok((write(self.job, piece, &mut files)?, files)));
        let mut state = self.state();
        let whole = state.files.as_mut();
        let kept = made.and_then(|(fragment, files)| {
            whole.map_or(Ok(()), |whole| whole.take(files))?;
            Ok(fragment)
        });
        match kept {
            Ok(fragment) => state.fragments.insert(piece, fragment),
            Err(error) => {
                state.fail(piece, error);
                return None;
            }
        };
        if state.fragments.len() < self.job.pieces as usize {
            return None;
        }
        let fragment = mem::take(&mut state.fragments).into_values().flatten().collect();
        let files = state.files.take()?;
        Some(Finished { unit: self.job.unit, identity: self.job.identity.clone(), files, fragment })
    }
}

/// Makes units on all threads of the pool that it is called in, piece by piece in their order, or (where a
/// piece keeps all threads busy itself) one after another. Those that fail do not keep others from being
/// made.
///
/// Units end on a thread of their own, as that waits for the disk and needs no core.
///
/// # Errors
/// The first error in the order of units.
pub(crate) fn make<'a>(
    jobs: &'a [Job],
    in_turn: bool,
    (place, watch): (&'a Destination, &'a dyn ProgressWatch),
    write: &Write<'_>,
) -> Result<(), ExportError> {
    let units: Vec<InHand<'a>> = jobs.iter().map(|job| InHand { job, state: Mutex::default() }).collect();
    let pieces = units.iter().flat_map(|unit| (0..unit.job.pieces).map(move |piece| (unit, piece)));
    let tasks: Vec<(&InHand<'a>, u32)> = pieces.collect();
    let next = AtomicUsize::new(0);
    let (send, receive) = mpsc::channel();
    // Each thread takes the next piece: so few units are in hand at a time.
    let work = |ready: &Sender<Finished<'a>>| {
        while let Some((unit, piece)) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) {
            // Nobody listens any more where units could not be ended.
            if unit.make(*piece, write, (place, watch)).is_some_and(|finished| ready.send(finished).is_err())
            {
                return;
            }
        }
    };
    let ended = std::thread::scope(|scope| {
        let ender = Builder::new().spawn_scoped(scope, move || end_all(place, &receive));
        let ender = ender.map_err(|e| write_error(place.root(), "start a thread that ends files", e))?;
        if in_turn {
            work(&send);
        } else {
            rayon::broadcast(|_| work(&send));
        }
        drop(send);
        ender.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    for unit in &units {
        if let Some((_, error)) = unit.state().failed.take() {
            return Err(error);
        }
    }
    ended
}

/// Ends units as they come; those that wait go together.
fn end_all(place: &Destination, units: &Receiver<Finished<'_>>) -> Result<(), ExportError> {
    while let Ok(first) = units.recv() {
        place.end(std::iter::once(first).chain(units.try_iter()).collect())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use crate::unit::Nobody;

    /// Comes after so many looks.
    struct Signal(AtomicUsize);

    impl ProgressWatch for Signal {
        fn advance(&self, _: u64) -> bool {
            self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
        }
    }

    fn unit(scene: u32) -> UnitName {
        UnitName { scene, agent: None }
    }

    fn jobs() -> [Job; 5] {
        std::array::from_fn(|i| Job {
            unit: unit(i as u32),
            identity: "x".to_owned(),
            pieces: 1 + 3 * (i as u32 % 3),
        })
    }

    fn on(threads: usize, make: impl FnOnce() -> Result<(), ExportError> + Send) -> Result<(), ExportError> {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(make)
    }

    fn name(job: &Job, piece: u32) -> String {
        format!("{}/{piece}", job.unit)
    }

    fn write(job: &Job, piece: u32, files: &mut UnitFiles<'_>) -> Result<Vec<u8>, ExportError> {
        files.put(&name(job, piece), &[piece as u8])?;
        Ok(vec![b'0' + piece as u8])
    }

    fn files_of(root: &Path, scene: u32) -> usize {
        fs::read_dir(root.join(unit(scene).to_string())).map_or(0, Iterator::count)
    }

    #[test]
    fn pieces_are_put_together_in_their_order_on_any_number_of_threads() -> Result<(), ExportError> {
        for (threads, in_turn) in [(1, false), (1, true), (4, false)] {
            let folder = tempfile::tempdir().expect("a folder");
            let place = Destination::new(folder.path(), "test");
            on(threads, || make(&jobs(), in_turn, (&place, &Nobody), &write))?;
            assert_eq!(place.finished()?, [0, 1, 2, 3, 4].map(unit));
            for (scene, fragment) in [(0, "0"), (1, "0123"), (2, "0123456"), (3, "0"), (4, "0123")] {
                assert!(place.is_done(unit(scene), "x")?);
                assert_eq!(place.fragment(unit(scene))?.as_deref(), Some(fragment.as_bytes()));
                assert_eq!(files_of(folder.path(), scene), fragment.len());
            }
        }
        Ok(())
    }

    #[test]
    fn a_unit_with_a_failed_piece_is_none_and_the_others_are_made() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        let broken = |job: &Job, piece: u32, files: &mut UnitFiles<'_>| match (job.unit.scene, piece) {
            (2, 4) | (4, 0) => Err(ExportError::Refused(job.unit.to_string())),
            _ => write(job, piece, files),
        };
        let failed = on(3, || make(&jobs(), false, (&place, &Nobody), &broken)).expect_err("two units fail");
        assert_eq!(failed.to_string(), "scene_0002", "the first in order");
        assert_eq!(place.finished()?, [0, 1, 3].map(unit));
        // What it has begun is known, and gone when it is begun again.
        assert!(files_of(folder.path(), 2) > 0);
        drop(place.begin(unit(2), &Nobody)?);
        assert_eq!(files_of(folder.path(), 2), 0);
        Ok(())
    }

    #[test]
    fn pieces_write_no_file_of_another() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        let same = |_: &Job, _: u32, files: &mut UnitFiles<'_>| files.put("a", b"").map(|()| Vec::new());
        let jobs = [Job { unit: unit(0), identity: "x".to_owned(), pieces: 2 }];
        let failed = on(1, || make(&jobs, false, (&place, &Nobody), &same)).expect_err("is refused");
        assert!(failed.to_string().ends_with("a: is written twice"), "{failed}");
    }

    #[test]
    fn a_signal_keeps_what_is_finished() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        // Units 0 and 1 have five pieces.
        let signal = Signal(AtomicUsize::new(7));
        let stopped = on(1, || make(&jobs(), false, (&place, &signal), &write)).expect_err("a signal");
        assert!(matches!(stopped, ExportError::Stopped));
        assert_eq!(place.finished()?, [0, 1].map(unit));
        Ok(())
    }
}
