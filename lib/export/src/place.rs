//! Where an export is written, and what of it is finished.
//!
//! Files get their names when they are whole. A unit counts once its record stands, which is put after all its files are on
//! the disk: a killed export loses the units in hand, and the next one makes just these.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};
use store::hash_bytes;

use crate::ExportError;
use crate::unit::{UnitName, Watch};

/// Folder of the records.
const RECORDS: &str = ".convoy-export";
/// What a file in hand is called behind its name.
const UNFINISHED: &str = ".unfinished";

/// A folder that an export is written into.
#[derive(Clone, Debug)]
pub struct Destination {
    root: PathBuf,
    layout: &'static str,
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
    /// Its options and those of the selection, in words.
    options: String,
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

    fn records(&self) -> PathBuf {
        self.root.join(RECORDS).join(self.layout)
    }

    /// Refuses a folder that holds an export with other options, or strange files.
    pub(crate) fn claim(&self, options: &str, force: bool) -> Result<(), ExportError> {
        let path = self.records().join("export.json");
        match read_json::<Common>(&path)? {
            Some(found) if found.options != options && !force => Err(ExportError::Refused(format!(
                "{}: holds an export with other options ({}; now {options}): choose another folder, or --force to make all of it again",
                self.root.display(),
                found.options
            ))),
            Some(found) if found.options != options => self.forget_all(),
            Some(_) => Ok(()),
            None if self.records().is_dir() => Ok(()),
            None => self.refuse_strangers(),
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
                let problem =
                    format!("{root}: holds {name:?} already, which no export made: choose another folder");
                return Err(ExportError::Refused(problem));
            }
        }
        Ok(())
    }

    /// Says what all units have in common.
    pub(crate) fn declare(&self, options: &str) -> Result<(), ExportError> {
        let common = Common { layout: self.layout.to_owned(), options: options.to_owned() };
        put(&self.records().join("export.json"), &to_json(&common))
    }

    /// Removes the files and records of all units.
    fn forget_all(&self) -> Result<(), ExportError> {
        for unit in self.finished()? {
            self.forget(unit)?;
        }
        Ok(())
    }

    /// Names of the units that have records.
    pub(crate) fn finished(&self) -> Result<Vec<UnitName>, ExportError> {
        let entries = match fs::read_dir(self.records()) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            other => other.map_err(|source| read_error(&self.records(), "list", source))?,
        };
        let mut units = Vec::new();
        for entry in entries {
            let entry = entry.map_err(|source| read_error(&self.records(), "list", source))?;
            let name = entry.file_name();
            units.extend(name.to_str().and_then(|n| n.strip_suffix(".json")).and_then(unit_of));
        }
        units.sort_unstable();
        Ok(units)
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

    /// Removes a unit: its record first, then its files.
    fn forget(&self, unit: UnitName) -> Result<(), ExportError> {
        if let Some(record) = self.record(unit)? {
            remove(&self.record_path(unit))?;
            for name in record.files.keys() {
                remove(&self.inside(name)?)?;
            }
        }
        remove(&self.fragment_path(unit))
    }

    /// Starts a unit anew.
    pub(crate) fn begin<'a>(
        &'a self,
        unit: UnitName,
        watch: &'a dyn Watch,
    ) -> Result<UnitFiles<'a>, ExportError> {
        self.forget(unit)?;
        Ok(self.files(watch))
    }

    /// Files that belong to no unit.
    pub(crate) fn files<'a>(&'a self, watch: &'a dyn Watch) -> UnitFiles<'a> {
        UnitFiles { place: self, files: BTreeMap::new(), folders: BTreeSet::new(), watch }
    }

    /// Ends a unit: from here on it is kept.
    pub(crate) fn end(
        &self,
        unit: UnitName,
        identity: &str,
        files: UnitFiles<'_>,
        fragment: &[u8],
    ) -> Result<(), ExportError> {
        let record =
            Record { identity: identity.to_owned(), files: files.files, fragment: hash_bytes(fragment) };
        put(&self.fragment_path(unit), fragment)?;
        self.sync()?;
        put(&self.record_path(unit), &to_json(&record))
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

    /// A path below the folder.
    fn inside(&self, name: &str) -> Result<PathBuf, ExportError> {
        let plain = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        if name.is_empty() || !plain {
            return Err(ExportError::Refused(format!(
                "`{name}` is no name of a file below the export's folder"
            )));
        }
        Ok(self.root.join(name))
    }
}

/// The files of a unit in hand.
pub struct UnitFiles<'a> {
    place: &'a Destination,
    files: BTreeMap<String, u64>,
    folders: BTreeSet<PathBuf>,
    watch: &'a dyn Watch,
}

