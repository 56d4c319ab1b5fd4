//! Everything that determines a dataset. Only the configuration and those who hand out its parts know this
//! whole: stages get the parts that they use ([`crate::stages`]).

use crate::annotation::AnnotationSettings;
use crate::bev::{BevRule, BevSettings};
use crate::card::CardSettings;
use crate::config_key::ConfigKey;
use crate::groups::{self, Group};
use crate::key::{Settings, settings};
use crate::models::ModelSettings;
use crate::reader::{Section, describe};
use crate::scenario::{Scenario, known_models};
use crate::scenes;
use crate::scenes::SceneCount;
use crate::store::StoreSettings;
use crate::tracks::TrackSettings;
use crate::world::{self, WorldSettings};

settings! {
    /// Everything that determines a dataset, besides maps and code.
    pub struct DatasetSettings {
        /// Name of the dataset, in reports.
        name: String = "dataset".into();
        /// How the store is kept: nothing of the dataset.
        #[serde(skip)]
        store: StoreSettings = StoreSettings::default(), table();
        /// Words of the dataset's card, README.md in the store.
        card: CardSettings = CardSettings::default(), table();
        /// Seed of every random stream but that of the scenery (`scenery.seed`).
        seed: u64 = 27, within(0..=i64::MAX as u64);
        /// How many scenes on which map.
        scenes: Vec<SceneCount> = Vec::new(), by(scenes::counts);
        /// Number of the first scene. Stores that are made apart and merged later have numbers of their own.
        #[serde(skip_serializing_if = "scenes::is_zero")]
        first_scene: u32 = 0, within(0..=900_000);
        /// Scenes to replace by other ones of the same split and map; keys are scene numbers.
        redraw: Vec<(u32, u32)> = Vec::new(), by(scenes::redraw);
        /// Models besides the built-in ones.
        #[serde(skip_serializing_if = "ModelSettings::is_built_in")]
        models: ModelSettings = ModelSettings::default(), table();
        /// What groups of scenes may have of their own.
        #[serde(flatten)]
        scenario: Scenario = Scenario::default(), flat();
        /// How much of the static world a scene has.
        world: WorldSettings = WorldSettings::default(), by(world::read);
        /// Which objects are annotated.
        annotation: AnnotationSettings = AnnotationSettings::default(), table();
        /// Objects followed over a scene.
        tracks: TrackSettings = TrackSettings::default(), table();
        /// Bird's-eye-view masks.
        bev: BevSettings = BevSettings::default(), table();
        /// Kinds of scenes: what stands in the table of a group goes before what stands at the top.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        groups: Vec<Group> = Vec::new(), or("all scenes are of one kind"), by(groups::read);
    }
    rule consistent;
}

/// Every key with its type, default and meaning, in reading order: the source of `docs/configuration.md`.
#[must_use]
pub fn config_keys() -> Vec<ConfigKey> {
    describe(read)
}

/// Reads a configuration.
pub(crate) fn read(root: &Section<'_>) -> DatasetSettings {
    DatasetSettings::read(root, &DatasetSettings::default())
}

/// What keys of several tables must be together.
fn consistent(root: &Section<'_>, settings: &DatasetSettings) {
    let all = settings.groups.iter().flat_map(|group| &group.scenes).chain(&settings.scenes);
    if all.map(|scenes| scenes.count).all(|count| count == 0) {
        let example = "[scenes.train] with \"convoy/demo\" = 2";
        root.fault_at("scenes", format!("no scenes: add a table such as {example}"));
    }
    check_rates(root, settings);
    if settings.models.is_built_in() {
        known_models(root, &settings.scenario.agents);
        let items = root.sections("groups", "", "").unwrap_or_default();
        for (item, group) in items.iter().zip(&settings.groups) {
            known_models(item, &group.scenario.agents);
        }
    }
}

/// Labels that are made of boxes need boxes at their frames.
fn check_rates(root: &Section<'_>, settings: &DatasetSettings) {
    let boxes = settings.annotation.every_n_frames;
    let problem = |key: &str, frames: u32| {
        format!(
            "`{key}` asks for every {frames}. frame, which is no multiple of `annotation.every_n_frames` ({boxes}): there are \
             no boxes between"
        )
    };
    let (bev, tracks) = (&settings.bev, &settings.tracks);
    if bev.enabled && bev.rule == BevRule::Simbev2x && !bev.every_n_frames.is_multiple_of(boxes) {
        root.fault_at("bev", problem("bev.every_n_frames", bev.every_n_frames));
    }
    for (key, frames) in [("tracks.step_s", tracks.step_frames()), ("tracks.every_s", tracks.every_frames())]
    {
        if tracks.windows && !frames.is_multiple_of(boxes) {
            root.fault_at_any(&["tracks", "annotation"], problem(key, frames));
        }
    }
}
impl DatasetSettings {
    /// The published settings for some scenes.
    #[must_use]
    pub fn with_scenes(scenes: Vec<SceneCount>) -> Self {
        Self { scenes, ..Self::default() }
    }

    /// The settings of a group's scenes: those of the dataset with what the group has of its own. The empty
    /// name stands for scenes of no group. None where there is no such group.
    #[must_use]
    pub fn of_group(&self, name: &str) -> Option<Self> {
        let scenario = if name.is_empty() { &self.scenario } else { &self.group(name)?.scenario };
        Some(Self { scenario: scenario.clone(), groups: Vec::new(), ..self.clone() })
    }

    /// A group by its name.
    #[must_use]
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }
}
