//! Rules of the page that need no browser, by node's own test runner.

use std::path::Path;
use std::process::Command;

use testkit::{Need, skip};

#[test]
fn the_rules_of_the_page_hold() {
    if Command::new("node").arg("--version").output().is_err() {
        return skip(Need::Npm, "there is no node to run the page's rules with");
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../viewer/test/rules.test.mjs");
    let output = Command::new("node").arg("--test").arg(script).output().expect("node starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("pass "), "{said}");
}
