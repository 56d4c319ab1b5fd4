//! What can be wrong with a pickle.

/// A pickle is broken, or says what no file of boxes says.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("byte {offset}: {problem}")]
pub struct PickleError {
    /// Where, from the first byte of the pickle.
    pub offset: usize,
    /// What is wrong.
    pub problem: String,
}
