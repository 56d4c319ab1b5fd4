//! Which crate may depend on which: a crate of a folder of `lib` uses crates of its own folder and of those
//! above it.

use std::path::Path;

/// The folders of `lib`, the uppermost first. `dev` holds what only tests and checks use.
const ROOMS: [&str; 10] = ["base", "data", "map", "world", "sim", "see", "labels", "store", "out", "dev"];

/// The checker finds no fault that it shares with the makers: it depends on no core, and of the schema it
/// uses numbers and names alone.
const CHECKER: &str = "bins/check";
const CHECKER_MAY_USE: [&str; 8] = [
    "Published",
    "BevClass",
    "DetectionClass",
    "Tag",
    "FRAME_PERIOD_S",
    "FORMAT_VERSION",
    "ReturnKind",
    "SIGN_TYPES",
];

/// A crate by its folder, as `lib/map/town` or `bins/stats`, and the workspace's crates that it is built
/// with, by the same. What tests and benchmarks alone use is not among them.
pub(crate) struct Crate {
    pub(crate) folder: String,
    pub(crate) uses: Vec<String>,
}

impl Crate {
    /// The position of its folder in [`ROOMS`]; programs come after all of them.
    fn room(&self) -> Option<usize> {
        room(&self.folder)
    }

    /// Reads a crate's manifest. Crates of the workspace are found by their keys in
    /// `[workspace.dependencies]`.
    ///
    /// # Errors
    ///
    /// Says what is wrong with the manifest.
    pub(crate) fn read(folder: &str, manifest: &str, workspace: &toml::Table) -> Result<Self, String> {
        let manifest: toml::Table = manifest.parse().map_err(|e| format!("{folder}/Cargo.toml: {e}"))?;
        let tables = ["dependencies", "build-dependencies"].map(|key| manifest.get(key));
        let names =
            tables.into_iter().flatten().filter_map(toml::Value::as_table).flat_map(toml::Table::keys);
        let path = |name: &String| workspace.get(name)?.get("path")?.as_str().map(str::to_owned);
        Ok(Self { folder: folder.to_owned(), uses: names.filter_map(path).collect() })
    }
}

fn room(folder: &str) -> Option<usize> {
    match folder.split('/').collect::<Vec<_>>()[..] {
        ["lib", room, _] => ROOMS.iter().position(|&known| known == room),
        ["bins", _] => Some(ROOMS.len()),
        _ => None,
    }
}

/// What is against the rules, a line each.
pub(crate) fn faults(crates: &[Crate]) -> Vec<String> {
    let mut faults = Vec::new();
    for this in crates {
        let Some(at) = this.room() else {
            faults.push(format!("{}: is in none of the folders {} of lib", this.folder, ROOMS.join(", ")));
            continue;
        };
        for used in &this.uses {
            let (dev, below) = (room(used) == Some(ROOMS.len() - 1), room(used) > Some(at));
            if below || dev && room(used) != Some(at) {
                faults.push(format!(
                    "{}: must not depend on {used}: a folder uses those above it",
                    this.folder
                ));
            }
            if this.folder == CHECKER && room(used) > Some(1) {
                faults.push(format!("{CHECKER}: must not depend on {used}, which it checks"));
            }
        }
    }
    faults
}

/// Lines of the checker's files that use more of the schema than they may.
pub(crate) fn faults_of_checker(file: &Path, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for (k, line) in text.lines().enumerate() {
        for (at, word) in line.match_indices("schema::") {
            let rest = line[at + word.len()..].trim_start_matches('{');
            let list = if line[at + word.len()..].starts_with('{') {
                rest.split('}').next().unwrap_or_default().split(", ").collect::<Vec<_>>()
            } else {
                rest.split(|c: char| !c.is_alphanumeric() && c != '_').take(1).collect()
            };
            if list.iter().any(|name| !CHECKER_MAY_USE.contains(&name.trim())) {
                let may = CHECKER_MAY_USE.join(", ");
                faults.push(format!("{}:{}: of schema the checker may use {may}", file.display(), k + 1));
            }
        }
    }
    faults
}

/// Whether a file is the checker's.
pub(crate) fn is_of_checker(crate_folder: &str) -> bool {
    crate_folder == CHECKER
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(folder: &str, uses: &[&str]) -> Crate {
        Crate { folder: folder.into(), uses: uses.iter().map(ToString::to_string).collect() }
    }

    #[test]
    fn crates_use_their_folder_and_those_above() {
        let fine = [
            of("lib/map/town", &["lib/map/opendrive", "lib/base/frames"]),
            of("bins/stats", &["lib/out/analysis", "lib/base/frames"]),
            of("bins/check", &["lib/data/schema"]),
            of("lib/dev/testkit", &["lib/see/render"]),
        ];
        assert_eq!(faults(&fine), [""; 0]);
        for (broken, fault) in [
            (of("lib/map/town", &["lib/see/render"]), "lib/map/town: must not depend on lib/see/render"),
            (of("lib/see/render", &["bins/stats"]), "must not depend on bins/stats"),
            (of("bins/stats", &["lib/dev/testkit"]), "must not depend on lib/dev/testkit"),
            (of("bins/check", &["lib/map/opendrive"]), "which it checks"),
            (of("lib/town", &[]), "is in none of the folders"),
        ] {
            let faults = faults(&[broken]);
            assert!(faults.len() == 1 && faults[0].contains(fault), "{faults:?}");
        }
    }

    #[test]
    fn manifests_say_what_is_built_in() {
        let workspace =
            "store = { path = 'lib/store/store' }\ntestkit = { path = 'lib/dev/testkit' }\nserde = '1'";
        let manifest = "[dependencies]\nstore.workspace = true\nserde = { workspace = true }\n\n\
            [dev-dependencies]\ntestkit.workspace = true";
        let read = Crate::read("bins/a", manifest, &workspace.parse().expect("is TOML")).expect("is TOML");
        assert_eq!(read.uses, ["lib/store/store"]);
    }

    #[test]
    fn the_checker_takes_names_and_numbers_only() {
        let faults = |text: &str| faults_of_checker(Path::new("a.rs"), text).len();
        assert_eq!(faults("use schema::{BevClass, Tag};\nschema::Tag::Car; schema::FRAME_PERIOD_S"), 0);
        assert_eq!(faults("use schema::{BevClass, Pose};\nlet x = schema::Pose::default();"), 2);
    }
}
