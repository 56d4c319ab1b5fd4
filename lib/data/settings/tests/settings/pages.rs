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
