//! Stages that tasks take together, and stages whose tasks go elsewhere.

use runner::{StageSpec, scene_stages};

/// A stage whose tasks go elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Split {
    pub(super) stage: &'static str,
    /// A partition of Slurm, or what a node of Kubernetes must have.
    pub(super) place: String,
    pub(super) options: Vec<String>,
}

impl std::str::FromStr for Split {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (stage, rest) = text.split_once('=').ok_or("expected STAGE=PLACE")?;
        let known = scene_stages().find(|known| known.name == stage).ok_or_else(|| {
            let names: Vec<&str> = scene_stages().map(|stage| stage.name).collect();
            format!("there is no stage of scenes `{stage}`; there are {}", names.join(", "))
        })?;
        let mut words = rest.split(',').map(str::to_owned);
        let place = words.next().filter(|name| !name.is_empty()).ok_or("expected STAGE=PLACE")?;
        Ok(Self { stage: known.name, place, options: words.collect() })
    }
}

/// Stages that run in one array of tasks.
pub(super) struct Group {
    pub(super) stages: Vec<&'static str>,
    pub(super) split: Option<Split>,
}

impl Group {
    fn is_all(&self) -> bool {
        self.stages.len() == scene_stages().count()
    }

    /// Of its script and of its logs.
    pub(super) fn name(&self) -> String {
        if self.is_all() { "scenes".to_owned() } else { self.stages.join("-") }
    }

    /// As `--stages` takes it.
    pub(super) fn words(&self) -> String {
        if self.is_all() { "scenes".to_owned() } else { self.stages.join(",") }
    }
}

/// The stages of scenes in the arrays in which they run, in their order: those that go elsewhere alone, all
/// others as early as what they read allows.
pub(super) fn groups_of(splits: &[Split]) -> Vec<Group> {
    let split_of = |stage: &StageSpec| splits.iter().find(|split| split.stage == stage.name);
    let mut left: Vec<&'static StageSpec> = scene_stages().collect();
    let mut groups = Vec::new();
    while !left.is_empty() {
        let mut stages = Vec::new();
        let mut later = Vec::new();
        for stage in left {
            let waits = |input: &StageSpec| later.iter().any(|later: &&StageSpec| later.name == input.name);
            if split_of(stage).is_some() || stage.inputs().any(waits) {
                later.push(stage);
            } else {
                stages.push(stage.name);
            }
        }
        if !stages.is_empty() {
            groups.push(Group { stages, split: None });
        }
        // The first of those that wait reads nothing of the others.
        left = later;
        if let Some(split) = left.first().copied().and_then(split_of) {
            groups.push(Group { stages: vec![split.stage], split: Some(split.clone()) });
            left.remove(0);
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use runner::Graph;

    use super::*;

    #[test]
    fn splits_name_stages_of_scenes() {
        for wrong in ["render-sensors", "render-sensors=", "stats=gpu", "paint=gpu"] {
            assert!(wrong.parse::<Split>().is_err(), "{wrong}");
        }
        // A graph of two splits: the first is not waited for by what does not read it.
        let splits = ["occupancy-gt=big", "render-sensors=gpu"].map(|split| split.parse().expect("is one"));
        let groups: Vec<Vec<&str>> = groups_of(&splits).into_iter().map(|group| group.stages).collect();
        assert_eq!(
            groups,
            [
                vec!["simulate-and-log", "bev-gt"],
                vec!["render-sensors"],
                vec!["occupancy-gt"],
                vec!["postprocess-valid", "merge-tracks"]
            ]
        );
        assert!(
            Graph::get().stages.len() > groups.concat().len(),
            "plan and statistics are jobs of their own"
        );
    }
}
