//! The boxes of a scene that are to be found.

use std::collections::BTreeMap;
use std::ops::Range;

use scene::SceneReader;
use schema::table::Row;
use schema::tables::{ActorRow, AgentRow, BoxRow, ValidBoxRow};
use schema::{ActorKind, AgentId, Attributes, DetectionClass, Difficulty, is_trailer, nuscenes_attribute};
use store::{RowGroups, keys};

use crate::EvaluationError;
use crate::attribute::number_of_attribute;
use crate::boxes::{Sighting, Solid, Target, yaw_of};
use crate::class::BoxClass;
use crate::mode::SeenBy;

schema::columns! {
    /// Where agents are.
    AgentPose of AgentRow { frame: u32, agent: String, id: u16, xyz_m: [f64; 3], quaternion: [f64; 4] }
}

schema::columns! {
    /// What objects are.
    Thing of ActorRow { id: u16, kind: ActorKind }
}

schema::columns! {
    /// Boxes.
    Placed of BoxRow {
        frame: u32, agent: String, id: u16, class: String, center_m: [f64; 3], size_m: [f64; 3], rpy_rad: [f64; 3],
        velocity_mps: [f32; 3], semantic_tags: Vec<u8>, attributes: Attributes,
    }
}

schema::columns! {
    /// What was seen of them.
    Sight of ValidBoxRow {
        frame: u32, agent: String, id: u16, num_lidar_pts: u32, num_radar_pts: u32, valid_flag: bool, difficulty: String,
    }
}

/// A box of an agent's list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Label {
    pub(crate) id: u16,
    pub(crate) class: BoxClass,
    pub(crate) solid: Solid,
    pub(crate) difficulty: Difficulty,
    /// Whether somebody who counts saw it.
    pub(crate) is_seen: bool,
    /// Points of lidars and radars of those who count.
    pub(crate) points: u64,
    /// Whose lidars have points of it.
    pub(crate) sighting: Sighting,
    /// nuScenes' attribute: a number of [`schema::NUSCENES_ATTRIBUTES`].
    pub(crate) attribute: Option<u8>,
}

impl Label {
    /// The box as a target of an ego that is somewhere; `class` is a number of the metric.
    pub(crate) fn target(&self, class: usize, ego_m: [f64; 3]) -> Target {
        Target {
            class,
            solid: self.solid,
            distance_m: self.solid.away_m(ego_m),
            difficulty: self.difficulty,
            sighting: self.sighting,
            attribute: self.attribute,
        }
    }
}

/// Where an agent is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    /// Its own object.
    pub(crate) id: u16,
    /// In the world, m.
    pub(crate) xyz_m: [f64; 3],
    /// Where it points to, about the world's up axis, rad.
    pub(crate) yaw_rad: f64,
}

/// The lists of all agents of a scene at some frames.
#[derive(Debug)]
pub(crate) struct SceneLabels {
    labels: Vec<Label>,
    /// Which of them are whose, by frame and agent.
    lists: BTreeMap<(u32, AgentId), Range<usize>>,
    /// Where each agent is, likewise.
    poses: BTreeMap<u32, BTreeMap<AgentId, Pose>>,
}

/// The rows of a table, one after the other.
fn rows<R: Row>(
    scene: &SceneReader,
) -> Result<impl Iterator<Item = Result<R, EvaluationError>>, EvaluationError> {
    let key = keys::table::<R>(scene.scene());
    let groups: RowGroups<R> = scene.store().row_groups(scene.manifest(R::STAGE)?, &key)?;
    Ok(groups.flat_map(|group| match group {
        Ok(rows) => rows.into_iter().map(Ok).collect::<Vec<_>>(),
        Err(fault) => vec![Err(EvaluationError::from(fault))],
    }))
}

