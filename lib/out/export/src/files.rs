//! The files that a unit writes.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::ExportError;
use crate::disk::{inside, read_error, remove, unfinished, write_error};
use crate::unit::ProgressWatch;

/// Names the files of a unit before they are made.
struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

/// The files of a unit in hand, or of a piece of it.
pub struct UnitFiles<'a> {
    root: &'a Path,
    files: BTreeMap<String, u64>,
    folders: BTreeSet<PathBuf>,
    journal: Arc<Journal>,
    watch: &'a dyn ProgressWatch,
}

impl<'a> UnitFiles<'a> {
    /// Files below a folder; the journal names each before it is made.
    pub(crate) fn new(root: &'a Path, (path, file): (PathBuf, File), watch: &'a dyn ProgressWatch) -> Self {
        let journal = Arc::new(Journal { path, file: Mutex::new(file) });
        Self { root, files: BTreeMap::new(), folders: BTreeSet::new(), journal, watch }
    }

    /// For another piece of the same unit.
    pub(crate) fn of_piece(&self) -> Self {
        let journal = self.journal.clone();
        Self {
            root: self.root,
            files: BTreeMap::new(),
            folders: self.folders.clone(),
            journal,
            watch: self.watch,
        }
    }

    /// Takes the finished files of a piece over.
    ///
    /// # Errors
    /// Another piece wrote one of them, too.
    pub(crate) fn take(&mut self, piece: Self) -> Result<(), ExportError> {
        if let Some(name) = piece.files.keys().find(|name| self.files.contains_key(*name)) {
            return Err(written_twice(&self.root.join(name)));
        }
        self.files.extend(piece.files);
        self.folders.extend(piece.folders);
        Ok(())
    }

    /// The finished files, with their sizes.
    pub(crate) fn into_sizes(self) -> BTreeMap<String, u64> {
        self.files
    }

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
        let path = inside(self.root, name)?;
        if self.files.contains_key(name) {
            return Err(written_twice(&path));
        }
        self.announce(name)?;
        self.folder_of(&path)?;
        let unfinished = unfinished(&path);
        let file = File::create(&unfinished).map_err(|source| write_error(&path, "create", source))?;
        Ok(ExportFile {
            name: name.to_owned(),
            path,
            unfinished,
            stream: BufWriter::with_capacity(1 << 16, file),
            bytes: 0,
        })
    }

    /// Makes a folder, for readers that look for empty ones, too.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn folder(&mut self, name: &str) -> Result<(), ExportError> {
        let folder = inside(self.root, name)?;
        fs::create_dir_all(&folder).map_err(|source| write_error(&folder, "make", source))?;
        self.folders.insert(folder);
        Ok(())
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

    /// Opens a finished file of any unit, for what is made at the end.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn open(&self, name: &str) -> Result<File, ExportError> {
        let path = inside(self.root, name)?;
        File::open(&path).map_err(|source| read_error(&path, "open", source))
    }

    /// Gives a finished file of the unit a second name: a link where the file system has them, else a copy.
    ///
    /// # Errors
    /// It cannot be written, or there is no such file.
    pub fn link(&mut self, name: &str, second: &str) -> Result<(), ExportError> {
        let from = inside(self.root, name)?;
        let Some(bytes) = self.files.get(name).copied() else {
            return Err(ExportError::Refused(format!("{}: is not written yet", from.display())));
        };
        let to = inside(self.root, second)?;
        self.announce(second)?;
        self.folder_of(&to)?;
        remove(&to)?;
        fs::hard_link(&from, &to)
            .or_else(|_| fs::copy(&from, &to).map(|_| ()))
            .map_err(|source| write_error(&to, "write", source))?;
        self.files.insert(second.to_owned(), bytes);
        Ok(())
    }

    /// Says in the journal that a file will be made.
    fn announce(&mut self, name: &str) -> Result<(), ExportError> {
        let Journal { path, file } = &*self.journal;
        // One write: a line of another piece never stands within it.
        let written =
            file.lock().unwrap_or_else(PoisonError::into_inner).write_all(format!("{name}\n").as_bytes());
        written.map_err(|source| write_error(path, "write", source))
    }

    fn folder_of(&mut self, path: &Path) -> Result<(), ExportError> {
        let folder = path.parent().unwrap_or(self.root);
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

fn written_twice(path: &Path) -> ExportError {
    ExportError::Refused(format!("{}: is written twice", path.display()))
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
