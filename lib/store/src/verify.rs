//! Re-hashing a store.

use std::io::Read;

use crate::manifest::{Manifest, Output};
use crate::{Store, StoreError};

/// What is wrong with a shard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// It is not there.
    Missing,
    /// It has another size than its manifest says.
    Size {
        /// Bytes in the manifest.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// It has the right size and other bytes.
    Changed,
    /// A manifest cannot be understood.
    Manifest(String),
}

/// A shard that is not as its manifest says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The shard (or the manifest itself).
    pub key: String,
    /// The manifest that names it.
    pub manifest: String,
    /// What is wrong.
    pub problem: Problem,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: ", self.key)?;
        match &self.problem {
            Problem::Missing => write!(f, "missing")?,
            Problem::Size { expected, found } => {
                write!(f, "{found} bytes, expected {expected}: truncated or changed")?;
            }
            Problem::Changed => write!(f, "right size, other bytes: changed")?,
            Problem::Manifest(problem) => write!(f, "{problem}")?,
        }
        write!(f, " (named by {})", self.manifest)
    }
}

/// The outcome of a verification.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Verification {
    /// Manifests read.
    pub manifests: usize,
    /// Shards hashed.
    pub shards: usize,
    /// Bytes hashed.
    pub bytes: u64,
    /// What is wrong.
    pub findings: Vec<Finding>,
}

/// Hashes every shard that a manifest names. `on_shard` is called after each.
///
/// # Errors
/// The store cannot be listed or read. Faulty shards are findings, not errors.
pub fn verify(store: &Store, mut on_shard: impl FnMut(&str)) -> Result<Verification, StoreError> {
    let mut result = Verification::default();
    for key in store.backend().list("")?.into_iter().filter(|k| is_manifest(k)) {
        let manifest: Manifest = match store.read_json(&key) {
            Ok(Some(manifest)) => manifest,
            Ok(None) => continue,
            Err(StoreError::Corrupt { problem, .. }) => {
                let finding =
                    Finding { key: key.clone(), manifest: key, problem: Problem::Manifest(problem) };
                result.findings.push(finding);
                continue;
            }
            Err(e) => return Err(e),
        };
        result.manifests += 1;
        for output in &manifest.outputs {
            if let Some(problem) = check(store, output)? {
                result.findings.push(Finding { key: output.key.clone(), manifest: key.clone(), problem });
            }
            result.shards += 1;
            result.bytes += output.bytes;
            on_shard(&output.key);
        }
    }
    Ok(result)
}

fn is_manifest(key: &str) -> bool {
    let scene = key.contains("/_manifests/") && !key.contains(".parts/");
    (scene && !key.ends_with(".redo.json") && !key.ends_with(".failed.json") && key.ends_with(".json"))
        || key.ends_with("/_manifest.json")
}

fn check(store: &Store, output: &Output) -> Result<Option<Problem>, StoreError> {
    match store.backend().size(&output.key)? {
        None => return Ok(Some(Problem::Missing)),
        Some(found) if found != output.bytes => {
            return Ok(Some(Problem::Size { expected: output.bytes, found }));
        }
        Some(_) => {}
    }
    let mut stream = store.backend().open(&output.key)?.into_stream();
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let n =
            stream.read(&mut buffer).map_err(|e| StoreError::io(store.location(&output.key), "read", e))?;
        if n == 0 {
            break;
        }
        hasher.update(&buffer[..n]);
    }
    let same = hasher.finalize().to_hex().as_str() == output.blake3;
    Ok((!same).then_some(Problem::Changed))
}
