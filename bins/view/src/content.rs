//! What there is to be had: the page, lists, and objects of one store.

use std::path::Path;

use serde_json::Value;

use crate::error::ViewError;
use crate::object::Object;
use crate::site::Site;
use crate::{listing, page, paths, predictions};

/// An answer's body.
#[derive(Debug)]
pub(crate) enum Content {
    /// From memory, with its media type.
    Text(String, &'static str),
    /// From the store, which may be asked for in parts.
    Object(Object, &'static str),
}

/// What a URL's path stands for, or why there is nothing there.
///
/// # Errors
/// There is no such page, scene or file, or it cannot be read.
pub(crate) fn content(site: &Site, path: &str) -> Result<Content, ViewError> {
    let text = |text: &str, media_type| Ok(Content::Text(text.to_owned(), media_type));
    match path {
        "/" | "/index.html" => Ok(Content::Text(page::served(), "text/html; charset=utf-8")),
        "/app.js" => text(page::APP, "text/javascript; charset=utf-8"),
        "/worker.js" => text(page::WORKER, "text/javascript; charset=utf-8"),
        "/style.css" => text(page::STYLE, "text/css; charset=utf-8"),
        "/api/names.json" => Ok(json(&listing::names())),
        "/api/store.json" => listing::store(site).map(|v| json(&v)),
        _ => {
            if let Some(name) = path.strip_prefix("/api/scenes/") {
                listing::scene(site, folder_of(name)?).map(|v| json(&v))
            } else if let Some(name) = path.strip_prefix("/api/predictions/") {
                predictions::of_scene(site, folder_of(name)?).map(|v| json(&v))
            } else if let Some(name) = path.strip_prefix("/store/") {
                file(site, name)
            } else {
                Err(ViewError::NoPage)
            }
        }
    }
}

/// The folder of the scene that a list `0007.json` is of.
fn folder_of(name: &str) -> Result<&str, ViewError> {
    let folder = name.strip_suffix(".json").filter(|folder| listing::is_number(folder));
    folder.ok_or(ViewError::NoScene)
}

fn file(site: &Site, name: &str) -> Result<Content, ViewError> {
    let key = paths::key_of(name).ok_or(ViewError::NoFile)?;
    let object = site.object(&key)?.ok_or(ViewError::NoFile)?;
    Ok(Content::Object(object, media_type(&key)))
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
