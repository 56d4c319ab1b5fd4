//! What there is to be had: the page, lists, and objects of one store.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use store::{Backend, Store, keys};

use crate::error::{ViewError, of_place};
use crate::object::Object;
use crate::{listing, page, paths};

/// A store that is shown.
pub(crate) struct Site {
    store: Store,
    /// Its folder, all links followed; none in a bucket.
    root: Option<PathBuf>,
}

/// An answer's body.
#[derive(Debug)]
pub(crate) enum Content {
    /// From memory, with its media type.
    Text(String, &'static str),
    /// From the store, which may be asked for in parts.
    Object(Object, &'static str),
}

impl Site {
    /// Opens a store.
    ///
    /// # Errors
    /// There is no such place, it is no store, or one of another format.
    pub(crate) fn open(place: &Path) -> Result<Self, ViewError> {
        let store = Store::open(place)?;
        if store.read(keys::DATASET)?.is_none() {
            return Err(ViewError::NoDataset(place.to_owned()));
        }
        let folder = store.location("");
        let root = match folder.contains("://") {
            true => None,
            false => Some(fs::canonicalize(&folder).map_err(of_place(&folder))?),
        };
        Ok(Self { store, root })
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

    /// What a URL's path stands for, or why there is nothing there.
    ///
    /// # Errors
    /// There is no such page, scene or file, or it cannot be read.
    pub(crate) fn content(&self, path: &str) -> Result<Content, ViewError> {
        let text = |text: &str, media_type| Ok(Content::Text(text.to_owned(), media_type));
        match path {
            "/" | "/index.html" => Ok(Content::Text(page::served(), "text/html; charset=utf-8")),
            "/app.js" => text(page::APP, "text/javascript; charset=utf-8"),
            "/worker.js" => text(page::WORKER, "text/javascript; charset=utf-8"),
            "/style.css" => text(page::STYLE, "text/css; charset=utf-8"),
            "/api/names.json" => Ok(json(&listing::names())),
            "/api/store.json" => listing::store(self).map(|v| json(&v)),
            _ => match (path.strip_prefix("/api/scenes/"), path.strip_prefix("/store/")) {
                (Some(name), _) => self.scene(name),
                (_, Some(name)) => self.file(name),
                _ => Err(ViewError::NoPage),
            },
        }
    }

    fn scene(&self, name: &str) -> Result<Content, ViewError> {
        let folder = name.strip_suffix(".json").filter(|folder| listing::is_number(folder));
        let folder = folder.ok_or(ViewError::NoScene)?;
        listing::scene(self, folder).map(|v| json(&v))
    }

    fn file(&self, name: &str) -> Result<Content, ViewError> {
        let key = paths::key_of(name).ok_or(ViewError::NoFile)?;
        let object = self.object(&key)?.ok_or(ViewError::NoFile)?;
        Ok(Content::Object(object, media_type(&key)))
    }
}

fn json(value: &Value) -> Content {
    Content::Text(value.to_string(), "application/json")
}

/// What a browser shows by itself (the report and its figures); all else are bytes.
fn media_type(key: &str) -> &'static str {
    match Path::new(key).extension().and_then(|e| e.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("jpg") => "image/jpeg",
        Some("json") => "application/json",
        Some("csv") => "text/csv; charset=utf-8",
        _ => "application/octet-stream",
    }
}
