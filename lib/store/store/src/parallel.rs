//! Requests side by side, where a place is worth asking so.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

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
        (0..at_once.min(items.len())).for_each(|_| drop(scope.spawn(work)));
    });
    // Those that were not begun come after one that failed.
    done.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
