//! `pipeline.toml`: which stages there are and what they depend on.

use std::sync::LazyLock;

use schema::settings::DatasetSettings;
use serde::Deserialize;
use serde_json::Value;

const TEXT: &str = include_str!("../../../pipeline.toml");

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
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageSpec {
    /// Name of the stage and of its binary.
    pub name: String,
    /// What one manifest covers.
    pub unit: UnitKind,
    /// Stages whose outputs it reads.
    pub reads: Vec<String>,
    /// Parts of the resolved configuration it uses, as dotted paths.
    pub config: Vec<String>,
    /// What it writes, in a scene's folder (or the store's).
    pub writes: Vec<String>,
}

/// All stages, each after those it reads.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Graph {
    /// The stages, in running order.
    #[serde(rename = "stage")]
    pub stages: Vec<StageSpec>,
}

static GRAPH: LazyLock<Graph> = LazyLock::new(|| {
    // The text is part of the program and parsed by a test: it cannot be wrong at run time.
    toml::from_str(TEXT).unwrap_or(Graph { stages: Vec::new() })
});

impl Graph {
    /// The graph this program was built with.
    #[must_use]
    pub fn get() -> &'static Self {
        &GRAPH
    }

    /// A stage by name.
    #[must_use]
    pub fn stage(&self, name: &str) -> Option<&StageSpec> {
        self.stages.iter().find(|s| s.name == name)
    }
}

/// Digest of the parts of a configuration that a stage uses.
#[must_use]
pub fn config_hash(spec: &StageSpec, settings: &DatasetSettings) -> String {
    let whole = serde_json::to_value(settings).unwrap_or(Value::Null);
    let mut text = String::new();
    for path in &spec.config {
        let part = path.split('.').fold(&whole, |value, key| &value[key]);
        text.push_str(&format!("{path}={part}\n"));
    }
    store::hash_bytes(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn stages_stand_after_what_they_read() {
        let graph: Graph = toml::from_str(TEXT).expect("pipeline.toml parses");
        let mut seen = BTreeSet::new();
        for stage in &graph.stages {
            assert!(stage.reads.iter().all(|r| seen.contains(r)), "{} reads a later stage", stage.name);
            assert!(seen.insert(stage.name.clone()));
        }
        assert_eq!(graph.stages.len(), 8);
    }

    #[test]
    fn every_config_path_exists_and_only_its_parts_count() {
        let base = crate::config::example_settings();
        let whole = serde_json::to_value(&base).expect("serialises");
        for stage in &Graph::get().stages {
            for path in &stage.config {
                let part = path.split('.').fold(&whole, |value, key| &value[key]);
                assert!(!part.is_null(), "{}: no configuration part {path}", stage.name);
            }
        }
        let mut changed = base.clone();
        changed.vehicle_rig.lidars[0].noise_m = 0.5;
        let differ: Vec<&str> = Graph::get()
            .stages
            .iter()
            .filter(|s| config_hash(s, &base) != config_hash(s, &changed))
            .map(|s| s.name.as_str())
            .collect();
        assert_eq!(differ, ["render-sensors"]);
    }
}
