//! What a stage wrote, from what.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::keys::may_name;
use crate::parallel::side_by_side;
use crate::{Scope, Store, StoreError, hash_bytes};

/// One shard a stage wrote.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Output {
    /// Where it is in the store.
    pub key: String,
    /// Size.
    pub bytes: u64,
    /// Table rows or array members.
    pub rows: u64,
    /// BLAKE3 of its bytes.
    pub blake3: String,
    /// Digest of the settings that it depends on, where its stage tells them apart by shards: it is kept when
    /// the stage is done again from the same inputs and this has not changed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_from: Option<String>,
    /// What its stage counts of it, by measure: told here, so that who keeps it need not read it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub counts: BTreeMap<String, u64>,
}

impl Output {
    /// What is in it and where it is, without remarks on how it was made.
    #[must_use]
    pub fn content(&self) -> (&str, u64, u64, &str) {
        (&self.key, self.bytes, self.rows, &self.blake3)
    }
}

/// A stage is done for a scope: written last, names everything.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Store layout version.
    pub format_version: u32,
    /// The stage.
    pub stage: String,
    /// Version of the code that wrote it.
    pub code_version: String,
    /// Digest of the parts of the configuration that the stage uses.
    pub config_hash: String,
    /// How often the stage was forced to redo this: what was made from an earlier one is stale.
    pub generation: u32,
    /// Digest of each thing that was read, by name.
    pub inputs: BTreeMap<String, String>,
    /// Everything that was written.
    pub outputs: Vec<Output>,
    /// Digests of parts that other stages depend on singly (a plan's scenes), by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub sections: BTreeMap<String, String>,
    /// Versions of later code, and digests of programs, that were told to keep this.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accepted_by: Vec<String>,
    /// Which build made it. A remark: it is no part of [`Manifest::digest`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_by: Option<MadeBy>,
}

/// The build of Convoy that made something.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MadeBy {
    /// Release (`0.1.0`).
    pub release: String,
    /// Commit that it was built from; none for a build with uncommitted changes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// BLAKE3 of the program's file, without the commit that is written into it.
    pub program: String,
    /// Of a plan, the versions of all stages of that build, by name: tasks of another one are refused.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub versions: BTreeMap<String, String>,
    /// The GPU that looked at the scene, and its driver; none where the CPU did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
}

impl MadeBy {
    /// Whether two builds of one version make the same: two of commits are trusted to their version, others
    /// only when the program is the same.
    #[must_use]
    pub fn makes_the_same(&self, other: &Self) -> bool {
        self.commit.is_some() && other.commit.is_some() || self.program == other.program
    }
}

/// A stage is being done again: kept until its new manifest stands, so that a killed run goes on as the same
/// try.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Redo {
    /// Generation of the new manifest.
    pub generation: u32,
    /// Outputs of the old one; what the new one does not name is removed.
    pub replaces: Vec<String>,
    /// The old manifest, where it says what its shards were made from: some may be kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub old: Option<Manifest>,
}

/// A stage failed for a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Version of the code that failed.
    pub code_version: String,
    /// Why.
    pub reason: String,
}

/// What all versions of a manifest, and of `dataset.json`, have.
#[derive(Deserialize)]
struct Versioned {
    format_version: u32,
}

impl Manifest {
    /// The output with a key.
    #[must_use]
    pub fn output(&self, key: &str) -> Option<&Output> {
        self.outputs.iter().find(|o| o.key == key)
    }

    /// The digest that dependants remember. Remarks do not alter it: which build made it, which later code
    /// keeps it.
    #[must_use]
    pub fn digest(&self) -> String {
        hash_bytes(&to_json(&Self { accepted_by: Vec::new(), made_by: None, ..self.clone() }))
    }

