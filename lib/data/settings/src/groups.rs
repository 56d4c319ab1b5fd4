//! Groups of scenes: a dataset of unlike scenes in one configuration.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::key::{Name, Settings, settings};
use crate::reader::{Section, describe};
use crate::scenario::Scenario;
use crate::scenes::{self, SceneCount};

/// Scenes of one kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Group {
    /// Name of the group.
    pub name: String,
    /// How many of its scenes on which map, in split order.
    pub scenes: Vec<SceneCount>,
    /// What its scenes have, whole: what the group does not say is that of the top.
    #[serde(flatten)]
    pub scenario: Scenario,
}

settings! {
    /// The keys of a group that are no scenario.
    struct Own {
        /// Name of the group: letters, digits, `_` and `-`. Besides `name` and `scenes` a group may have the
        /// tables `agents`, `timing`, `traffic`, `walkers`, `weather`, `lights`, `hazards`, `vehicle`, `rsu`
        /// and `rigs`, with the keys that they have at the top.
        name: String = String::new();
        /// How many of its scenes on which map; those at the top are scenes of no group.
        scenes: Vec<SceneCount> = Vec::new(), by(scenes::counts);
    }
}

/// The groups: what stands in the table of one goes before what stands at the top.
pub(crate) fn read(root: &Section<'_>, name: &Name, _: Vec<Group>) -> Vec<Group> {
    let list = root.sections(name.key, name.absent, name.doc);
    Own::read(&root.describe_item(name.key), &Own::default());
    let mut names = BTreeSet::new();
    let read = |item| of_item(root, item, &mut names);
    list.unwrap_or_default().into_iter().map(read).collect()
}

fn of_item<'a>(root: &Section<'a>, item: Section<'a>, names: &mut BTreeSet<String>) -> Group {
    let Own { name, scenes } = Own::read(&item, &Own::default());
    let path = item.path_of("name");
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if name.is_empty() || !name.chars().all(is_plain) {
        item.fault_at("name", format!("`{path}` is \"{name}\", expected letters, digits, _ and -"));
    } else if !names.insert(name.clone()) {
        item.fault_at("name", format!("`{path}`: another group is named \"{name}\", too"));
    }
    let item = item.over(root);
    let scenario = Scenario::read(&item, &Scenario::default());
    for key in item.take_keys_of(root) {
        let path = item.path_of(&key);
        item.fault_at(&key, format!("`{path}`: groups have no `{key}` of their own, it stands at the top"));
    }
    Group { name, scenes, scenario }
}

/// Names of the tables that a group may have.
pub(crate) fn scenario_keys() -> Vec<String> {
    let keys = describe(|section| Scenario::read(section, &Scenario::default()));
    keys.into_iter().map(|key| key.path).filter(|path| !path.contains('.')).collect()
}
