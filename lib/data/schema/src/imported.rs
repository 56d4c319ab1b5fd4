//! How what was imported is told from what was made.

/// Code version in the manifests of stages that a program of ours has not done: their outputs were imported
/// from a dataset in another layout. They are never stale, and no stage can do them again.
pub const IMPORTED: &str = "import";

/// Whether a code version stands for what was imported.
#[must_use]
pub fn is_imported(code_version: &str) -> bool {
    code_version == IMPORTED
}

/// Key of a sensor table's metadata that names, as a JSON list, the columns which hold zeros because the
/// dataset that was imported did not say them. They are no readings: nobody knows what should stand there.
pub const ZERO_COLUMNS: &str = "zero_columns";
