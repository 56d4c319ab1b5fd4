//! How what was imported is told from what was made.

/// Code version in the manifests of stages that a program of ours has not done: their outputs were imported from a dataset in
/// another layout. They are never stale, and no stage can do them again.
pub const IMPORTED: &str = "import";
