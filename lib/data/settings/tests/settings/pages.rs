//! Configurations of the how-to pages are good, and nothing in them is suspicious.

use std::fs;
use std::path::Path;

#[test]
fn configurations_on_pages_are_good() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs");
    let folder = tempfile::tempdir().expect("a folder");
    for page in ["weather.md", "agents.md", "trajectories.md"] {
        let text = fs::read_to_string(docs.join(page)).expect("the page is there");
        let blocks = text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
        let blocks: Vec<&str> = blocks.collect();
        assert!(!blocks.is_empty(), "{page}");
        for block in blocks {
            let path = folder.path().join("page.toml");
            fs::write(&path, block).expect("is written");
            let (_, warnings) = settings::load(&path).unwrap_or_else(|faults| panic!("{page}: {faults:?}"));
            assert_eq!(warnings, [], "{page}");
        }
    }
}

/// Recipes are parts of configurations: where one names no scenes, it stands below a line that does.
#[test]
fn recipes_on_pages_are_read() {
    const SCENES: &str = "[scenes.train]\n\"convoy/demo\" = 1\n\n";
    /// How a model's settings and a town's parameters begin.
    const OTHERS: [&str; 2] = ["[model]\n", "seed = 7\nstyle"];
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs");
    let mut read = 0;
    for page in ["how-to.md", "tutorial.md", "groups.md", "grow.md", "change-one-sensor.md"] {
        let text = fs::read_to_string(docs.join(page)).expect("the page is there");
        let blocks = text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
        for block in blocks.filter(|block| !OTHERS.iter().any(|head| block.starts_with(head))) {
            let config =
                if block.contains("scenes.") { block.to_owned() } else { format!("{SCENES}{block}") };
            settings::parse(&config, page).unwrap_or_else(|faults| panic!("{page}: {faults:?}\n{block}"));
            read += 1;
        }
    }
    assert!(read > 12, "{read}");
}
