//! Trajectories from outside, as the configuration names them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plan::TrackFiles;
use runner::StageError;
use settings::stages::PlanSettings;

use crate::error::TrajectoryError;
use crate::trajectory_file::read_file;

/// Digests of the files, as far as they are found.
pub(crate) fn digests(settings: &PlanSettings, folder: Option<&Path>) -> BTreeMap<String, String> {
    let of = |written: &str| {
        let bytes = std::fs::read(find(written, folder)?).ok()?;
        Some((format!("trajectories/{written}"), store::hash_bytes(&bytes)))
    };
    written(settings).filter_map(of).collect()
}

/// The files of all groups and editions.
fn written(settings: &PlanSettings) -> impl Iterator<Item = &str> {
    settings.all().into_iter().filter_map(|settings| settings.agents.trajectories.as_deref())
}

/// A file below the folder of maps, or from where the program runs.
fn find(written: &str, folder: Option<&Path>) -> Option<PathBuf> {
    let below = folder.map(|folder| folder.join(written));
    below.into_iter().chain([PathBuf::from(written)]).find(|path| path.is_file())
}

/// The tracks of all files.
///
/// # Errors
/// A file is missing, or is no table of poses.
pub(crate) fn read(settings: &PlanSettings, folder: Option<&Path>) -> Result<TrackFiles, StageError> {
    let mut files = TrackFiles::new();
    for written in written(settings) {
        if !files.contains_key(written) {
            let path = find(written, folder).ok_or_else(|| {
                StageError::usage(TrajectoryError::NotFound { written: written.to_owned() })
            })?;
            let fault = |problem| {
                StageError::usage(TrajectoryError::Bad { path: path.display().to_string(), problem })
            };
            let tracks = read_file(&path).map_err(fault)?;
            let moving: usize = tracks.iter().map(|track| track.poses.len()).sum();
            tracing::info!("{written}: {} actors, {moving} poses", tracks.len());
            files.insert(written.to_owned(), tracks);
        }
    }
    Ok(files)
}
