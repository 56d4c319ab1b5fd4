//! Digests of files.

use std::collections::BTreeMap;

/// BLAKE3 over paths and contents of files.
pub(crate) fn hash_of(files: &BTreeMap<String, Vec<u8>>) -> String {
    let mut all = blake3::Hasher::new();
    for (path, bytes) in files {
        all.update(format!("{path}\n{}\n", blake3::hash(bytes)).as_bytes());
    }
    all.finalize().to_hex().to_string()
}
