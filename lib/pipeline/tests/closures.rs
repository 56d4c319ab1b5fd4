//! What a change makes stale: for every crate and every file of the vocabulary, the stages whose code version it is in.
//!
//! The table stands in `closures.txt`. Where a closure grows on purpose, `CONVOY_ACCEPT=1 cargo test -p convoy-pipeline
//! --test closures` writes it anew: read the difference, and ask whether the stage computes from what it gained.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use pipeline::Graph;

/// Sources of crates that count by file.
const BY_FILE: [&str; 3] = ["lib/framewise/src/", "lib/scene/src/", "lib/schema/src/"];
const TABLE: &str = "lib/pipeline/tests/closures.txt";

/// What has a code version: the stages, and the tiles that scenes share.
fn versioned() -> Vec<&'static str> {
    Graph::get().stages.iter().map(|s| s.name).chain(["tiles"]).collect()
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// `crate or file: what a change of it makes stale`, sorted.
fn table(closures: &BTreeMap<String, closures::Closure>, root: &Path) -> String {
    let mut stages: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for parent in ["lib", "bins"] {
        for entry in fs::read_dir(root.join(parent)).expect("a folder of crates") {
            let path = entry.expect("an entry").path();
            if path.join("Cargo.toml").is_file() {
                let name = path.file_name().expect("a name").to_string_lossy();
                stages.insert(format!("{parent}/{name}"), Vec::new());
            }
        }
    }
    for product in versioned() {
        let closure = &closures[product];
        for name in &closure.crates {
            stages.get_mut(name).expect("a crate").push(product);
        }
        for file in closure.files.iter().filter(|file| BY_FILE.iter().any(|folder| file.starts_with(folder)))
        {
            stages.entry(file.clone()).or_default().push(product);
        }
    }
    let lines = stages.into_iter().map(|(name, stages)| match stages.len() {
        0 => format!("{name}: nothing\n"),
        n if n == versioned().len() => format!("{name}: everything\n"),
        _ => format!("{name}: {}\n", stages.join(", ")),
    });
    lines.collect()
}

#[test]
fn closures_hold_what_is_stated_and_no_more() {
    let root = workspace();
    let found = table(&closures::closures(&root).expect("closures"), &root);
    let path = root.join(TABLE);
    if std::env::var_os("CONVOY_ACCEPT").is_some() {
        fs::write(&path, &found).expect("the table is written");
    }
    let stated = fs::read_to_string(&path).expect(TABLE);
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<BTreeSet<_>>();
    let (stated, found) = (lines(&stated), lines(&found));
    let gone: Vec<_> = stated.difference(&found).collect();
    let new: Vec<_> = found.difference(&stated).collect();
    assert!(
        gone.is_empty() && new.is_empty(),
        "closures changed.\nstated: {gone:#?}\nfound: {new:#?}\nCONVOY_ACCEPT=1 accepts them"
    );
}

/// A copy of what closures are computed from, in which files can be changed.
fn copy() -> tempfile::TempDir {
    let (from, to) = (workspace(), tempfile::tempdir().expect("a temporary folder"));
    for name in ["Cargo.toml", "Cargo.lock"] {
        fs::copy(from.join(name), to.path().join(name)).expect("is copied");
    }
    for parent in ["lib", "bins"] {
        for entry in walkdir::WalkDir::new(from.join(parent)) {
            let entry = entry.expect("an entry");
            let target = to.path().join(entry.path().strip_prefix(&from).expect("is below"));
            if entry.file_type().is_dir() {
                fs::create_dir_all(target).expect("a folder");
            } else {
                fs::copy(entry.path(), target).expect("is copied");
            }
        }
    }
    to
}

/// Stages whose code version a change alters.
fn stale(root: &Path, before: &BTreeMap<String, closures::Closure>) -> Vec<&'static str> {
    let after = closures::closures(root).expect("closures");
    let differs = |name: &str| before[name].digest != after[name].digest;
    versioned().into_iter().filter(|name| differs(name)).collect()
}

fn append(root: &Path, file: &str, text: &str) {
    let path = root.join(file);
    let old = fs::read_to_string(&path).unwrap_or_default();
    fs::write(path, old + text).expect("is written");
}

#[test]
fn an_edit_makes_just_the_stated_stages_stale() {
    let root = copy();
    let root = root.path();
    let mut before = closures::closures(root).expect("closures");
    let stated = fs::read_to_string(workspace().join(TABLE)).expect(TABLE);
    // One line of each kind: who makes what stale.
    let mut tried = BTreeSet::new();
    for line in stated.lines() {
        let (name, stages) = line.split_once(": ").expect("a name and stages");
        let file = if name.ends_with(".rs") || name.ends_with(".toml") {
            name.to_owned()
        } else if root.join(name).join("src/lib.rs").is_file() {
            format!("{name}/src/lib.rs")
        } else {
            format!("{name}/src/main.rs")
        };
        // The root file of a crate that counts by file declares modules, and is none of them.
        if BY_FILE.contains(&format!("{name}/src/").as_str()) || !tried.insert(stages) {
            continue;
        }
        append(root, &file, "// Changed.\n");
        let expected: Vec<&str> = match stages {
            "nothing" => Vec::new(),
            "everything" => versioned(),
            list => list.split(", ").collect(),
        };
        assert_eq!(stale(root, &before), expected, "{file}");
        before = closures::closures(root).expect("closures");
    }
}

#[test]
fn what_a_stage_does_not_use_leaves_it_done() {
    let root = copy();
    let root = root.path();
    let before = closures::closures(root).expect("closures");
    let none: Vec<&str> = Vec::new();
    // A new crate, a new table, a new section of the configuration, their declarations, a test.
    fs::create_dir_all(root.join("lib/novelty/src")).expect("a folder");
    append(root, "lib/novelty/Cargo.toml", "[package]\nname = \"convoy-novelty\"\n[dependencies]\n");
    append(root, "lib/novelty/src/lib.rs", "pub fn new() {}\n");
    append(root, "lib/schema/src/tables/novelty.rs", "pub struct NoveltyRow;\n");
    append(root, "lib/schema/src/tables/mod.rs", "mod novelty;\npub use novelty::NoveltyRow;\n");
    append(root, "lib/schema/src/settings/novelty.rs", "pub struct NoveltySettings;\n");
    append(root, "lib/schema/src/settings/mod.rs", "mod novelty;\npub use novelty::NoveltySettings;\n");
    append(root, "lib/bev/src/tests.rs", "fn more() {}\n");
    append(root, "lib/bev/README.md", "More.\n");
    append(root, "Cargo.lock", "[[package]]\nname = \"novelty\"\nversion = \"1.0.0\"\n");
    assert_eq!(stale(root, &before), none);
    // Another version of a package makes those stale that are built with it.
    let path = root.join("Cargo.lock");
    let lock = fs::read_to_string(&path).expect("Cargo.lock");
    let at = lock.find("name = \"rapier3d\"").expect("traffic is built with rapier3d");
    let changed = format!("{}{}", &lock[..at], lock[at..].replacen("checksum = \"", "checksum = \"0", 1));
    fs::write(path, changed).expect("is written");
    assert_eq!(stale(root, &before), ["simulate-and-log"]);
}
