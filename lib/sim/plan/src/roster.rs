//! Which scene has which number: existing scenes keep theirs, added ones follow.

use std::collections::{BTreeMap, BTreeSet};

use random::Stream;
use serde::{Deserialize, Serialize};
use settings::Split;
use settings::stages::PlanSettings;

use crate::PlanError;

/// Most scenes of a dataset.
const MAX_SCENES: u32 = 1_000_000;

/// Number, split, map, edition and group of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneSlot {
    /// Scene number.
    pub scene: u32,
    /// Its split.
    pub split: Split,
    /// Map name.
    pub map: String,
    /// How often it was asked to be drawn anew; 0: the first draw.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub draw: u32,
    /// Which edition of the configuration it is made by.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub edition: u32,
    /// Its group; empty: it is of no group.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub group: String,
}

fn is_zero(number: &u32) -> bool {
    *number == 0
}

impl SceneSlot {
    /// Seed of the scene's plan: the dataset's for a first draw, another one for each later draw.
    #[must_use]
    pub fn seed(&self, dataset_seed: u64) -> u64 {
        match self.draw {
            0 => dataset_seed,
            draw => {
                let mut stream =
                    Stream::new(dataset_seed, u64::from(self.scene), "plan/redraw", u64::from(draw));
                u64::from(stream.next_u32())
            }
        }
    }
}

/// The scenes of a dataset by number, and what is odd about them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Roster {
    /// Ascending by number; numbers may be missing.
    pub slots: Vec<SceneSlot>,
    /// Where wishes and existing scenes disagree.
    pub warnings: Vec<String>,
}

/// A wish for scenes: group, split, map and how many.
type Wish<'a> = (&'a str, Split, &'a str, u32);

/// Gives every wished-for scene a number. `existing` are the slots of an earlier roster and `is_made` says
/// whether anything was made of one of them; it is asked where there are more than are wished for.
///
/// Existing scenes of any edition count against the wish for their group, split and map and keep their
/// numbers and editions. What is missing is of the newest edition and numbered from one past the highest:
/// train, val, test, and within each those of no group, then group by group, in the order of the settings.
/// Scenes beyond the wish stay when something was made of them and are forgotten otherwise; a scene is never
/// given another number, edition, group, split or map. [`PlanSettings::redraw`] says which scenes are drawn
/// anew.
///
/// # Errors
/// When they are too many to number.
pub fn enrol(
    settings: &PlanSettings,
    existing: &[SceneSlot],
    is_made: &dyn Fn(u32) -> bool,
) -> Result<Roster, PlanError> {
    let mut roster = Roster::default();
    let mut of: BTreeMap<(Split, &str, &str), Vec<&SceneSlot>> = BTreeMap::new();
    // A scene of an edition that is not there was planned by a run that was given up.
    for slot in existing.iter().filter(|slot| settings.of_group(slot.edition, &slot.group).is_some()) {
        of.entry((slot.split, &slot.group, &slot.map)).or_default().push(slot);
    }
    let mut missing: Vec<Wish<'_>> = Vec::new();
    for (group, split, map, wanted) in wishes(settings) {
        let mut here = of.remove(&(split, group, map)).unwrap_or_default();
        // A scene that was made is kept rather than one that is only planned, and the newest edition's first.
        if here.len() > wanted as usize {
            here.sort_by_key(|slot| (!is_made(slot.scene), slot.edition != settings.edition(), slot.scene));
        }
        let surplus = here.split_off(here.len().min(wanted as usize));
        missing.push((group, split, map, wanted - here.len() as u32));
        roster.slots.extend(here.into_iter().cloned());
        roster.keep_made(&surplus, settings.edition(), is_made);
    }
    for surplus in of.into_values() {
        roster.keep_made(&surplus, settings.edition(), is_made);
    }
    let next = roster.slots.iter().map(|slot| slot.scene + 1).max().unwrap_or(0);
    let mut next = next.max(settings.first_scene);
    for (group, split, map, count) in missing {
        if count > MAX_SCENES - next.min(MAX_SCENES) {
            return Err(PlanError::TooManyScenes { limit: MAX_SCENES });
        }
        let numbers = next..next + count;
        next = numbers.end;
        let slot = |scene| SceneSlot {
            scene,
            split,
            map: map.to_owned(),
            draw: 0,
            edition: settings.edition(),
            group: group.to_owned(),
        };
        roster.slots.extend(numbers.map(slot));
    }
    roster.slots.sort_by_key(|slot| slot.scene);
    for slot in &mut roster.slots {
        slot.draw = 0;
    }
    for &(scene, draw) in &settings.redraw {
        match roster.slots.iter_mut().find(|slot| slot.scene == scene) {
            Some(slot) => slot.draw = draw,
            None => roster.warnings.push(format!("scenes.redraw: there is no scene {scene}")),
        }
    }
    Ok(roster)
}

