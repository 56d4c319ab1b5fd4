//! The configurations that the scenes of a store are made by.
//!
//! A store remembers every configuration that it was made with, numbered from 0: its editions. The roster
//! says which edition and which group each scene belongs to, and a stage sees that edition's settings of that
//! group. The newest edition says which scenes there are. A store of one edition works as if there were no
//! such thing.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;
use settings::{DatasetSettings, KeyChange, key_changes};
use store::{SceneKind, Scope, Store, StoreError, keys};

/// What a configuration says besides how scenes are made: how many there are, and words.
const NO_RULES: [&str; 5] = ["name", "card", "scenes", "first_scene", "redraw"];

/// What the given configuration is meant to be for a store.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EditionWish {
    /// The edition that it equals, else the newest one, changed.
    #[default]
    Known,
    /// The edition that it equals, else one more: planned scenes keep theirs.
    Grown,
    /// This edition, changed.
    Of(u32),
}

/// Why a configuration cannot be an edition of a store.
#[derive(Debug, thiserror::Error)]
pub enum EditionError {
    /// There is no such edition.
    #[error("--edition {wanted}: the store's editions are 0 to {last}")]
    NoSuch {
        /// The wish.
        wanted: u32,
        /// The newest edition.
        last: usize,
    },
    /// The record of an edition is not one of this release.
    #[error(
        "{place}: edition {number} was recorded by another release and cannot be read ({problem}); put its configuration in \
         place of it: --edition {number} with the file that it was made from"
    )]
    Unreadable {
        /// The record.
        place: String,
        /// Number of the edition.
        number: usize,
        /// What is wrong.
        problem: String,
    },
    /// Something was made of scenes of a group that the configuration lacks.
    #[error(
        "scene {scene} is of group `{group}`, which the configuration no longer has: keep the group's table (with no scenes in \
         it: no more are made), or add this configuration to the store with --grow"
    )]
    NoGroup {
        /// The first such scene.
        scene: u32,
        /// Its group.
        group: String,
    },
    /// Editions differ in what all scenes of a dataset share.
    #[error("`{key}` is {old} in edition {number} and {new} in edition {given}: all editions share it")]
    NotShared {
        /// The key.
        key: &'static str,
        /// Its values.
        old: String,
        /// In the given edition.
        new: String,
        /// The other edition.
        number: usize,
        /// The given edition.
        given: usize,
    },
    /// No configuration is recorded.
    #[error("{place}: has no configuration that the store was planned by: give --config FILE")]
    NotRecorded {
        /// The record.
        place: String,
    },
    /// The store cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The configurations that the scenes of a store are made by.
#[derive(Clone, Debug)]
pub struct Editions {
    /// By number.
    list: Vec<DatasetSettings>,
    /// The number of the given configuration.
    given: usize,
    /// As the store has them, by number; fewer than there are now where one is added.
    recorded: Vec<Value>,
    of_scene: BTreeMap<u32, SceneKind>,
    settings: BTreeMap<SceneKind, DatasetSettings>,
}

impl Editions {
    /// One configuration for all scenes of no group.
    #[must_use]
    pub fn only(settings: &DatasetSettings) -> Self {
        let mut editions = Self {
            list: vec![settings.clone()],
            given: 0,
            recorded: Vec::new(),
            of_scene: BTreeMap::new(),
            settings: BTreeMap::new(),
        };
        editions.resolve();
        editions
    }

    /// The editions of a store, with a given configuration in its place among them.
    ///
    /// # Errors
    /// The store cannot be read, or the configuration cannot stand there.
    pub fn of_store(store: &Store, given: &DatasetSettings, wish: EditionWish) -> Result<Self, EditionError> {
        let mut editions = Self { recorded: recorded(store)?, ..Self::only(given) };
        editions.take_place(store, given, wish)?;
        editions.check_shared()?;
        editions.resolve();
        editions.enrol(store)?;
        Ok(editions)
    }

