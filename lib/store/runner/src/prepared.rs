//! What a stage works out before it may know whether it is to work at all.

use std::any::Any;
use std::sync::OnceLock;

use crate::error::StageError;

/// One value of a stage that several of its functions need: a plan is made once, whether it is told of,
/// looked at for what is suspicious, or written.
#[derive(Default)]
pub struct Prepared(OnceLock<Box<dyn Any + Send + Sync>>);

impl Prepared {
    /// The value, made when it is asked for first.
    ///
    /// # Errors
    /// It could not be made.
    ///
    /// # Panics
    /// A value of another type was asked for before.
    pub fn get_or_make<T: Send + Sync + 'static>(
        &self,
        make: impl FnOnce() -> Result<T, StageError>,
    ) -> Result<&T, StageError> {
        if self.0.get().is_none() {
            // Nobody else can have made it meanwhile: a stage's functions are called one after the other.
            let _ = self.0.set(Box::new(make()?));
        }
        let value = self.0.get().and_then(|value| value.downcast_ref());
        Ok(value.expect("a stage prepares one type of value"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_made_once_and_after_a_failure_again() {
        let prepared = Prepared::default();
        let failed = prepared.get_or_make(|| Err::<u32, _>(StageError::Stopped));
        assert!(failed.is_err());
        assert_eq!(*prepared.get_or_make(|| Ok(7)).expect("is made"), 7);
        assert_eq!(*prepared.get_or_make(|| Ok(8)).expect("is there"), 7);
    }
}
