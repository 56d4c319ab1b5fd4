//! Which part of a store is exported.

use schema::AgentId;
use store::SceneKind;

/// A part of a store. Everything is wanted where nothing is said.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Numbers of scenes: first and last of each piece.
    pub scenes: Option<Vec<(u32, u32)>>,
    /// Splits: `train`, `val`, `test`.
    pub splits: Vec<String>,
    /// Editions of the configuration, by number.
    pub editions: Vec<u32>,
    /// Groups of scenes, by name.
    pub groups: Vec<String>,
    /// Names of agents, in which `*` stands for anything: `vehicle_0`, `rsu_*`.
    pub agents: Vec<String>,
    /// Names of sensors, likewise: `LIDAR`, `RGB-*`.
    pub sensors: Vec<String>,
    /// Frames 0, n, 2 n, ...
    pub every_n_frames: u32,
}

impl Selection {
    /// Whether a scene of a split and a kind is wanted.
    #[must_use]
    pub fn has_scene(&self, scene: u32, split: &str, kind: &SceneKind) -> bool {
        self.scenes
            .as_ref()
            .is_none_or(|pieces| pieces.iter().any(|(first, last)| (*first..=*last).contains(&scene)))
            && (self.splits.is_empty() || self.splits.iter().any(|s| s == split))
            && (self.editions.is_empty() || self.editions.contains(&kind.edition))
            && (self.groups.is_empty() || self.groups.contains(&kind.group))
    }

    /// Whether an agent is wanted.
    #[must_use]
    pub fn has_agent(&self, agent: AgentId) -> bool {
        is_among(&self.agents, &agent.to_string())
    }

    /// Whether a sensor is wanted, by the name of its table.
    #[must_use]
    pub fn has_sensor(&self, name: &str) -> bool {
        is_among(&self.sensors, name)
    }

    /// Those of the frames `0..frames` that are wanted.
    pub fn frames(&self, frames: u32) -> impl Iterator<Item = u32> + use<> {
        schema::rate::due(frames, self.every_n_frames)
    }

    /// The selection in words that stay the same: part of what makes two exports the same. Scenes, splits,
    /// editions and groups are not: an export may grow by them.
    #[must_use]
    pub fn identity(&self) -> String {
        let Self { agents, sensors, every_n_frames, .. } = self;
        format!("agents {agents:?}, sensors {sensors:?}, every {}", (*every_n_frames).max(1))
    }
}

fn is_among(patterns: &[String], name: &str) -> bool {
    patterns.is_empty() || patterns.iter().any(|pattern| matches(pattern, name))
}

/// Whether a name is what a pattern says, in which `*` stands for any text.
#[must_use]
pub fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((head, rest)) => name.strip_prefix(head).is_some_and(|tail| {
            let starts = tail.char_indices().map(|(at, _)| at).chain([tail.len()]);
            starts.into_iter().any(|at| matches(rest, &tail[at..]))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_stand_for_any_text() {
        for (pattern, name, expected) in [
            ("LIDAR", "LIDAR", true),
            ("LIDAR", "LIDAR_2", false),
            ("RGB-*", "RGB-CAM_FRONT", true),
            ("RGB-*", "IST-CAM_FRONT", false),
            ("*-CAM_FRONT", "RGB-CAM_FRONT_LEFT", false),
            ("*CAM*LEFT", "RGB-CAM_FRONT_LEFT", true),
            ("*", "", true),
            ("", "x", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
    }

    #[test]
    fn nothing_said_is_everything() {
        let day = SceneKind::default();
        let all = Selection::default();
        assert!(all.has_scene(7, "val", &day) && all.has_agent(AgentId::rsu(3)) && all.has_sensor("IMU"));
        assert_eq!(all.frames(3).collect::<Vec<_>>(), [0, 1, 2]);
        let some = Selection {
            scenes: Some(vec![(7, 8)]),
            splits: vec!["val".into()],
            agents: vec!["vehicle_*".into()],
            every_n_frames: 4,
            ..all
        };
        let has = |scene, split| some.has_scene(scene, split, &day);
        assert!(has(7, "val") && !has(7, "train") && !has(6, "val"));
        let night = SceneKind { edition: 1, group: "night".into() };
        let of = |editions: &[u32], groups: &[&str]| {
            let groups = groups.iter().map(|group| (*group).to_owned()).collect();
            let some = Selection { editions: editions.to_vec(), groups, ..Selection::default() };
            [&day, &night].map(|kind| some.has_scene(0, "val", kind))
        };
        assert_eq!(
            [of(&[0], &[]), of(&[0, 1], &[]), of(&[], &["night"])],
            [[true, false], [true, true], [false, true]]
        );
        assert!(some.has_agent(AgentId::vehicle(2)) && !some.has_agent(AgentId::rsu(2)));
        assert_eq!(some.frames(9).collect::<Vec<_>>(), [0, 4, 8]);
    }
}
