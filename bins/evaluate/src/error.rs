//! Why there are no scores.

use evaluation::EvaluationError;
use export_core::ExportError;
use pipeline::{EXIT_SOME_FAILED, EXIT_TRY_AGAIN, EXIT_USAGE};
use store::StoreError;

/// Predictions cannot be scored.
#[derive(Debug)]
pub(crate) enum EvaluateError {
    /// The predictions, or what they are held against, are not as they should be.
    Evaluation(EvaluationError),
    /// The store has not what is wanted of it.
    Source(ExportError),
}

impl std::fmt::Display for EvaluateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Evaluation(fault) => fault.fmt(f),
            Self::Source(fault) => fault.fmt(f),
        }
    }
}

impl std::error::Error for EvaluateError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Evaluation(fault) => fault.source(),
            Self::Source(fault) => fault.source(),
        }
    }
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

impl From<EvaluationError> for EvaluateError {
    fn from(fault: EvaluationError) -> Self {
        Self::Evaluation(fault)
    }
}

impl From<ExportError> for EvaluateError {
    fn from(fault: ExportError) -> Self {
        Self::Source(fault)
    }
}

impl From<StoreError> for EvaluateError {
    fn from(fault: StoreError) -> Self {
        Self::Source(fault.into())
    }
}
