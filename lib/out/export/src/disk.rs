//! Files below a folder.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use crate::ExportError;

/// What a file in hand is called behind its name.
pub(crate) const UNFINISHED: &str = ".unfinished";

/// A path below a folder.
///
/// # Errors
/// The name leads out of it, or nowhere.
pub(crate) fn inside(root: &Path, name: &str) -> Result<PathBuf, ExportError> {
    let plain = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    if name.is_empty() || !plain {
        return Err(ExportError::Refused(format!("`{name}` is no name of a file below the export's folder")));
    }
    Ok(root.join(name))
}

/// What a file is called until it is whole.
pub(crate) fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(UNFINISHED);
    name.into()
}

pub(crate) fn read_error(path: &Path, action: &'static str, source: io::Error) -> ExportError {
    ExportError::Read { path: path.to_owned(), action, source }
}

pub(crate) fn write_error(path: &Path, action: &'static str, source: io::Error) -> ExportError {
    ExportError::Write { path: path.to_owned(), action, source }
}

/// Writes a small file whole, and synced.
pub(crate) fn put(path: &Path, bytes: &[u8]) -> Result<(), ExportError> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder).map_err(|source| write_error(folder, "make", source))?;
    let unfinished = unfinished(path);
    let written = File::create(&unfinished).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&unfinished, path)).map_err(|source| write_error(path, "write", source))
}

pub(crate) fn remove(path: &Path) -> Result<(), ExportError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(write_error(path, "remove", e)),
        _ => Ok(()),
    }
}

/// The whole lines of a record: one that was cut off names a file that was not made yet.
pub(crate) fn lines(path: &Path) -> Result<Vec<String>, ExportError> {
    let bytes = match fs::read(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(|source| read_error(path, "read", source))?,
    };
    let whole = bytes.split_inclusive(|&byte| byte == b'\n').filter_map(|line| line.strip_suffix(b"\n"));
    Ok(whole.filter_map(|line| String::from_utf8(line.to_vec()).ok()).collect())
}
