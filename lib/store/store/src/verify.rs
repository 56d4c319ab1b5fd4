//! Re-hashes a store, and names files that do not belong to it.

use crate::finding::{Finding, Problem};
use crate::known::{Known, known};
use crate::manifest::{Manifest, Output, is_as_written};
use crate::parallel::side_by_side;
use crate::{Scope, Store, StoreError, Unfinished, keys};

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
    let mut listed = store.backend().list("")?.objects;
    // Who is at work is nothing of the dataset.
    listed.retain(|object| !keys::is_lock(&object.key));
    let (files, sizes): (Vec<String>, Vec<u64>) = listed.into_iter().map(|o| (o.key, o.bytes)).unzip();
    let size_of = |key: &String| Some(sizes[files.binary_search(key).ok()?]);
    let known = known(store, &files, &mut result.findings, |findings, key, text, manifest| {
        result.manifests += 1;
        if !is_as_written(text, manifest) {
            let problem = Problem::Manifest("does not fit its own checksum: changed".to_owned());
            findings.push(Finding { key: key.to_owned(), manifest: None, problem });
        }
        let checked = check_outputs(store, key, manifest, &size_of, &mut on_shard)?;
        result.shards += manifest.outputs.len();
        result.bytes += manifest.outputs.iter().map(|output| output.bytes).sum::<u64>();
        findings.extend(checked);
        Ok(())
    })?;
    result.find_strays(&files, &known);
    result.find_undone(&files, expected, &known);
    Ok(result)
}

impl Verification {
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

fn check_outputs(
    store: &Store,
    key: &str,
    manifest: &Manifest,
    size_of: &(impl Fn(&String) -> Option<u64> + Sync),
    on_shard: &mut impl FnMut(&str),
) -> Result<Vec<Finding>, StoreError> {
    let problems = side_by_side(&manifest.outputs, store.backend().at_once(), |output| {
        check(store, output, size_of(&output.key))
    })?;
    let mut findings = Vec::new();
    for (output, problem) in manifest.outputs.iter().zip(problems) {
        if let Some(problem) = problem {
            findings.push(Finding { key: output.key.clone(), manifest: Some(key.to_owned()), problem });
        }
        on_shard(&output.key);
    }
    Ok(findings)
}

/// `listed` is the size that the place tells.
fn check(store: &Store, output: &Output, listed: Option<u64>) -> Result<Option<Problem>, StoreError> {
    let shard = match store.backend().open(&output.key, listed) {
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
