//! The sources of a crate, without its tests.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::ClosureError;
use crate::paths::paths_of;
use crate::words::names_of;

/// A source without its tests.
#[derive(Debug)]
pub(crate) struct Source {
    /// Relative to the workspace.
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    /// Paths in its code; none of what is no code.
    pub(crate) paths: BTreeSet<Vec<String>>,
    /// Names that it gives to others, where its crate counts by file; otherwise it always counts.
    pub(crate) names: Option<BTreeSet<String>>,
}

impl Source {
    pub(crate) fn new(name: String, bytes: Vec<u8>, by_file: bool) -> Self {
        let is_code = name.ends_with(".rs");
        let paths = if is_code { paths_of(&bytes) } else { BTreeSet::new() };
        let names = (is_code && by_file).then(|| names_of(&bytes));
        Self { name, bytes, paths, names }
    }

    /// Whether its code has a path into a crate, which its manifest may write with hyphens.
    pub(crate) fn speaks_of(&self, dependency: &str) -> bool {
        let name = dependency.replace('-', "_");
        self.paths.iter().any(|path| path.contains(&name))
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

/// The text without `#[cfg(test)] mod tests { ... }`.
fn without_tests(bytes: Vec<u8>) -> Vec<u8> {
    const MARK: &str = "\n#[cfg(test)]\nmod tests {\n";
    const END: &str = "\n}\n";
    let Ok(text) = str::from_utf8(&bytes) else { return bytes };
    let Some(at) = text.rfind(MARK) else { return bytes };
    // The first line that begins with a brace closes the module.
    let Some(length) = text[at + MARK.len()..].find(END) else { return bytes };
    let rest = &text[at + MARK.len() + length + END.len()..];
    [&text[..at], rest].concat().into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tests_are_left_out() {
        let cut = |text: &str| String::from_utf8(without_tests(text.as_bytes().to_vec())).expect("text");
        let code = "fn one() {}\n";
        let tests = "\n#[cfg(test)]\nmod tests {\n    fn t() {\n    }\n}\n";
        assert_eq!(cut(&format!("{code}{tests}")), code);
        assert_eq!(cut(&format!("{code}{tests}fn two() {{}}\n")), "fn one() {}\nfn two() {}\n");
        assert_eq!(cut(code), code);
    }
}
