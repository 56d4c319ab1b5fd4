//! What `stats` sees.

use serde::Serialize;

/// What the statistics say of the configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StatisticsSettings {
    /// Name of the dataset.
    pub name: String,
    /// Cells of a BEV mask.
    pub bev_cells_per_grid: u64,
}
