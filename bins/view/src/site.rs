//! What there is to be had: the page, lists, and files of one store.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{ViewError, of_file};
use crate::{listing, page, paths};

/// A store that is shown.
#[derive(Debug)]
pub(crate) struct Site {
    /// Its folder, all links followed.
    root: PathBuf,
    /// Its folder as it was named.
    named: PathBuf,
}

/// An answer's body.
#[derive(Debug)]
pub(crate) enum Content {
    /// From memory, with its media type.
    Text(String, &'static str),
    /// From a file, which may be asked for in parts.
    File { file: File, size: u64, media_type: &'static str },
}

impl Site {
    /// Opens a store.
    ///
    /// # Errors
    /// There is no such folder, it is no store, or one of another format.
    pub(crate) fn open(folder: &Path) -> Result<Self, ViewError> {
        let root = fs::canonicalize(folder).map_err(of_file(folder))?;
        if !root.join("dataset.json").is_file() {
            return Err(ViewError::NoDataset(folder.to_owned()));
        }
        listing::check_format(&root)?;
        Ok(Self { root, named: folder.to_owned() })
    }

    pub(crate) fn root(&self) -> &Path {
        &self.root
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
            "/api/store.json" => listing::store(&self.root, &self.named).map(|v| json(&v)),
            _ => match (path.strip_prefix("/api/scenes/"), path.strip_prefix("/store/")) {
                (Some(name), _) => self.scene(name),
                (_, Some(name)) => self.file(name),
                _ => Err(ViewError::NoPage),
            },
        }
    }

    fn scene(&self, name: &str) -> Result<Content, ViewError> {
        let folder =
            name.strip_suffix(".json").filter(|f| !f.is_empty() && f.bytes().all(|b| b.is_ascii_digit()));
        let folder = folder.ok_or(ViewError::NoScene)?;
        listing::scene(&self.root, folder).map(|v| json(&v))
    }

    fn file(&self, name: &str) -> Result<Content, ViewError> {
        let path = paths::file_below(&self.root, name).ok_or(ViewError::NoFile)?;
        let open = || {
            let file = File::open(&path)?;
            let size = file.metadata()?.len();
            Ok::<_, io::Error>(Content::File { file, size, media_type: media_type(&path) })
        };
        open().map_err(of_file(&path))
    }
}

fn json(value: &Value) -> Content {
    Content::Text(value.to_string(), "application/json")
}

/// What a browser shows by itself (the report and its figures); all else are bytes.
fn media_type(path: &Path) -> &'static str {
    match path.extension().and_then(|e| e.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("jpg") => "image/jpeg",
        Some("json") => "application/json",
        Some("csv") => "text/csv; charset=utf-8",
        _ => "application/octet-stream",
    }
}