    fn take_place(
        &mut self,
        store: &Store,
        given: &DatasetSettings,
        wish: EditionWish,
    ) -> Result<(), EditionError> {
        let count = self.recorded.len();
        if let EditionWish::Of(wanted) = wish
            && wanted as usize >= count
        {
            return Err(EditionError::NoSuch { wanted, last: count.saturating_sub(1) });
        }
        // The usual store needs nobody to read what it was made with.
        if count == 0 || (count == 1 && wish != EditionWish::Grown) {
            return Ok(());
        }
        let mut list: Vec<Option<DatasetSettings>> = Vec::new();
        let mut problems = BTreeMap::new();
        for (number, record) in self.recorded.iter().enumerate() {
            let read = read_back(record);
            problems.extend(read.as_ref().err().map(|problem| (number, problem.clone())));
            list.push(read.ok());
        }
        let rules = rules_of(given);
        let is_given = |known: &Option<DatasetSettings>| known.as_ref().is_some_and(|k| rules_of(k) == rules);
        let position = match wish {
            EditionWish::Of(wanted) => wanted as usize,
            _ => match (list.iter().rposition(is_given), wish) {
                (Some(position), _) => position,
                (None, EditionWish::Grown) => count,
                (None, _) => count - 1,
            },
        };
        list.resize(list.len().max(position + 1), None);
        list[position] = Some(given.clone());
        let whole = list.into_iter().enumerate().map(|(number, known)| {
            let problem = problems.get(&number).cloned().unwrap_or_default();
            let place = store.location(keys::DATASET);
            known.ok_or(EditionError::Unreadable { place, number, problem })
        });
        self.list = whole.collect::<Result<_, _>>()?;
        self.given = position;
        Ok(())
    }

    /// What readers take to be the same all over a dataset.
    fn check_shared(&self) -> Result<(), EditionError> {
        let given = self.given();
        for (number, other) in self.list.iter().enumerate() {
            let shared = [
                ("models.packs", format!("{:?}", other.models.packs), format!("{:?}", given.models.packs)),
                ("bev.classes", format!("{:?}", other.bev.classes), format!("{:?}", given.bev.classes)),
            ];
            for (key, old, new) in shared {
                if old != new {
                    return Err(EditionError::NotShared { key, old, new, number, given: self.given });
                }
            }
        }
        Ok(())
    }

    fn resolve(&mut self) {
        for (number, edition) in self.list.iter().enumerate() {
            let names = edition.groups.iter().map(|group| group.name.as_str()).chain([""]);
            let kind = |group: &str| SceneKind { edition: number as u32, group: group.to_owned() };
            let of_group = |name: &str| Some((kind(name), edition.of_group(name)?));
            self.settings.extend(names.filter_map(of_group));
        }
    }

    /// Reads which scene is of which edition and group.
    fn enrol(&mut self, store: &Store) -> Result<(), EditionError> {
        self.of_scene = store::scene_kinds(store)?;
        let unknown = self.of_scene.iter().filter(|(_, kind)| !self.settings.contains_key(kind));
        let unknown: Vec<u32> = unknown.map(|(scene, _)| *scene).collect();
        if unknown.is_empty() {
            return Ok(());
        }
        // Of what was only planned nothing is lost.
        let begun = store::scenes_begun(store)?;
        for scene in unknown {
            if let Some(kind) = self.of_scene.remove(&scene)
                && begun.contains(&scene)
            {
                return Err(EditionError::NoGroup { scene, group: kind.group });
            }
        }
        Ok(())
    }

    /// The same with scenes as they would be planned: each with its kind.
    #[must_use]
    pub fn with_scenes(&self, of_scene: BTreeMap<u32, SceneKind>) -> Self {
        Self { of_scene, ..self.clone() }
    }

    /// The edition that says which scenes there are.
    #[must_use]
    pub fn newest(&self) -> &DatasetSettings {
        // There is always one.
        &self.list[self.list.len() - 1]
    }

    /// The given configuration.
    #[must_use]
    pub fn given(&self) -> &DatasetSettings {
        &self.list[self.given]
    }

