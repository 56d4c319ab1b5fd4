//! The folder of a dataset: files are found by what infos call them, and none is read that is not in it.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use crate::error::ImportError;

/// Name of the folder that holds everything.
const NAME: &str = "simbev2x";

/// The folder of a dataset.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Without links.
    root: PathBuf,
}

impl Folder {
    /// Opens a dataset: the folder `simbev2x`, or that which holds it.
    ///
    /// # Errors
    /// There is no `infos` folder in it.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let inner = path.join(NAME);
        let root = if inner.join("infos").is_dir() { inner } else { path.to_owned() };
        if !root.join("infos").is_dir() {
            let path = path.display();
            return Err(ImportError::Refused(format!(
                "{path}: no dataset of SimBEV2X: neither it nor {NAME}/ in it holds the folder `infos`"
            )));
        }
        let root = fs::canonicalize(&root).map_err(|e| ImportError::source(&root, e))?;
        Ok(Self { root })
    }

    /// Where it is.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Where a file is that infos name. They do so with the path at which the dataset once was: what stands
    /// behind `simbev2x/` counts.
    ///
    /// # Errors
    /// The name leads out of the folder, by itself or by a link, or there is no such file.
    pub fn find(&self, said: &str) -> Result<PathBuf, ImportError> {
        let wrong = |problem: &str| ImportError::source(Path::new(said), problem);
        let marker = format!("{NAME}/");
        let rest = match said.rfind(&format!("/{marker}")) {
            Some(at) => &said[at + 1 + marker.len()..],
            None => said.strip_prefix(&marker).ok_or_else(|| wrong("names no file below simbev2x/"))?,
        };
        if rest.is_empty() || !Path::new(rest).components().all(|part| matches!(part, Component::Normal(_))) {
            return Err(wrong("leads out of the dataset's folder"));
        }
        self.inside(&self.root.join(rest))
    }

    /// A file that must be in the folder, links followed.
    pub(crate) fn inside(&self, path: &Path) -> Result<PathBuf, ImportError> {
        let found = fs::canonicalize(path).map_err(|e| ImportError::source(path, e))?;
        if !found.starts_with(&self.root) {
            return Err(ImportError::source(path, "is a link that leads out of the dataset's folder"));
        }
        if !found.is_file() {
            return Err(ImportError::source(path, "is no plain file"));
        }
        Ok(found)
    }

    /// The bytes of a file that infos name, of at most so many.
    ///
    /// # Errors
    /// As [`Folder::find`]; or it is larger, or cannot be read.
    pub fn read(&self, said: &str, most: u64) -> Result<(PathBuf, Vec<u8>), ImportError> {
        let path = self.find(said)?;
        let bytes = read_file(&path, most)?;
        Ok((path, bytes))
    }
}

/// The bytes of a file of at most so many.
pub(crate) fn read_file(path: &Path, most: u64) -> Result<Vec<u8>, ImportError> {
    let wrong = |e: std::io::Error| ImportError::source(path, e);
    let mut bytes = Vec::new();
    File::open(path).map_err(wrong)?.take(most + 1).read_to_end(&mut bytes).map_err(wrong)?;
    if bytes.len() as u64 > most {
        return Err(ImportError::source(
            path,
            format!("has more than the {most} bytes that such a file may have"),
        ));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_wherever_the_dataset_once_was() {
        let outer = tempfile::tempdir().expect("a folder");
        let root = outer.path().join("simbev2x");
        fs::create_dir_all(root.join("infos")).expect("made");
        fs::write(root.join("infos/a.json"), "{}").expect("written");
        fs::write(outer.path().join("secret"), "s").expect("written");
        for place in [outer.path(), &root] {
            let folder = Folder::open(place).expect("a dataset");
            for said in [
                "/dataset/simbev2x/infos/a.json",
                "simbev2x/infos/a.json",
                "x/simbev2x/simbev2x/infos/a.json",
            ] {
                assert_eq!(folder.read(said, 2).expect("is there").1, b"{}");
            }
            let problem = |said: &str| folder.read(said, 1).expect_err("refused").to_string();
            assert!(problem("simbev2x/infos/a.json").contains("has more than the 1 bytes"));
            assert!(problem("/etc/passwd").ends_with("names no file below simbev2x/"));
            for said in [
                "/d/simbev2x/../secret",
                "/d/simbev2x//etc/passwd",
                "/d/simbev2x/infos/../../secret",
                "/d/simbev2x/",
            ] {
                assert!(problem(said).ends_with("leads out of the dataset's folder"), "{said}");
            }
            assert!(
                problem("/d/simbev2x/infos/b.json")
                    .starts_with(&root.join("infos/b.json").display().to_string())
            );
            assert!(problem("/d/simbev2x/infos").ends_with("is no plain file"));
        }
        assert!(Folder::open(&root.join("infos")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_that_lead_out_are_refused() {
        let outer = tempfile::tempdir().expect("a folder");
        let root = outer.path().join("simbev2x");
        fs::create_dir_all(root.join("infos")).expect("made");
        fs::write(outer.path().join("secret"), "s").expect("written");
        std::os::unix::fs::symlink("../../secret", root.join("infos/out")).expect("linked");
        std::os::unix::fs::symlink("..", root.join("infos/up")).expect("linked");
        fs::write(root.join("file"), "f").expect("written");
        let folder = Folder::open(outer.path()).expect("a dataset");
        let error = folder.find("simbev2x/infos/out").expect_err("refused").to_string();
        assert!(error.ends_with("is a link that leads out of the dataset's folder"), "{error}");
        folder.find("simbev2x/infos/up/file").expect("links within are fine");
    }
}
