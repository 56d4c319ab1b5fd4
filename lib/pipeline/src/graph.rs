//! `pipeline.toml`: which stages there are and what they depend on.

/// What one manifest of a stage covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitKind {
    /// The dataset's plan.
    Plan,
    /// One scene.
    Scene,
    /// The dataset's statistics.
    Stats,
}

/// One stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageSpec {
    /// Name of the stage and of its binary.
    pub name: &'static str,
    /// What one manifest covers.
    pub unit: UnitKind,
    /// Positions in the graph of the stages whose outputs it reads.
    inputs: &'static [usize],
    /// What it writes, in a scene's folder (or the store's): files, and folders ending in `/`.
    pub writes: &'static [&'static str],
    /// Whether it looks at a scene's log (or makes it): it cannot be done of a scene that was imported, which has none.
    pub needs_log: bool,
}

/// All stages, each after those it reads.
#[derive(Debug)]
pub struct Graph {
    /// The stages, in running order.
    pub stages: &'static [StageSpec],
}

// The build script has read and checked the file.
static GRAPH: Graph = Graph { stages: include!(concat!(env!("OUT_DIR"), "/graph.rs")) };

impl Graph {
    /// The graph this program was built with.
    #[must_use]
    pub fn get() -> &'static Self {
        &GRAPH
    }

    /// The stage that makes the plan.
    #[must_use]
    pub fn planner(&self) -> &'static StageSpec {
        // The build script refuses a graph that begins with another one.
        &self.stages[0]
    }

    /// A stage by name.
    #[must_use]
    pub fn stage(&self, name: &str) -> Option<&'static StageSpec> {
        self.stages.iter().find(|s| s.name == name)
    }
}

impl StageSpec {
    /// The stages whose outputs it reads.
    pub fn inputs(&self) -> impl Iterator<Item = &'static StageSpec> + use<> {
        self.inputs.iter().map(|&position| &GRAPH.stages[position])
    }

    /// Whether the stage may write a shard, by its path in the scene's folder (or the store's). Stages of scenes may
    /// leave partial counts, `stats/NAME...`.
    #[must_use]
    pub fn may_write(&self, path: &str) -> bool {
        let is_count = || path.strip_prefix("stats/").is_some_and(|rest| rest.starts_with(self.name));
        self.writes.iter().any(|place| path == *place || place.ends_with('/') && path.starts_with(place))
            || self.unit == UnitKind::Scene && is_count()
    }
}
