//! Which object a request may read: one of the store, and nothing else.

use std::fs;
use std::path::Path;

/// The key that a path of a URL means (below `/store/`, still percent-encoded), if it can be one of a store.
pub(crate) fn key_of(encoded: &str) -> Option<String> {
    let key = decode(encoded)?;
    key.split('/').all(is_plain).then_some(key)
}

/// Whether a key of a store in a folder is a regular file below it, after all links are followed.
///
/// `root` must be canonical.
pub(crate) fn lies_below(root: &Path, key: &str) -> bool {
    // Asked before anything is opened: opening a pipe would wait for its other end.
    fs::canonicalize(root.join(key))
        .is_ok_and(|real| real.starts_with(root) && fs::metadata(&real).is_ok_and(|about| about.is_file()))
}

/// Whether a name is that of one entry of a folder, on any system: no way up, no drive, no hidden file
/// (stages write theirs under such names).
fn is_plain(name: &str) -> bool {
    !name.is_empty()
        && !name.starts_with('.')
        && !name.contains(['\\', ':', '\0'])
        && !name.chars().any(char::is_control)
}

/// The text of percent-encoded UTF-8; decoded once.
fn decode(encoded: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(encoded.len());
    let mut rest = encoded.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let digit = |b: Option<u8>| char::from(b?).to_digit(16);
        let (high, low) = (digit(rest.next())?, digit(rest.next())?);
        bytes.push((16 * high + low) as u8);
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// The file that a path of a URL means.
    fn file_below(root: &Path, encoded: &str) -> Option<PathBuf> {
        key_of(encoded).filter(|key| lies_below(root, key)).map(|key| root.join(key))
    }

    fn folder() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let root = fs::canonicalize(folder.path()).expect("is there").join("store");
        fs::create_dir_all(root.join("scenes/0000")).expect("is made");
        fs::write(root.join("dataset.json"), "{}").expect("is written");
        fs::write(root.join("scenes/0000/a b.parquet"), "x").expect("is written");
        fs::write(root.join("scenes/.hidden.tmp"), "x").expect("is written");
        fs::write(root.with_file_name("secret"), "x").expect("is written");
        (folder, root)
    }

    #[test]
    fn files_below_the_root_are_found() {
        let (_folder, root) = folder();
        assert_eq!(file_below(&root, "dataset.json"), Some(root.join("dataset.json")));
        assert_eq!(
            file_below(&root, "scenes/0000/a%20b.parquet"),
            Some(root.join("scenes/0000/a b.parquet"))
        );
        assert_eq!(file_below(&root, "%64ataset.json"), Some(root.join("dataset.json")));
    }

    #[test]
    fn nothing_else_is() {
        let (_folder, root) = folder();
        let outside = [
            "",
            "/",
            "..",
            "../secret",
            "scenes/../../secret",
            "scenes/../dataset.json",
            "%2e%2e/secret",
            "%2e%2e%2fsecret",
            "..%2fsecret",
            "%252e%252e/secret",
            "..\\secret",
            "..%5csecret",
            "/etc/passwd",
            "%2fetc%2fpasswd",
            "//etc/passwd",
            "./dataset.json",
            "scenes//0000/a%20b.parquet",
            "scenes/.hidden.tmp",
            "C:/windows",
            "dataset.json%00",
            "dataset.json/",
            "dataset.json%",
            "dataset.json%2",
            "dataset.json%zz",
            "%ff%fe",
            "scenes",
            "scenes/0000",
            "nothing",
        ];
        for path in outside {
            assert_eq!(file_below(&root, path), None, "{path}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_may_not_leave_the_store() {
        use std::os::unix::fs::symlink;
        let (_folder, root) = folder();
        symlink(root.with_file_name("secret"), root.join("out")).expect("is linked");
        symlink("/etc", root.join("etc")).expect("is linked");
        symlink(root.join("dataset.json"), root.join("within")).expect("is linked");
        assert_eq!(file_below(&root, "out"), None);
        assert_eq!(file_below(&root, "etc/passwd"), None);
        assert_eq!(file_below(&root, "within"), Some(root.join("within")));
    }
}
