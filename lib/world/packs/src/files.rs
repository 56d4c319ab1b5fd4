//! Where a model's files come from: a folder, or a store.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use percent_encoding::percent_decode_str;

/// Files by their paths in a pack (`/` between folders).
pub trait Files {
    /// The bytes of a file, at most one more than `most`; `None`: there is none.
    ///
    /// # Errors
    /// It cannot be read.
    fn read(&self, path: &str, most: u64) -> Result<Option<Vec<u8>>, String>;

    /// What a file is called in messages.
    fn location(&self, path: &str) -> String;
}

/// A folder of the disk. Links that lead out of it are not followed.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Files for Folder {
    fn read(&self, path: &str, most: u64) -> Result<Option<Vec<u8>>, String> {
        let whole = self.0.join(path);
        let real = match whole.canonicalize() {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
            found => found.map_err(|e| e.to_string())?,
        };
        if !real.starts_with(self.0.canonicalize().map_err(|e| e.to_string())?) {
            return Err("it leads out of the folder".into());
        }
        if !real.is_file() {
            return Err("it is no file".into());
        }
        let mut bytes = Vec::new();
        let file = File::open(&real).map_err(|e| e.to_string())?;
        file.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| e.to_string())?;
        Ok(Some(bytes))
    }

    fn location(&self, path: &str) -> String {
        self.0.join(path).display().to_string()
    }
}

/// The path that a URI of a file in folder `beside` names; `None`: it may lie outside of the pack.
pub(crate) fn inside(beside: &str, uri: &str) -> Option<String> {
    let decoded = percent_decode_str(uri).decode_utf8().ok()?;
    let is_plain = |part: &str| {
        !part.is_empty()
            && !part.starts_with('.')
            && part.chars().all(|c| c.is_alphanumeric() || matches!(c, '.' | '_' | '-' | ' ' | '(' | ')'))
    };
    let path = Path::new(beside).parent().and_then(Path::to_str).filter(|folder| !folder.is_empty());
    let path = path.map_or_else(|| decoded.to_string(), |folder| format!("{folder}/{decoded}"));
    // Pages are told from what they name.
    (path.split('/').all(is_plain) && !path.ends_with(".toml") && path.len() < 200).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_outside_is_refused() {
        assert_eq!(inside("van.gltf", "van.bin").as_deref(), Some("van.bin"));
        assert_eq!(inside("a/van.gltf", "tex/side%20left.png").as_deref(), Some("a/tex/side left.png"));
        for uri in [
            "../van.bin",
            "/etc/passwd",
            "http://a.b/c",
            "a//b",
            ".hidden",
            "a\\b",
            "C:x",
            "%2e%2e/x",
            "%",
            "",
            "x.toml",
            "a/./b",
            "file:x",
        ] {
            assert_eq!(inside("van.gltf", uri), None, "{uri}");
        }
    }
}
