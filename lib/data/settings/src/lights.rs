//! Street lamps and lit windows.

use serde::Serialize;

/// Street lamps and lit windows at night.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightSettings {
    /// Chance that a street lamp has failed (0.1).
    pub street_lamp_failure: f64,
    /// Change the flux of all street lamps of a dark scene by a common amount.
    pub change_intensity: bool,
    /// That amount, lumens; drawn per scene within the nominal flux either way when absent.
    pub intensity_change_lm: Option<f64>,
    /// No change takes a lamp below this flux, lumens (10,000).
    pub min_intensity_lm: f64,
    /// In a dark scene each building's windows have a colour of their own (not on high ground).
    pub random_building_colors: bool,
    /// Street lamps never burn.
    pub street_lamps_off: bool,
    /// Windows are never lit.
    pub buildings_off: bool,
}

impl Default for LightSettings {
    fn default() -> Self {
        Self {
            street_lamp_failure: 0.1,
            change_intensity: true,
            intensity_change_lm: None,
            min_intensity_lm: 10_000.0,
            random_building_colors: true,
            street_lamps_off: false,
            buildings_off: false,
        }
    }
}
