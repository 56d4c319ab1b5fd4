//! The layout of a store: where everything is.

use schema::AgentId;
use schema::arrays::ArrayKind;
use schema::table::Row;
use schema::tile::TileIndex;

/// What a manifest is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// The whole dataset's plan.
    Plan,
    /// One scene.
    Scene(u32),
    /// A tile of the static world, of a set that is named by what its tiles are made from.
    Tile {
        /// Which set.
        set: u64,
        /// Which tile of it.
        index: TileIndex,
    },
    /// The whole dataset's statistics.
    Stats,
}

impl Scope {
    /// The folder that holds everything of this scope.
    #[must_use]
    pub fn folder(self) -> String {
        match self {
            Self::Plan => "plan".into(),
            Self::Scene(scene) => format!("scenes/{scene:04}"),
            Self::Tile { set, index } => format!("tiles/{set:016x}/{index}"),
            Self::Stats => "stats".into(),
        }
    }

    /// The folders in which stages of the scope write.
    #[must_use]
    pub fn folders(self) -> Vec<String> {
        let mut folders = vec![self.folder()];
        if self == Self::Plan {
            folders.extend(["maps".to_owned(), "models".to_owned()]);
        }
        folders
    }

    /// Whether stages of the scope also write beside all folders: a plan its record, statistics their card.
    #[must_use]
    pub fn writes_at_top(self) -> bool {
        matches!(self, Self::Plan | Self::Stats)
    }

    /// The folder with all records of stages.
    #[must_use]
    pub fn records(self) -> String {
        match self {
            Self::Plan | Self::Tile { .. } | Self::Stats => self.folder(),
            Self::Scene(_) => format!("{}/_manifests", self.folder()),
        }
    }

    /// The manifest of a stage.
    #[must_use]
    pub fn manifest(self, stage: &str) -> String {
        match self {
            Self::Plan | Self::Tile { .. } | Self::Stats => format!("{}/_manifest.json", self.folder()),
            Self::Scene(_) => format!("{}/_manifests/{stage}.json", self.folder()),
        }
    }

    /// The folder of a stage's records of finished units, until its manifest takes their place.
    #[must_use]
    pub fn parts(self, stage: &str) -> String {
        format!("{}/_manifests/{stage}.parts", self.folder())
    }

    /// The record of one finished unit.
    #[must_use]
    pub fn part(self, stage: &str, unit: &str) -> String {
        format!("{}/{unit}.json", self.parts(stage))
    }

    /// The record that a stage is being done again.
    #[must_use]
    pub fn redo(self, stage: &str) -> String {
        format!("{}/_manifests/{stage}.redo.json", self.folder())
    }

    /// The record that a stage failed.
    #[must_use]
    pub fn failure(self, stage: &str) -> String {
        format!("{}/_manifests/{stage}.failed.json", self.folder())
    }
}

/// Whether a record (a manifest, of a unit or of redoing) may name an object: one in the folders in which
/// stages of its own scope write. Records are read from places that others can write, too.
pub(crate) fn may_name(record: &str, key: &str) -> bool {
    // Names of records and of their folders begin with a low line.
    let own = record.split("/_").next().unwrap_or_default();
    let whole = [Scope::Plan, Scope::Stats].into_iter().find(|scope| scope.folder() == own);
    let folders = whole.map_or_else(|| vec![own.to_owned()], Scope::folders);
    let is_in = |folder: &String| key.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'));
    let is_at_top = whole.is_some_and(Scope::writes_at_top) && !key.contains('/');
    let is_plain = |part: &str| !matches!(part, "" | "." | "..") && !part.contains('\\');
    (folders.iter().any(is_in) || is_at_top) && key.split('/').all(is_plain)
}

/// The folder of locks: who works on the store. They are nothing of the dataset.
pub const LOCKS: &str = "_locks";
/// Format version, resolved configuration, code version.
pub const DATASET: &str = "dataset.json";
/// Which scene has which number, split and map: what an expansion goes on from.
pub const ROSTER: &str = "plan/roster.json";
/// Planned scenes.
pub const PLAN_SCENES: &str = "plan/scenes.parquet";
/// Planned hazards.
pub const PLAN_HAZARDS: &str = "plan/hazards.parquet";
/// Keyframes of the weather.
pub const PLAN_WEATHER: &str = "plan/weather.parquet";
/// Routes that the user gave.
pub const PLAN_ROUTES: &str = "plan/routes.parquet";
/// Trajectories that the user gave.
pub const PLAN_TRAJECTORIES: &str = "plan/trajectories.parquet";
/// Models of packs.
pub const PLAN_MODELS: &str = "plan/models.parquet";
/// Planned agents.
pub const PLAN_AGENTS: &str = "plan/agents.parquet";

