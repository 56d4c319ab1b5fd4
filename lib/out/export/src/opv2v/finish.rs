//! What is common to all: facts of scenarios, which agent carries which sensor for HEAL, and what trainers
//! must be told.

use std::collections::BTreeMap;

use schema::{AgentId, AgentKind};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::options::{Variant, scenario, split_of};
use super::record::{map, to_yaml};
use crate::{ExportError, UnitFiles, UnitName};

/// Puts what trainers must be told into their own files.
const ADAPT: &str = include_str!("adapt_hypes.py");
/// Objects of a sample that are room for at least; loaders stop at one more.
const MAX_OBJECTS: u32 = 300;
/// Agents of a sample that loaders take at least; later ones are cut off.
const MAX_AGENTS: usize = 5;

/// What an agent's unit leaves for the end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Fragment {
    pub(super) split: String,
    pub(super) map: String,
    pub(super) agent: String,
    pub(super) name: i64,
    pub(super) frames: u32,
    pub(super) every_n_frames: u32,
    /// Most objects of a frame's list.
    pub(super) most_boxes: u32,
    /// Whether there are clouds of fewer beams.
    pub(super) is_thinned: bool,
    pub(super) camera_px: Option<[u32; 2]>,
}

impl Fragment {
    fn is_rsu(&self) -> bool {
        self.agent.parse::<AgentId>().is_ok_and(|agent| agent.kind == AgentKind::Rsu)
    }

    pub(super) fn to_bytes(&self) -> Result<Vec<u8>, ExportError> {
        serde_json::to_vec(self).map_err(|e| ExportError::Refused(format!("a record cannot be written: {e}")))
    }
}

/// The exported agents of all scenes, in the order in which loaders list them.
type Scenes = BTreeMap<u32, Vec<Fragment>>;

/// Writes it from what the units left.
pub(super) fn write(
    variant: Variant,
    units: &[(UnitName, Vec<u8>)],
    files: &mut UnitFiles<'_>,
) -> Result<(), ExportError> {
    let mut scenes = Scenes::new();
    for (unit, bytes) in units.iter().filter(|(_, bytes)| !bytes.is_empty()) {
        let fragment: Fragment = serde_json::from_slice(bytes).map_err(|e| {
            ExportError::Refused(format!(
                "the record of {unit} is damaged ({e}): --force makes all of it again"
            ))
        })?;
        scenes.entry(unit.scene).or_default().push(fragment);
    }
    for (scene, agents) in &mut scenes {
        agents.sort_by_key(|agent| agent.name.to_string());
        if let Some(first) = agents.first() {
            let folder = format!("{}/{}/{}", variant.folder(), split_of(&first.split), scenario(*scene));
            files.put(&format!("{folder}/data_protocol.yaml"), &to_yaml(&protocol(*scene, agents)))?;
        }
    }
    if variant == Variant::Opv2v {
        let text = serde_json::to_string_pretty(&modalities(&scenes)).unwrap_or_default();
        files.put("heter_modality_assign.json", (text + "\n").as_bytes())?;
    }
    files.put("hypes/values.yaml", &to_yaml(&values(variant, &scenes)))?;
    files.put("hypes/adapt_hypes.py", ADAPT.as_bytes())
}

/// Facts of a scenario; no loader reads them.
fn protocol(scene: u32, agents: &[Fragment]) -> Value {
    let first = &agents[0];
    map([
        ("scene", scene.into()),
        ("map", first.map.as_str().into()),
        ("split", first.split.as_str().into()),
        ("frames", first.frames.into()),
        ("period_s", super::record::number(0.05 * f64::from(first.every_n_frames))),
        ("agents", map(agents.iter().map(|agent| (agent.name.to_string(), agent.agent.as_str().into())))),
    ])
}

/// Which sensor of an agent HEAL shall use: m1 its lidar, m2 its cameras, m3 32 and m4 (cameras again) in
/// turn, so that each is there as often. Agents without cameras take turns with lidars alone, those without
/// thinned clouds have no m3. HEAL's tests take the first agent listed that has the wanted sensor for the
/// ego: vehicles come before RSUs, and the first vehicle has m1.
fn modalities(scenes: &Scenes) -> Value {
    let of = |(number, (scene, agent)): (usize, (u32, &Fragment))| {
        let turn = if number == 0 { 0 } else { number + scene as usize };
        let kinds: &[&str] = match (agent.camera_px.is_some(), agent.is_thinned) {
            (true, true) => &["m1", "m2", "m3", "m4"],
            (true, false) => &["m1", "m2", "m4"],
            (false, true) => &["m1", "m3"],
            (false, false) => &["m1"],
        };
        (agent.name.to_string(), Value::from(kinds[turn % kinds.len()]))
    };
    map(scenes.iter().map(|(scene, agents)| {
        let mut agents: Vec<&Fragment> = agents.iter().collect();
        agents.sort_by_key(|agent| (agent.is_rsu(), agent.name));
        let agents = agents.into_iter().map(|agent| (*scene, agent)).enumerate();
        (scenario(*scene), map(agents.map(of)))
    }))
}

