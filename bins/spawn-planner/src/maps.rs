//! The maps of a plan: our own towns are generated, others read from files, those of older scenes from the
//! store.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use opendrive::Map;
use plan::SceneSlot;
use runner::{At, Place, StageError};
use settings::stages::PlanSettings;
use settings::{MAP_ENDINGS, map_name};
use store::{Store, keys};

use crate::error::MapError;

/// Digests of the map files, by name in the store. Our own towns are part of the code; a file that is not
/// found now is in the store already, or missed with a message when it is needed.
pub(crate) fn digests(settings: &PlanSettings, folder: Option<&Path>) -> BTreeMap<String, String> {
    let all = settings.all();
    let wishes = all.iter().flat_map(|settings| &settings.scenes);
    let maps = wishes.filter(|s| s.count > 0).map(|s| s.map.as_str());
    maps.filter(|written| town::named(written).is_none())
        .filter_map(|written| {
            let source = read_map_file(written, folder).ok()?;
            Some((keys::map(map_name(written)), store::hash_bytes(&source.text)))
        })
        .collect()
}

/// A map's OpenDRIVE text and where it comes from, for messages.
pub(crate) struct MapSource {
    pub(crate) text: Vec<u8>,
    origin: String,
}

/// The path without its ending, where it is one of a map file.
fn file_stem(written: &str) -> Option<&str> {
    MAP_ENDINGS.iter().find_map(|ending| written.strip_suffix(ending))
}

/// The OpenDRIVE text of every map that a scene stands on, by its name in the store.
pub(crate) fn texts(
    settings: &PlanSettings,
    slots: &[SceneSlot],
    folder: Option<&Path>,
    store: &Store,
) -> Result<BTreeMap<String, MapSource>, StageError> {
    let mut written_as: BTreeMap<&str, &str> = BTreeMap::new();
    let all = settings.all();
    let wishes = all.iter().flat_map(|settings| &settings.scenes);
    for written in wishes.filter(|s| s.count > 0).map(|s| s.map.as_str()) {
        let name = map_name(written);
        if let Some(other) = written_as.insert(name, written)
            && other != written
        {
            let [first, second, name] = [other, written, name].map(str::to_owned);
            return Err(StageError::usage(MapError::SameName { first, second, name }));
        }
    }
    let mut texts = BTreeMap::new();
    for name in slots.iter().map(|slot| slot.map.as_str()) {
        if texts.contains_key(name) {
            continue;
        }
        let written = written_as.get(name).copied();
        let source = match (town::named(name), written) {
            (Some(parameters), _) => {
                let network = town::generate(&parameters).at(Place::default)?;
                MapSource { text: opendrive::write(&network).into_bytes(), origin: name.to_owned() }
            }
            (None, Some(written)) => read_map_file(written, folder)?,
            (None, None) => {
                let origin = store.location(&keys::map(name));
                let text = replay::maps::read_text(store, name).at(Place::default)?.ok_or(MapError::Gone);
                let text = text.at(|| Place::file(&origin))?;
                MapSource { text, origin }
            }
        };
        texts.insert(name.to_owned(), source);
    }
    Ok(texts)
}

/// Reads a map from the path that was written, below the maps folder or from where the program runs; or,
/// where no ending was written, from the file of that stem in the maps folder.
fn read_map_file(written: &str, folder: Option<&Path>) -> Result<MapSource, StageError> {
    let own = town::names().join(", ");
    let paths: Vec<PathBuf> = if file_stem(written).is_some() {
        let below = folder.map(|f| f.join(written));
        below.into_iter().chain([PathBuf::from(written)]).collect()
    } else {
        let Some(folder) = folder else {
            let written = written.to_owned();
            return Err(StageError::usage(MapError::NoFolder { written, own }));
        };
        if written.split(['/', '\\']).any(|part| part.is_empty() || part.starts_with('.')) {
            return Err(StageError::usage(MapError::NotPlain { written: written.to_owned() }));
        }
        MAP_ENDINGS.iter().map(|ending| folder.join(format!("{written}{ending}"))).collect()
    };
    for path in &paths {
        match std::fs::read(path) {
            Ok(bytes) => {
                let text = unpack(bytes, path)?;
                return Ok(MapSource { text, origin: path.display().to_string() });
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
            Err(source) => {
                let path = path.clone();
                return Err(StageError::usage(MapError::Unreadable { path, source }));
            }
        }
    }
    let looked: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
    let (written, looked) = (written.to_owned(), looked.join(" nor "));
    Err(StageError::usage(MapError::NotFound { written, looked, own }))
}

/// The text of a map file that may be gzipped: the store keeps the text, so its hash does not depend on
/// packing.
fn unpack(bytes: Vec<u8>, path: &Path) -> Result<Vec<u8>, StageError> {
    const LARGEST: u64 = 1 << 30;
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    flate2::read::GzDecoder::new(bytes.as_slice())
        .take(LARGEST)
        .read_to_end(&mut text)
        .map_err(MapError::Gzip)
        .at(|| Place::file(path.display().to_string()))?;
    Ok(text)
}

pub(crate) fn parse(source: &MapSource) -> Result<Map, StageError> {
    let origin = &source.origin;
    let network = opendrive::read_bytes(&source.text).at(|| Place::file(origin))?;
    if !network.warnings.is_empty() {
        let count = network.warnings.len();
        tracing::info!("{origin}: {count} peculiarities in the file (CONVOY_LOG=debug lists them)");
        for warning in &network.warnings {
            tracing::debug!("{origin}: {warning}");
        }
    }
    Ok(Map::new(network))
}
