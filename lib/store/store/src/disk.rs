//! The store on a file system.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read, Write};
use std::ops::Range;
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use bytes::Bytes;
use walkdir::{DirEntry, WalkDir};

use crate::backend::{Area, Backend, LARGEST_READ, Listed, Listing, Shard, Sink, Unfinished};
use crate::error::StoreError;
use crate::process::{is_running, marked_host};

const UNFINISHED: &str = ".tmp";
/// What another machine (or this one, before it was started anew) left unfinished is believed dead after this
/// long without a write.
const FOREIGN_DEAD: Duration = Duration::from_secs(24 * 3600);

/// How often a folder is made anew that others remove as often.
const TRIES: usize = 100;

/// A folder. An object is written under another name, synced and renamed into place.
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
        let attempt = format!("{}~{}~{nanos:x}", marked_host(), std::process::id());
        Self { root: root.to_owned(), attempt, next: AtomicU64::new(0) }
    }

    fn path(&self, key: &str) -> PathBuf {
        self.root.join(key)
    }

    fn begin(&self, key: &str, owner: &str) -> Result<DiskSink, StoreError> {
        let path = self.path(key);
        let error = |action| {
            let path = path.display().to_string();
            move |e| StoreError::write(path, action, e)
        };
        let folder = path.parent().unwrap_or(&self.root);
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let unfinished = folder.join(format!(".{owner}~{name}~{}-{number}{UNFINISHED}", self.attempt));
        let mut tries = 0;
        let file = loop {
            match OpenOptions::new().write(true).create_new(true).open(&unfinished) {
                // There is no folder yet, or it went with the last object in it, which another process
                // removed.
                Err(e) if is_absent(&e) && tries < TRIES => tries += 1,
                opened => break opened.map_err(error("create"))?,
            }
            match fs::create_dir_all(folder) {
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists && !folder.exists() && tries < TRIES => {}
                made => made.map_err(error("make the folder of"))?,
            }
        };
        Ok(DiskSink { file: BufWriter::with_capacity(1 << 16, file), unfinished, path, committed: false })
    }

    /// Unfinished files in an area, with their owners.
    fn unfinished_files(&self, area: Area<'_>) -> Result<Vec<(PathBuf, UnfinishedName)>, StoreError> {
        let named = |entry: DirEntry| {
            let name = UnfinishedName::parse(&entry.file_name().to_string_lossy())?;
            Some((entry.into_path(), name))
        };
        let (folder, depth) = match area {
            Area::Top => ("", 1),
            Area::Below(folder) => (folder, usize::MAX),
        };
        Ok(self.walk(folder, depth)?.into_iter().filter_map(named).collect())
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

impl DiskSink {
    fn error(&self, action: &'static str) -> impl FnOnce(io::Error) -> StoreError + use<> {
        let path = self.path.display().to_string();
        move |e| StoreError::write(path, action, e)
    }

    fn sync(&mut self) -> Result<(), StoreError> {
        self.file.flush().map_err(self.error("write"))?;
        self.file.get_ref().sync_all().map_err(self.error("sync"))
    }

    /// A new name is durable only when its folder is.
    fn sync_folder(&self) -> Result<(), StoreError> {
        let Some(folder) = self.path.parent() else { return Ok(()) };
        File::open(folder).and_then(|f| f.sync_all()).map_err(self.error("sync the folder of"))
    }
}

impl Sink for DiskSink {
    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        self.sync()?;
        fs::rename(&self.unfinished, &self.path).map_err(self.error("rename into place"))?;
        self.committed = true;
        self.sync_folder()
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

struct DiskShard {
    file: File,
    bytes: u64,
}

impl Shard for DiskShard {
    fn size(&self) -> u64 {
        self.bytes
    }

    fn read_at(&self, range: Range<u64>) -> io::Result<Bytes> {
        let length = usize::try_from(range.end.saturating_sub(range.start)).map_err(io::Error::other)?;
        let mut bytes = vec![0; length];
        self.file.read_exact_at(&mut bytes, range.start)?;
        Ok(bytes.into())
    }
}

impl Backend for Disk {
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError> {
        Ok(Box::new(self.begin(key, owner)?))
    }

    fn put_if_absent(&self, key: &str, owner: &str, bytes: &[u8]) -> Result<bool, StoreError> {
        let mut sink = self.begin(key, owner)?;
        sink.write_all(bytes).map_err(sink.error("write"))?;
        sink.sync()?;
        // A link, unlike a rename, never takes the place of a file. The other name goes when the sink is
        // dropped.
        match fs::hard_link(&sink.unfinished, &sink.path) {
            Ok(()) => {}
            // A file system of a network may do it and lose the answer, or be asked twice.
            Err(_) if is_one_file(&sink.unfinished, &sink.path) => {}
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => return Ok(false),
            // Some file systems have no links.
            Err(no_link) => match rename_where_is_none(&sink.unfinished, &sink.path) {
                Ok(()) => sink.committed = true,
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => return Ok(false),
                Err(e) if is_unknown(&no_link) && is_unknown(&e) => {
                    let problem = "the file system can neither link files nor rename them without replacing \
                                   others, so two that work on a store at once would ruin it: use another one";
                    return Err(StoreError::Unfit { path: self.location(""), problem: problem.to_owned() });
                }
                Err(e) if is_unknown(&no_link) => return Err(sink.error("rename into place")(e)),
                Err(_) => return Err(sink.error("link into place")(no_link)),
            },
        }
        sink.sync_folder()?;
        Ok(true)
    }

    fn replace(&self, key: &str, owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError> {
        if self.read(key)?.as_deref() != Some(old) {
            return Ok(false);
        }
        let mut sink = self.begin(key, owner)?;
        sink.write_all(new).map_err(sink.error("write"))?;
        Box::new(sink).commit()?;
        Ok(true)
    }

    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let read = || -> io::Result<Result<Vec<u8>, u64>> {
            let mut bytes = Vec::new();
            let file = File::open(self.path(key))?;
            let length = file.metadata()?.len();
            if length > LARGEST_READ {
                return Ok(Err(length));
            }
            bytes.reserve_exact(usize::try_from(length).map_err(io::Error::other)?);
            // It may grow meanwhile, if it is none of ours.
            file.take(LARGEST_READ).read_to_end(&mut bytes)?;
            Ok(Ok(bytes))
        };
        match read() {
            Ok(Ok(bytes)) => Ok(Some(bytes)),
            Ok(Err(length)) => Err(StoreError::too_large(self.location(key), length)),
            Err(e) if is_absent(&e) => Ok(None),
            Err(e) => Err(StoreError::read(self.location(key), "read", e)),
        }
    }

    fn open(&self, key: &str, _bytes: Option<u64>) -> Result<Box<dyn Shard>, StoreError> {
        let opened = File::open(self.path(key)).and_then(|file| Ok((file.metadata()?, file)));
        match opened {
            Ok((meta, file)) if meta.is_file() => Ok(Box::new(DiskShard { file, bytes: meta.len() })),
            Ok(_) => Err(StoreError::Missing { path: self.location(key) }),
            Err(e) if is_absent(&e) => Err(StoreError::Missing { path: self.location(key) }),
            Err(e) => Err(StoreError::read(self.location(key), "open", e)),
        }
    }

    fn size(&self, key: &str) -> Result<Option<u64>, StoreError> {
        match fs::metadata(self.path(key)) {
            Ok(meta) => Ok(meta.is_file().then_some(meta.len())),
            Err(e) if is_absent(&e) => Ok(None),
            Err(e) => Err(StoreError::read(self.location(key), "look at", e)),
        }
    }

    fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError> {
        match fs::metadata(self.path(key)).and_then(|meta| meta.modified()) {
            Ok(time) => Ok(Some(time)),
            Err(e) if is_absent(&e) => Ok(None),
            Err(e) => Err(StoreError::read(self.location(key), "look at", e)),
        }
    }

    fn remove(&self, key: &str) -> Result<(), StoreError> {
        let path = self.path(key);
        match fs::remove_file(&path) {
            Ok(()) => {}
            Err(e) if is_absent(&e) => return Ok(()),
            Err(e) => return Err(StoreError::write(self.location(key), "remove", e)),
        }
        // Folders exist only for what is in them.
        let mut folder = path.parent();
        while let Some(empty) = folder.filter(|f| *f != self.root && fs::remove_dir(f).is_ok()) {
            folder = empty.parent();
        }
        Ok(())
    }

    fn list(&self, folder: &str) -> Result<Listing, StoreError> {
        let mut listing = Listing::default();
        for entry in self.walk(folder, usize::MAX)? {
            if UnfinishedName::parse(&entry.file_name().to_string_lossy()).is_some() {
                listing.has_unfinished = true;
                continue;
            }
            let Ok(key) = entry.path().strip_prefix(&self.root) else { continue };
            let bytes = match entry.metadata() {
                Ok(meta) => meta.len(),
                Err(e) if e.io_error().is_some_and(is_absent) => continue,
                Err(e) => {
                    return Err(StoreError::read(entry.path().display().to_string(), "look at", e.into()));
                }
            };
            listing.objects.push(Listed { key: key.to_string_lossy().into_owned(), bytes });
        }
        listing.objects.sort_unstable();
        Ok(listing)
    }

    fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        let failed = |e| StoreError::read(self.location(folder), "list", e);
        let entries = match fs::read_dir(self.path(folder)) {
            Err(e) if is_absent(&e) => return Ok(Vec::new()),
            entries => entries.map_err(failed)?,
        };
        let mut names = Vec::new();
        for entry in entries {
            let entry = entry.map_err(failed)?;
            // Behind links, too.
            if entry.path().is_dir() {
                names.push(entry.file_name().to_string_lossy().into_owned());
            }
        }
        names.sort_unstable();
        Ok(names)
    }

    fn unfinished(&self, folder: &str) -> Result<Vec<Unfinished>, StoreError> {
        let files = self.unfinished_files(Area::Below(folder))?.into_iter();
        Ok(files
            .map(|(path, name)| Unfinished {
                location: path.display().to_string(),
                abandoned: name.is_abandoned(&path),
                owner: name.owner,
            })
            .collect())
    }

    fn sweep(&self, area: Area<'_>, owner: &str) -> Result<usize, StoreError> {
        let mut swept = 0;
        for (path, name) in self.unfinished_files(area)? {
            if name.owner == owner && name.is_abandoned(&path) {
                match fs::remove_file(&path) {
                    // Another process sweeps the same.
                    Err(e) if is_absent(&e) => {}
                    removed => {
                        removed.map_err(|e| {
                            StoreError::write(path.display().to_string(), "remove the leftover", e)
                        })?;
                        swept += 1;
                    }
                }
            }
        }
        Ok(swept)
    }

    fn location(&self, key: &str) -> String {
        self.path(key).display().to_string()
    }
}

impl Disk {
    /// Files below a folder, down to a depth.
    fn walk(&self, folder: &str, depth: usize) -> Result<Vec<DirEntry>, StoreError> {
        let start = self.path(folder);
        let mut files = Vec::new();
        for entry in WalkDir::new(&start).max_depth(depth).follow_links(true).sort_by_file_name() {
            match entry {
                Ok(entry) if entry.file_type().is_file() => files.push(entry),
                Ok(_) => {}
                // A file or folder that vanishes while walking is another process's business.
                Err(e) if e.io_error().is_some_and(is_absent) => {}
                // A link to a folder in which it lies.
                Err(e) if e.loop_ancestor().is_some() => {}
                Err(e) => {
                    let path = e.path().unwrap_or(&start).display().to_string();
                    return Err(StoreError::read(path, "list", e.into()));
                }
            }
        }
        Ok(files)
    }
}

/// The name of an unfinished file: `.owner~name~host+mark~pid~time-number.tmp`.
struct UnfinishedName {
    owner: String,
    host: String,
    pid: u32,
}

impl UnfinishedName {
    fn parse(name: &str) -> Option<Self> {
        let (owner, rest) = name.strip_prefix('.')?.strip_suffix(UNFINISHED)?.split_once('~')?;
        let mut parts = rest.rsplit('~').skip(1);
        let (pid, host) = (parts.next()?.parse().ok()?, parts.next()?);
        Some(Self { owner: owner.to_owned(), host: host.to_owned(), pid })
    }

    /// Whether the process that was writing it is gone. Another process at work on the same shard is let be:
    /// both write the same bytes, and the later rename wins.
    fn is_abandoned(&self, path: &Path) -> bool {
        if self.host == marked_host() {
            return self.pid == std::process::id() || !is_running(self.pid);
        }
        let age = fs::metadata(path).and_then(|m| m.modified()).map(|t| t.elapsed().unwrap_or_default());
        age.is_ok_and(|age| age > FOREIGN_DEAD)
    }
}

/// Renames a file, but never takes the place of another.
fn rename_where_is_none(from: &Path, to: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    renameat_with(CWD, from, CWD, to, RenameFlags::NOREPLACE).map_err(io::Error::from)
}

/// Whether a file system does not know what it was asked for. Of links some say that nobody may make them.
fn is_unknown(error: &io::Error) -> bool {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    matches!(error.kind(), InvalidInput | PermissionDenied | Unsupported)
}

/// Whether two names are of one file.
fn is_one_file(one: &Path, other: &Path) -> bool {
    let file = |path: &Path| fs::metadata(path).map(|about| (about.dev(), about.ino())).ok();
    file(one).is_some_and(|one| file(other) == Some(one))
}

fn is_absent(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_renamed_replaces_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let [one, other, free] = ["one", "other", "free"].map(|name| folder.path().join(name));
        [&one, &other]
            .iter()
            .for_each(|path| fs::write(path, path.as_os_str().as_encoded_bytes()).expect("writes"));
        let refused = rename_where_is_none(&one, &other).expect_err("there is one");
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        rename_where_is_none(&one, &free).expect("there is none");
        assert!(
            !one.exists()
                && fs::read(&other).is_ok_and(|bytes| bytes == other.as_os_str().as_encoded_bytes())
        );
    }
}
