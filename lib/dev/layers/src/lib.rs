//! Fails where a crate depends on one that is not above it, and where files of a crate need one another in a
//! circle: neither can be read, tested or moved without the other; where comments are wider than code; and
//! where pages of the documentation name what is not there.
//! All of it is tests: the last one in this file looks at the workspace.
//!
//! A file needs another one if it names something of it outside tests. Names that a module only hands on
//! count as those of the file that they come from.
#![cfg(test)]

mod comments;
mod graph;
mod lexer;
mod pages;
mod paths;
mod rooms;

use std::path::{Path, PathBuf};

use graph::{Graph, circles, shortest};
use rooms::Crate;

#[derive(Default)]
struct Checked {
    crates: usize,
    files: usize,
    faults: Vec<String>,
}

fn check(workspace: &Path, checked: &mut Checked) -> Result<(), String> {
    let root: toml::Table =
        read(&workspace.join("Cargo.toml"))?.parse().map_err(|e| format!("Cargo.toml: {e}"))?;
    let shared = root.get("workspace").and_then(|w| w.get("dependencies")).and_then(toml::Value::as_table);
    let shared = shared.ok_or("Cargo.toml: there is no [workspace.dependencies]")?;
    let mut folders: Vec<PathBuf> =
        folders(&workspace.join("lib")).iter().flat_map(|room| self::folders(room)).collect();
    folders.extend(self::folders(&workspace.join("bins")));
    // A crate that went leaves a folder behind where something that git ignores lay in it.
    folders.retain(|folder| folder.join("Cargo.toml").is_file());
    let mut crates = Vec::new();
    for folder in folders {
        let name = folder.strip_prefix(workspace).unwrap_or(&folder).display().to_string();
        crates.push(Crate::read(&name, &read(&folder.join("Cargo.toml"))?, shared)?);
        for root in ["lib.rs", "main.rs"] {
            let load = |path: &Path| std::fs::read_to_string(folder.join("src").join(path)).ok();
            let Some(graph) = Graph::read(root, &load) else { continue };
            let src = Path::new(&name).join("src");
            checked.files += graph.files.len();
            checked.faults.extend(circles(&graph).iter().map(|circle| told(&src, &graph, circle)));
            if rooms::is_of_checker(&name) {
                let lines = |file: &PathBuf| {
                    rooms::faults_of_checker(&src.join(file), &load(file).unwrap_or_default())
                };
                checked.faults.extend(graph.files.iter().flat_map(lines));
            }
        }
    }
    checked.crates = crates.len();
    for top in ["lib", "bins", "tests"] {
        for file in sources(&workspace.join(top)) {
            let name = file.strip_prefix(workspace).unwrap_or(&file);
            checked.faults.extend(comments::faults(name, &read(&file)?));
        }
    }
    checked.faults.extend(rooms::faults(&crates));
    let commands = pages::Commands::read(workspace)?;
    for page in pages::pages(workspace) {
        let name = page.strip_prefix(workspace).unwrap_or(&page);
        checked.faults.extend(pages::faults(workspace, name, &read(&page)?, &commands));
    }
    Ok(())
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// The folders in a folder, by name.
fn folders(path: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.is_dir()).collect();
    found.sort();
    found
}

/// All sources below a folder, but for what cargo made.
fn sources(path: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in folders(path).into_iter().filter(|folder| !folder.ends_with("target")) {
        found.extend(sources(&folder));
    }
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    found.extend(entries.map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "rs")));
    found.sort();
    found
}

/// A circle in words: its shortest round, and whatever else is part of it.
fn told(src: &Path, graph: &Graph, circle: &[usize]) -> String {
    let round = shortest(graph, circle);
    let name = |file: usize| src.join(&graph.files[file]).display().to_string();
    let mut text = "files that need one another in a circle:".to_owned();
    for (k, &(file, line)) in round.iter().enumerate() {
        let next = round[(k + 1) % round.len()].0;
        text += &format!("\n  {}:{line} needs {}", name(file), name(next));
    }
    let others: Vec<String> =
        circle.iter().filter(|&&k| round.iter().all(|r| r.0 != k)).map(|&k| name(k)).collect();
    if !others.is_empty() {
        text += &format!("\n  and so, too: {}", others.join(", "));
    }
    text
}

#[test]
fn the_workspace_keeps_its_rules() {
    let mut checked = Checked::default();
    if let Err(fault) = check(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.."), &mut checked) {
        checked.faults.push(fault);
    }
    assert!(checked.faults.is_empty(), "\n{}", checked.faults.join("\n"));
    assert!(
        checked.crates >= 50 && checked.files >= 1000,
        "{} files of {} crates",
        checked.files,
        checked.crates
    );
}
