//! Work side by side. Where the system gives no thread, the one that asks does it all.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, Scope, ScopedJoinHandle};

/// Does something with each of some items, on at most `at_once` threads, and returns what came of it in their
/// order. After an error nothing more is begun, and the first of the items' errors is returned.
///
/// # Errors
/// That of an item.
pub fn side_by_side<I: Sync, T: Send, E: Send>(
    items: &[I],
    at_once: usize,
    one: impl Fn(&I) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    side_by_side_in(items, at_once, one, Builder::new)
}

fn side_by_side_in<I: Sync, T: Send, E: Send>(
    items: &[I],
    at_once: usize,
    one: impl Fn(&I) -> Result<T, E> + Sync,
    thread: fn() -> Builder,
) -> Result<Vec<T>, E> {
    if at_once < 2 || items.len() < 2 {
        return items.iter().map(one).collect();
    }
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<Option<Result<T, E>>>> = Mutex::new(items.iter().map(|_| None).collect());
    let work = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(i) else { return };
            let result = one(item);
            if result.is_err() {
                next.store(items.len(), Ordering::Relaxed);
            }
            done.lock().unwrap_or_else(PoisonError::into_inner)[i] = Some(result);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..at_once.min(items.len()) {
            if thread().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
    // Those that were not begun come after one that failed.
    done.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
}

/// What is done on a thread of its own, or was done at once.
#[derive(Debug)]
pub struct Aside<'scope, T>(Kind<'scope, T>);

#[derive(Debug)]
enum Kind<'scope, T> {
    Thread(ScopedJoinHandle<'scope, Option<T>>),
    Done(Option<T>),
}

/// Does something on a thread of its own, or here and now where the system gives none.
pub fn aside<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Aside<'scope, T> {
    aside_in(scope, work, Builder::new())
}

fn aside_in<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    work: impl FnOnce() -> T + Send + 'scope,
    thread: Builder,
) -> Aside<'scope, T> {
    // A thread that does not start takes what it was to do with it.
    let work = Arc::new(Mutex::new(Some(work)));
    let given = Arc::clone(&work);
    let take = |work: &Mutex<Option<_>>| work.lock().unwrap_or_else(PoisonError::into_inner).take();
    match thread.spawn_scoped(scope, move || take(&given).map(|work| work())) {
        Ok(thread) => Aside(Kind::Thread(thread)),
        Err(_) => Aside(Kind::Done(take(&work).map(|work| work()))),
    }
}

impl<T> Aside<'_, T> {
    /// Waits for it.
    ///
    /// # Panics
    /// As what was done did.
    #[must_use]
    pub fn join(self) -> T {
        let done = match self.0 {
            Kind::Thread(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            Kind::Done(done) => done,
        };
        done.expect("taken by one of two, of which one never runs")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thread that no system gives: its stack is larger than any memory.
    fn none() -> Builder {
        Builder::new().stack_size(1 << 60)
    }

    #[test]
    fn all_is_done_where_there_are_no_threads() {
        std::thread::scope(|scope| assert!(none().spawn_scoped(scope, || ()).is_err()));
        let items: Vec<usize> = (0..100).collect();
        assert_eq!(side_by_side_in(&items, 8, |n| Ok::<_, ()>(*n), none), Ok(items));
        let own = std::thread::current().id();
        let by = std::thread::scope(|scope| {
            let here = aside_in(scope, || std::thread::current().id(), none());
            (here.join(), aside(scope, || std::thread::current().id()).join())
        });
        assert!(by.0 == own && by.1 != own);
    }

    #[test]
    fn results_keep_their_order_and_errors_end_it() {
        let items: Vec<usize> = (0..100).collect();
        for at_once in [1, 7, 200] {
            let double = side_by_side(&items, at_once, |n| Ok::<_, usize>(2 * n)).expect("none fails");
            assert_eq!(double, items.iter().map(|n| 2 * n).collect::<Vec<_>>());
            let failed = side_by_side(&items, at_once, |n| if *n < 40 { Ok(()) } else { Err(*n) });
            assert_eq!(failed, Err(40), "the first");
        }
    }
}