    /// All editions, by number.
    #[must_use]
    pub fn all(&self) -> &[DatasetSettings] {
        &self.list
    }

    /// Whether the given configuration is an edition that the store does not have yet.
    #[must_use]
    pub fn is_grown(&self) -> bool {
        !self.recorded.is_empty() && self.given >= self.recorded.len()
    }

    /// The kind of a scene; where the roster has no such scene, the newest edition and no group.
    #[must_use]
    pub fn kind_of(&self, scene: u32) -> SceneKind {
        let newest = || SceneKind { edition: (self.list.len() - 1) as u32, group: String::new() };
        self.of_scene.get(&scene).cloned().unwrap_or_else(newest)
    }

    /// Settings of a scene: those of its group in its edition. Of other scopes: the newest edition.
    #[must_use]
    pub fn of(&self, scope: Scope) -> &DatasetSettings {
        let Scope::Scene(scene) = scope else { return self.newest() };
        self.settings.get(&self.kind_of(scene)).unwrap_or_else(|| self.newest())
    }

    /// The keys of a scope's settings (of a scene: those of its group in its edition) that have other values
    /// than the store's record has; none where there is no record.
    pub(crate) fn changes_of(&self, scope: Scope) -> Option<Vec<KeyChange>> {
        let newest = || SceneKind { edition: (self.list.len() - 1) as u32, group: String::new() };
        let kind = if let Scope::Scene(scene) = scope { self.kind_of(scene) } else { newest() };
        let old = self.recorded.get(kind.edition as usize)?;
        let new = written(self.list.get(kind.edition as usize)?);
        match scope {
            Scope::Scene(_) => {
                Some(key_changes(&record_of_group(old, &kind.group), &record_of_group(&new, &kind.group)))
            }
            _ => Some(key_changes(old, &new)),
        }
    }

    /// The keys that have other values than the store's record has, and whether there are any (or there is no
    /// record). An added edition changes nothing.
    #[must_use]
    pub fn changes(&self) -> (Vec<KeyChange>, bool) {
        let changes = self.recorded.iter().zip(&self.list).enumerate().flat_map(|(number, (old, new))| {
            let changes = key_changes(old, &written(new));
            let prefix = if self.list.len() > 1 { format!("edition {number}: ") } else { String::new() };
            changes.into_iter().map(move |c| KeyChange { key: format!("{prefix}{}", c.key), ..c })
        });
        let changes: Vec<KeyChange> = changes.collect();
        let differs = self.recorded.is_empty() || !changes.is_empty();
        (changes, differs)
    }
}

/// The editions as `dataset.json` has them, by number: none where there is no such record.
///
/// # Errors
/// The store cannot be read.
pub fn recorded(store: &Store) -> Result<Vec<Value>, StoreError> {
    let dataset: Option<Value> = match store.read_json(keys::DATASET) {
        Err(StoreError::Corrupt { .. }) => None,
        other => other?,
    };
    let Some(mut dataset) = dataset else { return Ok(Vec::new()) };
    let config = dataset.get_mut("config").map(Value::take).filter(Value::is_object);
    Ok(match dataset.get_mut("editions").map(Value::take) {
        Some(Value::Array(editions)) if !editions.is_empty() => editions,
        _ => config.into_iter().collect(),
    })
}

/// The newest configuration that a store was planned by.
///
/// # Errors
/// The store cannot be read, has no configuration, or one of another release.
pub fn newest_recorded(store: &Store) -> Result<DatasetSettings, EditionError> {
    let place = store.location(keys::DATASET);
    let recorded = recorded(store)?;
    let Some(newest) = recorded.last() else { return Err(EditionError::NotRecorded { place }) };
    let number = recorded.len() - 1;
    read_back(newest).map_err(|problem| EditionError::Unreadable { place, number, problem })
}

/// A configuration as a record has it.
fn written(settings: &DatasetSettings) -> Value {
    // What is written here has been read from a file: it can be written.
    serde_json::to_value(settings).unwrap_or_default()
}

