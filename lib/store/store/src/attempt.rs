//! One try of a stage at one scope: units of work, shards, the manifest last.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

use schema::table::{Column, Row};

use crate::backend::Area;
use crate::error::sound;
use crate::manifest::{MadeBy, Manifest, Output, Redo};
use crate::parallel::side_by_side;
use crate::table::{TableOptions, TableWriter, write_columns};
use crate::write::{FileWriter, Finished};
use crate::{Scope, Store, StoreError, keys, write};

/// What makes two tries the same: if all of it is equal, so are the outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The stage.
    pub stage: String,
    /// What it works on.
    pub scope: Scope,
    /// Version of the code.
    pub code_version: String,
    /// Digest of the parts of the configuration it uses.
    pub config_hash: String,
    /// Digest of each thing it reads.
    pub inputs: BTreeMap<String, String>,
    /// The build at work; none where that does not matter (imports).
    pub made_by: Option<MadeBy>,
}

/// A running try.
///
/// ```
/// use std::collections::BTreeMap;
///
/// use schema::tables::GnssRow;
/// use store::{Attempt, Identity, Scope, Store, verify};
///
/// let store = Store::open("memory:")?;
/// let identity = Identity {
///     stage: "render-sensors".into(),
///     scope: Scope::Scene(7),
///     code_version: "1".into(),
///     config_hash: "c".into(),
///     inputs: BTreeMap::new(),
///     made_by: None,
/// };
/// let attempt = Attempt::start(&store, identity, false)?;
/// if let Some(mut unit) = attempt.unit("vehicle_0")? {
///     unit.rows("scenes/0007/GNSS.parquet", &[GnssRow { frame: 3, ..GnssRow::default() }])?;
///     unit.finish()?;
/// }
/// let manifest = attempt.commit()?;
///
/// let rows: Vec<GnssRow> = store.read_rows(&manifest, "scenes/0007/GNSS.parquet")?;
/// assert_eq!(rows[0].frame, 3);
/// let checked = verify(&store, &[(Scope::Scene(7), "render-sensors")], |_| {})?;
/// assert!(checked.findings.is_empty());
/// # Ok::<(), store::StoreError>(())
/// ```
///
/// Dropping it keeps finished units for the next one and discards shards in hand.
#[derive(Debug)]
pub struct Attempt {
    store: Store,
    identity: Identity,
    redo: Redo,
    earlier: Earlier,
    so_far: Mutex<SoFar>,
    sections: BTreeMap<String, String>,
    /// Records of earlier tries that were there at the start, but for the manifest.
    records: BTreeSet<String>,
    /// Nothing was there, and all is made within moments: no records of units are kept.
    is_brief: bool,
}

/// Shards of earlier tries that may be kept, and whether they are certainly as they were written: those of a
/// manifest that stands.
#[derive(Debug, Default)]
struct Earlier(Vec<(Output, bool)>);

impl Earlier {
    /// Those of a manifest that stands.
    fn standing(old: &Manifest, identity: &Identity, force: bool) -> Self {
        let mut earlier = Self::default();
        earlier.add(old, identity, force);
        earlier.0.iter_mut().for_each(|(_, is_certain)| *is_certain = true);
        earlier
    }

    /// Adds those of a record of the same code and the same inputs: whose settings alone may be others.
    fn add(&mut self, record: &Manifest, identity: &Identity, force: bool) {
        let is_alike = record.code_version == identity.code_version && record.inputs == identity.inputs;
        if !force && is_alike && identity.may_go_on_from(record) {
            let outputs = record.outputs.iter().filter(|output| output.made_from.is_some());
            self.0.extend(outputs.map(|output| (output.clone(), false)));
        }
    }
}

impl Identity {
    /// Whether a manifest is of this code, configuration and inputs.
    fn is_of(&self, manifest: &Manifest) -> bool {
        (&manifest.code_version, &manifest.config_hash, &manifest.inputs)
            == (&self.code_version, &self.config_hash, &self.inputs)
    }

    /// Whether what an earlier try made is what this build would make.
    fn may_go_on_from(&self, record: &Manifest) -> bool {
        match (&self.made_by, &record.made_by) {
            (Some(now), Some(then)) => now.makes_the_same(then),
            _ => true,
        }
    }
}

