//! The store on a file system.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::backend::{Backend, Shard, Sink};
use crate::error::StoreError;

const UNFINISHED: &str = ".tmp";
/// What another host left unfinished is believed dead after this long without a write.
const FOREIGN_DEAD: Duration = Duration::from_secs(24 * 3600);

/// A folder.
#[derive(Debug)]
pub struct Disk {
    root: PathBuf,
    attempt: String,
    next: AtomicU64,
}

impl Disk {
    /// The store in a folder, which is made when something is written.
    #[must_use]
    pub fn new(root: &Path) -> Self {
        // The attempt's name only has to differ from other processes'; it never reaches a committed byte.
        let nanos = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_nanos());
        let attempt = format!("{}~{}~{nanos:x}", host(), std::process::id());
        Self { root: root.to_owned(), attempt, next: AtomicU64::new(0) }
    }

    fn path(&self, key: &str) -> PathBuf {
        self.root.join(key)
    }
}

struct DiskSink {
    file: BufWriter<File>,
    unfinished: PathBuf,
    path: PathBuf,
    committed: bool,
}

impl Write for DiskSink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Sink for DiskSink {
    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        let error = |action| {
            let path = self.path.display().to_string();
            move |e| StoreError::io(path, action, e)
        };
        self.file.flush().map_err(error("write"))?;
        self.file.get_ref().sync_all().map_err(error("sync"))?;
        fs::rename(&self.unfinished, &self.path).map_err(error("rename into place"))?;
        self.committed = true;
        if let Some(folder) = self.path.parent() {
            // The rename is durable only when the folder is.
            File::open(folder).and_then(|f| f.sync_all()).map_err(error("sync the folder of"))?;
        }
        Ok(())
    }
}

impl Drop for DiskSink {
    fn drop(&mut self) {
        if !self.committed {
            // A leftover that cannot be removed now is swept at the next start.
            let _ = fs::remove_file(&self.unfinished);
        }
    }
}

impl Backend for Disk {
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        let path = self.path(key);
        let error = |action| {
            let path = path.display().to_string();
            move |e| StoreError::io(path, action, e)
        };
        let folder = path.parent().unwrap_or(&self.root);
        fs::create_dir_all(folder).map_err(error("make the folder of"))?;
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let unfinished = folder.join(format!(".{owner}~{name}~{}-{number}{UNFINISHED}", self.attempt));
        let file =
            OpenOptions::new().write(true).create_new(true).open(&unfinished).map_err(error("create"))?;
        Ok(Box::new(DiskSink {
            file: BufWriter::with_capacity(1 << 16, file),
            unfinished,
            path,
            committed: false,
        }))
    }

    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        match fs::read(self.path(key)) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if is_absent(&e) => Ok(None),
            Err(e) => Err(StoreError::io(self.location(key), "read", e)),
        }
    }

    fn open(&self, key: &str) -> Result<Shard, StoreError> {
        match File::open(self.path(key)) {
            Ok(file) => Ok(Shard::File(file)),
            Err(e) if is_absent(&e) => Err(StoreError::Missing { path: self.location(key) }),
            Err(e) => Err(StoreError::io(self.location(key), "open", e)),
        }
    }

    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        match fs::metadata(self.path(key)) {
            Ok(meta) => Ok(Some(meta.len())),
            Err(e) if is_absent(&e) => Ok(None),
            Err(e) => Err(StoreError::io(self.location(key), "look at", e)),
        }
    }

    fn remove(&self, key: &str) -> Result<(), StoreError> {
        let path = self.path(key);
        match fs::remove_file(&path) {
            Ok(()) => {}
            Err(e) if is_absent(&e) => return Ok(()),
            Err(e) => return Err(StoreError::io(self.location(key), "remove", e)),
        }
        // Folders exist only for what is in them.
        let mut folder = path.parent();
        while let Some(empty) = folder.filter(|f| *f != self.root && fs::remove_dir(f).is_ok()) {
            folder = empty.parent();
        }
        Ok(())
    }

    fn list(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        let mut keys = Vec::new();
        for path in self.walk(folder)? {
            if path.extension().is_none_or(|e| e != "tmp")
                && let Ok(key) = path.strip_prefix(&self.root)
            {
                keys.push(key.to_string_lossy().into_owned());
            }
        }
        keys.sort_unstable();
        Ok(keys)
    }

    fn sweep(&self, folder: &str, owner: &str) -> Result<usize, StoreError> {
        let prefix = format!(".{owner}~");
        let mut swept = 0;
        for path in self.walk(folder)? {
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            if name.starts_with(&prefix) && name.ends_with(UNFINISHED) && is_abandoned(&path, &name) {
                fs::remove_file(&path)
                    .map_err(|e| StoreError::io(path.display().to_string(), "remove the leftover", e))?;
                swept += 1;
            }
        }
        Ok(swept)
    }

    fn location(&self, key: &str) -> String {
        self.path(key).display().to_string()
    }
}

impl Disk {
    fn walk(&self, folder: &str) -> Result<Vec<PathBuf>, StoreError> {
        let start = self.path(folder);
        let mut files = Vec::new();
        for entry in walkdir::WalkDir::new(&start).sort_by_file_name() {
            match entry {
                Ok(entry) if entry.file_type().is_file() => files.push(entry.into_path()),
                Ok(_) => {}
                // A file or folder that vanishes while walking is another process's business.
                Err(e) if e.io_error().is_some_and(is_absent) => {}
                Err(e) => {
                    let path = e.path().unwrap_or(&start).display().to_string();
                    return Err(StoreError::io(path, "list", e.into()));
                }
            }
        }
        Ok(files)
    }
}

/// Name of this machine, without what separates the parts of an unfinished file's name.
fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().replace(['~', '/'], "-")
}

/// Whether the process that was writing an unfinished file (`.owner~name~host~pid~...`) is gone. Another process at work
/// on the same shard is let be: both write the same bytes, and the later rename wins.
fn is_abandoned(path: &Path, name: &str) -> bool {
    let mut parts = name.rsplit('~').skip(1);
    let (pid, written_on) = (parts.next().and_then(|p| p.parse::<u32>().ok()), parts.next());
    let (Some(pid), Some(written_on)) = (pid, written_on) else { return true };
    if written_on == host() {
        return pid == std::process::id() || !is_running(pid);
    }
    let age = fs::metadata(path).and_then(|m| m.modified()).map(|t| t.elapsed().unwrap_or_default());
    age.is_ok_and(|age| age > FOREIGN_DEAD)
}

/// Whether a process of this machine still does anything. Where `/proc` does not tell, it counts as gone.
fn is_running(pid: u32) -> bool {
    let Ok(stat) = fs::read_to_string(format!("/proc/{pid}/stat")) else { return false };
    // `pid (name) state ...`; a name may hold brackets.
    let state = stat.rsplit(") ").next().and_then(|rest| rest.chars().next());
    !matches!(state, None | Some('Z' | 'X'))
}

fn is_absent(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
}
