//! Scenery placed by rule.

use crate::key::{Name, Settings, choice, settings};
use crate::reader::Section;

choice! {
    /// A time of the year.
    pub enum Season {
        /// Trees have leaves, and fields stand high.
        #[default]
        Summer = "summer",
        /// Broad-leaved trees are bare, and fields are empty.
        Winter = "winter",
    }
}

settings! {
    /// How the land beside the roads is built up and planted: what the tiles of a map are made from.
    pub struct SceneryRules {
        /// Seed of what is built beside the roads: scenes share it, whatever the dataset's seed is.
        seed: u64 = 1, within(0..=i64::MAX as u64);
        /// How much there is besides buildings, trees, lamps and parked vehicles - plots, meadows, woods,
        /// street furniture: 0 nothing, 1 as in towns, 2 more.
        #[serde(skip_serializing_if = "is_one")]
        density: f64 = 1.0, within(0.0..=2.0);
        /// Share of free frontage with buildings.
        building_density: f64 = 0.8, share();
        /// Share of free frontage with trees.
        tree_density: f64 = 0.6, share();
        /// Distance between street lamps along a sidewalk, m.
        lamp_spacing_m: f64 = 25.0, within(5.0..=1000.0);
        /// Share of parking spaces that are taken.
        parked_share: f64 = 0.5, share();
        /// Time of the year.
        #[serde(skip_serializing_if = "is_summer")]
        season: Season = Season::Summer, choice();
    }
}

settings! {
    /// The static world, and how much of it a scene has.
    pub struct WorldSettings {
        /// How it is built up.
        scenery: SceneryRules = SceneryRules::default(), apart();
        /// The static world is there within this distance of every agent at every frame, m (more where boxes
        /// or grids reach farther); nothing is seen beyond.
        radius_m: f64 = 400.0, within(50.0..=5000.0);
    }
}

settings! {
    /// Keys of `[scenery]` that stood in `[world]` at first, and are still read there.
    struct OldNames {
        /// Old name of `scenery.seed`.
        seed: Option<u64> = None, within(0..=i64::MAX as u64), or("as there");
        /// Old name of `scenery.building_density`.
        building_density: Option<f64> = None, within(0.0..=1.0), or("as there");
        /// Old name of `scenery.tree_density`.
        tree_density: Option<f64> = None, within(0.0..=1.0), or("as there");
        /// Old name of `scenery.lamp_spacing_m`.
        lamp_spacing_m: Option<f64> = None, within(5.0..=1000.0), or("as there");
        /// Old name of `scenery.parked_share`.
        parked_share: Option<f64> = None, within(0.0..=1.0), or("as there");
    }
}

fn is_one(value: &f64) -> bool {
    *value == 1.0
}

fn is_summer(season: &Season) -> bool {
    *season == Season::Summer
}

/// Reads `[world]` and `[scenery]`.
pub(crate) fn read(root: &Section<'_>, name: &Name, default: WorldSettings) -> WorldSettings {
    let about = "What is built and planted by rule on the land beside the roads.";
    let (world, scenery) = (root.section(name.key, name.doc), root.section("scenery", about));
    let settings = WorldSettings::read(&world, &default);
    let old = OldNames::read(&world, &OldNames::default());
    for key in ["seed", "building_density", "tree_density", "lamp_spacing_m", "parked_share"] {
        if world.has(key) && scenery.has(key) {
            let told =
                format!("`world.{key}` is the old name of `scenery.{key}`, which is there, too: remove it");
            world.fault_at(key, told);
        }
    }
    let default = SceneryRules {
        seed: old.seed.unwrap_or(default.scenery.seed),
        building_density: old.building_density.unwrap_or(default.scenery.building_density),
        tree_density: old.tree_density.unwrap_or(default.scenery.tree_density),
        lamp_spacing_m: old.lamp_spacing_m.unwrap_or(default.scenery.lamp_spacing_m),
        parked_share: old.parked_share.unwrap_or(default.scenery.parked_share),
        ..default.scenery
    };
    WorldSettings { scenery: SceneryRules::read(&scenery, &default), ..settings }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;

    fn scenery(text: &str) -> Result<SceneryRules, String> {
        let text = format!("[scenes.train]\n\"convoy/demo\" = 1\n{text}");
        let faults = |faults: Vec<crate::Fault>| faults.iter().map(|f| f.message.clone()).collect::<String>();
        parse(&text, "x.toml").map(|all| all.world.scenery).map_err(faults)
    }

    #[test]
    fn old_names_are_read_where_the_new_ones_are_not_there() {
        let old = scenery("[world]\nseed = 7\ntree_density = 0.25\nradius_m = 90\n").expect("is good");
        let new =
            scenery("[world]\nradius_m = 90\n[scenery]\nseed = 7\ntree_density = 0.25\n").expect("is good");
        assert_eq!(old, new);
        assert_eq!(old, SceneryRules { seed: 7, tree_density: 0.25, ..SceneryRules::default() });
        let mixed = scenery("[world]\nseed = 7\n[scenery]\nseason = \"winter\"\n").expect("is good");
        assert_eq!((mixed.seed, mixed.season), (7, Season::Winter));
        let both = scenery("[world]\nseed = 7\n[scenery]\nseed = 8\n").expect_err("is said twice");
        assert!(both.contains("`world.seed` is the old name of `scenery.seed`"), "{both}");
    }

    #[test]
    fn what_is_as_ever_is_not_written_down() {
        let rules = serde_json::to_value(SceneryRules::default()).expect("is JSON");
        assert!(rules.get("density").is_none() && rules.get("season").is_none(), "{rules}");
    }
}
