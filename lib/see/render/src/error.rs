//! What can go wrong in looking.

/// A renderer could not answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A snapshot speaks of meshes that the renderer was never given.
    #[error(
        "a snapshot of {in_snapshot} meshes was placed over {prepared} prepared ones: prepare all of them first"
    )]
    Unprepared {
        /// Meshes that the snapshot lists.
        in_snapshot: usize,
        /// Meshes that were prepared.
        prepared: usize,
    },
    /// The device behind a renderer failed: it is lost, or its memory is full.
    #[error("the renderer's device failed")]
    Device(#[source] Box<dyn std::error::Error + Send + Sync>),
}
