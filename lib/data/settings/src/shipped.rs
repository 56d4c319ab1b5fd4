//! The configurations that come with the programs: the files of `configs/`, by name.

use std::io;
use std::path::{Component, Path, PathBuf};

/// A configuration, or a rig that configurations may name, as it stands in `configs/`.
#[derive(Clone, Copy, Debug)]
pub struct Shipped {
    /// Its path below `configs/`, without the ending: `demo`, `rigs/nuscenes`.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! shipped {
    ($name:literal) => {
        Shipped { name: $name, text: include_str!(concat!("../../../../configs/", $name, ".toml")) }
    };
}

/// What stands before the name where no file is meant.
const PREFIX: &str = "shipped:";

const SHIPPED: [Shipped; 14] = [
    shipped!("benchmark-gpu"),
    shipped!("benchmark"),
    shipped!("day-and-night"),
    shipped!("demo"),
    shipped!("simbev2x-full"),
    shipped!("tiny"),
    shipped!("town03"),
    shipped!("town04"),
    shipped!("town10"),
    shipped!("rigs/nuscenes"),
    shipped!("rigs/opv2v-rsu"),
    shipped!("rigs/opv2v"),
    shipped!("rigs/simbev2x-rsu"),
    shipped!("rigs/simbev2x-vehicle"),
];

impl Shipped {
    /// All of them: configurations by name, then rigs.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &SHIPPED
    }

    /// The one of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        SHIPPED.iter().find(|shipped| shipped.name == name)
    }

    /// The configuration that a path names: `shipped:demo`, or a plain `demo` where there is no such file.
    #[must_use]
    pub fn at(path: &Path) -> Option<&'static Self> {
        let written = path.to_str()?;
        if let Some(name) = written.strip_prefix(PREFIX) {
            return Self::named(name);
        }
        let is_plain = matches!(path.components().collect::<Vec<_>>()[..], [Component::Normal(_)]);
        Self::named(written).filter(|_| is_plain && !path.exists())
    }

    /// The path that names it whatever files there are.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        format!("{PREFIX}{}", self.name).into()
    }

    /// Whether it is a rig, which a configuration names, and no configuration itself.
    #[must_use]
    pub fn is_rig(&self) -> bool {
        self.name.starts_with("rigs/")
    }

    /// What its first comment says: the first sentence.
    #[must_use]
    pub fn about(&self) -> String {
        let comments = self.text.lines().map_while(|line| line.strip_prefix('#'));
        let comments = comments.filter(|line| !line.starts_with(':')).map(str::trim);
        let text = comments.collect::<Vec<_>>().join(" ");
        text.split_once(". ").map_or(&*text, |(first, _)| first).trim_end_matches('.').to_owned()
    }
}

/// The text of a configuration: of a file, or of one that comes with the programs by its name.
///
/// # Errors
/// There is neither.
pub fn text_at(path: &Path) -> io::Result<String> {
    match Shipped::at(path) {
        Some(shipped) => Ok(shipped.text.to_owned()),
        None => std::fs::read_to_string(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_comes_with_the_programs_and_can_be_used() {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../configs");
        let mut there = Vec::new();
        for (folder, before) in [(folder.clone(), ""), (folder.join("rigs"), "rigs/")] {
            let files = std::fs::read_dir(folder).expect("the folder").flatten().map(|entry| entry.path());
            let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
            let name = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
            there.extend(files.filter_map(name).map(|name| format!("{before}{name}")));
        }
        there.sort_unstable();
        let mut known: Vec<&str> = Shipped::all().iter().map(|shipped| shipped.name).collect();
        known.sort_unstable();
        assert_eq!(known, there);
        for shipped in Shipped::all() {
            assert!(!shipped.about().is_empty(), "{} says nothing of itself", shipped.name);
            // A rig is read where a configuration names it: its file lies in the folder of all.
            let (text, file) = match shipped.is_rig() {
                false => (shipped.text.to_owned(), format!("{}.toml", shipped.name)),
                true => {
                    let kind = if shipped.name.ends_with("rsu") { "rsu" } else { "vehicle" };
                    let named = format!("[{kind}]\nrig = \"{}.toml\"\n", shipped.name);
                    (format!("[scenes.train]\n\"convoy/demo\" = 1\n{named}"), "any.toml".to_owned())
                }
            };
            let file = folder.join(file).display().to_string();
            let read = crate::parse(&text, &file);
            assert!(read.is_ok(), "{}: {read:?}", shipped.name);
        }
    }

    #[test]
    fn plain_names_stand_for_configurations_where_there_is_no_such_file() {
        let at = |path: &str| Shipped::at(Path::new(path)).map(|shipped| shipped.name);
        assert_eq!(at("demo"), Some("demo"));
        // The package's own folder `src` is there, `demo.toml` is a file that is not.
        for path in ["src", "demo.toml", "./demo", "configs/demo", "rigs/nuscenes", "dmo", ""] {
            assert_eq!(at(path), None, "{path}");
        }
        assert_eq!(at("shipped:demo"), Some("demo"));
        assert!(
            Shipped::all().iter().all(|shipped| at(&shipped.path().to_string_lossy()) == Some(shipped.name))
        );
        assert!(text_at(Path::new("demo")).expect("comes with the programs").contains("name = \"demo\""));
        assert!(text_at(Path::new("dmo")).is_err());
        assert!(crate::load(Path::new("tiny")).is_ok());
    }
}
