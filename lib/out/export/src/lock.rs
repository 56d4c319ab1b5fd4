//! One export at a time in a folder.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::ExportError;
use crate::disk::{read_error, remove, write_error};

/// Its name in the folder of records.
const LOCK: &str = "lock.json";
/// A lock that is given back while one looks at it is asked for again, so often.
const TRIES: usize = 5;

/// Who is at work in a folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Owner {
    /// Name of the machine.
    host: String,
    /// Number of the process.
    process: u32,
    /// When the process began, as the system counts; tells it from a later one of the same number.
    began: Option<u64>,
    /// What it exports.
    layout: String,
}

impl Owner {
    fn of_this_process(layout: &str) -> Self {
        let process = std::process::id();
        Self { host: host(), process, began: began(process), layout: layout.to_owned() }
    }

    /// Whether its process has ended, as far as this machine can tell.
    fn is_gone(&self) -> bool {
        self.host == host() && (self.began.is_none() || began(self.process) != self.began)
    }
}

/// The right to write into a folder, until it is dropped.
#[derive(Debug)]
pub(crate) struct FolderLock {
    path: PathBuf,
    owner: Owner,
}

impl FolderLock {
    /// Takes the lock in a folder of records; that of a process of this machine that has ended gives way.
    ///
    /// # Errors
    /// Another export holds it, or the folder cannot be written.
    pub(crate) fn take(records: &Path, layout: &str) -> Result<Self, ExportError> {
        let path = records.join(LOCK);
        let owner = Owner::of_this_process(layout);
        fs::create_dir_all(records).map_err(|source| write_error(records, "make", source))?;
        for _ in 0..TRIES {
            if create(&path, &owner).map_err(|source| write_error(&path, "create", source))? {
                sweep(records);
                return Ok(Self { path, owner });
            }
            match fs::read(&path) {
                Err(e) if e.kind() == io::ErrorKind::NotFound => {}
                Err(source) => return Err(read_error(&path, "read", source)),
                Ok(text) => match serde_json::from_slice::<Owner>(&text) {
                    Ok(found) if found.is_gone() => take_away(&path, &text)?,
                    found => return Err(held(&path, found.ok().as_ref())),
                },
            }
        }
        Err(held(&path, None))
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        let text = fs::read(&self.path).ok();
        if text.and_then(|text| serde_json::from_slice::<Owner>(&text).ok()).as_ref() == Some(&self.owner) {
            // One that cannot be removed is taken over by the next export.
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn held(path: &Path, owner: Option<&Owner>) -> ExportError {
    let folder = path.parent().and_then(Path::parent).unwrap_or(path).display();
    let who = match owner {
        Some(Owner { host, process, layout, .. }) => {
            format!("process {process} on {host} (export {layout})")
        }
        None => "another export".to_owned(),
    };
    ExportError::Refused(format!(
        "{folder}: {who} is at work there: wait for it, or choose another folder (if it is none any more, remove {})",
        path.display()
    ))
}

/// Makes the lock with its owner in it; not where there is one.
fn create(path: &Path, owner: &Owner) -> io::Result<bool> {
    let text = serde_json::to_vec_pretty(owner).unwrap_or_default();
    let own = beside(path);
    fs::write(&own, &text)?;
    // A link, unlike a rename, never takes the place of a file.
    let linked = fs::hard_link(&own, path);
    fs::remove_file(&own)?;
    match linked {
        Ok(()) => Ok(true),
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(false),
        // Some file systems have no links: there it is empty for a moment.
        Err(_) => match OpenOptions::new().write(true).create_new(true).open(path) {
            Ok(mut file) => file.write_all(&text).map(|()| true),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(false),
            Err(e) => Err(e),
        },
    }
}

/// Removes the lock of an owner that is gone. Several may try at once, and one of them may have a lock of its
/// own there by now: that is put back.
fn take_away(path: &Path, text: &[u8]) -> Result<(), ExportError> {
    let away = beside(path);
    match fs::rename(path, &away) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        other => other.map_err(|source| write_error(path, "take over", source))?,
    }
    let is_as_read = fs::read(&away).is_ok_and(|found| found == text);
    if !is_as_read {
        fs::hard_link(&away, path).map_err(|source| write_error(path, "put back", source))?;
    }
    remove(&away)
}

/// A name that no other process uses.
fn beside(path: &Path) -> PathBuf {
    path.with_extension(format!("{}-{}", host(), std::process::id()))
}

/// Removes what processes of this machine left that were killed while they looked for the lock.
fn sweep(records: &Path) {
    let begins = format!("lock.{}-", host());
    for entry in fs::read_dir(records).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let process = name.to_str().and_then(|name| name.strip_prefix(&begins)?.parse().ok());
        if process.is_some_and(|process| began(process).is_none()) {
            // One that cannot be removed is in nobody's way.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().replace('/', "-")
}

/// When a running process of this machine began, in ticks since it was started; none for one that has ended,
/// and where the system does not tell.
fn began(process: u32) -> Option<u64> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // `process (name) state ...`, the time 20th from the state on; a name may hold brackets.
    let fields: Vec<&str> = stat.rsplit(") ").next()?.split(' ').collect();
    if matches!(fields.first(), None | Some(&("Z" | "X"))) {
        return None;
    }
    fields.get(19)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    fn put(records: &Path, owner: &Owner) {
        fs::write(records.join(LOCK), serde_json::to_vec(owner).expect("is text")).expect("is written");
    }

    fn names(records: &Path) -> usize {
        fs::read_dir(records).expect("is a folder").count()
    }

    #[test]
    fn one_holds_it_until_it_is_dropped() {
        let folder = tempfile::tempdir().expect("a folder");
        let records = folder.path().join(".convoy-export");
        let held = FolderLock::take(&records, "kitti").expect("is free");
        let refused = FolderLock::take(&records, "mcap").expect_err("is held").to_string();
        let process = std::process::id();
        for words in [
            format!("{}: process {process} on {}", folder.path().display(), host()),
            "(export kitti)".to_owned(),
            "choose another folder".to_owned(),
            format!("remove {}", records.join(LOCK).display()),
        ] {
            assert!(refused.contains(&words), "{words}: {refused}");
        }
        drop(held);
        assert_eq!(names(&records), 0, "it leaves nothing");
        drop(FolderLock::take(&records, "mcap").expect("is free again"));
    }

    #[test]
    fn that_of_a_process_that_ended_gives_way_and_that_of_another_host_does_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let records = folder.path();
        let mut child = Command::new("sleep").arg("60").stdout(Stdio::null()).spawn().expect("starts");
        let process = child.id();
        let owner = Owner { host: host(), process, began: began(process), layout: "kitti".to_owned() };
        assert!(owner.began.is_some());
        put(records, &owner);
        assert!(FolderLock::take(records, "kitti").is_err(), "it runs");
        // A process of the same number that began at another time is another one.
        put(records, &Owner { began: owner.began.map(|began| began - 1), ..owner.clone() });
        drop(FolderLock::take(records, "kitti").expect("is none any more"));
        child.kill().and_then(|()| child.wait()).expect("ends");
        put(records, &owner);
        drop(FolderLock::take(records, "kitti").expect("has ended"));
        assert_eq!(names(records), 0);

        let elsewhere = Owner { host: "elsewhere".to_owned(), ..owner };
        put(records, &elsewhere);
        let refused = FolderLock::take(records, "kitti").expect_err("nobody knows").to_string();
        assert!(refused.contains(&format!("process {process} on elsewhere")), "{refused}");
        fs::write(records.join(LOCK), "").expect("is written");
        let refused = FolderLock::take(records, "kitti").expect_err("is being written").to_string();
        assert!(refused.contains("another export"), "{refused}");
        assert_eq!(names(records), 1, "it stays as it was");
    }

    #[test]
    fn of_many_that_find_a_dead_one_a_single_one_gets_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let records = folder.path();
        // No process has this number.
        let gone = Owner { host: host(), process: u32::MAX, began: Some(1), layout: "kitti".to_owned() };
        put(records, &gone);
        fs::write(records.join(format!("lock.{}-{}", host(), u32::MAX)), "").expect("is written");
        let text = fs::read(records.join(LOCK)).expect("is there");
        let held = FolderLock::take(records, "kitti").expect("is taken over");
        // Another one has read the dead one's, too, and is late.
        take_away(&records.join(LOCK), &text).expect("puts it back");
        assert!(FolderLock::take(records, "kitti").is_err(), "it is held");
        drop(held);
        assert_eq!(names(records), 0);
    }
}
