//! Fails where files of a crate need one another in a circle: neither can be read, tested or moved without the other.
//! Part of `make lint`.
//!
//! A file needs another one if it names something of it outside tests. Names that a module only hands on count as those of
//! the file that they come from.
#![allow(clippy::print_stdout, clippy::print_stderr)] // It is a check on the command line.

mod graph;
mod lexer;
mod paths;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use graph::{Graph, circles, shortest};

/// Circles that are left, by crate and the files or folders that they are within; those that are gone must leave this list,
/// too.
const KNOWN: &[(&str, &[&str])] = &[];

fn main() -> ExitCode {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut faults: Vec<String> = Vec::new();
    let mut left = vec![false; KNOWN.len()];
    let (mut crates, mut files) = (0, 0);
    for folder in ["lib", "bins"].iter().flat_map(|group| folders(&workspace.join(group))) {
        for root in ["lib.rs", "main.rs"] {
            let load = |path: &Path| std::fs::read_to_string(folder.join("src").join(path)).ok();
            let Some(graph) = Graph::read(root, &load) else { continue };
            (crates, files) = (crates + 1, files + graph.files.len());
            let group = folder.parent().and_then(Path::file_name).unwrap_or_default();
            let name = Path::new(group).join(folder.file_name().unwrap_or_default());
            for circle in circles(&graph) {
                let is_in = |(at, members): &(&str, &[&str])| {
                    let known = |file: &PathBuf| members.iter().any(|m| file.starts_with(m));
                    Path::new(at) == name && circle.iter().all(|&k| known(&graph.files[k]))
                };
                match KNOWN.iter().position(is_in) {
                    Some(known) => left[known] = true,
                    None => faults.push(told(&name.join("src"), &graph, &circle)),
                }
            }
        }
    }
    let gone = KNOWN.iter().zip(left).filter(|(_, left)| !left);
    faults.extend(gone.map(|((name, files), _)| {
        format!("{name}: the circle in {} is gone: take it out of tests/layers/src/main.rs", files.join(", "))
    }));
    for fault in &faults {
        eprintln!("{fault}");
    }
    println!("{files} files of {crates} crates, {} circles known", KNOWN.len());
    ExitCode::from(u8::from(!faults.is_empty() || files == 0))
}

fn folders(path: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.join("src").is_dir()).collect();
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