/// A configuration from its record, or why it is none of this release: all keys of the record must be known.
/// Keys that were added since have their defaults.
fn read_back(record: &Value) -> Result<DatasetSettings, String> {
    let settings = DatasetSettings::deserialize(record).map_err(|error| error.to_string())?;
    let lost = key_changes(record, &written(&settings)).into_iter().find(|change| change.old.is_some());
    match lost {
        Some(change) => Err(change.to_string()),
        None => Ok(settings),
    }
}

/// What a configuration says of how scenes are made.
fn rules_of(settings: &DatasetSettings) -> Value {
    rules_of_record(&written(settings))
}

/// The record of a configuration as it holds for a group: what its table says goes before what stands at the
/// top. The empty name stands for scenes of no group.
#[must_use]
pub fn record_of_group(record: &Value, group: &str) -> Value {
    let mut record = record.clone();
    if let Some(record) = record.as_object_mut()
        && let Some(Value::Array(groups)) = record.remove("groups")
        && let Some(Value::Object(own)) = groups.into_iter().find(|table| table["name"] == group)
    {
        let besides = ["name", "scenes"];
        record.extend(own.into_iter().filter(|(key, _)| !besides.contains(&key.as_str())));
    }
    record
}

/// What the record of a configuration says of how scenes are made: all but names, words and counts.
#[must_use]
pub fn rules_of_record(record: &Value) -> Value {
    let mut rules = record.clone();
    let clear = |table: &mut Value, names: &[&str]| {
        if let Some(table) = table.as_object_mut() {
            names.iter().for_each(|name| drop(table.remove(*name)));
        }
    };
    clear(&mut rules, &NO_RULES);
    if let Some(groups) = rules.get_mut("groups").and_then(Value::as_array_mut) {
        groups.iter_mut().for_each(|group| clear(group, &["scenes"]));
    }
    rules
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::views::example_settings;

    /// A store that was made by some configurations, with scenes of some kinds.
    fn store_of(editions: &[Value], scenes: &[(u32, u32, &str)]) -> Store {
        let store = Store::open("memory:").expect("opens");
        let dataset = match editions {
            [] => json!({"format_version": schema::FORMAT_VERSION}),
            [only] => json!({"format_version": schema::FORMAT_VERSION, "config": only}),
            [.., newest] => {
                json!({"format_version": schema::FORMAT_VERSION, "config": newest, "editions": editions})
            }
        };
        store.write_json(keys::DATASET, "spawn-planner", &dataset).expect("is written");
        let slot = |(scene, edition, group): &(u32, u32, &str)| json!({"scene": scene, "edition": edition, "group": group});
        let roster: Vec<Value> = scenes.iter().map(slot).collect();
        store.write_json(keys::ROSTER, "spawn-planner", &roster).expect("is written");
        store
    }

    fn with_vehicles(vehicles: u32) -> DatasetSettings {
        let mut settings = example_settings();
        settings.scenario.traffic.vehicles = Some(vehicles);
        settings
    }

    fn vehicles(editions: &Editions) -> Vec<Option<u32>> {
        editions.all().iter().map(|edition| edition.scenario.traffic.vehicles).collect()
    }

    #[test]
    fn a_configuration_takes_the_place_that_it_is_meant_for() {
        let [four, five, six] = [4, 5, 6].map(with_vehicles);
        let one = store_of(&[written(&four)], &[(0, 0, "")]);
        let two = store_of(&[written(&four), written(&five)], &[(0, 0, ""), (1, 1, "")]);
        let of = |store: &Store, given: &DatasetSettings, wish| {
            let editions = Editions::of_store(store, given, wish).expect("has a place");
            (vehicles(&editions), editions.given, editions.is_grown())
        };
        let (known, grown) = (EditionWish::Known, EditionWish::Grown);
        assert_eq!(of(&store_of(&[], &[]), &four, grown), (vec![Some(4)], 0, false));
        assert_eq!(of(&one, &five, known), (vec![Some(5)], 0, false));
        assert_eq!(of(&one, &five, grown), (vec![Some(4), Some(5)], 1, true));
        assert_eq!(of(&one, &four, grown), (vec![Some(4)], 0, false));
        assert_eq!(of(&two, &four, known), (vec![Some(4), Some(5)], 0, false));
        assert_eq!(of(&two, &six, known), (vec![Some(4), Some(6)], 1, false));
        assert_eq!(of(&two, &six, EditionWish::Of(0)), (vec![Some(6), Some(5)], 0, false));
        // Other counts make no other rules.
        let mut more = four.clone();
        more.scenes[0].count = 9;
        assert_eq!(of(&two, &more, known), (vec![Some(4), Some(5)], 0, false));
        let none = Editions::of_store(&two, &six, EditionWish::Of(2)).expect_err("there is none");
        assert_eq!(none.to_string(), "--edition 2: the store's editions are 0 to 1");
    }

    #[test]
    fn scenes_have_the_settings_of_their_kind() {
        let text = "[scenes.train]\n\"convoy/demo\" = 1\n[traffic]\nvehicles = 5\n[[groups]]\nname = \"empty\"\n[groups.traffic]\n\
                    vehicles = 0\n";
        let grouped = settings::parse(text, "x.toml").expect("is valid");
        let kinds = [(0, 0, ""), (1, 1, ""), (2, 1, "empty")];
        let store = store_of(&[written(&with_vehicles(4)), written(&grouped)], &kinds);
        let editions = Editions::of_store(&store, &grouped, EditionWish::Known).expect("opens");
        let vehicles = |scene| editions.of(Scope::Scene(scene)).scenario.traffic.vehicles;
        assert_eq!([0, 1, 2, 3].map(vehicles), [Some(4), Some(5), Some(0), Some(5)]);
        assert_eq!(editions.of(Scope::Plan), editions.newest());

        // Without the group its scene is forgotten while nothing is made of it.
        let without = with_vehicles(5);
        let editions = Editions::of_store(&store, &without, EditionWish::Known).expect("opens");
        assert_eq!(editions.of(Scope::Scene(2)).scenario.traffic.vehicles, Some(5));
        store.write_json("scenes/0002/_manifests/bev-gt.json", "bev-gt", &1).expect("is written");
        let lost = Editions::of_store(&store, &without, EditionWish::Known).expect_err("is made");
        assert!(matches!(lost, EditionError::NoGroup { scene: 2, ref group } if group == "empty"), "{lost}");
    }

    #[test]
    fn records_of_other_releases_are_read_as_far_as_they_are_understood() {
        let mut older = written(&with_vehicles(4));
        older["traffic"].as_object_mut().expect("is a table").remove("door_open");
        assert_eq!(read_back(&older).expect("has a default"), with_vehicles(4));
        older["traffic"]["horses"] = json!(3);
        assert_eq!(read_back(&older).expect_err("is unknown"), "traffic.horses: 3 -> none");
        let store = store_of(&[older], &[(0, 0, "")]);
        let unread =
            Editions::of_store(&store, &with_vehicles(5), EditionWish::Grown).expect_err("is unknown");
        assert!(unread.to_string().contains("edition 0 was recorded by another release"), "{unread}");
        // The usual run does not care.
        assert!(Editions::of_store(&store, &with_vehicles(5), EditionWish::Known).is_ok());
    }

    #[test]
    fn what_all_scenes_share_is_the_same_in_all_editions() {
        let store = store_of(&[written(&with_vehicles(4))], &[(0, 0, "")]);
        let mut other = with_vehicles(5);
        other.models.packs = vec!["lorries".into()];
        let refused = Editions::of_store(&store, &other, EditionWish::Grown).expect_err("differs");
        let told = "`models.packs` is [] in edition 0 and [\"lorries\"] in edition 1: all editions share it";
        assert_eq!(refused.to_string(), told);
    }
}