/// Scenes wanted of each group, split and map, in numbering order, each combination once.
fn wishes(settings: &PlanSettings) -> Vec<Wish<'_>> {
    let groups = settings.groups.iter().map(|(name, of_group)| (name.as_str(), of_group));
    let groups: Vec<(&str, &PlanSettings)> = std::iter::once(("", settings)).chain(groups).collect();
    let mut wishes: Vec<Wish<'_>> = Vec::new();
    for split in Split::ALL {
        for (group, settings) in &groups {
            let mut seen = BTreeSet::new();
            let of_split = || settings.scenes.iter().filter(|w| w.split == split);
            for wish in of_split().filter(|w| seen.insert(&w.map)) {
                let total = of_split().filter(|w| w.map == wish.map).map(|w| w.count);
                wishes.push((group, split, &wish.map, total.fold(0, u32::saturating_add)));
            }
        }
    }
    wishes
}

impl Roster {
    fn keep_made(&mut self, surplus: &[&SceneSlot], newest: u32, is_made: &dyn Fn(u32) -> bool) {
        let kept: Vec<SceneSlot> =
            surplus.iter().filter(|s| is_made(s.scene)).map(|s| (*s).clone()).collect();
        // Older editions have the scenes that they have.
        let told: Vec<&SceneSlot> = kept.iter().filter(|slot| slot.edition == newest).collect();
        if let Some(first) = told.first() {
            let numbers: Vec<String> = told.iter().map(|s| s.scene.to_string()).collect();
            self.warnings.push(format!(
                "{}{} on {}: the configuration no longer asks for scenes {}; what was made is never removed, so they \
                 stay (to be rid of them, make the dataset in another store)",
                if first.group.is_empty() { String::new() } else { format!("group {}, ", first.group) },
                first.split.name(),
                first.map,
                numbers.join(", ")
            ));
        }
        self.slots.extend(kept);
    }
}

