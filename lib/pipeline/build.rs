//! Writes what this program was built with: the stage graph of `pipeline.toml` and the code version of every stage.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use serde::Deserialize;

/// A stage as `pipeline.toml` has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Spec {
    name: String,
    unit: String,
    reads: Vec<String>,
    writes: Vec<String>,
    /// Whether it looks at the log, and so cannot be done of a scene that was imported.
    #[serde(default = "yes")]
    needs_log: bool,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Graph {
    stage: Vec<Spec>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../..");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let file = root.join("pipeline.toml");
    println!("cargo::rerun-if-changed={}", file.display());
    for watched in closures::watched(&root) {
        println!("cargo::rerun-if-changed={}", watched.display());
    }
    let graph: Graph =
        toml::from_str(&fs::read_to_string(file)?).map_err(|e| format!("pipeline.toml: {e}"))?;
    fs::write(out.join("graph.rs"), stages(&graph)?)?;
    fs::write(out.join("code_versions.rs"), versions(&closures::closures(&root)?)?)?;
    Ok(())
}

/// The graph as a Rust expression.
fn stages(graph: &Graph) -> Result<String, String> {
    let mut text = String::from("&[\n");
    let mut seen: Vec<&String> = Vec::new();
    for Spec { name, unit, reads, writes, needs_log } in &graph.stage {
        let position = |read: &String| {
            let found = seen.iter().position(|stage| *stage == read);
            found.ok_or_else(|| format!("pipeline.toml: {name} reads {read}, which does not stand before it"))
        };
        let inputs: Vec<usize> = reads.iter().map(position).collect::<Result<_, _>>()?;
        if seen.contains(&name) {
            return Err(format!("pipeline.toml: {name} stands there twice"));
        }
        if (unit == "plan") != seen.is_empty() {
            return Err(format!("pipeline.toml: {name}: the first stage, and no other, makes the plan"));
        }
        seen.push(name);
        let kind = match unit.as_str() {
            "plan" => "Plan",
            "scene" => "Scene",
            "stats" => "Stats",
            other => {
                return Err(format!("pipeline.toml: {name}: unit {other:?} is none of plan, scene, stats"));
            }
        };
        text += &format!(
            "    StageSpec {{ name: {name:?}, unit: UnitKind::{kind}, inputs: &{inputs:?}, writes: &{writes:?}, \
             needs_log: {needs_log} }},\n"
        );
    }
    Ok(text + "]\n")
}

/// Code versions: the release and a digest of every source that a program is built from.
fn versions(closures: &BTreeMap<String, closures::Closure>) -> Result<String, Box<dyn Error>> {
    let release = env::var("CARGO_PKG_VERSION")?;
    let mut text = String::from("&[\n");
    for (program, closure) in closures {
        text += &format!("    ({program:?}, \"{release}+{}\"),\n", &closure.digest[..16]);
    }
    Ok(text + "]\n")
}
