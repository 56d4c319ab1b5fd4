//! `versions.toml`: a number for each stage, in the order in which they work.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use convoy_tests::workspace;

/// The file's text with the numbers in it.
pub(super) struct Versions {
    text: String,
    stages: Vec<(String, u32)>,
}

/// Stage and number of a line, if it has any.
fn parse(line: &str) -> Option<(&str, u32)> {
    let (stage, number) = line.split('#').next()?.split_once('=')?;
    Some((stage.trim().trim_matches('"'), number.trim().parse().ok()?))
}

impl Versions {
    fn path() -> PathBuf {
        workspace().join("versions.toml")
    }

    pub(super) fn read() -> Self {
        Self::of(fs::read_to_string(Self::path()).expect("versions.toml is there"))
    }

    pub(super) fn of(text: String) -> Self {
        let stages: Vec<_> = text.lines().filter_map(parse).map(|(s, n)| (s.to_owned(), n)).collect();
        let table: toml::Table = text.parse().expect("versions.toml is TOML");
        assert_eq!(table.len(), stages.len(), "versions.toml has lines that are no `stage = number`");
        Self { text, stages }
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }

    pub(super) fn numbers(&self) -> BTreeMap<String, u32> {
        self.stages.iter().cloned().collect()
    }

    /// Where a stage stands among those that work one after the other; last what has no number.
    pub(super) fn place(&self, stage: &str) -> usize {
        self.stages.iter().position(|(s, _)| s == stage).unwrap_or(usize::MAX)
    }

    /// The file with numbers that are not below these: all else stays as it is, comments too.
    pub(super) fn raised(&self, least: &BTreeMap<String, u32>) -> Self {
        let line = |line: &str| match parse(line) {
            Some((stage, number)) if least.get(stage).is_some_and(|least| *least > number) => {
                let (head, tail) = line.split_once('=').unwrap_or_default();
                format!("{head}={}", tail.replacen(&number.to_string(), &least[stage].to_string(), 1))
            }
            _ => line.to_owned(),
        };
        Self::of(self.text.lines().map(|l| line(l) + "\n").collect())
    }

    /// Writes the file where it would be another one.
    pub(super) fn write(&self) {
        if Self::read().text != self.text {
            fs::write(Self::path(), &self.text).expect("versions.toml is written");
        }
    }
}
