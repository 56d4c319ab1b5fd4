//! `docs/opendrive-coverage.md` and the reader name the same elements.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const PAGE: &str = include_str!("../../../docs/opendrive-coverage.md");
const FILE: &str = include_str!("data/everything.xodr");

/// The double-quoted texts of a line of source.
fn quoted(line: &str) -> Vec<&str> {
    line.split('"').skip(1).step_by(2).collect()
}

/// The element names that the reader's sources match on: arms of `match`, comparisons, and lists of names.
fn names_in_the_reader() -> BTreeSet<String> {
    let mut sources = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src/read")];
    let mut names = BTreeSet::new();
    while let Some(path) = sources.pop() {
        if path.is_dir() {
            sources.extend(std::fs::read_dir(&path).expect("sources").map(|e| e.expect("sources").path()));
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("sources");
        // Tests of the reader's own are about other names.
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for line in code.lines() {
            let arm = line.trim_start().starts_with('"') && line.contains("=>");
            let found = if arm {
                quoted(line.split("=>").next().unwrap_or_default())
            } else if [
                "named(",
                ".kept(",
                "cubics(",
                "let standard",
                ".name() == ",
                ".name() != ",
                "matches!(side",
            ]
            .iter()
            .any(|mark| line.contains(mark))
            {
                quoted(line)
            } else {
                Vec::new()
            };
            let is_name = |name: &&str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric());
            names.extend(found.into_iter().filter(is_name).map(str::to_owned));
        }
    }
    // Not elements: values and attributes on such lines.
    for other in ["undefined", "mwyEntry", "mwyExit", "s", "sOffset", "ds"] {
        names.remove(other);
    }
    names
}

/// Element names of the page, with the word that stands for them.
fn names_on_the_page() -> BTreeMap<String, BTreeSet<String>> {
    let mut names: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for row in PAGE.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        for path in cells[1].split('`').skip(1).step_by(2) {
            let name = path.rsplit('/').next().unwrap_or_default();
            names.entry(name.to_owned()).or_default().insert(cells[2].to_owned());
        }
    }
    names
}

/// Names of the elements of an XML text that stand outside of others that are kept whole.
fn names_in(text: &str) -> BTreeSet<String> {
    let document = roxmltree::Document::parse(text).expect("XML");
    let elements = document.descendants().filter(roxmltree::Node::is_element);
    elements.map(|n| n.tag_name().name().to_owned()).collect()
}

#[test]
fn every_name_that_the_reader_knows_is_on_the_page() {
    let (reader, page) = (names_in_the_reader(), names_on_the_page());
    assert!(reader.len() > 90, "{reader:?}");
    let missing: Vec<&String> = reader.iter().filter(|name| !page.contains_key(*name)).collect();
    assert!(missing.is_empty() || missing == ["userData"], "{missing:?}");
    // And the other way about, but for the root and what is not read.
    for (name, words) in &page {
        let not_read = words.iter().all(|w| w == "no");
        assert!(not_read || reader.contains(name) || name == "OpenDRIVE", "{name} is not read");
    }
}

#[test]
fn everything_on_the_page_is_in_the_file_that_is_tested() {
    // That file is read without a warning about unknown elements (tests/elements.rs).
    let file = names_in(FILE);
    for (name, words) in names_on_the_page() {
        let read = words.iter().any(|w| w != "no");
        let spared =
            ["signalGroup", "vmsGroup", "vmsBoard", "poly3", "paramPoly3", "spiral"].contains(&name.as_str());
        assert!(!read || spared || file.contains(&name), "{name} is not in the file");
    }
}
