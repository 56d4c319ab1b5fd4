//! Taking over what another store has.

use crate::backend::Shard;
use crate::manifest::{Manifest, Output};
use crate::parallel::side_by_side;
use crate::write::FileWriter;
use crate::{Attempt, Scope, Store, StoreError};

/// Bytes copied at a time.
const CHUNK: u64 = 4 << 20;

impl Store {
    /// Takes over what a stage made for a scope in another store: its shards, each held against its checksum,
    /// its manifest last. What is there already, byte for byte, is not copied again, so one that was killed
    /// goes on. Returns the bytes copied.
    ///
    /// # Errors
    /// A shard cannot be read or written, is not what the manifest says, or lies outside the scope's folder;
    /// or another manifest of the stage stands here.
    pub fn adopt(&self, from: &Self, scope: Scope, manifest: &Manifest) -> Result<u64, StoreError> {
        from.check_names(
            &scope.manifest(&manifest.stage),
            manifest.outputs.iter().map(|output| &output.key),
        )?;
        let at_once = self.backend().at_once().max(from.backend().at_once());
        let copied = side_by_side(&manifest.outputs, at_once, |output| {
            if self.holds(output)? {
                return Ok(0);
            }
            self.copy(from, manifest, output).map(|()| output.bytes)
        })?;
        self.commit_manifest(&scope.manifest(&manifest.stage), manifest)?;
        Attempt::tidy(self, scope, &manifest.stage)?;
        Ok(copied.into_iter().sum())
    }

    /// Whether a shard is here with these very bytes.
    pub(crate) fn holds(&self, output: &Output) -> Result<bool, StoreError> {
        let shard = match self.backend().open(&output.key, Some(output.bytes)) {
            Err(StoreError::Missing { .. }) => return Ok(false),
            opened => opened?,
        };
        if shard.size() != output.bytes {
            return Ok(false);
        }
        let mut hasher = blake3::Hasher::new();
        self.each_chunk(shard.as_ref(), &output.key, |bytes| {
            hasher.update(bytes);
            Ok(())
        })?;
        Ok(hasher.finalize().to_hex().as_str() == output.blake3)
    }

    fn copy(&self, from: &Self, manifest: &Manifest, output: &Output) -> Result<(), StoreError> {
        // Refuses shards that are missing or of another size.
        let read = from.open_output(manifest, &output.key)?;
        let mut file = FileWriter::create(self, &output.key, &manifest.stage)?;
        from.each_chunk(read.as_ref(), &output.key, |bytes| file.write_bytes(bytes))?;
        let shard = file.finish(output.rows)?;
        if shard.output().content() != output.content() {
            let problem = "its bytes are not those that the manifest names".into();
            return Err(StoreError::Corrupt { path: from.location(&output.key), problem });
        }
        shard.commit().map(|_| ())
    }

    /// Hands out all of a shard, some at a time.
    pub(crate) fn each_chunk(
        &self,
        shard: &dyn Shard,
        key: &str,
        mut take: impl FnMut(&[u8]) -> Result<(), StoreError>,
    ) -> Result<(), StoreError> {
        let mut at = 0;
        while at < shard.size() {
            let end = shard.size().min(at + CHUNK);
            shard.will_read(end..shard.size().min(end + CHUNK));
            let bytes =
                shard.read_at(at..end).map_err(|e| StoreError::read(self.location(key), "read", e))?;
            take(&bytes)?;
            at = end;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{Identity, verify};

    const SCOPE: Scope = Scope::Scene(3);
    const SHARD: &str = "scenes/0003/bev/vehicle_0.npz";

    /// A store with one stage of a scene.
    fn store(bytes: &[u8]) -> (Store, Manifest) {
        let store = Store::open("memory:").expect("opens");
        let identity = Identity {
            stage: "bev-gt".into(),
            scope: SCOPE,
            code_version: "1".into(),
            config_hash: "c".into(),
            inputs: BTreeMap::new(),
            made_by: None,
        };
        let attempt = Attempt::start(&store, identity, false).expect("starts");
        let mut unit = attempt.unit("all").expect("reads").expect("is new");
        unit.bytes(SHARD, bytes, 1).expect("writes");
        unit.finish().expect("finishes");
        let manifest = attempt.commit().expect("commits");
        (store, manifest)
    }

    #[test]
    fn what_is_taken_over_is_whole_and_copied_once() {
        let bytes: Vec<u8> = (0..3_000_000_u32).map(|k| (k % 251) as u8).collect();
        let (from, manifest) = store(&bytes);
        let here = Store::open("memory:").expect("opens");
        assert_eq!(here.adopt(&from, SCOPE, &manifest).expect("copies"), 3_000_000);
        assert_eq!(here.read(SHARD).expect("reads").as_deref(), Some(&bytes[..]));
        let checked = verify(&here, &[(SCOPE, "bev-gt")], |_| {}).expect("reads");
        assert!(checked.findings.is_empty() && checked.manifests == 1);
        assert_eq!(here.adopt(&from, SCOPE, &manifest).expect("has it"), 0);
        // A shard of a copy that was killed, or of the same size by chance, is not believed.
        for broken in [&bytes[..7], &[0; 3_000_000]] {
            here.backend().remove(&SCOPE.manifest("bev-gt")).expect("removes");
            let mut sink = here.backend().create(SHARD, "bev-gt").expect("creates");
            sink.write_all(broken).expect("writes");
            sink.commit().expect("commits");
            assert_eq!(here.adopt(&from, SCOPE, &manifest).expect("copies"), 3_000_000);
            assert_eq!(here.read(SHARD).expect("reads").as_deref(), Some(&bytes[..]));
        }
    }

    #[test]
    fn faulty_shards_and_foreign_folders_are_refused() {
        let (from, manifest) = store(b"all that there is");
        let here = Store::open("memory:").expect("opens");
        let mut sink = from.backend().create(SHARD, "bev-gt").expect("creates");
        sink.write_all(b"all that there As").expect("writes");
        sink.commit().expect("commits");
        let text = here.adopt(&from, SCOPE, &manifest).expect_err("is another").to_string();
        assert!(text.contains("not those that the manifest names"), "{text}");
        assert!(here.backend().keys("").expect("lists").is_empty());
        for key in ["scenes/0004/a", "scenes/0003/../../a", "/etc/a", "scenes/00031/a", "scenes/0003//a"] {
            let mut foreign = manifest.clone();
            foreign.outputs[0].key = key.into();
            let text = here.adopt(&from, SCOPE, &foreign).expect_err("is outside").to_string();
            assert!(text.contains("not in its folder"), "{key}: {text}");
        }
    }

    #[test]
    fn another_manifest_stays() {
        let (from, manifest) = store(b"one");
        let (here, _) = store(b"two");
        assert!(here.manifest(SCOPE, "bev-gt").expect("reads").is_some_and(|m| m != manifest));
        // Callers check first; without that both would be written, and neither would be valid.
        assert!(matches!(here.adopt(&from, SCOPE, &manifest), Err(StoreError::Contested { .. })));
    }
}