/// What trainers must be told so that they lose nothing of it: see `docs/exports.md`.
fn values(variant: Variant, scenes: &Scenes) -> Value {
    let root = variant.folder();
    let most_agents = scenes.values().map(Vec::len).max().unwrap_or(0).max(MAX_AGENTS);
    // No sample has more objects than its agents' lists together.
    let together = |agents: &Vec<Fragment>| agents.iter().map(|agent| agent.most_boxes).sum::<u32>();
    let most_objects = scenes.values().map(together).max().unwrap_or(0).max(MAX_OBJECTS);
    let mut values = vec![
        ("root_dir", format!("{root}/train").into()),
        ("validate_dir", format!("{root}/validate").into()),
        ("test_dir", format!("{root}/test").into()),
        ("max_cav", most_agents.into()),
        ("max_num", most_objects.into()),
        // V2X-Real's own are wide enough.
        (
            "z_range",
            if variant == Variant::Opv2v { super::record::numbers([-3.0, 5.0]) } else { Value::Null },
        ),
        ("y_range", super::record::numbers([-76.8, 76.8])),
    ];
    if let Some([width, height]) = scenes.values().flatten().find_map(|agent| agent.camera_px) {
        values.extend([("camera_width", width.into()), ("camera_height", height.into())]);
    }
    if variant == Variant::Opv2v {
        values.push(("assignment_path", "heter_modality_assign.json".into()));
    }
    map(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agent(name: i64, most_boxes: u32, has_cameras: bool) -> Fragment {
        Fragment {
            split: "val".into(),
            map: "convoy/07".into(),
            agent: if name < 0 { format!("rsu_{}", -1 - name) } else { format!("vehicle_{name}") },
            name,
            frames: 12,
            every_n_frames: 2,
            most_boxes,
            is_thinned: true,
            camera_px: has_cameras.then_some([640, 360]),
        }
    }

    #[test]
    fn everybody_takes_turns() {
        let agents = vec![agent(-1, 9, false), agent(10001, 9, true), agent(10002, 9, true)];
        let scenes = Scenes::from([(0, agents.clone()), (3, agents)]);
        let expected = serde_json::json!({
            "scene_0000": {"10001": "m1", "10002": "m2", "-1": "m1"},
            "scene_0003": {"10001": "m1", "10002": "m1", "-1": "m3"},
        });
        // The order is told, too.
        assert_eq!(modalities(&scenes).to_string(), expected.to_string());
        let whole = |name, has_cameras| Fragment { is_thinned: false, ..agent(name, 9, has_cameras) };
        let scenes =
            Scenes::from([(2, vec![whole(10001, true), whole(10002, false), agent(10003, 9, false)])]);
        let expected = serde_json::json!({"scene_0002": {"10001": "m1", "10002": "m1", "10003": "m1"}});
        assert_eq!(modalities(&scenes), expected);
    }

    #[test]
    fn there_is_room_for_everybody() {
        let few = Scenes::from([(0, vec![agent(10001, 40, true)])]);
        let found = values(Variant::Opv2v, &few);
        assert_eq!((&found["max_cav"], &found["max_num"]), (&5.into(), &300.into()));
        assert_eq!(
            (&found["camera_width"], &found["z_range"]),
            (&640.into(), &serde_json::json!([-3.0, 5.0]))
        );
        let many = Scenes::from([(0, (1..=7).map(|n| agent(10000 + n, 50, false)).collect())]);
        let found = values(Variant::V2xReal, &many);
        assert_eq!((&found["max_cav"], &found["max_num"]), (&7.into(), &350.into()));
        assert_eq!((&found["z_range"], found.get("camera_width")), (&Value::Null, None));
    }

    #[test]
    fn facts_of_a_scenario() {
        let text = to_yaml(&protocol(3, &[agent(-1, 0, false), agent(10001, 0, true)]));
        let expected = "scene: 3\nmap: \"convoy/07\"\nsplit: val\nframes: 12\nperiod_s: 0.1\nagents:\n  -1: rsu_0\n  10001: vehicle_10001\n";
        assert_eq!(String::from_utf8(text).expect("is text"), expected);
    }
}
