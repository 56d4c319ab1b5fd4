//! What a stage wrote, from what.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

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
    /// Versions of later code that was told to keep this.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accepted_by: Vec<String>,
}

/// A stage is being done again: kept until its new manifest stands, so that a killed run goes on as the same try.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Redo {
    /// Generation of the new manifest.
    pub generation: u32,
    /// Outputs of the old one; what the new one does not name is removed.
    pub replaces: Vec<String>,
}

/// A stage failed for a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Version of the code that failed.
    pub code_version: String,
    /// Why.
    pub reason: String,
}

/// What all versions of a manifest have.
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

    /// Whether code of a version made it, or was told to keep it.
    #[must_use]
    pub fn is_of_code(&self, version: &str) -> bool {
        self.code_version == version || self.accepted_by.iter().any(|accepted| accepted == version)
    }

    /// The digest that dependants remember. Who keeps what was made does not alter it.
    #[must_use]
    pub fn digest(&self) -> String {
        if self.accepted_by.is_empty() {
            return hash_bytes(&to_json(self));
        }
        hash_bytes(&to_json(&Self { accepted_by: Vec::new(), ..self.clone() }))
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
        let mut sink = self.backend().create(key, owner)?;
        sink.write_all(&to_json(value)).map_err(|e| StoreError::write(self.location(key), "write", e))?;
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
        // The version first: what follows it may look otherwise in another one.
        let Versioned { format_version } = self.parse(key, &bytes)?;
        if format_version != schema::FORMAT_VERSION {
            let (path, expected) = (self.location(key), schema::FORMAT_VERSION);
            return Err(StoreError::Format { path, found: format_version, expected });
        }
        self.parse(key, &bytes).map(Some)
    }

    /// Writes a manifest where none stands. One of the same content is as good as ours.
    ///
    /// # Errors
    /// The backend cannot write; or another process did the same stage from something else at the same time. Each has
    /// then replaced shards of the other, so no manifest is left to stand for them.
    pub(crate) fn commit_manifest(&self, key: &str, manifest: &Manifest) -> Result<(), StoreError> {
        let bytes = to_json(manifest);
        if self.backend().put_if_absent(key, &manifest.stage, &bytes)?
            || self.read(key)?.as_ref() == Some(&bytes)
        {
            return Ok(());
        }
        self.backend().remove(key)?;
        Err(StoreError::Contested { path: self.location(key) })
    }

    /// Puts a manifest in the place of one that its writer has read: another process may have done the stage again since.
    ///
    /// # Errors
    /// The backend cannot write, or another manifest, or none, stands there now.
    pub fn replace_manifest(&self, scope: Scope, read: &Manifest, new: &Manifest) -> Result<(), StoreError> {
        let key = scope.manifest(&read.stage);
        if self.manifest_at(&key)?.as_ref() != Some(read) {
            return Err(StoreError::Contested { path: self.location(&key) });
        }
        self.write_json(&key, &read.stage, new)
    }

    /// Whether every output of a manifest is there in its size. (Contents are checked by [`crate::verify`].)
    ///
    /// # Errors
    /// The backend cannot be asked.
    pub fn outputs_present(&self, manifest: &Manifest) -> Result<bool, StoreError> {
        for output in &manifest.outputs {
            if self.backend().size(&output.key)? != Some(output.bytes) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
