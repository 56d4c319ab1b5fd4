//! Writes the stamp: which commit is built, and whether anything was changed since.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What programs are built from, seen from the root of the repository.
const SOURCES: [&str; 7] =
    ["lib", "bins", "Cargo.toml", "Cargo.lock", "pipeline.toml", "versions.toml", ".cargo/config.toml"];

/// Output of git, or none where there is no git or no repository.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").arg("--no-optional-locks").args(arguments).current_dir(root).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn main() -> std::io::Result<()> {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../../..");
    println!("cargo:rerun-if-env-changed=CONVOY_COMMIT");
    println!("cargo:rerun-if-env-changed=CONVOY_COMMIT_DATE");
    for source in SOURCES {
        println!("cargo:rerun-if-changed={}", root.join(source).display());
    }
    // The log of HEAD grows with every commit, and with nothing else that matters here.
    let log = git(&root, &["rev-parse", "--git-path", "logs/HEAD"]).map(|log| root.join(log));
    if let Some(log) = log.filter(|log| log.exists()) {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    let named = std::env::var("CONVOY_COMMIT").ok().filter(|commit| !commit.is_empty());
    let commit = named.clone().or_else(|| git(&root, &["rev-parse", "HEAD"]));
    let is_unchanged = || {
        let status = [&["status", "--porcelain", "--"][..], &SOURCES].concat();
        git(&root, &status).is_some_and(|changes| changes.is_empty())
    };
    let is_committed = named.is_some() || (commit.is_some() && is_unchanged());
    let named_date = std::env::var("CONVOY_COMMIT_DATE").ok();
    let of_commit = |commit: &String| git(&root, &["show", "--no-patch", "--format=%cs", commit]);
    let date = named_date.or_else(|| commit.as_ref().and_then(of_commit)).unwrap_or_default();
    let sign = if is_committed { '+' } else { '-' };
    let stamp = format!("\0convoy-build-stamp\0{:<64.64}{sign}{date:<10.10}", commit.unwrap_or_default());
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    std::fs::write(out.join("stamp"), stamp)
}
