//! Which sources each stage is built from, and a digest of them: the stage's code version.
//!
//! A stage's closure holds what its output is computed from and no more:
//!
//! * its own crate and every crate of ours below it, as the `[dependencies]` of their manifests say, but those that are
//!   marked as outside: `[package.metadata.convoy] closure = "outside"`. What these hand to a stage (settings, arguments) is
//!   hashed as a value in the manifests, or never reaches its bytes (progress, exit codes).
//! * of crates marked `closure = "by-file"` (vocabularies: many small files that know little of one another) only the files
//!   that define a name which the rest of the closure imports or writes as a path ([`reach`]), and of their dependencies
//!   only those that these files speak of. So a new table or settings key makes just those stages stale that know it.
//! * of other people's crates, the versions and checksums in `Cargo.lock` of those in the stage's own tree, and the
//!   features that the workspace asks of them.
//!
//! Tests are no part of it: files called `tests.rs` and `#[cfg(test)] mod tests { ... }` are left out.
//!
//! Read from the manifests directly rather than with `cargo_metadata`: that starts cargo within a build and wants every
//! package of the lock file downloaded, those of other platforms too.

mod error;
mod lock;
mod manifest;
mod paths;
mod reach;
mod sources;
mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

pub use error::ClosureError;

use lock::Lock;
use manifest::{Kind, Package, Workspace};
use sources::Source;

/// What a program is built from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Closure {
    /// Our crates, by folder (`lib/bev`), whole ones and those counted by file.
    pub crates: BTreeSet<String>,
    /// Files, relative to the workspace, with `/`.
    pub files: BTreeSet<String>,
    /// Other people's packages: name, version and checksum, and what the workspace asks of them.
    pub packages: BTreeSet<String>,
    /// BLAKE3 of all of it, hexadecimal.
    pub digest: String,
}

/// The closures of every program under `bins`, and of every crate whose product is kept under a version of its own
/// (`[package.metadata.convoy] product = true`), by name.
///
/// # Errors
/// A manifest, the lock file or a source cannot be read or understood.
pub fn closures(root: &Path) -> Result<BTreeMap<String, Closure>, ClosureError> {
    let workspace = Workspace::read(root)?;
    let lock = Lock::read(root)?;
    let mut sources = BTreeMap::new();
    for (folder, package) in workspace.packages.iter().filter(|(_, package)| package.kind != Kind::Outside) {
        sources.insert(folder.as_str(), sources::of_crate(root, folder, package.kind == Kind::ByFile)?);
    }
    let programs = workspace.packages.values().filter(|p| p.folder.starts_with("bins/") || p.is_product);
    programs
        .map(|program| Ok((program.name().to_owned(), closure(&workspace, &lock, &sources, program)?)))
        .collect()
}

/// Every folder that a build must watch for changes of closures.
#[must_use]
pub fn watched(root: &Path) -> Vec<PathBuf> {
    ["Cargo.toml", "Cargo.lock", "bins", "lib"].map(|name| root.join(name)).into()
}

fn closure<'a>(
    workspace: &'a Workspace,
    lock: &Lock,
    sources: &BTreeMap<&str, Vec<Source>>,
    program: &'a Package,
) -> Result<Closure, ClosureError> {
    let (mut whole, mut by_file, mut foreign) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    let mut open = vec![program.folder.as_str()];
    let mut files;
    loop {
        // Of crates counted by file, dependencies count below: for the files that are reached.
        while let Some(folder) = open.pop() {
            let Some(package) = workspace.packages.get(folder) else { continue };
            match package.kind {
                Kind::Whole if whole.insert(folder) => {
                    open.extend(depend(workspace, package, &mut foreign, |_| true))
                }
                Kind::ByFile => {
                    by_file.insert(folder);
                }
                Kind::Whole | Kind::Outside => {}
            }
        }
        files = sources_of(sources, &whole);
        let vocabularies = workspace.names_of(&by_file);
        let reached = reach::reached(&files, &vocabularies, sources_of(sources, &by_file))?;
        for folder in &by_file {
            let Some(package) = workspace.packages.get(*folder) else { continue };
            let prefix = format!("{folder}/");
            let own = || reached.iter().filter(|file| file.name.starts_with(&prefix));
            let is_used = |dependency: &str| own().any(|file| file.speaks_of(dependency));
            let below = depend(workspace, package, &mut foreign, is_used);
            open.extend(
                below.into_iter().filter(|folder| !whole.contains(folder) && !by_file.contains(folder)),
            );
        }
        open.retain(|folder| workspace.packages.get(*folder).is_some_and(|p| p.kind != Kind::Outside));
        if open.is_empty() {
            files.extend(reached);
            break;
        }
    }
    files.sort_by(|a, b| a.name.cmp(&b.name));
    let mut packages = BTreeSet::new();
    for (user, dependency) in foreign {
        packages.extend(lock.tree(user, dependency)?);
        packages.extend(workspace.asked_of(dependency));
    }
    let mut hasher = blake3::Hasher::new();
    let texts = files.iter().map(|source| (&source.name, source.bytes.as_slice()));
    for (name, bytes) in texts.chain(packages.iter().map(|package| (package, &b""[..]))) {
        // Names are relative to the workspace: where it is checked out makes no difference.
        for part in [name.as_bytes(), bytes] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
    }
    let crates = whole.into_iter().chain(by_file).map(str::to_owned).collect();
    let files = files.into_iter().map(|source| source.name.clone()).collect();
    Ok(Closure { crates, files, packages, digest: hasher.finalize().to_hex().to_string() })
}

/// Folders of our crates that a crate depends on; other people's go to `foreign`, with the crate.
fn depend<'a>(
    workspace: &'a Workspace,
    package: &'a Package,
    foreign: &mut BTreeSet<(&'a str, &'a str)>,
    counts: impl Fn(&str) -> bool,
) -> Vec<&'a str> {
    let mut own = Vec::new();
    for dependency in package.dependencies.iter().filter(|name| counts(name)) {
        match workspace.own.get(dependency) {
            Some(folder) => own.push(folder.as_str()),
            None => {
                foreign.insert((package.package.as_str(), dependency.as_str()));
            }
        }
    }
    own
}

fn sources_of<'a>(sources: &'a BTreeMap<&str, Vec<Source>>, folders: &BTreeSet<&'a str>) -> Vec<&'a Source> {
    folders.iter().filter_map(|folder| sources.get(folder)).flatten().collect()
}
