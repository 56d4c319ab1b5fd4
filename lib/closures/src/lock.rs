//! Other people's packages: `Cargo.lock`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::Value;

use crate::ClosureError;
use crate::manifest::read_toml;

/// The packages of the lock file.
#[derive(Debug)]
pub(crate) struct Lock {
    packages: Vec<Locked>,
    /// Positions in `packages`, by name.
    by_name: BTreeMap<String, Vec<usize>>,
}

#[derive(Debug)]
struct Locked {
    name: String,
    version: String,
    checksum: String,
    /// `name`, or `name version` where there are several.
    dependencies: Vec<String>,
}

impl Lock {
    pub(crate) fn read(root: &Path) -> Result<Self, ClosureError> {
        let table = read_toml(&root.join("Cargo.lock"))?;
        let entries = table.get("package").and_then(Value::as_array).cloned().unwrap_or_default();
        let text =
            |entry: &Value, key: &str| entry.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
        let mut packages = Vec::with_capacity(entries.len());
        let mut by_name: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for entry in &entries {
            let listed = entry.get("dependencies").and_then(Value::as_array).into_iter().flatten();
            let locked = Locked {
                name: text(entry, "name"),
                version: text(entry, "version"),
                checksum: text(entry, "checksum"),
                dependencies: listed.filter_map(Value::as_str).map(str::to_owned).collect(),
            };
            by_name.entry(locked.name.clone()).or_default().push(packages.len());
            packages.push(locked);
        }
        Ok(Self { packages, by_name })
    }

    /// Position of what a list of dependencies names: `name`, `name version` or `name version (source)`.
    fn find(&self, listed: &str) -> Option<usize> {
        let mut words = listed.split(' ');
        let candidates = self.by_name.get(words.next()?)?;
        match words.next() {
            None => candidates.first().copied(),
            Some(version) => candidates.iter().copied().find(|&i| self.packages[i].version == version),
        }
    }

    /// A dependency of a package and everything below it, each as one line.
    pub(crate) fn tree(&self, user: &str, dependency: &str) -> Result<BTreeSet<String>, ClosureError> {
        let listed = self
            .find(user)
            .and_then(|i| {
                self.packages[i].dependencies.iter().find(|d| d.split(' ').next() == Some(dependency))
            })
            .and_then(|listed| self.find(listed));
        let Some(first) = listed else {
            return Err(ClosureError::Unlocked { user: user.to_owned(), dependency: dependency.to_owned() });
        };
        let (mut open, mut seen) = (vec![first], BTreeSet::new());
        while let Some(i) = open.pop() {
            if seen.insert(i) {
                open.extend(self.packages[i].dependencies.iter().filter_map(|d| self.find(d)));
            }
        }
        let line = |p: &Locked| format!("{} {} {}", p.name, p.version, p.checksum);
        Ok(seen.into_iter().map(|i| line(&self.packages[i])).collect())
    }
}
