//! Why there are no scores.

use evaluation::EvaluationError;
use export_core::ExportError;
use runner::{EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE};
use store::StoreError;

/// Predictions cannot be scored.
#[derive(Debug, thiserror::Error)]
pub(crate) enum EvaluateError {
    /// The predictions, or what they are held against, are not as they should be.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// The store has not what is wanted of it.
    #[error(transparent)]
    Source(#[from] ExportError),
}

impl EvaluateError {
    /// What the program ends with.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Evaluation(EvaluationError::Refused(_) | EvaluationError::Predictions { .. })
            | Self::Source(ExportError::Refused(_)) => EXIT_USAGE,
            Self::Evaluation(EvaluationError::Write { .. }) => EXIT_TRY_AGAIN,
            Self::Source(ExportError::Store(e)) | Self::Evaluation(EvaluationError::Store(e))
                if e.is_usage() =>
            {
                EXIT_USAGE
            }
            _ => EXIT_SOME_FAILED,
        }
    }
}

impl From<StoreError> for EvaluateError {
    fn from(fault: StoreError) -> Self {
        Self::Source(fault.into())
    }
}
