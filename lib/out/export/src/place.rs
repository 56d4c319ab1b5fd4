//! Where an export is written, and what of it is finished.
//!
//! Files get their names when they are whole. A unit counts once its record stands, which is put after all
//! its files are on the disk: a killed export loses the units in hand, and the next one makes just these.
//! Until then a journal names the unit's files before they are made, so that nothing is left of it that
//! nobody knows.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use store::hash_bytes;

use crate::ExportError;
use crate::asked::{Asked, changes};
use crate::disk::{UNFINISHED, inside, lines, put, read_error, remove, unfinished, write_error};
use crate::files::UnitFiles;
use crate::lock::FolderLock;
use crate::unit::{ProgressWatch, UnitName};

/// Folder of the records.
const RECORDS: &str = ".convoy-export";
/// Ends the names of lists of what a unit in hand makes.
const JOURNAL: &str = ".journal";

/// A folder that an export is written into.
#[derive(Clone, Debug)]
pub struct Destination {
    root: PathBuf,
    layout: &'static str,
}

/// A unit of which everything is written, though not yet on the disk.
pub(crate) struct Finished<'a> {
    pub(crate) unit: UnitName,
    /// Digest of what it was made from.
    pub(crate) identity: String,
    pub(crate) files: UnitFiles<'a>,
    /// What it leaves for the end.
    pub(crate) fragment: Vec<u8>,
}

/// What a finished unit wrote, from what.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Record {
    /// Digest of what it was made from.
    identity: String,
    /// Its files, with their sizes.
    files: BTreeMap<String, u64>,
    /// Digest of its fragment.
    fragment: String,
}

/// What all units of an export have in common.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Common {
    layout: String,
    /// Its options and those of the selection, in words: what makes it the same.
    options: String,
    /// The same option by option; nothing of exports of earlier versions.
    #[serde(default)]
    asked: BTreeMap<String, String>,
}

impl Destination {
    /// The folder for a layout; it is made when something is written.
    #[must_use]
    pub fn new(root: &Path, layout: &'static str) -> Self {
        Self { root: root.to_owned(), layout }
    }

