//! How much of a device's memory may be used, and how many calls it has in hand.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use crate::error::GpuError;

/// Calls on a device at a time, whatever the number of threads.
const AT_A_TIME: usize = 3;

/// A device's memory: no more than so many bytes of it are used at a time.
#[derive(Debug)]
pub(crate) struct Memory {
    used: Mutex<Used>,
    given_back: Condvar,
}

#[derive(Debug)]
struct Used {
    limit_bytes: u64,
    bytes: u64,
    calls: usize,
}

/// Bytes of it, until they are dropped.
#[derive(Debug)]
pub(crate) struct Held {
    memory: Arc<Memory>,
    bytes: u64,
    calls: usize,
}

impl Memory {
    pub(crate) fn new(limit_bytes: u64) -> Arc<Self> {
        let used = Mutex::new(Used { limit_bytes, bytes: 0, calls: 0 });
        Arc::new(Self { used, given_back: Condvar::new() })
    }

    /// From now on no more than so many bytes are used.
    pub(crate) fn limit(&self, bytes: u64) {
        self.used().limit_bytes = bytes;
    }

    /// Bytes for what stays on the device.
    ///
    /// # Errors
    /// There are not so many.
    pub(crate) fn keep(self: &Arc<Self>, bytes: u64) -> Result<Held, GpuError> {
        self.take(bytes, 0)
    }

    /// Bytes for a call, which waits while others are in hand and leave too little.
    ///
    /// # Errors
    /// There are not so many, with nothing else in hand.
    pub(crate) fn call(self: &Arc<Self>, bytes: u64) -> Result<Held, GpuError> {
        self.take(bytes, 1)
    }

    fn take(self: &Arc<Self>, bytes: u64, calls: usize) -> Result<Held, GpuError> {
        let mut used = self.used();
        loop {
            let fits = used.bytes.saturating_add(bytes) <= used.limit_bytes;
            if fits && used.calls + calls <= AT_A_TIME {
                used.bytes += bytes;
                used.calls += calls;
                return Ok(Held { memory: Arc::clone(self), bytes, calls });
            }
            if used.calls == 0 {
                let free_bytes = used.limit_bytes.saturating_sub(used.bytes);
                return Err(GpuError::Memory {
                    problem: format!("{bytes} bytes of {free_bytes} are needed"),
                });
            }
            used = self.given_back.wait(used).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn used(&self) -> MutexGuard<'_, Used> {
        // Counts are whole even if whoever held the lock stopped.
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let mut used = self.memory.used();
        used.bytes -= self.bytes;
        used.calls -= self.calls;
        drop(used);
        self.memory.given_back.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn no_more_is_held_than_there_is() {
        let memory = Memory::new(100);
        let kept = memory.keep(60).expect("fits");
        assert!(memory.keep(41).is_err() && memory.call(41).is_err());
        drop(memory.call(40).expect("fits"));
        drop(kept);
        assert!(memory.call(100).is_ok() && memory.call(101).is_err());
        assert!(memory.keep(u64::MAX).is_err());
    }

    #[test]
    fn calls_wait_for_others_that_hold_what_they_need() {
        let (memory, in_hand) = (Memory::new(100), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let held = memory.call(40).expect("fits alone");
                        let others = in_hand.fetch_add(1, Ordering::SeqCst);
                        assert!(others < 2, "40 bytes each of 100");
                        in_hand.fetch_sub(1, Ordering::SeqCst);
                        drop(held);
                    }
                });
            }
        });
        assert!(memory.keep(100).is_ok());
    }
}
