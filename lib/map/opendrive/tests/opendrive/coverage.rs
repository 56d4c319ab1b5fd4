//! `docs/opendrive-coverage.md` and the reader name the same elements, and each element is read for
//! something.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

use opendrive::Network;

const PAGE: &str = include_str!("../../../../../docs/opendrive-coverage.md");
const FILE: &str = include_str!("../data/everything.xodr");

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

/// The file that has one of everything (it is read without a warning about unknown elements:
/// tests/elements.rs), and what no network can have besides.
fn files() -> Vec<String> {
    let groups = r#"<signalGroup id="1"><name/></signalGroup><vmsGroup id="2"/></OpenDRIVE>"#;
    let whole = FILE.replace("</OpenDRIVE>", groups).replacen("<staticBoard", "<vmsBoard/><staticBoard", 1);
    let curves = [
        r#"<spiral curvStart="0" curvEnd="0.001"/>"#,
        r#"<poly3 a="0" b="0" c="0.001" d="0"/>"#,
        r#"<paramPoly3 aU="0" bU="200" cU="0" dU="0" aV="0" bV="0" cV="1" dV="0" pRange="normalized"/>"#,
    ];
    let bent = curves.map(|curve| FILE.replacen("<line/>", curve, 1));
    std::iter::once(whole).chain(bent).collect()
}

/// The elements of an XML text, by the names on the way to them.
fn paths(text: &str) -> BTreeMap<String, Vec<Range<usize>>> {
    let document = roxmltree::Document::parse(text).expect("XML");
    let mut found: BTreeMap<String, Vec<Range<usize>>> = BTreeMap::new();
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        let names: Vec<&str> =
            node.ancestors().filter(|n| n.is_element()).map(|n| n.tag_name().name()).collect();
        let path = names.into_iter().rev().collect::<Vec<_>>().join("/");
        found.entry(path).or_default().push(node.range());
    }
    found
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
fn each_element_of_the_file_makes_a_difference() {
    let mut tried = 0;
    for file in files() {
        let whole = Network::parse(&file);
        assert!(whole.as_ref().is_ok_and(|network| network.warnings.is_empty()), "{whole:?}");
        for (path, ranges) in paths(&file) {
            // Passed over without a word, wherever it stands.
            if path.contains("userData") {
                continue;
            }
            let mut without = file.clone();
            ranges.iter().rev().for_each(|range| without.replace_range(range.clone(), ""));
            assert!(Network::parse(&without) != whole, "{path} might as well be absent");
            tried += 1;
        }
    }
    assert!(tried > 400, "{tried}");
}

#[test]
fn what_is_on_the_page_is_in_the_file_or_is_not_understood() {
    let paths: BTreeSet<String> = files().iter().flat_map(|file| paths(file).into_keys()).collect();
    let name_of = |path: &str| path.rsplit('/').next().unwrap_or_default().to_owned();
    let there: BTreeSet<String> = paths.iter().map(|path| name_of(path)).collect();
    for (name, words) in names_on_the_page() {
        if words.iter().any(|w| w != "no") {
            assert!(there.contains(&name), "{name} is in no file");
        } else {
            let text = FILE.replace("</OpenDRIVE>", &format!("<{name}/></OpenDRIVE>"));
            let network = Network::parse(&text).expect("still good");
            assert_eq!(network.unknown_elements.keys().collect::<Vec<_>>(), [&name]);
        }
    }
    // The other way round, except inside elements that are kept whole.
    let page = names_on_the_page();
    let whole = |name: &str| name == "userData" || page.get(name).is_some_and(|words| words.contains("kept"));
    let listed = |path: &&String| page.contains_key(&name_of(path)) || path.split('/').any(whole);
    let unlisted: Vec<&String> = paths.iter().filter(|path| !listed(path)).collect();
    assert!(unlisted.is_empty(), "{unlisted:?}");
}
