//! What of a store is not there yet: nothing can be found wrong in it.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use crate::files::{Table, Unreadable};
use crate::ledger::Ledger;

/// What is made of each scene, in running order.
const OF_SCENES: [&str; 6] =
    ["simulate-and-log", "render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks"];

/// How much of a store, or of some of its scenes, is not there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Standing {
    /// Scenes that are planned or begun.
    scenes: usize,
    /// How many of them lack something.
    unfinished: usize,
    /// How many lack what each stage makes.
    lacking: [usize; OF_SCENES.len()],
    /// What the whole dataset lacks.
    of_dataset: Vec<&'static str>,
}

impl Standing {
    /// Looks which manifests stand, of all scenes or of those that are wanted.
    pub(crate) fn of(store: &Path, there: &[u32], wanted: impl Fn(u32) -> bool, ledger: &mut Ledger) -> Self {
        let mut standing = Self::default();
        let plan = store.join("plan/scenes.parquet");
        let mut scenes: BTreeSet<u32> = there.iter().copied().collect();
        if plan.is_file() {
            scenes.extend(ledger.read(planned(&plan)).unwrap_or_default());
        } else {
            standing.of_dataset.push("the plan");
        }
        if !store.join("stats/_manifest.json").is_file() {
            standing.of_dataset.push("the statistics");
        }
        for scene in scenes.into_iter().filter(|scene| wanted(*scene)) {
            let manifests = store.join(format!("scenes/{scene:04}/_manifests"));
            let lacks = OF_SCENES.map(|stage| !manifests.join(format!("{stage}.json")).is_file());
            standing.scenes += 1;
            standing.unfinished += usize::from(lacks.contains(&true));
            for (count, lacks) in standing.lacking.iter_mut().zip(lacks) {
                *count += usize::from(lacks);
            }
        }
        standing
    }

    /// Whether everything is there.
    pub(crate) fn is_whole(&self) -> bool {
        self.unfinished == 0 && self.of_dataset.is_empty()
    }

    /// What is not there, for people; nothing where all is.
    pub(crate) fn lines(&self) -> String {
        let mut text = String::new();
        for (stage, &count) in OF_SCENES.iter().zip(&self.lacking).filter(|(_, count)| **count > 0) {
            let _ = writeln!(text, "  {stage}: not done in {count} of {} scenes", self.scenes);
        }
        for what in &self.of_dataset {
            let _ = writeln!(text, "  {what}");
        }
        if text.is_empty() { text } else { format!("\nNot there yet\n{text}") }
    }

    /// The same in a few words.
    pub(crate) fn words(&self) -> String {
        let scenes = format!("{} of {} scenes", self.unfinished, self.scenes);
        let scenes = (self.unfinished > 0).then_some(scenes);
        let lacking = scenes.into_iter().chain(self.of_dataset.iter().map(|&what| what.to_owned()));
        lacking.collect::<Vec<_>>().join(", ")
    }
}

/// The scenes of a plan.
fn planned(table: &Path) -> Result<Vec<u32>, Unreadable> {
    let mut scenes = Vec::new();
    for rows in Table::open(table)?.batches()? {
        scenes.extend(rows.ints("scene")?.iter().filter_map(|&scene| u32::try_from(scene).ok()));
    }
    Ok(scenes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn stages_of_scenes_are_those_of_the_pipeline() {
        let pipeline = include_str!("../../../pipeline.toml");
        let stages = pipeline.split("[[stage]]").filter(|stage| stage.contains("unit = \"scene\""));
        let names: Vec<&str> = stages.filter_map(|stage| stage.split('"').nth(1)).collect();
        assert_eq!(names, OF_SCENES);
    }

    #[test]
    fn what_is_not_there_is_counted() {
        let folder = tempfile::tempdir().expect("a folder");
        let done = |scene: u32, stages: &[&str]| {
            let manifests = folder.path().join(format!("scenes/{scene:04}/_manifests"));
            fs::create_dir_all(&manifests).expect("a folder");
            for stage in stages {
                fs::write(manifests.join(format!("{stage}.json")), "{}").expect("writes");
            }
        };
        done(0, &OF_SCENES);
        done(1, &OF_SCENES[..2]);
        let of =
            |wanted: fn(u32) -> bool| Standing::of(folder.path(), &[0, 1], wanted, &mut Ledger::default());
        let all = of(|_| true);
        assert!(!all.is_whole());
        assert_eq!(
            all.lines(),
            "\nNot there yet\n  bev-gt: not done in 1 of 2 scenes\n  occupancy-gt: not done in 1 of 2 scenes\n  \
             postprocess-valid: not done in 1 of 2 scenes\n  merge-tracks: not done in 1 of 2 scenes\n  the plan\n  \
             the statistics\n"
        );
        assert_eq!(all.words(), "1 of 2 scenes, the plan, the statistics");
        assert_eq!(of(|scene| scene == 0).words(), "the plan, the statistics");
        for part in ["plan/scenes.parquet", "stats/_manifest.json"] {
            let path = folder.path().join(part);
            fs::create_dir_all(path.parent().expect("has one")).expect("a folder");
            fs::write(path, "").expect("writes");
        }
        assert!(of(|scene| scene == 0).is_whole());
        assert_eq!(of(|scene| scene == 0).lines(), "");
    }
}
