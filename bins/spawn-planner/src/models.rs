//! The models of packs: read where they lie, checked, and put into the store as they are.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use packs::PackModel;
use runner::StageError;
use settings::stages::PlanSettings;
use store::{Unit, keys};

use crate::error::ModelError;

/// Digests of the folders of packs, as far as they are found.
pub(crate) fn digests(settings: &PlanSettings, folder: Option<&Path>) -> BTreeMap<String, String> {
    let of = |written: &String| Some((format!("models/{written}"), packs::digest(&find(written, folder)?)?));
    settings.models.packs.iter().filter_map(of).collect()
}

/// The folder of a pack: below that of maps, or from where the program runs.
fn find(written: &str, folder: Option<&Path>) -> Option<PathBuf> {
    let below = folder.map(|folder| folder.join(written));
    below.into_iter().chain([PathBuf::from(written)]).find(|path| path.is_dir())
}

/// All models of all packs, by name.
///
/// # Errors
/// A folder is missing, a model cannot be used, or two have one name.
pub(crate) fn read(settings: &PlanSettings, folder: Option<&Path>) -> Result<Vec<PackModel>, StageError> {
    let mut models: Vec<(PackModel, &str)> = Vec::new();
    for written in &settings.models.packs {
        let path = find(written, folder)
            .ok_or_else(|| StageError::usage(ModelError::NoFolder { written: written.clone() }))?;
        for model in packs::read_folder(&path).map_err(StageError::usage)? {
            if let Some((_, other)) = models.iter().find(|(other, _)| other.row.name == model.row.name) {
                let (name, first, second) = (model.row.name, (*other).to_owned(), written.clone());
                return Err(StageError::usage(ModelError::SameName { name, first, second }));
            }
            let [length, width, height] = model.row.size_m;
            let triangles: usize =
                model.levels.iter().take(1).flat_map(|l| &l.pieces).map(|p| p.mesh.triangles.len()).sum();
            tracing::info!(
                "{written}: {} ({length:.2} x {width:.2} x {height:.2} m, {triangles} triangles)",
                model.row.name
            );
            models.push((model, written));
        }
    }
    let mut models: Vec<PackModel> = models.into_iter().map(|(model, _)| model).collect();
    models.sort_by(|a, b| a.row.name.cmp(&b.row.name));
    Ok(models)
}

/// Puts the files of models into the store: from here on they are read there.
///
/// # Errors
/// The store cannot be written.
pub(crate) fn put(models: &[PackModel], unit: &mut Unit<'_>) -> Result<(), StageError> {
    for model in models {
        for (path, bytes) in &model.files {
            unit.bytes(&keys::model_file(&model.row.name, path), bytes, 1)?;
        }
    }
    Ok(())
}