    /// The digest that those remember who read some of the outputs alone: of what is in these, and of how
    /// often the stage was forced. Settings and inputs of the stage alter it by what is in them.
    #[must_use]
    pub fn digest_of(&self, is_read: impl Fn(&Output) -> bool) -> String {
        let read: Vec<_> =
            self.outputs.iter().filter(|output| is_read(output)).map(Output::content).collect();
        hash_bytes(&to_json(&(self.generation, read)))
    }
}

/// Key of a manifest's own checksum, its last line: BLAKE3 of its text with this checksum left empty.
const SEAL: &str = "record_blake3";

/// A manifest as it is written, with its own checksum.
#[derive(Serialize)]
struct Sealed<'a> {
    #[serde(flatten)]
    manifest: &'a Manifest,
    record_blake3: String,
}

/// The text of a manifest, with its own checksum.
fn sealed(manifest: &Manifest) -> Vec<u8> {
    let unsealed = to_json(&Sealed { manifest, record_blake3: String::new() });
    to_json(&Sealed { manifest, record_blake3: hash_bytes(&unsealed) })
}

/// Whether the text of a manifest fits its own checksum. Text without one (older releases wrote none) must be
/// the text that its content gives.
pub(crate) fn is_as_written(text: &[u8], manifest: &Manifest) -> bool {
    let end = "\"\n}\n";
    let digest = |text: &[u8]| -> Option<(Vec<u8>, Vec<u8>)> {
        let body = text.strip_suffix(end.as_bytes())?;
        let (rest, digest) = body.split_at_checked(body.len().checked_sub(blake3::OUT_LEN * 2)?)?;
        rest.strip_suffix(format!("\"{SEAL}\": \"").as_bytes())?;
        Some(([rest, end.as_bytes()].concat(), digest.to_vec()))
    };
    match digest(text) {
        Some((unsealed, digest)) => hash_bytes(&unsealed).as_bytes() == digest,
        None => text == to_json(manifest),
    }
}

/// Pretty JSON with a final newline.
pub(crate) fn to_json<T: Serialize>(value: &T) -> Vec<u8> {
    // Our records hold strings, integers and maps with string keys: serialising them cannot fail.
    let mut bytes = serde_json::to_vec_pretty(value).unwrap_or_default();
    bytes.push(b'\n');
    bytes
}

impl Store {
    /// A record in JSON, or `None` when it does not exist.
    ///
    /// # Errors
    /// It cannot be read or understood.
    pub fn read_json<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>, StoreError> {
        let Some(bytes) = self.read(key)? else { return Ok(None) };
        self.parse(key, &bytes).map(Some)
    }

    fn parse<T: DeserializeOwned>(&self, key: &str, bytes: &[u8]) -> Result<T, StoreError> {
        serde_json::from_slice(bytes)
            .map_err(|e| StoreError::Corrupt { path: self.location(key), problem: e.to_string() })
    }

    /// Writes a record in JSON, atomically.
    ///
    /// # Errors
    /// The backend cannot write.
    pub fn write_json<T: Serialize>(&self, key: &str, owner: &str, value: &T) -> Result<(), StoreError> {
        self.write_bytes(key, owner, &to_json(value))
    }

    fn write_bytes(&self, key: &str, owner: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let mut sink = self.backend().create(key, owner)?;
        sink.write_all(bytes).map_err(|e| StoreError::write(self.location(key), "write", e))?;
        sink.commit()
    }

    /// A stage's manifest, or `None` when the stage is not done.
    ///
    /// # Errors
    /// It cannot be read or understood, or is of another format version.
    pub fn manifest(&self, scope: Scope, stage: &str) -> Result<Option<Manifest>, StoreError> {
        self.manifest_at(&scope.manifest(stage))
    }

    pub(crate) fn manifest_at(&self, key: &str) -> Result<Option<Manifest>, StoreError> {
        let Some(bytes) = self.read(key)? else { return Ok(None) };
        self.parse_manifest(key, &bytes).map(Some)
    }

