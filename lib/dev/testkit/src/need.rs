//! What a machine may lack, and the rule for it.

use std::io::Write;
use std::process::Command;

/// Names what must not be missing: a list of [`Need`]s' words with commas between them.
const REQUIRE: &str = "CONVOY_REQUIRE";

/// Something that tests look at where it is at hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The folder of real maps; the word in `CONVOY_REQUIRE` is `maps`.
    Maps,
    /// Python with packages; the word is `python`.
    Python,
    /// nuscenes-devkit in an environment of its own; the word is `devkit`.
    Devkit,
    /// npm with its registry, to build the viewer's page; the word is `npm`.
    Npm,
    /// Chromium and node, to look at the viewer's page; the word is `browser`.
    Browser,
    /// A Vulkan adapter, if only one in software; the word is `vulkan`.
    Vulkan,
}

impl Need {
    const ALL: [Self; 6] = [Self::Maps, Self::Python, Self::Devkit, Self::Npm, Self::Browser, Self::Vulkan];

    fn word(self) -> &'static str {
        match self {
            Self::Maps => "maps",
            Self::Python => "python",
            Self::Devkit => "devkit",
            Self::Npm => "npm",
            Self::Browser => "browser",
            Self::Vulkan => "vulkan",
        }
    }
}

/// Says that the running test, or a part of it, is skipped for want of something.
///
/// # Panics
/// `CONVOY_REQUIRE` names the need, or holds a word that is none.
#[track_caller]
pub fn skip(need: Need, missing: &str) {
    let required = std::env::var(REQUIRE).unwrap_or_default();
    assert!(!is_required(need, &required), "{REQUIRE}={required}, but {missing}");
    // Past the harness, which keeps the output of tests that pass to itself.
    let _ = writeln!(std::io::stderr(), "skipped: {missing}");
}

/// Chromium, where it and node are at hand: `CONVOY_CHROMIUM` may name it.
#[must_use]
pub fn chromium() -> Option<String> {
    let runs =
        |name: &str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let named = std::env::var("CONVOY_CHROMIUM").ok();
    let known = ["chromium", "chromium-browser", "google-chrome"].map(str::to_owned);
    let found = named.into_iter().chain(known).find(|name| runs(name)).filter(|_| runs("node"));
    if found.is_none() {
        skip(Need::Browser, "there is no Chromium with node to look at pages");
    }
    found
}

#[track_caller]
fn is_required(need: Need, list: &str) -> bool {
    let words: Vec<&str> = list.split(',').map(str::trim).filter(|w| !w.is_empty()).collect();
    let known = |word: &&str| Need::ALL.iter().any(|n| n.word() == *word);
    assert!(
        words.iter().all(known),
        "{REQUIRE}={list}: expected words out of {}",
        Need::ALL.map(Need::word).join(", ")
    );
    words.contains(&need.word())
}

/// The Python interpreter (`CONVOY_PYTHON`, else `python3`) if it has the packages; else a note that the test
/// is skipped and `None`.
///
/// # Panics
/// It has not, and `CONVOY_REQUIRE` names `python`.
#[must_use]
#[track_caller]
pub fn python(packages: &[&str]) -> Option<String> {
    let python = std::env::var("CONVOY_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let imports =
        format!("import {}", ["sys"].iter().chain(packages).copied().collect::<Vec<_>>().join(", "));
    let found = Command::new(&python).args(["-c", &imports]).output();
    if found.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    skip(Need::Python, &format!("there is no {python} with {}", packages.join(" and ")));
    None
}

/// An interpreter with nuscenes-devkit (`CONVOY_DEVKIT`, else that of the folder that `make devkit` makes);
/// else a note that the test is skipped and `None`. The package wants a numpy before 2, which other tests do
/// not.
///
/// # Panics
/// There is none, and `CONVOY_REQUIRE` names `devkit`.
#[must_use]
#[track_caller]
pub fn devkit() -> Option<String> {
    let made = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../target/devkit/bin/python3");
    let python = std::env::var("CONVOY_DEVKIT").unwrap_or_else(|_| made.to_owned());
    let found = Command::new(&python).args(["-c", "import nuscenes"]).output();
    if found.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    skip(Need::Devkit, &format!("there is no {python} with nuscenes-devkit (make devkit)"));
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_required_and_nothing_else() {
        let required = |list: &str| -> Vec<Need> {
            Need::ALL.into_iter().filter(|need| is_required(*need, list)).collect()
        };
        assert_eq!(required(""), []);
        assert_eq!(required("maps"), [Need::Maps]);
        assert_eq!(required(" python,"), [Need::Python]);
        assert_eq!(required("devkit,python, maps"), [Need::Maps, Need::Python, Need::Devkit]);
        assert_eq!(required("browser,npm,vulkan"), [Need::Npm, Need::Browser, Need::Vulkan]);
    }

    #[test]
    #[should_panic(
        expected = "CONVOY_REQUIRE=map: expected words out of maps, python, devkit, npm, browser, vulkan"
    )]
    fn a_misspelt_need_does_not_pass() {
        is_required(Need::Maps, "map");
    }
}
