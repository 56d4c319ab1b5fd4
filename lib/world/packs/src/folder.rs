//! A folder of models.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

use crate::error::{PackError, Problem};
use crate::files::{Files, Folder};
use crate::hash::hash_of;
use crate::limits;
use crate::model::{PackModel, read_model};

/// The files of a folder and of those in it, by name.
fn listed(folder: &Path) -> Result<Vec<PathBuf>, PackError> {
    let place = folder.display().to_string();
    let mut files = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        let unreadable =
            |e: std::io::Error| PackError::file(at.display().to_string(), Problem::Unreadable(e.to_string()));
        for entry in std::fs::read_dir(&at).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let kind = entry.file_type().map_err(unreadable)?;
            // Links are no folders: this ends.
            if kind.is_dir() {
                open.push(entry.path());
            } else if kind.is_file() {
                files.push(entry.path());
            }
            if files.len() + open.len() > limits::FOLDER_FILES {
                return Err(PackError::file(place, Problem::TooManyFiles(limits::FOLDER_FILES)));
            }
        }
    }
    files.sort();
    Ok(files)
}

/// All models of a folder: one for each page `NAME.toml` in it, by the names of these.
///
/// # Errors
/// There is no model, one cannot be used, or two have one name.
pub fn read_folder(folder: &Path) -> Result<Vec<PackModel>, PackError> {
    let files = Folder(folder.to_owned());
    let pages = listed(folder)?.into_iter().filter(|path| path.parent() == Some(folder));
    let pages = pages.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()));
    let pages: Vec<String> = pages.filter(|name| name.ends_with(".toml") && !name.starts_with('.')).collect();
    if pages.is_empty() {
        return Err(PackError::file(folder.display().to_string(), Problem::NoModels));
    }
    let mut models: Vec<PackModel> = Vec::new();
    for page in pages {
        let model = read_model(&page, &files)?;
        if let Some(other) = models.iter().find(|other| other.row.name == model.row.name) {
            let (name, other) = (model.row.name, files.location(&other.row.page));
            return Err(PackError::file(files.location(&page), Problem::Duplicate { name, other }));
        }
        models.push(model);
    }
    Ok(models)
}

/// A digest of everything in a folder: whether it changed since it was last asked for. What cannot be read
/// counts as such; `None`: the folder is none, or has too many files, which [`read_folder`] says.
#[must_use]
pub fn digest(folder: &Path) -> Option<String> {
    let mut contents = BTreeMap::new();
    for path in listed(folder).ok()? {
        let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
        let mut hasher = blake3::Hasher::new();
        let read = File::open(&path).and_then(|file| hasher.update_reader(file).map(|_| ()));
        let what = read.map_or_else(|_| Vec::new(), |()| hasher.finalize().as_bytes().to_vec());
        contents.insert(name, what);
    }
    Some(hash_of(&contents))
}
