//! Scenery placed by rule.

use serde::Serialize;

/// Scenery placed by rule on the land beside the roads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldSettings {
    /// Buildings per free frontage, 0 to 1 (0.8).
    pub building_density: f64,
    /// Trees per free frontage, 0 to 1 (0.6).
    pub tree_density: f64,
    /// Distance between street lamps along a sidewalk, metres (28).
    pub lamp_spacing_m: f64,
    /// Share of parking spaces that are taken, 0 to 1 (0.5).
    pub parked_share: f64,
    /// Scenery is built within this distance of any agent's path start, metres (400).
    pub radius_m: f64,
}

impl Default for WorldSettings {
    fn default() -> Self {
        Self {
            building_density: 0.8,
            tree_density: 0.6,
            lamp_spacing_m: 28.0,
            parked_share: 0.5,
            radius_m: 400.0,
        }
    }
}
