//! Manifests of the workspace.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use toml::{Table, Value};

use crate::ClosureError;

/// How a crate counts in closures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// All its sources.
    Whole,
    /// Files that define what others speak of.
    ByFile,
    /// Not at all, nor what is below it.
    Outside,
}

/// A crate of ours.
#[derive(Debug)]
pub(crate) struct Package {
    /// Relative to the workspace: `lib/bev`.
    pub(crate) folder: String,
    /// `convoy-bev`.
    pub(crate) package: String,
    pub(crate) kind: Kind,
    /// Whether what it makes is kept in the store under a version of its own.
    pub(crate) is_product: bool,
    /// What it is built with, by the names it has for them.
    pub(crate) dependencies: Vec<String>,
}

impl Package {
    /// Name of its folder, which is that of its program.
    pub(crate) fn name(&self) -> &str {
        self.folder.rsplit('/').next().unwrap_or(&self.folder)
    }
}

/// The manifests.
#[derive(Debug)]
pub(crate) struct Workspace {
    /// Our crates, by folder.
    pub(crate) packages: BTreeMap<String, Package>,
    /// Folders of our crates, by the names that others have for them.
    pub(crate) own: BTreeMap<String, String>,
    /// What the workspace asks of its dependencies.
    asked: Table,
}

pub(crate) fn read_toml(path: &Path) -> Result<Table, ClosureError> {
    let text = fs::read_to_string(path).map_err(|source| ClosureError::Io { path: path.into(), source })?;
    text.parse().map_err(|e| ClosureError::Toml { path: path.into(), source: Box::new(e) })
}

impl Workspace {
    pub(crate) fn read(root: &Path) -> Result<Self, ClosureError> {
        let table = read_toml(&root.join("Cargo.toml"))?;
        let asked = table
            .get("workspace")
            .and_then(|w| w.get("dependencies"))
            .and_then(Value::as_table)
            .cloned()
            .unwrap_or_default();
        let folder_of = |value: &Value| value.get("path").and_then(Value::as_str).map(str::to_owned);
        let own = asked.iter().filter_map(|(name, value)| Some((name.clone(), folder_of(value)?))).collect();
        let mut packages = BTreeMap::new();
        for parent in ["bins", "lib"] {
            for folder in crates_under(root, parent)? {
                packages.insert(folder.clone(), Package::read(root, folder)?);
            }
        }
        Ok(Self { packages, own, asked })
    }

    /// The names that others have for crates, by their folders.
    pub(crate) fn names_of<'a>(&'a self, folders: &BTreeSet<&str>) -> BTreeSet<&'a str> {
        let own = self.own.iter().filter(|(_, folder)| folders.contains(folder.as_str()));
        own.map(|(name, _)| name.as_str()).collect()
    }

    /// What the workspace asks of a dependency: version and features.
    pub(crate) fn asked_of(&self, dependency: &str) -> Option<String> {
        self.asked.get(dependency).map(|value| format!("{dependency} = {value}"))
    }
}

impl Package {
    fn read(root: &Path, folder: String) -> Result<Self, ClosureError> {
        let path = root.join(&folder).join("Cargo.toml");
        let table = read_toml(&path)?;
        let wrong = |problem: String| ClosureError::Manifest { path: path.clone(), problem };
        let about =
            table.get("package").and_then(Value::as_table).ok_or_else(|| wrong("has no [package]".into()))?;
        let package = about.get("name").and_then(Value::as_str).ok_or_else(|| wrong("has no name".into()))?;
        let marks = about.get("metadata").and_then(|m| m.get("convoy"));
        let mark = marks.and_then(|c| c.get("closure"));
        let is_product = marks.and_then(|c| c.get("product")).and_then(Value::as_bool).unwrap_or(false);
        let kind = match mark.map(|value| value.as_str().unwrap_or_default()) {
            None => Kind::Whole,
            Some("by-file") => Kind::ByFile,
            Some("outside") => Kind::Outside,
            Some(other) => {
                return Err(wrong(format!("closure = {other:?} is neither \"outside\" nor \"by-file\"")));
            }
        };
        let mut dependencies = Vec::new();
        for part in ["dependencies", "build-dependencies"] {
            dependencies
                .extend(table.get(part).and_then(Value::as_table).into_iter().flat_map(Table::keys).cloned());
        }
        if table.contains_key("target") || table.contains_key("features") {
            return Err(wrong(
                "has features or dependencies of some targets: closures do not know of these".into(),
            ));
        }
        Ok(Self { package: package.to_owned(), folder, kind, is_product, dependencies })
    }
}

/// Folders of crates, relative to the workspace, sorted.
fn crates_under(root: &Path, parent: &str) -> Result<Vec<String>, ClosureError> {
    let folder = root.join(parent);
    let io = |source| ClosureError::Io { path: folder.clone(), source };
    let mut found = Vec::new();
    for entry in fs::read_dir(&folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if path.join("Cargo.toml").is_file()
            && let Some(name) = path.file_name().and_then(|n| n.to_str())
        {
            found.push(format!("{parent}/{name}"));
        }
    }
    found.sort();
    Ok(found)
}
