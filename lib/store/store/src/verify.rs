//! Re-hashes a store, and names files that do not belong to it.

use std::collections::{BTreeMap, BTreeSet};

use crate::manifest::{Failure, Manifest, Output, Redo, is_as_written};
use crate::parallel::side_by_side;
use crate::{Scope, Store, StoreError, Unfinished, keys};

/// What is wrong with a file.
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
    /// No manifest names it, and no try of a stage has it in hand.
    Stray,
    /// A stage has no manifest: it was never done, was stopped half-way, or the manifest was deleted.
    NotDone,
    /// A stage has no manifest because it failed.
    Failed(String),
}

/// A file that is not as it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The file.
    pub key: String,
    /// The manifest that names it, where there is one.
    pub manifest: Option<String>,
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
            Problem::Stray => write!(f, "no manifest names this file")?,
            Problem::NotDone => write!(f, "no manifest: the stage is not done, or its manifest was deleted")?,
            Problem::Failed(reason) => write!(f, "no manifest: the stage failed: {reason}")?,
        }
        self.manifest.as_ref().map_or(Ok(()), |manifest| write!(f, " (named by {manifest})"))
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
    /// Files of tries that are running or were stopped half-way: the stage takes them up or away when it runs
    /// again.
    pub in_hand: Vec<String>,
    /// Objects that were begun and not completed.
    pub unfinished: Vec<Unfinished>,
}

/// Hashes every shard that a manifest names, and names files that belong to none and stages (of those
/// `expected`) without one. `on_shard` is called after each shard.
///
/// # Errors
/// The store cannot be listed or read. Faulty shards are findings, not errors.
pub fn verify(
    store: &Store,
    expected: &[(Scope, &str)],
    mut on_shard: impl FnMut(&str),
) -> Result<Verification, StoreError> {
    let mut unfinished = store.backend().unfinished("")?;
    unfinished.retain(|upload| upload.owner != keys::LOCKS);
    let mut result = Verification { unfinished, ..Verification::default() };
    let mut files = store.backend().keys("")?;
    // Who is at work is nothing of the dataset.
    files.retain(|key| !keys::is_lock(key));
    let mut known = Known::default();
    for key in &files {
        match record_of(key) {
            Some(Record::Manifest) => {
                let Some(text) = store.read(key)? else {
                    known.committed.insert(key.clone());
                    continue;
                };
                if let Some(manifest) = sound_or_finding(store.parse_manifest(key, &text), key, &mut result)?
                {
                    result.manifests += 1;
                    if !is_as_written(&text, &manifest) {
                        let problem = Problem::Manifest("does not fit its own checksum: changed".to_owned());
                        result.findings.push(Finding { key: key.clone(), manifest: None, problem });
                    }
                    result.check_outputs(store, key, &manifest, &mut on_shard)?;
                    known.committed.extend(manifest.outputs.into_iter().map(|output| output.key));
                }
                known.committed.insert(key.clone());
            }
            Some(Record::MeshPart) => {
                let part: Option<Manifest> = sound_or_finding(store.read_json(key), key, &mut result)?;
                known.in_hand.extend(part.into_iter().flat_map(|p| p.outputs).map(|output| output.key));
                known.in_hand.insert(key.clone());
            }
            Some(Record::Redo) => {
                let redo: Option<Redo> = sound_or_finding(store.read_json(key), key, &mut result)?;
                known.in_hand.extend(redo.into_iter().flat_map(|redo| redo.replaces));
                known.in_hand.insert(key.clone());
            }
            Some(Record::Failure) => {
                let failure: Option<Failure> = sound_or_finding(store.read_json(key), key, &mut result)?;
                known.failures.extend(failure.map(|failure| (key.clone(), failure.reason)));
                known.committed.insert(key.clone());
            }
            None => {}
        }
    }
    result.find_strays(&files, &known);
    result.find_undone(&files, expected, &known);
    Ok(result)
}

/// Which files belong where.
#[derive(Default)]
struct Known {
    committed: BTreeSet<String>,
    in_hand: BTreeSet<String>,
    failures: BTreeMap<String, String>,
}

enum Record {
    Manifest,
    MeshPart,
    Redo,
    Failure,
}

/// Which kind of record a key is, by the layout of [`keys`].
fn record_of(key: &str) -> Option<Record> {
    let (folder, name) = key.rsplit_once('/')?;
    if name == "_manifest.json" {
        return Some(Record::Manifest);
    }
    let (_, below) = folder.split_once("/_manifests").filter(|_| name.ends_with(".json"))?;
    match below {
        "" if name.ends_with(".redo.json") => Some(Record::Redo),
        "" if name.ends_with(".failed.json") => Some(Record::Failure),
        "" => Some(Record::Manifest),
        below if below.starts_with('/') && below.ends_with(".parts") => Some(Record::MeshPart),
        _ => None,
    }
}

/// A damaged record is a finding.
fn sound_or_finding<T: Into<Option<R>>, R>(
    record: Result<T, StoreError>,
    key: &str,
    result: &mut Verification,
) -> Result<Option<R>, StoreError> {
    let problem = match record {
        Err(StoreError::Corrupt { problem, .. }) => problem,
        Err(e @ StoreError::Format { .. }) => e.to_string(),
        other => return other.map(Into::into),
    };
    let problem = Problem::Manifest(problem);
    result.findings.push(Finding { key: key.to_owned(), manifest: None, problem });
    Ok(None)
}

impl Verification {
    fn check_outputs(
        &mut self,
        store: &Store,
        key: &str,
        manifest: &Manifest,
        on_shard: &mut impl FnMut(&str),
    ) -> Result<(), StoreError> {
        let problems =
            side_by_side(&manifest.outputs, store.backend().at_once(), |output| check(store, output))?;
        for (output, problem) in manifest.outputs.iter().zip(problems) {
            if let Some(problem) = problem {
                let manifest = Some(key.to_owned());
                self.findings.push(Finding { key: output.key.clone(), manifest, problem });
            }
            self.shards += 1;
            self.bytes += output.bytes;
            on_shard(&output.key);
        }
        Ok(())
    }

    fn find_strays(&mut self, files: &[String], known: &Known) {
        for key in files.iter().filter(|key| !known.committed.contains(*key)) {
            if known.in_hand.contains(key) {
                self.in_hand.push(key.clone());
            } else {
                let finding = Finding { key: key.clone(), manifest: None, problem: Problem::Stray };
                self.findings.push(finding);
            }
        }
    }

    fn find_undone(&mut self, files: &[String], expected: &[(Scope, &str)], known: &Known) {
        for (scope, stage) in expected {
            let key = scope.manifest(stage);
            if files.binary_search(&key).is_err() {
                let failure = known.failures.get(&scope.failure(stage));
                let problem = failure.map_or(Problem::NotDone, |reason| Problem::Failed(reason.clone()));
                self.findings.push(Finding { key, manifest: None, problem });
            }
        }
    }
}

fn check(store: &Store, output: &Output) -> Result<Option<Problem>, StoreError> {
    let shard = match store.backend().open(&output.key) {
        Err(StoreError::Missing { .. }) => return Ok(Some(Problem::Missing)),
        opened => opened?,
    };
    if shard.size() != output.bytes {
        return Ok(Some(Problem::Size { expected: output.bytes, found: shard.size() }));
    }
    let mut hasher = blake3::Hasher::new();
    store.each_chunk(shard.as_ref(), &output.key, |bytes| {
        hasher.update(bytes);
        Ok(())
    })?;
    let same = hasher.finalize().to_hex().as_str() == output.blake3;
    Ok((!same).then_some(Problem::Changed))
}
