//! Scenery placed by rule.

use crate::key::settings;

settings! {
    /// How the land beside the roads is built up: what the tiles of a map are made from.
    pub struct SceneryRules {
        /// Seed of what is built beside the roads: scenes share it, whatever the dataset's seed is.
        seed: u64 = 1, within(0..=i64::MAX as u64);
        /// Share of free frontage with buildings.
        building_density: f64 = 0.8, share();
        /// Share of free frontage with trees.
        tree_density: f64 = 0.6, share();
        /// Distance between street lamps along a sidewalk, m.
        lamp_spacing_m: f64 = 28.0, within(5.0..=1000.0);
        /// Share of parking spaces that are taken.
        parked_share: f64 = 0.5, share();
    }
}

settings! {
    /// The static world, and how much of it a scene has.
    pub struct WorldSettings {
        /// How it is built up.
        scenery: SceneryRules = SceneryRules::default(), flat();
        /// The static world is there within this distance of every agent at every frame, m (more where boxes
        /// or grids reach farther); nothing is seen beyond.
        radius_m: f64 = 400.0, within(50.0..=5000.0);
    }
}
