//! Working memory that frames computed in parallel hand on to one another.

use std::sync::Mutex;

/// Buffers of a kind that wait to be used again; there are never more than threads that use them at once.
#[derive(Debug)]
pub(crate) struct BufferPool<T> {
    free: Mutex<Vec<T>>,
}

impl<T> Default for BufferPool<T> {
    fn default() -> Self {
        Self { free: Mutex::new(Vec::new()) }
    }
}

impl<T> BufferPool<T> {
    /// Takes a free value or makes one.
    ///
    /// # Errors
    /// It could not be made.
    pub(crate) fn take<E>(&self, make: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        let free = self.free.lock().ok().and_then(|mut free| free.pop());
        free.map_or_else(make, Ok)
    }

    /// Gives a value back.
    pub(crate) fn give(&self, value: T) {
        if let Ok(mut free) = self.free.lock() {
            free.push(value);
        }
    }
}
