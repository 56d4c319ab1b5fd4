//! What can be wrong with what this stage reads.

use labels::fill::FillError;
use scene::SceneError;

/// Boxes or grids do not fit together.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    /// A part of the scene cannot be read.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A box of nobody.
    #[error(
        "has boxes out of order, or of an agent or frame that does not exist (run simulate-and-log with --force)"
    )]
    Boxes,
    /// Pixels stand after those of a later frame.
    #[error("visible: row {row} is out of order (run render-sensors with --force)")]
    Visible { row: usize },
    /// A voxel grid is of another kind.
    #[error("{path}: frame {frame}: is no three-dimensional array of bytes")]
    NoGrid { path: String, frame: u32 },
    /// A voxel grid cannot be filled.
    #[error("{path}: frame {frame}: {source} (run occupancy-gt for this scene again with --force)")]
    Fill { path: String, frame: u32, source: FillError },
}
