//! A store that is shown, as far as it may be read.

use std::fs;
use std::path::{Path, PathBuf};

use evaluation::PredictionFile;
use serde_json::Value;
use store::{Backend, Store, keys};

use crate::error::{ViewError, of_place};
use crate::object::Object;
use crate::paths;

/// A store that is shown.
pub(crate) struct Site {
    store: Store,
    /// Its folder, all links followed; none in a bucket.
    root: Option<PathBuf>,
    /// What a model found in it.
    predictions: Option<PredictionFile>,
}

impl Site {
    /// Opens a store, and a file of predictions for it.
    ///
    /// # Errors
    /// There is no such place, it is no store, or one of another format; the predictions cannot be read, or
    /// are for other scenes.
    pub(crate) fn open(place: &Path, predictions: Option<&Path>) -> Result<Self, ViewError> {
        let store = Store::open(place)?;
        if store.read(keys::DATASET)?.is_none() {
            return Err(ViewError::NoDataset(place.to_owned()));
        }
        // A bucket is no path.
        let root = fs::canonicalize(store.location("")).ok();
        let predictions = predictions.map(|path| open_predictions(&store, path)).transpose()?;
        Ok(Self { store, root, predictions })
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }

    pub(crate) fn predictions(&self) -> Option<&PredictionFile> {
        self.predictions.as_ref()
    }

    pub(crate) fn backend(&self) -> &dyn Backend {
        self.store.backend()
    }

    /// The last part of where it is.
    pub(crate) fn folder(&self) -> String {
        let place =
            self.root.as_ref().map_or_else(|| self.store.location(""), |root| root.display().to_string());
        place.trim_end_matches('/').rsplit('/').next().unwrap_or_default().to_owned()
    }

    /// An object, if it is one of the store: of a folder, what lies outside is none, whatever links say.
    ///
    /// # Errors
    /// It cannot be read.
    pub(crate) fn object(&self, key: &str) -> Result<Option<Object>, ViewError> {
        if self.root.as_ref().is_some_and(|root| !paths::lies_below(root, key)) {
            return Ok(None);
        }
        Object::open(&self.store, key)
    }

    /// An object that is JSON.
    ///
    /// # Errors
    /// It cannot be read or understood.
    pub(crate) fn json(&self, key: &str) -> Result<Option<Value>, ViewError> {
        let Some(object) = self.object(key)? else { return Ok(None) };
        Ok(Some(serde_json::from_slice(&object.bytes()?).map_err(of_place(&object.place))?))
    }
}

/// Opens a file of predictions for a store.
///
/// # Errors
/// It cannot be read, or has rows of other scenes alone.
fn open_predictions(store: &Store, path: &Path) -> Result<PredictionFile, ViewError> {
    if path.extension().is_some_and(|end| end == "json") {
        return Err(ViewError::Results(path.to_owned()));
    }
    let file = PredictionFile::open(path)?;
    let there = store.backend().folders("scenes")?;
    let is_there = |scene: u32| there.iter().any(|folder| folder.parse() == Ok(scene));
    if !file.scenes().any(is_there) {
        let scenes = file.scenes().map(|scene| scene.to_string()).collect::<Vec<_>>().join(", ");
        return Err(ViewError::OtherScenes { file: path.to_owned(), scenes });
    }
    Ok(file)
}