/// How far a try has come.
#[derive(Debug, Default)]
struct SoFar {
    /// The manifest of the try before is still there.
    old_stands: bool,
    /// Shards of all finished units.
    outputs: Vec<Output>,
    /// Records that this try wrote.
    written: Vec<String>,
}

impl Attempt {
    /// Starts (or takes up) a try and sweeps leftovers. An old manifest stands until the first shard is ready
    /// to take an old one's place; a damaged one is replaced like any other. With `force` the new manifest
    /// differs from the old one even if everything else is equal, so that dependants become stale; units that
    /// a killed forced try finished are kept.
    ///
    /// # Errors
    /// The store cannot be read or written.
    pub fn start(store: &Store, identity: Identity, force: bool) -> Result<Self, StoreError> {
        let (scope, stage) = (identity.scope, identity.stage.as_str());
        sweep(store, scope, stage)?;
        let mut records = records_of(store, scope, stage)?;
        let old_stands = records.remove(&scope.manifest(stage));
        let old = if old_stands { sound(store.manifest(scope, stage))? } else { None };
        let mut so_far = SoFar { old_stands, ..SoFar::default() };
        let (redo, earlier) = match old {
            Some(old) => {
                let generation = old.generation + u32::from(force);
                let replaces = old.outputs.iter().map(|o| o.key.clone()).collect();
                let earlier = Earlier::standing(&old, &identity, force);
                let tells = !force && old.outputs.iter().any(|output| output.made_from.is_some());
                (Redo { generation, replaces, old: tells.then_some(old) }, earlier)
            }
            None => Self::go_on(store, &identity, force, &records, &mut so_far)?,
        };
        let (store, so_far, sections) = (store.clone(), Mutex::new(so_far), BTreeMap::new());
        Ok(Self { store, identity, redo, earlier, so_far, sections, records, is_brief: false })
    }

    /// Takes up what a try left that was stopped after it had set the old manifest aside, or had none. What
    /// it had finished for another identity is replaced like the old manifest's outputs.
    fn go_on(
        store: &Store,
        identity: &Identity,
        force: bool,
        records: &BTreeSet<String>,
        so_far: &mut SoFar,
    ) -> Result<(Redo, Earlier), StoreError> {
        let (scope, stage) = (identity.scope, identity.stage.as_str());
        let redo_key = scope.redo(stage);
        let read = if records.contains(&redo_key) { sound(store.redo(&redo_key))? } else { None };
        let read: Redo = read.unwrap_or_default();
        let mut redo = read.clone();
        let mut earlier = Earlier::default();
        if let Some(old) = &redo.old {
            earlier.add(old, identity, force);
        }
        let parts = scope.parts(stage);
        for key in records.iter().filter(|key| key.starts_with(&parts)) {
            let Some(part) = sound(store.part(key))? else { continue };
            earlier.add(&part, identity, force);
            if !identity.is_of(&part) {
                redo.replaces.extend(part.outputs.into_iter().map(|output| output.key));
            }
        }
        redo.replaces.sort_unstable();
        redo.replaces.dedup();
        if redo.replaces.len() > read.replaces.len() {
            // The records of those units are about to be replaced.
            store.write_json(&redo_key, stage, &redo)?;
            so_far.written.push(redo_key);
        }
        Ok((redo, earlier))
    }