    /// The folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    pub(crate) fn records(&self) -> PathBuf {
        self.root.join(RECORDS).join(self.layout)
    }

    /// The right to write here, until it is dropped.
    ///
    /// # Errors
    /// Another export is at work here, or the folder cannot be written.
    pub(crate) fn lock(&self) -> Result<FolderLock, ExportError> {
        FolderLock::take(&self.root.join(RECORDS), self.layout)
    }

    /// Refuses a folder that holds an export with other options, or strange files. Says whether there is an
    /// export with other options, which is to be replaced by `force`.
    pub(crate) fn claim(&self, asked: &Asked, force: bool) -> Result<bool, ExportError> {
        let path = self.records().join("export.json");
        match read_json::<Common>(&path)? {
            Some(found) if found.options != asked.identity && !force => Err(ExportError::Refused(format!(
                "{}: holds an export with other options ({}): choose another folder, or --force to make all of it again",
                self.root.display(),
                changes(&found.asked, &asked.by_option)
            ))),
            Some(found) => Ok(found.options != asked.identity),
            None if self.records().is_dir() => Ok(false),
            None => self.refuse_strangers().map(|()| false),
        }
    }

    /// A folder that has files, and no export of ours among them, is somebody's.
    fn refuse_strangers(&self) -> Result<(), ExportError> {
        let entries = match fs::read_dir(&self.root) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
            other => other.map_err(|source| read_error(&self.root, "list", source))?,
        };
        for entry in entries {
            let entry = entry.map_err(|source| read_error(&self.root, "list", source))?;
            if entry.file_name() != RECORDS {
                let (root, name) = (self.root.display(), entry.file_name());
                let name = name.display();
                let problem =
                    format!("{root}: holds `{name}` already, which no export made: choose another folder");
                return Err(ExportError::Refused(problem));
            }
        }
        Ok(())
    }

    /// Says what all units have in common.
    pub(crate) fn declare(&self, asked: &Asked) -> Result<(), ExportError> {
        let Asked { identity: options, by_option: asked } = asked.clone();
        let common = Common { layout: self.layout.to_owned(), options, asked };
        put(&self.records().join("export.json"), &to_json(&common))
    }

    /// Removes the files and records of all units, and what they have in common.
    pub(crate) fn forget_all(&self) -> Result<(), ExportError> {
        self.forget_common()?;
        for unit in self.named(".json")?.into_iter().chain(self.named(JOURNAL)?) {
            let names = self.forget(unit)?;
            self.prune(&names);
        }
        Ok(())
    }

    /// Names of the units that have records.
    pub(crate) fn finished(&self) -> Result<Vec<UnitName>, ExportError> {
        self.named(".json")
    }

    /// The units that have a file of some kind among the records.
    fn named(&self, ending: &str) -> Result<Vec<UnitName>, ExportError> {
        let names = self.record_names()?;
        let mut units: Vec<UnitName> =
            names.iter().filter_map(|name| name.strip_suffix(ending)).filter_map(unit_of).collect();
        units.sort_unstable();
        Ok(units)
    }

    /// Names of the files among the records; ours are all text.
    fn record_names(&self) -> Result<Vec<String>, ExportError> {
        let entries = match fs::read_dir(self.records()) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            other => other.map_err(|source| read_error(&self.records(), "list", source))?,
        };
        let mut names = Vec::new();
        for entry in entries {
            let entry = entry.map_err(|source| read_error(&self.records(), "list", source))?;
            names.extend(entry.file_name().into_string().ok());
        }
        Ok(names)
    }

    fn record_path(&self, unit: UnitName) -> PathBuf {
        self.records().join(format!("{unit}.json"))
    }

    fn fragment_path(&self, unit: UnitName) -> PathBuf {
        self.records().join(format!("{unit}.fragment"))
    }

    fn record(&self, unit: UnitName) -> Result<Option<Record>, ExportError> {
        read_json(&self.record_path(unit))
    }

    /// Whether a unit is finished: of the same identity, with all its files in their sizes.
    pub(crate) fn is_done(&self, unit: UnitName, identity: &str) -> Result<bool, ExportError> {
        let Some(record) = self.record(unit)? else { return Ok(false) };
        let here = |(name, bytes): (&String, &u64)| {
            fs::metadata(self.root.join(name)).is_ok_and(|found| found.is_file() && found.len() == *bytes)
        };
        Ok(record.identity == identity && record.files.iter().all(here) && self.fragment(unit)?.is_some())
    }

    /// What a finished unit left for the end.
    pub(crate) fn fragment(&self, unit: UnitName) -> Result<Option<Vec<u8>>, ExportError> {
        let Some(record) = self.record(unit)? else { return Ok(None) };
        let path = self.fragment_path(unit);
        match fs::read(&path) {
            Ok(bytes) => Ok(Some(bytes).filter(|bytes| hash_bytes(bytes) == record.fragment)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(read_error(&path, "read", source)),
        }
    }

    fn journal_path(&self, unit: UnitName) -> PathBuf {
        self.records().join(format!("{unit}{JOURNAL}"))
    }

    /// Removes what killed runs left among the records: files in hand, and the journals of units that are
    /// finished.
    pub(crate) fn tidy(&self) -> Result<(), ExportError> {
        for name in self.record_names()?.iter().filter(|name| name.ends_with(UNFINISHED)) {
            remove(&self.records().join(name))?;
        }
        for unit in self.named(JOURNAL)? {
            if self.record(unit)?.is_some() {
                remove(&self.journal_path(unit))?;
            }
        }
        Ok(())
    }

    /// Removes a unit: its record first, then its files, also those that a killed run has begun; last what
    /// names them. The names of the files; their folders stay, as other units may be about to write there.
    fn forget(&self, unit: UnitName) -> Result<Vec<String>, ExportError> {
        let journal = self.journal_path(unit);
        if let Some(record) = self.record(unit)? {
            // Should this be killed, the next one knows of the files.
            let names: String = record.files.keys().map(|name| format!("{name}\n")).collect();
            put(&journal, names.as_bytes())?;
            remove(&self.record_path(unit))?;
        }
        remove(&self.fragment_path(unit))?;
        let names = lines(&journal)?;
        for name in &names {
            let path = inside(&self.root, name)?;
            remove(&unfinished(&path))?;
            remove(&path)?;
        }
        remove(&journal)?;
        Ok(names)
    }

    /// Removes the folders that are empty without some files.
    pub(crate) fn prune<'n>(&self, names: impl IntoIterator<Item = &'n String>) {
        let folder = |name: &String| self.root.join(name).parent().map(Path::to_owned);
        let folders: BTreeSet<PathBuf> = names.into_iter().filter_map(folder).collect();
        for folder in folders {
            let above = folder.ancestors().take_while(|above| *above != self.root);
            // What is not empty stays.
            let _ = above.map(fs::remove_dir).take_while(Result::is_ok).count();
        }
    }

    /// Starts a unit anew.
    pub(crate) fn begin<'a>(
        &'a self,
        unit: UnitName,
        watch: &'a dyn ProgressWatch,
    ) -> Result<UnitFiles<'a>, ExportError> {
        self.forget(unit)?;
        let path = self.journal_path(unit);
        fs::create_dir_all(self.records())
            .map_err(|source| write_error(&path, "make the folder of", source))?;
        let journal = File::create(&path).map_err(|source| write_error(&path, "create", source))?;
        Ok(UnitFiles::new(&self.root, (path, journal), watch))
    }

    /// Ends units: from here on they are kept.
    pub(crate) fn end(&self, units: Vec<Finished<'_>>) -> Result<(), ExportError> {
        let mut records = Vec::new();
        for Finished { unit, identity, files, fragment } in units {
            put(&self.fragment_path(unit), &fragment)?;
            let fragment = hash_bytes(&fragment);
            records.push((unit, Record { identity, files: files.into_sizes(), fragment }));
        }
        self.sync()?;
        for (unit, record) in records {
            put(&self.record_path(unit), &to_json(&record))?;
            remove(&self.journal_path(unit))?;
        }
        Ok(())
    }

    /// Everything written so far is on the disk after this.
    pub(crate) fn sync(&self) -> Result<(), ExportError> {
        let folder = File::open(&self.root).map_err(|source| write_error(&self.root, "open", source))?;
        #[cfg(target_os = "linux")]
        let done = rustix::fs::syncfs(&folder).map_err(io::Error::from);
        #[cfg(not(target_os = "linux"))]
        let done = folder.sync_all();
        done.map_err(|source| write_error(&self.root, "sync", source))
    }
}

