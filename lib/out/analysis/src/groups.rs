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

/// Scenes and counts, apart by split and map.
#[derive(Clone, Debug, Default)]
pub struct GroupTotals {
    parts: BTreeMap<(String, String), (Vec<SceneInfo>, MeasureTotals)>,
}

impl GroupTotals {
    /// Adds a scene and what was counted of it.
    pub fn add(&mut self, scene: &SceneInfo, counts: &MeasureTotals) {
        let (scenes, totals) = self.parts.entry((scene.split.clone(), scene.map.clone())).or_default();
        scenes.push(scene.clone());
        totals.merge(counts);
    }

    /// What readers can choose: each split, then each map, then each map of a split. What has no scenes, all
    /// of them, or the same ones as an earlier choice is left out. Each is computed when it is asked for.
    pub fn groups<'a>(&'a self, facts: &'a DatasetFacts) -> impl Iterator<Item = Group> + 'a {
        let splits: BTreeSet<&str> = self.parts.keys().map(|(split, _)| split.as_str()).collect();
        let maps: BTreeSet<&str> = self.parts.keys().map(|(_, map)| map.as_str()).collect();
        let pairs = splits.iter().flat_map(|split| maps.iter().map(|map| (Some(*split), Some(*map))));
        let mut choices: Vec<(Option<&str>, Option<&str>)> =
            splits.iter().map(|s| (Some(*s), None)).collect();
        choices.extend(maps.iter().map(|map| (None, Some(*map))));
        choices.extend(pairs);
        let mut seen = BTreeSet::from([Vec::new(), self.scenes((None, None))]);
        choices.retain(|choice| seen.insert(self.scenes(*choice)));
        choices.into_iter().map(|choice| self.group(facts, choice))
    }

    fn parts_of<'a>(
        &'a self,
        (split, map): (Option<&'a str>, Option<&'a str>),
    ) -> impl Iterator<Item = &'a (Vec<SceneInfo>, MeasureTotals)> {
        let is_wanted = move |(of, on): &(String, String)| {
            split.is_none_or(|split| split == of) && map.is_none_or(|map| map == on)
        };
        self.parts.iter().filter(move |(key, _)| is_wanted(key)).map(|(_, part)| part)
    }

    fn scenes(&self, choice: (Option<&str>, Option<&str>)) -> Vec<u32> {
        let scenes = self.parts_of(choice).flat_map(|(scenes, _)| scenes);
        let mut scenes: Vec<u32> = scenes.map(|scene| scene.scene).collect();
        scenes.sort_unstable();
        scenes
    }

    fn group(&self, facts: &DatasetFacts, choice: (Option<&str>, Option<&str>)) -> Group {
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
        let facts = DatasetFacts { name: "demo".into(), planned_scenes: 99, bev_cells: 400, bev_cell_m: 0.4 };
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
            totals.add(scene, &counts);
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
        assert_eq!(chosen(&[]), []);
    }
}