/// Whether an object is a lock, and nothing of the dataset.
#[must_use]
pub fn is_lock(key: &str) -> bool {
    key.strip_prefix(LOCKS).is_some_and(|rest| rest.starts_with('/'))
}

/// A map, by name.
#[must_use]
pub fn map(name: &str) -> String {
    format!("maps/{name}.xodr.zst")
}

/// The vector map of a map.
#[must_use]
pub fn vector_map(name: &str) -> String {
    format!("maps/{name}.vector.parquet")
}

/// A file of a model of a pack, by the model's name and its path in the pack.
#[must_use]
pub fn model_file(model: &str, path: &str) -> String {
    format!("models/{model}/{path}")
}

/// A file of a scene, by its name in the scene's folder.
#[must_use]
pub fn scene(scene: u32, name: &str) -> String {
    format!("scenes/{scene:04}/{name}")
}

/// The scene in whose folder a file lies.
#[must_use]
pub fn scene_of(key: &str) -> Option<u32> {
    key.strip_prefix("scenes/")?.split_once('/')?.0.parse().ok()
}

/// A table of a scene, by the type of its rows.
#[must_use]
pub fn table<R: Row>(of_scene: u32) -> String {
    scene(of_scene, &format!("{}.parquet", R::TABLE))
}

/// A table of a tile, by its name: `surfaces`, `objects`.
#[must_use]
pub fn tile(set: u64, index: TileIndex, name: &str) -> String {
    format!("{}/{name}.parquet", Scope::Tile { set, index }.folder())
}

/// A sensor's shard.
#[must_use]
pub fn sensor(scene: u32, agent: AgentId, sensor: &str) -> String {
    format!("scenes/{scene:04}/sensors/{agent}/{sensor}.parquet")
}

/// Arrays of an agent, one a frame.
#[must_use]
pub fn array(scene: u32, kind: &ArrayKind, agent: AgentId) -> String {
    format!("scenes/{scene:04}/{}/{agent}.npz", kind.folder)
}

/// Partial counts of a stage.
#[must_use]
pub fn partial_stats(scene: u32, stage: &str) -> String {
    format!("scenes/{scene:04}/stats/{stage}.parquet")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_name_what_lies_in_their_folders() {
        let tile = Scope::Tile { set: 7, index: TileIndex { x: -1, y: 2 } };
        let records = |scope: Scope| [scope.manifest("s"), scope.part("s", "u"), scope.redo("s")];
        let mesh = format!("{}/meshes.parquet", tile.folder());
        for (scope, key) in [
            (Scope::Plan, "maps/convoy/demo.xodr.zst"),
            (Scope::Plan, "models/van/van.bin"),
            (Scope::Plan, PLAN_SCENES),
            (Scope::Plan, DATASET),
            (Scope::Stats, "README.md"),
            (Scope::Stats, "stats/report.html"),
            (Scope::Scene(3), "scenes/0003/bev/vehicle_0.npz"),
            (tile, mesh.as_str()),
        ] {
            assert!(records(scope).iter().all(|record| may_name(record, key)), "{key}");
        }
        for (scope, key) in [
            (Scope::Plan, "scenes/0000/a"),
            (Scope::Stats, "maps/a"),
            (Scope::Scene(3), "scenes/0004/a"),
            (Scope::Scene(3), "scenes/00031/a"),
            (Scope::Scene(3), "scenes/0003/../0004/a"),
            (Scope::Scene(3), "scenes/0003//a"),
            (Scope::Scene(3), "../a"),
            (Scope::Scene(3), "/etc/passwd"),
            (Scope::Scene(3), "README.md"),
            (Scope::Scene(3), ""),
            (tile, "tiles/a"),
        ] {
            assert!(!records(scope).iter().any(|record| may_name(record, key)), "{key}");
        }
    }
}