    pub(crate) fn parse_manifest(&self, key: &str, text: &[u8]) -> Result<Manifest, StoreError> {
        // The version first: what follows it may look otherwise in another one.
        self.check_format(key, text)?;
        let manifest: Manifest = self.parse(key, text)?;
        self.check_names(key, manifest.outputs.iter().map(|output| &output.key))?;
        Ok(manifest)
    }

    /// Refuses a record that names what its stage cannot have written: nobody follows it.
    pub(crate) fn check_names<'a>(
        &self,
        record: &str,
        mut names: impl Iterator<Item = &'a String>,
    ) -> Result<(), StoreError> {
        names.find(|name| !may_name(record, name)).map_or(Ok(()), |name| {
            let problem = format!("names `{name}`, which is not in its folder");
            Err(StoreError::Corrupt { path: self.location(record), problem })
        })
    }

    /// The record of a finished unit.
    pub(crate) fn part(&self, key: &str) -> Result<Option<Manifest>, StoreError> {
        let Some(part) = self.read_json::<Manifest>(key)? else { return Ok(None) };
        self.check_names(key, part.outputs.iter().map(|output| &output.key))?;
        Ok(Some(part))
    }

    /// What a stage that is being done again replaces.
    pub(crate) fn redo(&self, key: &str) -> Result<Option<Redo>, StoreError> {
        let Some(redo) = self.read_json::<Redo>(key)? else { return Ok(None) };
        let old = redo.old.iter().flat_map(|old| &old.outputs).map(|output| &output.key);
        self.check_names(key, redo.replaces.iter().chain(old))?;
        Ok(Some(redo))
    }

    /// Refuses a document that names a format version that is not read. A damaged one is for its readers to
    /// name.
    pub(crate) fn check_format(&self, key: &str, document: &[u8]) -> Result<(), StoreError> {
        match serde_json::from_slice(document) {
            Ok(Versioned { format_version: found }) if !schema::is_read(found) => {
                let (path, expected) = (self.location(key), schema::FORMAT_VERSION);
                Err(StoreError::Format { path, found, expected })
            }
            _ => Ok(()),
        }
    }

    /// Writes a manifest where there is none. One that differs by remarks alone is as good as this one.
    ///
    /// # Errors
    /// The backend cannot write; or another process did the same stage from something else at the same time.
    /// Each has then replaced shards of the other, so no manifest is left for them.
    pub(crate) fn commit_manifest(&self, key: &str, manifest: &Manifest) -> Result<(), StoreError> {
        if self.backend().put_if_absent(key, &manifest.stage, &sealed(manifest))? {
            return Ok(());
        }
        if self.manifest_at(key)?.is_some_and(|there| there.digest() == manifest.digest()) {
            return Ok(());
        }
        self.backend().remove(key)?;
        Err(StoreError::Contested { path: self.location(key) })
    }

    /// Puts a manifest in the place of one that its writer has read: another process may have done the stage
    /// again since.
    ///
    /// # Errors
    /// The backend cannot write, or another manifest, or none, stands there now.
    pub fn replace_manifest(&self, scope: Scope, read: &Manifest, new: &Manifest) -> Result<(), StoreError> {
        let key = scope.manifest(&read.stage);
        let bytes = self.read(&key)?.unwrap_or_default();
        let is_as_read = self.parse::<Manifest>(&key, &bytes).is_ok_and(|there| there == *read);
        if is_as_read && self.backend().replace(&key, &read.stage, &bytes, &sealed(new))? {
            return Ok(());
        }
        Err(StoreError::Contested { path: self.location(&key) })
    }

    /// Whether every output of a manifest is there in its size. (Contents are checked by [`crate::verify`].)
    ///
    /// # Errors
    /// The backend cannot be asked.
    pub fn outputs_present(&self, manifest: &Manifest) -> Result<bool, StoreError> {
        let is_there = |output: &Output| Ok(self.backend().size(&output.key)? == Some(output.bytes));
        let there = side_by_side(&manifest.outputs, self.backend().at_once(), is_there)?;
        Ok(there.into_iter().all(|is_there| is_there))
    }
}
