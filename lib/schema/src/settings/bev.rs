//! BEV masks.

use serde::Serialize;

/// The BEV grid: square, centred on the agent, row 0 ahead, column 0 left.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BevSettings {
    /// Write BEV masks.
    pub enabled: bool,
    /// Rows and columns (400).
    pub cells: u32,
    /// Cell size, metres (0.4).
    pub cell_m: f64,
}

impl Default for BevSettings {
    fn default() -> Self {
        Self { enabled: true, cells: 400, cell_m: 0.4 }
    }
}

impl BevSettings {
    /// Half the grid's side, metres.
    #[must_use]
    pub fn half_extent_m(&self) -> f64 {
        0.5 * f64::from(self.cells) * self.cell_m
    }
}