impl SceneLabels {
    /// Reads those of the frames that are wanted.
    pub(crate) fn read(scene: &SceneReader, is_due: impl Fn(u32) -> bool) -> Result<Self, EvaluationError> {
        let number = scene.scene();
        let named = |frame: u32, agent: &str| {
            let fault = |problem: String| fault(number, frame, agent, problem);
            agent.parse::<AgentId>().map_err(|e| fault(e.to_string()))
        };
        let mut poses: BTreeMap<u32, BTreeMap<AgentId, Pose>> = BTreeMap::new();
        for pose in rows::<AgentPose>(scene)? {
            let AgentPose { frame, agent, id, xyz_m, quaternion } = pose?;
            if is_due(frame) {
                let yaw_rad = yaw_of(quaternion)
                    .ok_or_else(|| fault(number, frame, &agent, "its `quaternion` is no rotation".into()))?;
                poses.entry(frame).or_default().insert(named(frame, &agent)?, Pose { id, xyz_m, yaw_rad });
            }
        }
        let mut kinds = BTreeMap::new();
        for thing in rows::<Thing>(scene)? {
            let Thing { id, kind } = thing?;
            kinds.insert(id, kind);
        }
        let (mut labels, mut lists) = (Vec::new(), BTreeMap::<(u32, AgentId), Range<usize>>::new());
        let mut sights = rows::<Sight>(scene)?;
        let mut whose: Option<(String, AgentId)> = None;
        for placed in rows::<Placed>(scene)? {
            let placed = placed?;
            let Placed { frame, agent, id, .. } = &placed;
            let fault = |problem: &str| fault(number, *frame, agent, format!("object {id}: {problem}"));
            let sight = sights.next().transpose()?;
            let sight = sight.filter(|s| (s.frame, s.id) == (*frame, *id) && s.agent == *agent);
            let sight = sight.ok_or_else(|| fault("`boxes_valid` has no row of it in its place"))?;
            if !is_due(*frame) {
                continue;
            }
            let owner = match &whose {
                Some((name, owner)) if name == agent => *owner,
                _ => whose.insert((agent.clone(), named(*frame, agent)?)).1,
            };
            let at = labels.len();
            let range = lists.entry((*frame, owner)).or_insert(at..at);
            if range.end != at {
                return Err(fault("the boxes of a frame and agent do not stand together"));
            }
            range.end += 1;
            let kind = kinds.get(id).copied().unwrap_or_default();
            labels.push(label(&placed, &sight, kind).ok_or_else(|| {
                fault(&format!("class `{}` or difficulty `{}` is none", placed.class, sight.difficulty))
            })?);
        }
        Ok(Self { labels, lists, poses })
    }

    /// Where an agent is.
    pub(crate) fn pose(&self, frame: u32, agent: AgentId) -> Option<Pose> {
        self.poses.get(&frame)?.get(&agent).copied()
    }

    /// The list of an agent with what those who count saw of it.
    pub(crate) fn of(&self, frame: u32, agent: AgentId, seen: SeenBy) -> Vec<Label> {
        let list =
            |agent| self.lists.get(&(frame, agent)).map_or(&[][..], |range| &self.labels[range.clone()]);
        let mut own = list(agent).to_vec();
        match seen {
            SeenBy::Nobody => own.iter_mut().for_each(|label| label.is_seen = true),
            SeenBy::Ego => {}
            SeenBy::Partners { .. } => {
                let by_id: BTreeMap<u16, usize> = own.iter().enumerate().map(|(i, l)| (l.id, i)).collect();
                let others = self.poses.get(&frame);
                let here = self.pose(frame, agent).map_or([f64::NAN; 3], |pose| pose.xyz_m);
                for (other, Pose { xyz_m, .. }) in others.into_iter().flatten() {
                    if !seen.is_partner((agent, here), (*other, *xyz_m)) {
                        continue;
                    }
                    for label in list(*other) {
                        let Some(mine) = by_id.get(&label.id).map(|i| &mut own[*i]) else { continue };
                        mine.is_seen |= label.is_seen;
                        mine.points += label.points;
                        if mine.sighting == Sighting::Nobody && label.sighting == Sighting::Ego {
                            mine.sighting = Sighting::Partners;
                        }
                    }
                }
            }
        }
        own
    }
}

fn fault(scene: u32, frame: u32, agent: &str, problem: String) -> EvaluationError {
    EvaluationError::Labels { scene, frame, agent: agent.to_owned(), problem }
}

fn label(placed: &Placed, sight: &Sight, kind: ActorKind) -> Option<Label> {
    let class = DetectionClass::from_name(&placed.class)?;
    let levels = [Difficulty::Easy, Difficulty::Medium, Difficulty::Hard];
    let [vx, vy, vz] = placed.velocity_mps.map(f64::from);
    let speed_mps = (vx * vx + vy * vy + vz * vz).sqrt();
    let attribute = nuscenes_attribute(class, kind, &placed.semantic_tags, &placed.attributes, speed_mps);
    Some(Label {
        id: placed.id,
        class: if is_trailer(class, &placed.attributes) {
            BoxClass::Trailer
        } else {
            BoxClass::Detection(class)
        },
        solid: Solid {
            center_m: placed.center_m,
            size_m: placed.size_m,
            yaw_rad: placed.rpy_rad[2],
            velocity_mps: [vx, vy],
        },
        difficulty: levels.into_iter().find(|level| level.name() == sight.difficulty)?,
        is_seen: sight.valid_flag,
        points: u64::from(sight.num_lidar_pts) + u64::from(sight.num_radar_pts),
        sighting: if sight.num_lidar_pts > 0 { Sighting::Ego } else { Sighting::Nobody },
        attribute: attribute.and_then(number_of_attribute),
    })
}
