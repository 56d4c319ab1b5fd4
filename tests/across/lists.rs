//! Lists of stages, and of what they write, in files that no compiler holds against `pipeline.toml`.

use std::fs;

use convoy_tests::workspace;
use runner::{Graph, StageSpec, UnitKind};

/// Stages that make something of a scene.
fn of_scenes() -> impl Iterator<Item = &'static StageSpec> {
    Graph::get().stages.iter().filter(|stage| stage.unit == UnitKind::Scene)
}

#[test]
fn every_list_names_all_stages() {
    for file in ["bins/view/src/listing.rs", "docs/architecture.md"] {
        let text = fs::read_to_string(workspace().join(file)).expect("reads");
        for stage in of_scenes() {
            let named = [format!("\"{}\"", stage.name), format!("[{}]", stage.name)];
            assert!(named.iter().any(|name| text.contains(name)), "{file} does not name {}", stage.name);
        }
    }
}

/// Whoever misses a file is told which stage writes it. What the first stage of a scene writes is the rest.
#[test]
fn readers_know_which_stage_writes_a_file() {
    for file in ["python/src/convoy/files.py", "viewer/src/data/store.js"] {
        let text = fs::read_to_string(workspace().join(file)).expect("reads");
        let plain = text.replace(['\'', '"'], "");
        for stage in of_scenes().skip(1) {
            for path in &stage.writes {
                let entry = format!(" {}: {},", path.trim_end_matches('/'), stage.name);
                assert!(plain.contains(&entry), "{file} does not say that {} writes {path}", stage.name);
            }
        }
    }
}