    fn so_far(&self) -> MutexGuard<'_, SoFar> {
        // A thread that panicked inside left a valid state: outputs are recorded once they are stored.
        self.so_far.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Starts a try where none of the same identity has ended: what is named by its content is made once, and
    /// within moments. Its manifest comes back instead where it stands and everything it names is there.
    /// Several processes may try at once: each writes the same bytes, and no manifest that stands is taken
    /// away.
    ///
    /// # Errors
    /// As [`Attempt::start`].
    pub fn start_once(store: &Store, identity: Identity) -> Result<Result<Self, Manifest>, StoreError> {
        let (scope, stage) = (identity.scope, identity.stage.as_str());
        let listing = store.backend().list(&scope.folder())?;
        let manifest_key = scope.manifest(stage);
        if !listing.has_unfinished && listing.objects.is_empty() {
            return Ok(Ok(Self {
                store: store.clone(),
                identity,
                redo: Redo::default(),
                earlier: Earlier::default(),
                so_far: Mutex::default(),
                sections: BTreeMap::new(),
                records: BTreeSet::new(),
                is_brief: true,
            }));
        }
        let sizes: BTreeMap<&str, u64> = listing.objects.iter().map(|o| (o.key.as_str(), o.bytes)).collect();
        if sizes.contains_key(manifest_key.as_str())
            && let Some(manifest) = sound(store.manifest(scope, stage))?
            && identity.is_of(&manifest)
            && manifest.outputs.iter().all(|output| sizes.get(output.key.as_str()) == Some(&output.bytes))
        {
            if listing.has_unfinished || sizes.len() > manifest.outputs.len() + 1 {
                // The process that put it there may have been killed just then.
                Self::tidy(store, scope, stage)?;
            }
            return Ok(Err(manifest));
        }
        let attempt = Self::start(store, identity, false)?;
        // One that another process has put there since the look is never taken away.
        if attempt.so_far().old_stands
            && let Some(manifest) = sound(store.manifest(attempt.identity.scope, &attempt.identity.stage))?
            && attempt.identity.is_of(&manifest)
            && store.outputs_present(&manifest)?
        {
            return Ok(Err(manifest));
        }
        Ok(Ok(attempt))
    }

    /// Removes what a try left that was killed after its manifest stood: leftovers, records of units and of
    /// redoing.
    ///
    /// # Errors
    /// The store cannot be listed or changed.
    pub fn tidy(store: &Store, scope: Scope, stage: &str) -> Result<(), StoreError> {
        let backend = store.backend();
        sweep(store, scope, stage)?;
        for key in backend.keys(&scope.parts(stage))? {
            backend.remove(&key)?;
        }
        backend.remove(&scope.redo(stage))?;
        backend.remove(&scope.failure(stage))
    }

    /// Replaces one shard of what a stage did, or adds it, without doing the stage again: for records of
    /// things that the stage's other shards do not depend on. What was made from these stays as it is.
    ///
    /// # Errors
    /// The store cannot be read or written, the stage is not done, or another process does it again at this
    /// moment.
    pub fn amend(
        store: &Store,
        scope: Scope,
        stage: &str,
        key: &str,
        bytes: &[u8],
    ) -> Result<(), StoreError> {
        let read = store
            .manifest(scope, stage)?
            .ok_or_else(|| StoreError::Missing { path: store.location(&scope.manifest(stage)) })?;
        let mut file = FileWriter::create(store, key, stage)?;
        file.write_bytes(bytes)?;
        let shard = file.finish(1)?.commit()?;
        let mut manifest = read.clone();
        manifest.outputs.retain(|output| output.key != key);
        manifest.outputs.push(shard);
        manifest.outputs.sort_by(|a, b| a.key.cmp(&b.key));
        store.replace_manifest(scope, &read, &manifest)
    }

    /// Takes the old manifest away: from here on its shards are replaced one by one.
    fn set_old_aside(&self, so_far: &mut SoFar) -> Result<(), StoreError> {
        if so_far.old_stands {
            let (scope, stage) = (self.identity.scope, self.identity.stage.as_str());
            self.store.write_json(&scope.redo(stage), stage, &self.redo)?;
            so_far.written.push(scope.redo(stage));
            self.store.backend().remove(&scope.manifest(stage))?;
            so_far.old_stands = false;
        }
        Ok(())
    }

