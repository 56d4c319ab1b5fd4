//! What can be wrong with what this stage reads.

/// Boxes, readings or grids do not fit together.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    /// A sensor's table has fewer frames than the scene.
    #[error("ends before this frame")]
    Ends,
    /// A sensor's table goes on with another frame than the scene.
    #[error("has frame {found} instead")]
    OtherFrame {
        /// Its frame.
        found: u32,
    },
    /// A box of nobody.
    #[error("has boxes of an agent or frame that does not exist")]
    Boxes,
    /// A voxel grid is of another kind.
    #[error("{member}: is no three-dimensional array of bytes")]
    NoGrid {
        /// Its name in the archive.
        member: String,
    },
    /// The archive of voxel grids is broken.
    #[error("{0} (run {stage} for this scene again with --force)", stage = crate::OCCUPANCY)]
    Grids(#[source] Box<dyn std::error::Error + Send + Sync>),
}
