//! The sources of a crate, without its tests.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::ClosureError;
use crate::words::{names_of, words_of};

/// A source without its tests.
#[derive(Debug)]
pub(crate) struct Source {
    /// Relative to the workspace.
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    /// Words of its code; none of what is no code.
    pub(crate) words: BTreeSet<String>,
    /// Names that it gives to others, where its crate counts by file; otherwise it always counts.
    pub(crate) names: Option<BTreeSet<String>>,
}

impl Source {
    pub(crate) fn new(name: String, bytes: Vec<u8>, by_file: bool) -> Self {
        let is_code = name.ends_with(".rs");
        let words = if is_code { words_of(&bytes) } else { BTreeSet::new() };
        let names = (is_code && by_file).then(|| names_of(&bytes));
        Self { name, bytes, words, names }
    }
}

/// Every source of a crate, and its manifest.
pub(crate) fn of_crate(root: &Path, folder: &str, by_file: bool) -> Result<Vec<Source>, ClosureError> {
    let mut found = Vec::new();
    // What a program embeds (`include_str!`) lies beside its sources.
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        let path = root.join(&next);
        let io = |source| ClosureError::Io { path: path.clone(), source };
        for entry in fs::read_dir(&path).map_err(io)? {
            let entry = entry.map_err(io)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let key = format!("{next}/{name}");
            let is_top = next == folder;
            if entry.path().is_dir() {
                if !(is_top && ["tests", "benches", "examples", "target"].contains(&name.as_str())) {
                    open.push(key);
                }
            } else if name != "tests.rs" && !(is_top && name.ends_with(".md")) {
                let bytes = fs::read(entry.path())
                    .map_err(|source| ClosureError::Io { path: entry.path(), source })?;
                let bytes = if name.ends_with(".rs") { without_tests(bytes) } else { bytes };
                found.push(Source::new(key, bytes, by_file));
            }
        }
    }
    Ok(found)
}

/// The text before `#[cfg(test)] mod tests { ... }`, where that ends the file.
fn without_tests(bytes: Vec<u8>) -> Vec<u8> {
    const MARK: &str = "\n#[cfg(test)]\nmod tests {\n";
    let Ok(text) = str::from_utf8(&bytes) else { return bytes };
    match text.rfind(MARK) {
        // The first line that starts with a brace closes the module.
        Some(at)
            if text[at + MARK.len()..]
                .find("\n}")
                .is_some_and(|end| at + MARK.len() + end + 3 >= text.len()) =>
        {
            text.as_bytes()[..at].to_vec()
        }
        _ => bytes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tests_at_the_end_are_left_out() {
        let cut = |text: &str| String::from_utf8(without_tests(text.as_bytes().to_vec())).expect("text");
        let code = "fn one() {}\n";
        let tests = "\n#[cfg(test)]\nmod tests {\n    fn t() {\n    }\n}\n";
        assert_eq!(cut(&format!("{code}{tests}")), code);
        let more = format!("{code}{tests}fn two() {{}}\n");
        assert_eq!(cut(&more), more, "code after tests counts");
        assert_eq!(cut(code), code);
    }
}
