//! The configuration as a ConfigMap: its file, and the files of rigs that it names.

use std::path::{Component, Path, PathBuf};

use super::yaml;
use crate::words::word;

/// A ConfigMap takes no more (1 MiB).
const MOST_BYTES: usize = 1 << 20;

/// Why a configuration cannot be handed over.
#[derive(Debug, thiserror::Error)]
pub(super) enum ConfigMapError {
    /// A file cannot be read.
    #[error("{}: cannot read: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// A rig lies where no ConfigMap has files.
    #[error(
        "rig \"{0}\": Kubernetes is handed the folder of the configuration alone: put the rig's file there, and name it without `..`"
    )]
    Outside(String),
    /// There is too much text.
    #[error(
        "the configuration and its rigs have {0} bytes, and a ConfigMap of Kubernetes takes {MOST_BYTES}"
    )]
    TooLarge(usize),
}

/// Files of a configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ConfigMap {
    /// The first is what `--config` names.
    files: Vec<File>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct File {
    key: String,
    /// Where it lies for the program, below the folder of all.
    path: String,
    text: String,
}

impl ConfigMap {
    /// Reads a configuration file and those that it names.
    ///
    /// # Errors
    /// One cannot be read or handed over.
    pub(super) fn read(config: &Path) -> Result<Self, ConfigMapError> {
        let read = |path: &Path| {
            settings::text_at(path).map_err(|source| ConfigMapError::Read { path: path.to_owned(), source })
        };
        let named = settings::rigs_named_in(config)
            .map_err(|source| ConfigMapError::Read { path: config.to_owned(), source })?;
        let name = word(&config.file_name().unwrap_or_default().to_string_lossy());
        let key = match config.extension() {
            Some(ending) => format!("config.{}", word(&ending.to_string_lossy())),
            None => "config".to_owned(),
        };
        let mut files = vec![File { key, path: name, text: read(config)? }];
        for (number, rig) in (1..).zip(named) {
            let is_below = |part| matches!(part, Component::Normal(_) | Component::CurDir);
            if !Path::new(&rig).components().all(is_below) {
                return Err(ConfigMapError::Outside(rig));
            }
            let text = read(&config.with_file_name(&rig))?;
            files.push(File { key: format!("rig-{number}.toml"), path: rig, text });
        }
        let bytes = files.iter().map(|file| file.text.len()).sum();
        if bytes > MOST_BYTES {
            return Err(ConfigMapError::TooLarge(bytes));
        }
        Ok(Self { files })
    }

    /// The name of the configuration's file.
    pub(super) fn main(&self) -> &str {
        self.files.first().map_or("", |file| &file.path)
    }

    /// What the ConfigMap holds.
    pub(super) fn data(&self) -> String {
        let line = |file: &File| format!("  {}: {}\n", file.key, yaml::block(&file.text, 4));
        self.files.iter().map(line).collect()
    }

    /// Where its files lie, by key, and set in by so much.
    pub(super) fn items(&self, indent: usize) -> String {
        let space = " ".repeat(indent);
        let item = |file: &File| {
            format!("{space}- key: {}\n{space}  path: {}\n", file.key, yaml::quoted(&file.path))
        };
        self.files.iter().map(item).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(rig: &str) -> Result<ConfigMap, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("is written");
        };
        std::fs::create_dir_all(folder.path().join("rigs")).expect("is made");
        write("rain town.toml", &format!("name = \"rain\"\n[vehicle]\nrig = \"{rig}\"\n"));
        write("rigs/van.toml", "[camera]\nwidth = 320\n");
        let told = |e: ConfigMapError| e.to_string().replace(&format!("{}/", folder.path().display()), "");
        ConfigMap::read(&folder.path().join("rain town.toml")).map_err(told)
    }

    #[test]
    fn a_configuration_brings_its_rigs() {
        let map = map("rigs/van.toml").expect("is good");
        assert_eq!(map.main(), "rain_town.toml");
        insta::assert_snapshot!(format!("data:\n{}items:\n{}", map.data(), map.items(2)), @r#"
        data:
          config.toml: |
            name = "rain"
            [vehicle]
            rig = "rigs/van.toml"
          rig-1.toml: |
            [camera]
            width = 320
        items:
          - key: config.toml
            path: "rain_town.toml"
          - key: rig-1.toml
            path: "rigs/van.toml"
        "#);
    }

    #[test]
    fn what_cannot_be_handed_over_is_told() {
        let refused =
            ["../van.toml", "/rigs/van.toml", "none.toml"].map(|rig| map(rig).expect_err("is refused"));
        insta::assert_snapshot!(refused.join("\n"), @r#"
        rig "../van.toml": Kubernetes is handed the folder of the configuration alone: put the rig's file there, and name it without `..`
        rig "/rigs/van.toml": Kubernetes is handed the folder of the configuration alone: put the rig's file there, and name it without `..`
        none.toml: cannot read: No such file or directory (os error 2)
        "#);
    }
}
