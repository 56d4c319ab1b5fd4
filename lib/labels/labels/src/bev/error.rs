//! What can be wrong with a grid.

use settings::BevSettings;

/// A grid that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("BEV grid of {cells} cells of {cell_m} m: 1 to 8192 cells of a finite size above 0 are possible")]
pub struct BevError {
    /// Rows and columns.
    pub cells: u32,
    /// Cell size, metres.
    pub cell_m: f64,
}

impl BevError {
    /// Rows and columns of a grid that can be made.
    pub(crate) fn check(settings: &BevSettings) -> Result<usize, Self> {
        let BevSettings { cells, cell_m, .. } = *settings;
        let possible = (1..=8192).contains(&cells) && cell_m.is_finite() && cell_m > 0.0;
        if possible { Ok(cells as usize) } else { Err(Self { cells, cell_m }) }
    }
}