/// The scenes of a new dataset, numbered from 0.
///
/// # Errors
/// When they are too many to number.
pub fn scene_slots(settings: &PlanSettings) -> Result<Vec<SceneSlot>, PlanError> {
    Ok(enrol(settings, &[], &|_| false)?.slots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use settings::SceneCount;

    fn settings(wishes: &[(Split, &str, u32)]) -> PlanSettings {
        let count = |&(split, map, count): &(Split, &str, u32)| SceneCount { split, map: map.into(), count };
        PlanSettings::with_scenes(wishes.iter().map(count).collect())
    }

    fn short(slots: &[SceneSlot]) -> Vec<(u32, &'static str, &str, u32)> {
        slots.iter().map(|s| (s.scene, s.split.name(), s.map.as_str(), s.draw)).collect()
    }

    const TRAIN: Split = Split::Train;
    const VAL: Split = Split::Val;

    #[test]
    fn additions_follow_the_highest_number() {
        let first = scene_slots(&settings(&[(TRAIN, "a", 2), (VAL, "a", 1)])).expect("few");
        assert_eq!(short(&first), [(0, "train", "a", 0), (1, "train", "a", 0), (2, "val", "a", 0)]);
        let wider = settings(&[(TRAIN, "b", 1), (TRAIN, "a", 3), (VAL, "a", 1)]);
        let second = enrol(&wider, &first, &|_| false).expect("few");
        assert_eq!(short(&second.slots[..3]), short(&first));
        assert_eq!(short(&second.slots[3..]), [(3, "train", "b", 0), (4, "train", "a", 0)]);
        // With a hole in the numbers: one past the highest, not their count.
        let holed: Vec<SceneSlot> = second.slots.iter().filter(|s| s.scene != 1).cloned().collect();
        let third = enrol(&wider, &holed, &|_| false).expect("few");
        assert_eq!(short(&third.slots).last(), Some(&(5, "train", "a", 0)));
        assert_eq!(third.slots.len(), 5);
        assert_eq!(enrol(&wider, &third.slots, &|_| false).expect("few"), third);
    }

    #[test]
    fn what_was_made_stays_and_what_was_only_planned_goes() {
        let four = scene_slots(&settings(&[(TRAIN, "a", 3), (TRAIN, "b", 1)])).expect("few");
        let less = settings(&[(TRAIN, "a", 1)]);
        let made = |made: &'static [u32]| enrol(&less, &four, &move |n| made.contains(&n)).expect("few");
        assert_eq!(short(&made(&[]).slots), [(0, "train", "a", 0)]);
        let last = made(&[2]);
        assert_eq!((short(&last.slots), last.warnings.len()), (vec![(2, "train", "a", 0)], 0));
        let all = made(&[0, 1, 2, 3]);
        assert_eq!(all.slots, four);
        assert_eq!(all.warnings.len(), 2);
        assert!(all.warnings[0].contains("train on a") && all.warnings[0].contains("1, 2;"), "{all:?}");
        assert!(all.warnings[1].contains("train on b"), "{all:?}");
    }

    #[test]
    fn redrawing_changes_one_seed() {
        let mut wish = settings(&[(TRAIN, "a", 3)]);
        let first = scene_slots(&wish).expect("few");
        wish.redraw = vec![(1, 2), (9, 1)];
        let again = enrol(&wish, &first, &|_| true).expect("few");
        assert_eq!(again.warnings, ["scenes.redraw: there is no scene 9"]);
        let seeds: Vec<u64> = again.slots.iter().map(|s| s.seed(27)).collect();
        assert!(seeds[0] == 27 && seeds[2] == 27 && seeds[1] != 27);
        assert_ne!(SceneSlot { draw: 3, ..again.slots[1].clone() }.seed(27), seeds[1]);
        // Taking the wish back gives the first scene again.
        wish.redraw.clear();
        assert_eq!(enrol(&wish, &again.slots, &|_| true).expect("few").slots, first);
    }

    #[test]
    fn editions_and_groups_keep_their_scenes() {
        let first = scene_slots(&settings(&[(TRAIN, "a", 2)])).expect("few");
        let mut grown = settings(&[(TRAIN, "a", 3)]);
        grown.older = vec![settings(&[(TRAIN, "a", 2)])];
        grown.groups = vec![("night".into(), settings(&[(TRAIN, "a", 1), (VAL, "b", 1)]))];
        let slots = enrol(&grown, &first, &|_| true).expect("few").slots;
        let kinds: Vec<_> =
            slots.iter().map(|s| (s.scene, s.split.name(), s.edition, s.group.as_str())).collect();
        let expected = [
            (0, "train", 0, ""),
            (1, "train", 0, ""),
            (2, "train", 1, ""),
            (3, "train", 1, "night"),
            (4, "val", 1, "night"),
        ];
        assert_eq!(kinds, expected);
        // Fewer are asked for: those of older editions stay without a word.
        let less = PlanSettings { scenes: settings(&[(TRAIN, "a", 1)]).scenes, ..grown.clone() };
        let kept = enrol(&less, &slots, &|_| true).expect("few");
        assert_eq!((kept.slots, kept.warnings), (slots.clone(), Vec::<String>::new()));
        let none = PlanSettings { groups: Vec::new(), ..grown };
        let kept = enrol(&none, &slots, &|scene| scene < 3).expect("few");
        assert_eq!(kept.slots, slots[..3], "scenes of a group that is gone, of which nothing is made");
    }

    #[test]
    fn numbers_begin_where_they_are_told() {
        let apart = PlanSettings { first_scene: 100, ..settings(&[(TRAIN, "a", 2)]) };
        let slots = scene_slots(&apart).expect("few");
        assert_eq!(slots.iter().map(|slot| slot.scene).collect::<Vec<_>>(), [100, 101]);
        let more = PlanSettings { first_scene: 7, ..settings(&[(TRAIN, "a", 3)]) };
        let slots = enrol(&more, &slots, &|_| true).expect("few").slots;
        assert_eq!(slots.iter().map(|slot| slot.scene).collect::<Vec<_>>(), [100, 101, 102]);
    }

    #[test]
    fn too_many_scenes_are_refused() {
        let wishes = settings(&[(TRAIN, "a", u32::MAX), (TRAIN, "a", 5), (VAL, "a", 1)]);
        assert!(matches!(scene_slots(&wishes), Err(PlanError::TooManyScenes { .. })));
        let high = SceneSlot {
            scene: MAX_SCENES + 7,
            split: TRAIN,
            map: "a".into(),
            draw: 0,
            edition: 0,
            group: String::new(),
        };
        assert!(enrol(&settings(&[(TRAIN, "a", 2)]), &[high], &|_| true).is_err());
    }
}
