//! From what a user writes to a place of storage.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use percent_encoding::percent_decode_str;

use crate::{Backend, Disk, Memory, StoreError, objects};

/// Refuses what is written like a place and names none, without asking the place.
///
/// # Errors
/// A URL that a slash lacks, no place, or a file.
pub fn check_place(place: impl AsRef<OsStr>) -> Result<(), StoreError> {
    let place = place.as_ref();
    if place.to_str().is_some_and(|text| text.contains("://")) { Ok(()) } else { open(place).map(drop) }
}

/// The place of storage that a path or a URL names.
pub(crate) fn open(place: &OsStr) -> Result<Arc<dyn Backend>, StoreError> {
    // A path that is no UTF-8 is no URL either.
    let Some(text) = place.to_str() else { return folder(Path::new(place)) };
    let unsupported =
        |problem: &str| StoreError::Place { place: text.to_owned(), problem: problem.to_owned() };
    if text == "memory:" {
        return Ok(Arc::new(Memory::default()));
    }
    match text.split_once("://") {
        None if text.is_empty() => Err(unsupported("names no place")),
        None if ["s3:/", "az:/", "gs:/", "file:/"].iter().any(|scheme| text.starts_with(scheme)) => {
            Err(unsupported("has one / behind the colon, where a URL has two"))
        }
        None => folder(Path::new(text)),
        Some(("file", rest)) => {
            let path = rest.strip_prefix("localhost").unwrap_or(rest);
            if !path.starts_with('/') {
                return Err(unsupported("a file URL takes a whole path, file:///FOLDER"));
            }
            let path = decoded(path).ok_or_else(|| unsupported("has a % without two hexadecimal digits"))?;
            folder(&path)
        }
        Some((scheme, rest)) => match objects::open(scheme, rest) {
            Some(bucket) => Ok(Arc::new(bucket?)),
            None => Err(StoreError::Place {
                place: objects::without_secrets(scheme, rest),
                problem: format!("there is no store of kind `{scheme}`"),
            }),
        },
    }
}

/// A folder, which need not exist yet.
fn folder(path: &Path) -> Result<Arc<dyn Backend>, StoreError> {
    let first_there = path.ancestors().find_map(|above| Some((above, above.metadata().ok()?)));
    match first_there {
        Some((above, found)) if !found.is_dir() => Err(StoreError::Place {
            place: path.display().to_string(),
            problem: if above == path {
                "is a file".to_owned()
            } else {
                format!("lies below a file, {}", above.display())
            },
        }),
        _ => Ok(Arc::new(Disk::new(path))),
    }
}

/// A path whose bytes may be written as `%20`.
fn decoded(path: &str) -> Option<PathBuf> {
    let is_whole =
        |after: &str| after.as_bytes().get(..2).is_some_and(|two| two.iter().all(u8::is_ascii_hexdigit));
    let decoded = percent_decode_str(path).decode_utf8().ok()?;
    path.split('%').skip(1).all(is_whole).then(|| PathBuf::from(decoded.as_ref()))
}

#[cfg(test)]
mod tests {
    use crate::Store;

    #[test]
    fn paths_and_urls_name_places() {
        for (place, location) in [
            ("dataset", "dataset/x"),
            ("/data/set 1", "/data/set 1/x"),
            ("a:b", "a:b/x"),
            ("file:///data/set%201", "/data/set 1/x"),
            ("file://localhost/data", "/data/x"),
            ("memory:", "memory:x"),
        ] {
            let store = Store::open(place).expect(place);
            assert_eq!(store.location("x"), location, "{place}");
        }
    }

    #[test]
    fn files_hold_no_store() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        std::fs::write(&file, "").expect("is written");
        let said = |place: &std::path::Path| Store::open(place).expect_err("is a file");
        assert!(said(&file).to_string().contains("file`: is a file; a store is a folder"));
        assert!(said(&file.join("a/b")).to_string().contains("lies below a file, "));
        assert!(said(&file).is_usage());
        assert!(Store::open(folder.path().join("new/store")).is_ok());
    }

    #[test]
    fn what_is_not_supported_says_what_is() {
        for (place, problem) in [
            ("ftp://server/set", "no store of kind `ftp`"),
            ("s3://", "names no bucket"),
            ("az://set/../a", "names no folder"),
            ("File:///data", "no store of kind `File`"),
            ("file://server/data", "file:///FOLDER"),
            ("file:///data%2", "without two hexadecimal digits"),
            ("", "names no place"),
            ("s3:/sets/rain", "one / behind the colon"),
        ] {
            let text = Store::open(place).expect_err(place).to_string();
            assert!(text.contains(problem) && text.contains(place) && text.contains("a folder"), "{text}");
        }
    }
}