    /// Opens a unit of work (an agent, say), or `None` when an earlier try of the same identity finished it.
    /// Several may be open at once.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn unit(&self, name: &str) -> Result<Option<Unit<'_>>, StoreError> {
        let key = self.identity.scope.part(&self.identity.stage, name);
        // What another process finishes at this moment is made once more, with the same bytes.
        if self.records.contains(&key)
            && let Some(part) = sound(self.store.part(&key))?
        {
            let same = Manifest {
                format_version: part.format_version,
                outputs: part.outputs.clone(),
                ..self.manifest_of(Vec::new())
            };
            if part.digest() == same.digest()
                && self.identity.may_go_on_from(&part)
                && self.store.outputs_present(&part)?
            {
                self.so_far().outputs.extend(part.outputs);
                return Ok(None);
            }
        }
        Ok(Some(Unit { attempt: self, name: name.to_owned(), shards: Vec::new(), kept: Vec::new() }))
    }

    /// A shard that an earlier try made from the same, if it is still there.
    fn earlier(&self, key: &str, made_from: &str) -> Result<Option<Output>, StoreError> {
        for (output, is_certain) in &self.earlier.0 {
            if output.key != key || output.made_from.as_deref() != Some(made_from) {
                continue;
            }
            let is_there = if *is_certain {
                self.store.backend().size(key)? == Some(output.bytes)
            } else {
                // It may have been replaced before that try was stopped.
                self.store.holds(output)?
            };
            if is_there {
                return Ok(Some(output.clone()));
            }
        }
        Ok(None)
    }

    /// Keys of the shards of all finished units, sorted.
    #[must_use]
    pub fn keys(&self) -> Vec<String> {
        let mut keys: Vec<String> = self.so_far().outputs.iter().map(|output| output.key.clone()).collect();
        keys.sort_unstable();
        keys
    }

    /// Remembers the digest of a part that other stages depend on singly.
    pub fn section(&mut self, name: &str, digest: String) {
        self.sections.insert(name.to_owned(), digest);
    }

    /// Writes the manifest, removes what an older try left, and ends the try.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn commit(mut self) -> Result<Manifest, StoreError> {
        let mut so_far = self.so_far();
        self.set_old_aside(&mut so_far)?;
        let SoFar { outputs, written, .. } = std::mem::take(&mut *so_far);
        drop(so_far);
        let mut manifest = self.manifest_of(outputs);
        manifest.outputs.sort_by(|a, b| a.key.cmp(&b.key));
        manifest.sections = std::mem::take(&mut self.sections);
        let (scope, stage) = (self.identity.scope, self.identity.stage.as_str());
        let backend = self.store.backend();
        let kept: BTreeSet<&str> = manifest.outputs.iter().map(|o| o.key.as_str()).collect();
        for key in self.redo.replaces.iter().filter(|k| !kept.contains(k.as_str())) {
            backend.remove(key)?;
        }
        self.store.commit_manifest(&scope.manifest(stage), &manifest)?;
        let records: BTreeSet<String> = self.records.into_iter().chain(written).collect();
        let records: Vec<String> = records.into_iter().collect();
        side_by_side(&records, backend.at_once(), |key| backend.remove(key))?;
        Ok(manifest)
    }

    fn manifest_of(&self, outputs: Vec<Output>) -> Manifest {
        Manifest {
            format_version: schema::FORMAT_VERSION,
            stage: self.identity.stage.clone(),
            code_version: self.identity.code_version.clone(),
            config_hash: self.identity.config_hash.clone(),
            generation: self.redo.generation,
            inputs: self.identity.inputs.clone(),
            outputs,
            sections: BTreeMap::new(),
            accepted_by: Vec::new(),
            made_by: self.identity.made_by.clone(),
        }
    }
}

/// Records of a stage that are there: its manifest, those of units, of redoing and of failing.
fn records_of(store: &Store, scope: Scope, stage: &str) -> Result<BTreeSet<String>, StoreError> {
    let own = [scope.manifest(stage), scope.redo(stage), scope.failure(stage)];
    let parts = format!("{}/", scope.parts(stage));
    let is_own = |key: &String| own.contains(key) || key.starts_with(&parts);
    Ok(store.backend().keys(&scope.records())?.into_iter().filter(is_own).collect())
}

/// Removes what killed writers of a stage left unfinished of a scope.
fn sweep(store: &Store, scope: Scope, stage: &str) -> Result<(), StoreError> {
    for folder in scope.folders() {
        store.backend().sweep(Area::Below(&folder), stage)?;
    }
    if scope.writes_at_top() {
        store.backend().sweep(Area::Top, stage)?;
    }
    Ok(())
}

