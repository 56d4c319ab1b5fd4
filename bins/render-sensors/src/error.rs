//! What can go wrong between a sensor and its table.

/// A lidar's sweep is not of its table's kind: a bug.
#[derive(Debug, thiserror::Error)]
#[error("reading and table are of different kinds")]
pub(crate) struct KindError;
