//! Statistics of parts of the scenes, for the report's filters.

use std::collections::{BTreeMap, BTreeSet};

use schema::scene_info::SceneInfo;

use crate::compute::{DatasetFacts, compute_tables};
use crate::figures::{Figure, draw_figures};
use crate::table::{Section, Tables};
use crate::totals::MeasureTotals;

/// Some of the scenes, and the statistics of them alone.
#[derive(Clone, Debug)]
pub struct Group {
    /// Which scenes, in order.
    pub scenes: Vec<u32>,
    /// Their tables, but those beside the published dataset.
    pub tables: Tables,
    /// Their figures.
    pub figures: Vec<Figure>,
}

/// Split, map and kind of a scene.
type Place = [String; 3];
/// What a reader chose of each: none, all.
type Choice<'a> = [Option<&'a str>; 3];

/// Scenes and counts, apart by split, map and kind.
#[derive(Clone, Debug, Default)]
pub struct GroupTotals {
    parts: BTreeMap<Place, (Vec<SceneInfo>, MeasureTotals)>,
}

impl GroupTotals {
    /// Adds a scene of a kind (empty: there is but one) and what was counted of it.
    pub fn add(&mut self, scene: &SceneInfo, kind: &str, counts: &MeasureTotals) {
        let place = [scene.split.clone(), scene.map.clone(), kind.to_owned()];
        let (scenes, totals) = self.parts.entry(place).or_default();
        scenes.push(scene.clone());
        totals.merge(counts);
    }

    /// What readers can choose: each split, then each map, then each kind, then what two of these leave. What
    /// has no scenes, all of them, or the same ones as an earlier choice is left out. Each is computed when
    /// it is asked for.
    pub fn groups<'a>(&'a self, facts: &'a DatasetFacts) -> impl Iterator<Item = Group> + 'a {
        let values = |of: usize| -> Vec<Option<&str>> {
            let values: BTreeSet<&str> = self.parts.keys().map(|place| place[of].as_str()).collect();
            values.into_iter().map(Some).collect()
        };
        let [splits, maps, kinds] = [0, 1, 2].map(values);
        let none = [None];
        let mut choices: Vec<Choice<'_>> = Vec::new();
        let combinations: [[&[Option<&str>]; 3]; 6] = [
            [&splits, &none, &none],
            [&none, &maps, &none],
            [&none, &none, &kinds],
            [&splits, &maps, &none],
            [&splits, &none, &kinds],
            [&none, &maps, &kinds],
        ];
        for [splits, maps, kinds] in combinations {
            for split in splits {
                for map in maps {
                    choices.extend(kinds.iter().map(|kind| [*split, *map, *kind]));
                }
            }
        }
        let mut seen = BTreeSet::from([Vec::new(), self.scenes([None; 3])]);
        choices.retain(|choice| seen.insert(self.scenes(*choice)));
        choices.into_iter().map(|choice| self.group(facts, choice))
    }

    fn parts_of<'a>(
        &'a self,
        choice: Choice<'a>,
    ) -> impl Iterator<Item = &'a (Vec<SceneInfo>, MeasureTotals)> {
        let is_wanted = move |place: &Place| {
            choice.iter().zip(place).all(|(wanted, value)| wanted.is_none_or(|wanted| wanted == value))
        };
        self.parts.iter().filter(move |(place, _)| is_wanted(place)).map(|(_, part)| part)
    }

    fn scenes(&self, choice: Choice<'_>) -> Vec<u32> {
        let scenes = self.parts_of(choice).flat_map(|(scenes, _)| scenes);
        let mut scenes: Vec<u32> = scenes.map(|scene| scene.scene).collect();
        scenes.sort_unstable();
        scenes
    }

    fn group(&self, facts: &DatasetFacts, choice: Choice<'_>) -> Group {
        let (mut scenes, mut counts) = (Vec::new(), MeasureTotals::default());
        for (infos, totals) in self.parts_of(choice) {
            scenes.extend(infos.iter().cloned());
            counts.merge(totals);
        }
        // Of a part nothing is missing: how much of the plan is done is said of the whole.
        let facts = DatasetFacts { planned_scenes: scenes.len() as u64, ..facts.clone() };
        let mut tables = compute_tables(&facts, &scenes, &counts);
        tables.tables.retain(|table| table.section != Section::Published);
        Group { scenes: self.scenes(choice), figures: draw_figures(&tables), tables }
    }
}

#[cfg(test)]
mod tests {
    use schema::measures::tracks::BOXES;
    use schema::tables::PartialRow;

    use super::*;

    fn scene(scene: u32, split: &str, map: &str) -> SceneInfo {
        SceneInfo { scene, split: split.into(), map: map.into(), frames: 20, ..SceneInfo::default() }
    }

    /// Tables of each choice: its scenes, and its number of boxes.
    fn chosen(scenes: &[SceneInfo]) -> Vec<(Vec<u32>, u64)> {
        let facts = DatasetFacts {
            name: "demo".into(),
            planned_scenes: 99,
            bev_cells: 400,
            bev_cell_m: 0.4,
            ..DatasetFacts::default()
        };
        let mut totals = GroupTotals::default();
        for scene in scenes {
            let row = PartialRow {
                measure: BOXES.into(),
                class: "car".into(),
                count: 10_u64.pow(scene.scene),
                ..PartialRow::default()
            };
            let mut counts = MeasureTotals::default();
            counts.add(&[row]);
            totals.add(scene, if scene.scene == 9 { "night" } else { "" }, &counts);
        }
        let boxes = |group: &Group| {
            group.tables.get("boxes_per_class").and_then(|t| t.counts("all").last().copied()).unwrap_or(0)
        };
        totals.groups(&facts).map(|group| (group.scenes.clone(), boxes(&group))).collect()
    }

    #[test]
    fn each_choice_has_its_own_scenes_and_no_two_the_same() {
        let scenes =
            [scene(0, "train", "A"), scene(1, "train", "B"), scene(2, "val", "A"), scene(3, "val", "A")];
        assert_eq!(
            chosen(&scenes),
            [
                (vec![0, 1], 11),
                (vec![2, 3], 1100),
                (vec![0, 2, 3], 1101),
                // B is of one split only: the same scenes as of both.
                (vec![1], 10),
                (vec![0], 1),
            ]
        );
        assert_eq!(chosen(&[scene(0, "train", "A"), scene(1, "train", "A")]), [], "there is no choice");
        // A scene of another kind.
        assert_eq!(
            chosen(&[scene(0, "train", "A"), scene(9, "train", "A")]),
            [(vec![0], 1), (vec![9], 1_000_000_000)]
        );
        assert_eq!(chosen(&[]), []);
    }
}
