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
        text.push_str(&format!("{path}={}\n", part(&whole, path)));
    }
    store::hash_bytes(text.as_bytes())
}

/// A part of a configuration by its path, `annotation.box_radius_m`; null where there is none. `rigs[].lidar` is the
/// list of that part of each entry.
fn part(value: &Value, path: &str) -> Value {
    let (key, rest) = path.split_once('.').unwrap_or((path, ""));
    match (key.strip_suffix("[]"), rest) {
        (Some(list), _) => {
            let entries = value[list].as_array().map_or(&[][..], Vec::as_slice);
            entries.iter().map(|entry| part(entry, rest)).collect()
        }
        (None, "") => value[key].clone(),
        (None, rest) => part(&value[key], rest),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use schema::settings::OwnRig;
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
        let mut base = crate::config::example_settings();
        base.own_rigs.push(OwnRig {
            agents: vec!["vehicle_1".into()],
            rig: base.vehicle_rig.clone(),
            occupancy: base.vehicle_occupancy.clone(),
        });
        let whole = serde_json::to_value(&base).expect("serialises");
        for stage in &Graph::get().stages {
            for path in &stage.config {
                let part = part(&whole, path);
                let missing =
                    |v: &Value| v.is_null() || v.as_array().is_some_and(|v| v.iter().any(Value::is_null));
                assert!(!missing(&part), "{}: no configuration part {path}", stage.name);
            }
        }
        let differ = |change: fn(&mut DatasetSettings)| -> Vec<&str> {
            let mut changed = base.clone();
            change(&mut changed);
            let stages = Graph::get().stages.iter();
            stages
                .filter(|s| config_hash(s, &base) != config_hash(s, &changed))
                .map(|s| s.name.as_str())
                .collect()
        };
        assert_eq!(differ(|s| s.vehicle_rig.lidars[0].noise_m = 0.5), ["render-sensors"]);
        assert_eq!(differ(|s| s.own_rigs[0].rig.lidars[0].noise_m = 0.5), ["render-sensors"]);
        assert_eq!(differ(|s| s.own_rigs[0].occupancy.voxel_m = 0.5), ["occupancy-gt", "postprocess-valid"]);
    }
}
