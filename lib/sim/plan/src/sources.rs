//! Models and trajectories, for the planner.

use catalogue::Catalogue;

use crate::tracks::TrackFiles;

/// What scenes are planned from besides settings and maps.
#[derive(Clone, Copy, Debug)]
pub struct PlanSources<'a> {
    /// The models that there are.
    pub catalogue: &'a Catalogue,
    /// Trajectories, by the name of their file.
    pub tracks: &'a TrackFiles,
}