impl UnitFiles<'_> {
    /// Writes a whole file, by its path below the export's folder (`/` between parts).
    ///
    /// # Errors
    /// It cannot be written, or is written twice.
    pub fn put(&mut self, name: &str, bytes: &[u8]) -> Result<(), ExportError> {
        let mut file = self.create(name)?;
        file.write_all(bytes)?;
        self.add(file)
    }

    /// Starts a file that is written piece by piece; [`UnitFiles::add`] ends it.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn create(&mut self, name: &str) -> Result<ExportFile, ExportError> {
        let path = self.place.inside(name)?;
        if self.files.contains_key(name) {
            return Err(ExportError::Refused(format!("{}: is written twice", path.display())));
        }
        self.folder_of(&path)?;
        let mut unfinished = path.clone().into_os_string();
        unfinished.push(UNFINISHED);
        let unfinished = PathBuf::from(unfinished);
        let file = File::create(&unfinished).map_err(|source| write_error(&path, "create", source))?;
        Ok(ExportFile {
            name: name.to_owned(),
            path,
            unfinished,
            stream: BufWriter::with_capacity(1 << 16, file),
            bytes: 0,
        })
    }

    /// Ends a file: it gets its name.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn add(&mut self, file: ExportFile) -> Result<(), ExportError> {
        let ExportFile { name, path, unfinished, mut stream, bytes } = file;
        stream.flush().map_err(|source| write_error(&path, "write", source))?;
        drop(stream);
        fs::rename(&unfinished, &path).map_err(|source| write_error(&path, "rename into place", source))?;
        self.files.insert(name, bytes);
        Ok(())
    }

    /// Gives a finished file of the unit a second name: a link where the file system has them, else a copy.
    ///
    /// # Errors
    /// It cannot be written, or there is no such file.
    pub fn link(&mut self, name: &str, second: &str) -> Result<(), ExportError> {
        let from = self.place.inside(name)?;
        let Some(bytes) = self.files.get(name).copied() else {
            return Err(ExportError::Refused(format!("{}: is not written yet", from.display())));
        };
        let to = self.place.inside(second)?;
        self.folder_of(&to)?;
        remove(&to)?;
        fs::hard_link(&from, &to)
            .or_else(|_| fs::copy(&from, &to).map(|_| ()))
            .map_err(|source| write_error(&to, "write", source))?;
        self.files.insert(second.to_owned(), bytes);
        Ok(())
    }

    fn folder_of(&mut self, path: &Path) -> Result<(), ExportError> {
        let folder = path.parent().unwrap_or(&self.place.root);
        if !self.folders.contains(folder) {
            fs::create_dir_all(folder).map_err(|source| write_error(folder, "make", source))?;
            self.folders.insert(folder.to_owned());
        }
        Ok(())
    }

    /// Counts frames of agents as done.
    ///
    /// # Errors
    /// A signal came: drop what is in hand and return.
    pub fn advance(&self, agent_frames: u64) -> Result<(), ExportError> {
        if self.watch.advance(agent_frames) { Err(ExportError::Stopped) } else { Ok(()) }
    }
}

/// A file that is being written.
#[derive(Debug)]
pub struct ExportFile {
    name: String,
    path: PathBuf,
    unfinished: PathBuf,
    stream: BufWriter<File>,
    bytes: u64,
}

impl ExportFile {
    /// Appends bytes.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn write_all(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        self.bytes += bytes.len() as u64;
        self.stream.write_all(bytes).map_err(|source| write_error(&self.path, "write", source))
    }
}

/// For writers of formats that want a stream.
impl Write for ExportFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.stream.write(bytes)?;
        self.bytes += written as u64;
        Ok(written)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
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

fn read_error(path: &Path, action: &'static str, source: io::Error) -> ExportError {
    ExportError::Read { path: path.to_owned(), action, source }
}

fn write_error(path: &Path, action: &'static str, source: io::Error) -> ExportError {
    ExportError::Write { path: path.to_owned(), action, source }
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

/// Writes a small file whole, and synced.
fn put(path: &Path, bytes: &[u8]) -> Result<(), ExportError> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder).map_err(|source| write_error(folder, "make", source))?;
    let mut unfinished = path.to_owned().into_os_string();
    unfinished.push(UNFINISHED);
    let unfinished = PathBuf::from(unfinished);
    let written = File::create(&unfinished).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&unfinished, path)).map_err(|source| write_error(path, "write", source))
}

fn remove(path: &Path) -> Result<(), ExportError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(write_error(path, "remove", e)),
        _ => Ok(()),
    }
}
