//! Which files of a store belong where, by its records.

use std::collections::{BTreeMap, BTreeSet};

use crate::finding::{Finding, Problem};
use crate::manifest::{Failure, Manifest, Redo};
use crate::{Store, StoreError};

/// Which files belong where.
#[derive(Default)]
pub(crate) struct Known {
    /// Records, and what manifests name.
    pub(crate) committed: BTreeSet<String>,
    /// What tries that are running or were stopped half-way have in hand.
    pub(crate) in_hand: BTreeSet<String>,
    /// Why stages failed, by the keys of the records that say so.
    pub(crate) failures: BTreeMap<String, String>,
}

enum Record {
    Manifest,
    Part,
    Redo,
    Failure,
}

/// Reads all records among some files. What cannot be understood becomes a finding; `on_manifest` sees each
/// manifest with its key and text.
///
/// # Errors
/// The store cannot be read, or that of `on_manifest`.
pub(crate) fn known(
    store: &Store,
    files: &[String],
    findings: &mut Vec<Finding>,
    mut on_manifest: impl FnMut(&mut Vec<Finding>, &str, &[u8], &Manifest) -> Result<(), StoreError>,
) -> Result<Known, StoreError> {
    let mut known = Known::default();
    for key in files {
        match record_of(key) {
            Some(Record::Manifest) => {
                known.committed.insert(key.clone());
                let Some(text) = store.read(key)? else { continue };
                if let Some(manifest) = sound_or_finding(store.parse_manifest(key, &text), key, findings)? {
                    on_manifest(findings, key, &text, &manifest)?;
                    known.committed.extend(manifest.outputs.into_iter().map(|output| output.key));
                }
            }
            Some(Record::Part) => {
                let part: Option<Manifest> = sound_or_finding(store.part(key), key, findings)?;
                known.in_hand.extend(part.into_iter().flat_map(|p| p.outputs).map(|output| output.key));
                known.in_hand.insert(key.clone());
            }
            Some(Record::Redo) => {
                let redo: Option<Redo> = sound_or_finding(store.redo(key), key, findings)?;
                known.in_hand.extend(redo.into_iter().flat_map(|redo| redo.replaces));
                known.in_hand.insert(key.clone());
            }
            Some(Record::Failure) => {
                let failure: Option<Failure> = sound_or_finding(store.read_json(key), key, findings)?;
                known.failures.extend(failure.map(|failure| (key.clone(), failure.reason)));
                known.committed.insert(key.clone());
            }
            None => {}
        }
    }
    Ok(known)
}

/// Which kind of record a key is, by the layout of [`crate::keys`].
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
        below if below.starts_with('/') && below.ends_with(".parts") => Some(Record::Part),
        _ => None,
    }
}

/// A damaged record is a finding.
fn sound_or_finding<T: Into<Option<R>>, R>(
    record: Result<T, StoreError>,
    key: &str,
    findings: &mut Vec<Finding>,
) -> Result<Option<R>, StoreError> {
    let problem = match record {
        Err(StoreError::Corrupt { problem, .. }) => problem,
        Err(e @ StoreError::Format { .. }) => e.to_string(),
        other => return other.map(Into::into),
    };
    let problem = Problem::Manifest(problem);
    findings.push(Finding { key: key.to_owned(), manifest: None, problem });
    Ok(None)
}
