//! Programs and documentation that `make test` leaves out hold no test: `test = false` and `doctest = false`
//! spare building them.

use std::fs;
use std::path::{Path, PathBuf};

use convoy_tests::workspace;

/// Files below `src` that hold one of some words.
fn holding(folder: &Path, words: &[&str]) -> Vec<String> {
    let files = walkdir::WalkDir::new(folder.join("src")).into_iter().filter_map(Result::ok);
    let rust = files.filter(|f| f.path().extension().is_some_and(|e| e == "rs"));
    let holds = |path: &Path| {
        let text = fs::read_to_string(path).expect("reads");
        text.lines().any(|line| words.iter().any(|w| line.trim_start().starts_with(w)))
    };
    rust.filter(|f| holds(f.path())).map(|f| f.path().display().to_string()).collect()
}

/// Folders with a manifest in `lib` and `bins`.
fn crate_folders() -> Vec<PathBuf> {
    let below = ["lib", "bins"]
        .map(|group| walkdir::WalkDir::new(workspace().join(group)).max_depth(2).sort_by_file_name());
    let folders = below.into_iter().flatten().map(|entry| entry.expect("reads").into_path());
    folders.filter(|folder| folder.join("Cargo.toml").is_file()).collect()
}

#[test]
fn what_is_not_built_for_tests_holds_none() {
    let (mut crates, mut spared) = (0, 0);
    for folder in crate_folders() {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("reads");
        let manifest: toml::Table = manifest.parse().expect("is TOML");
        let off = |target: Option<&toml::Value>, key: &str| {
            target.and_then(|t| t.get(key)).and_then(toml::Value::as_bool) == Some(false)
        };
        let (lib, bin) = (manifest.get("lib"), manifest.get("bin").and_then(|bins| bins.get(0)));
        let tests = ["#[test]", "#[cfg(test)]", "proptest!"];
        // A program's own modules stand beside the library's, if there is one.
        if off(lib, "test") || (lib.is_none() && off(bin, "test")) {
            assert_eq!(holding(&folder, &tests), [""; 0], "`test = false` of {}", folder.display());
            spared += 1;
        }
        if off(lib, "doctest") {
            let examples = ["/// ```", "//! ```"];
            assert_eq!(holding(&folder, &examples), [""; 0], "`doctest = false` of {}", folder.display());
            spared += 1;
        }
        crates += 1;
    }
    assert!(crates > 35 && spared > 20, "{crates} {spared}");
}