/// A unit of work within a try: its shards are kept once it is finished, even if the try is killed later.
#[derive(Debug)]
pub struct Unit<'a> {
    attempt: &'a Attempt,
    name: String,
    shards: Vec<Finished>,
    kept: Vec<Output>,
}

impl Unit<'_> {
    /// Starts a shard of any bytes.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn file(&self, key: &str) -> Result<FileWriter, StoreError> {
        FileWriter::create(&self.attempt.store, key, &self.attempt.identity.stage)
    }

    /// Starts a table.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn table<R: Row>(&self, key: &str, options: TableOptions) -> Result<TableWriter<R>, StoreError> {
        TableWriter::create(self.file(key)?, options)
    }

    /// Writes a whole table.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn rows<R: Row>(&mut self, key: &str, rows: &[R]) -> Result<(), StoreError> {
        let shard = self.finished_rows(key, rows)?;
        self.add(shard);
        Ok(())
    }

    /// The same, not yet among the unit's outputs.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn finished_rows<R: Row>(&self, key: &str, rows: &[R]) -> Result<Finished, StoreError> {
        let mut table = self.table(key, TableOptions::default())?;
        table.push(rows)?;
        table.finish()
    }

    /// Writes a whole table of a scene under the name of its rows' type.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn put<R: Row>(&mut self, scene: u32, rows: &[R]) -> Result<(), StoreError> {
        self.rows(&keys::table::<R>(scene), rows)
    }

    /// Writes a whole table of columns that no row type describes (statistics).
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn columns(&mut self, key: &str, columns: Vec<(&str, Column)>) -> Result<(), StoreError> {
        let shard = write_columns(self.file(key)?, columns)?;
        self.add(shard);
        Ok(())
    }

    /// Writes a whole shard of bytes.
    ///
    /// # Errors
    /// The store cannot be written.
    pub fn bytes(&mut self, key: &str, bytes: &[u8], rows: u64) -> Result<(), StoreError> {
        let mut file = self.file(key)?;
        file.write_bytes(bytes)?;
        self.add(file.finish(rows)?);
        Ok(())
    }

    /// Keeps a shard that an earlier try of the same code made from the same inputs and settings, if there is
    /// one: it counts among the unit's outputs and is not written. A forced try keeps none.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn keep(&mut self, key: &str, made_from: &str) -> Result<bool, StoreError> {
        let found = self.attempt.earlier(key, made_from)?;
        let is_kept = found.is_some();
        self.kept.extend(found);
        Ok(is_kept)
    }

    /// The shards that were kept.
    #[must_use]
    pub fn kept(&self) -> &[Output] {
        &self.kept
    }

    /// Counts a finished shard among the unit's outputs.
    pub fn add(&mut self, shard: Finished) {
        self.shards.push(shard);
    }

    /// Makes the unit's shards visible and ends it: from here on a killed run keeps it.
    ///
    /// # Errors
    /// The store cannot be written, or two shards of the try have the same key.
    pub fn finish(self) -> Result<(), StoreError> {
        let Self { attempt, name, shards, kept } = self;
        let mut so_far = attempt.so_far();
        let mut keys: BTreeSet<&str> = so_far.outputs.iter().map(|o| o.key.as_str()).collect();
        let mut all = shards.iter().map(Finished::output).chain(&kept);
        if let Some(output) = all.find(|output| !keys.insert(&output.key)) {
            return Err(StoreError::Twice { path: attempt.store.location(&output.key) });
        }
        attempt.set_old_aside(&mut so_far)?;
        let backend = attempt.store.backend();
        let mut outputs = kept;
        if attempt.is_brief {
            so_far.outputs.extend(write::commit(shards, backend.at_once())?);
            return Ok(());
        }
        let record = attempt.identity.scope.part(&attempt.identity.stage, &name);
        if attempt.records.contains(&record) {
            // One of another identity, whose shards are replaced now.
            backend.remove(&record)?;
        }
        outputs.extend(write::commit(shards, backend.at_once())?);
        let part = attempt.manifest_of(outputs);
        attempt.store.write_json(&record, &attempt.identity.stage, &part)?;
        so_far.written.push(record);
        so_far.outputs.extend(part.outputs);
        Ok(())
    }
}