fn unit_of(name: &str) -> Option<UnitName> {
    let rest = name.strip_prefix("scene_")?;
    let (scene, agent) = match rest.split_once('.') {
        Some((scene, agent)) => (scene, Some(agent.parse().ok()?)),
        None => (rest, None),
    };
    Some(UnitName { scene: scene.parse().ok()?, agent })
}

/// A record; a damaged one counts as none.
fn read_json<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<Option<T>, ExportError> {
    match fs::read(path) {
        Ok(bytes) => Ok(serde_json::from_slice(&bytes).ok()),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(read_error(path, "read", source)),
    }
}

fn to_json<T: Serialize>(value: &T) -> Vec<u8> {
    // Records are lists and maps of text and numbers: they can always be written down.
    serde_json::to_vec_pretty(value).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use schema::AgentId;

    use super::*;
    use crate::unit::Nobody;

    fn files_below(folder: &Path) -> Vec<String> {
        let mut found = Vec::new();
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                found.extend(files_below(&path));
            } else {
                found.push(path.file_name().unwrap_or_default().to_string_lossy().into_owned());
            }
        }
        found.sort();
        found
    }

    #[test]
    fn a_unit_counts_once_it_is_ended_and_leaves_nothing_when_it_is_not() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        let unit = UnitName { scene: 3, agent: Some(AgentId::rsu(1)) };
        let mut files = place.begin(unit, &Nobody)?;
        files.put("a/one.bin", b"12345")?;
        files.link("a/one.bin", "b/two.bin")?;
        // Killed while a file is in hand.
        drop(files.create("a/three.bin")?);
        drop(files);
        assert!(!place.is_done(unit, "x")? && place.finished()?.is_empty());

        let mut files = place.begin(unit, &Nobody)?;
        assert_eq!(files_below(folder.path()), ["scene_0003.rsu_1.journal"]);
        files.put("a/four.bin", b"1")?;
        let finished = Finished { unit, identity: "x".to_owned(), files, fragment: b"fragment".to_vec() };
        place.end(vec![finished])?;
        assert!(place.is_done(unit, "x")? && !place.is_done(unit, "y")?);
        assert_eq!((place.finished()?, place.fragment(unit)?), (vec![unit], Some(b"fragment".to_vec())));

        // Another size is another file; a changed fragment is none.
        fs::write(folder.path().join("a/four.bin"), "12").expect("is written");
        assert!(!place.is_done(unit, "x")?);
        fs::write(folder.path().join("a/four.bin"), "2").expect("is written");
        fs::write(place.fragment_path(unit), "other").expect("is written");
        assert!(!place.is_done(unit, "x")?);
        Ok(())
    }

    /// A unit of one file, ended.
    fn end_one(place: &Destination, unit: UnitName) -> Result<(), ExportError> {
        let mut files = place.begin(unit, &Nobody)?;
        files.put("a/one.bin", b"1")?;
        place.end(vec![Finished { unit, identity: "x".to_owned(), files, fragment: Vec::new() }])
    }

    #[test]
    fn a_kill_between_the_record_and_the_end_of_the_journal_leaves_nothing() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        let (ended, begun) = (UnitName { scene: 0, agent: None }, UnitName { scene: 1, agent: None });
        end_one(&place, ended)?;
        let whole = files_below(folder.path());
        fs::write(place.journal_path(ended), "a/one.bin\n").expect("is written");
        fs::write(unfinished(&place.journal_path(ended)), "a/o").expect("is written");
        drop(place.begin(begun, &Nobody)?);
        place.tidy()?;
        assert!(place.is_done(ended, "x")? && place.journal_path(begun).is_file());
        place.forget(begun)?;
        assert_eq!(files_below(folder.path()), whole);
        Ok(())
    }

    #[test]
    fn a_kill_while_a_unit_is_removed_leaves_its_files_known() -> Result<(), ExportError> {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        let unit = UnitName { scene: 0, agent: None };
        end_one(&place, unit)?;
        // A folder in place of the file stops the removal where a kill would.
        let file = folder.path().join("a/one.bin");
        fs::remove_file(&file).and_then(|()| fs::create_dir(&file)).expect("is a folder now");
        assert!(place.forget(unit).is_err() && !place.is_done(unit, "x")?);
        fs::remove_dir(&file).and_then(|()| fs::write(&file, "1")).expect("is a file again");
        // The last line was cut off: nothing is done to what it may name.
        fs::write(folder.path().join("a/one"), "mine").expect("is written");
        let mut names = fs::read(place.journal_path(unit)).expect("is read");
        names.extend_from_slice(b"a/one");
        for cut in [&names[..], b"a/one\xc3"] {
            fs::write(place.journal_path(unit), cut).expect("is written");
            place.forget(unit)?;
        }
        assert_eq!(files_below(folder.path()), ["one"]);
        Ok(())
    }

    #[test]
    fn names_stay_below_the_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Destination::new(folder.path(), "test");
        let mut files = place.begin_common(&Nobody).expect("can be written");
        for name in ["", "/etc/x", "../x", "a/../../x"] {
            assert!(files.put(name, b"").is_err(), "{name}");
        }
    }
}
