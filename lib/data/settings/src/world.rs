//! Scenery placed by rule.

use serde::Serialize;

/// How the land beside the roads is built up: what the tiles of a map are made from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneryRules {
    /// Seed of everything that is placed (1).
    pub seed: u64,
    /// Buildings per free frontage, 0 to 1 (0.8).
    pub building_density: f64,
    /// Trees per free frontage, 0 to 1 (0.6).
    pub tree_density: f64,
    /// Distance between street lamps along a sidewalk, metres (28).
    pub lamp_spacing_m: f64,
    /// Share of parking spaces that are taken, 0 to 1 (0.5).
    pub parked_share: f64,
}

impl Default for SceneryRules {
    fn default() -> Self {
        Self { seed: 1, building_density: 0.8, tree_density: 0.6, lamp_spacing_m: 28.0, parked_share: 0.5 }
    }
}

/// The static world, and how much of it a scene has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldSettings {
    /// How it is built up.
    pub scenery: SceneryRules,
    /// It is there within this distance of every agent at every frame, metres (400).
    pub radius_m: f64,
}

impl Default for WorldSettings {
    fn default() -> Self {
        Self { scenery: SceneryRules::default(), radius_m: 400.0 }
    }
}
