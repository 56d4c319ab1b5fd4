//! `pipeline.toml` and `versions.toml`: which stages there are, what they depend on, and the version of what
//! each makes.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

/// What one manifest of a stage covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UnitKind {
    /// The dataset's plan.
    Plan,
    /// One scene.
    Scene,
    /// The dataset's statistics.
    Stats,
}

/// One stage.
#[derive(Debug)]
pub struct StageSpec {
    /// Name of the stage and of its binary.
    pub name: &'static str,
    /// What one manifest covers.
    pub unit: UnitKind,
    /// Positions in the graph of the stages whose outputs it reads.
    inputs: Vec<usize>,
    /// What it writes, in a scene's folder (or the store's): files, and folders ending in `/`.
    pub writes: Vec<&'static str>,
    /// Whether it looks at a scene's log (or makes it): it cannot be done of a scene that was imported, which
    /// has none.
    pub needs_log: bool,
}

/// All stages, each after those it reads.
#[derive(Debug)]
pub struct Graph {
    /// The stages, in running order.
    pub stages: Vec<StageSpec>,
}

static GRAPH: LazyLock<Graph> = LazyLock::new(|| {
    // A test reads both files: that a program has broken ones built in is a bug.
    Graph::read(include_str!("../../../../pipeline.toml"))
        .unwrap_or_else(|fault| panic!("pipeline.toml: {fault}"))
});

static VERSIONS: LazyLock<BTreeMap<&'static str, u32>> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../../versions.toml"))
        .unwrap_or_else(|fault| panic!("versions.toml: {fault}"))
});

/// The versions of what stages make, of the tiles, and of exports: the whole numbers of `versions.toml`.
pub(crate) fn stated_versions() -> &'static BTreeMap<&'static str, u32> {
    &VERSIONS
}

/// A stage as `pipeline.toml` has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry<'t> {
    name: &'t str,
    unit: UnitKind,
    #[serde(borrow)]
    reads: Vec<&'t str>,
    #[serde(borrow)]
    writes: Vec<&'t str>,
    #[serde(default = "yes")]
    needs_log: bool,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File<'t> {
    #[serde(borrow)]
    stage: Vec<Entry<'t>>,
}

impl Graph {
    /// The graph this program was built with.
    #[must_use]
    pub fn get() -> &'static Self {
        &GRAPH
    }

    /// The stage that makes the plan.
    #[must_use]
    pub fn planner(&self) -> &StageSpec {
        // A graph that begins with another stage is refused when it is read.
        &self.stages[0]
    }

    /// A stage by name.
    #[must_use]
    pub fn stage(&self, name: &str) -> Option<&StageSpec> {
        self.stages.iter().find(|s| s.name == name)
    }

    fn read(text: &'static str) -> Result<Self, String> {
        let File { stage: entries } = toml::from_str(text).map_err(|e| e.to_string())?;
        let mut stages: Vec<StageSpec> = Vec::new();
        for Entry { name, unit, reads, writes, needs_log } in entries {
            let position = |read: &&str| {
                let found = stages.iter().position(|stage| stage.name == *read);
                found.ok_or_else(|| format!("{name} reads {read}, which does not stand before it"))
            };
            let inputs = reads.iter().map(position).collect::<Result<_, _>>()?;
            if stages.iter().any(|stage| stage.name == name) {
                return Err(format!("{name} stands there twice"));
            }
            if (unit == UnitKind::Plan) != stages.is_empty() {
                return Err(format!("{name}: the first stage, and no other, makes the plan"));
            }
            stages.push(StageSpec { name, unit, inputs, writes, needs_log });
        }
        if stages.is_empty() { Err("it has no stages".to_owned()) } else { Ok(Self { stages }) }
    }
}

impl StageSpec {
    /// The stage, and those of its unit that are made from what it makes.
    #[must_use]
    pub fn with_followers(&'static self) -> Vec<&'static Self> {
        let mut all = vec![self];
        for stage in GRAPH.stages.iter().filter(|stage| stage.unit == self.unit) {
            if stage.inputs().any(|input| all.iter().any(|known| known.name == input.name)) {
                all.push(stage);
            }
        }
        all
    }

    /// The stages whose outputs it reads.
    pub fn inputs(&self) -> impl Iterator<Item = &'static StageSpec> + use<> {
        self.inputs.clone().into_iter().map(|position| &GRAPH.stages[position])
    }

    /// Whether the stage may write a shard, by its path in the scene's folder (or the store's). Stages of
    /// scenes may leave partial counts, `stats/NAME...`.
    #[must_use]
    pub fn may_write(&self, path: &str) -> bool {
        let is_count = || path.strip_prefix("stats/").is_some_and(|rest| rest.starts_with(self.name));
        self.writes.iter().any(|place| path == *place || place.ends_with('/') && path.starts_with(place))
            || self.unit == UnitKind::Scene && is_count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_has_a_version_and_nothing_else_has_one() {
        let mut stages: Vec<&str> = Graph::get().stages.iter().map(|stage| stage.name).collect();
        stages.extend(["tiles", "export"]);
        stages.sort_unstable();
        assert_eq!(VERSIONS.keys().copied().collect::<Vec<_>>(), stages);
        assert!(VERSIONS.values().all(|version| *version > 0), "{VERSIONS:?}");
    }

    #[test]
    fn graphs_that_lead_nowhere_are_refused() {
        for (text, fault) in [
            ("stage = []", "no stages"),
            ("[[stage]]\nname = 'a'\nunit = 'scene'\nreads = []\nwrites = []", "makes the plan"),
            ("[[stage]]\nname = 'a'\nunit = 'plan'\nreads = ['b']\nwrites = []", "reads b"),
            ("[[stage]]\nname = 'a'\nunit = 'town'\nreads = []\nwrites = []", "town"),
        ] {
            let refused = Graph::read(text).expect_err(text);
            assert!(refused.contains(fault), "{refused}");
        }
    }
}
