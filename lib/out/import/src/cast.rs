//! The objects of a scene, from the lists of all agents and frames: their numbers and what log tables say of
//! them.

use std::collections::BTreeMap;

use frames::{Object, Pose, World};
use rayon::prelude::*;
use schema::tables::ActorRow;
use schema::{ActorKind, ActorRole, AgentId, AgentKind, Attributes, DetectionClass};

use crate::error::{ImportError, SourceFault};
use crate::folder::Folder;
use crate::infos::Scene;
use crate::names::BOXES;
use crate::record::{self, Labelled};
use crate::{json, npy};

/// Most bytes of a file of boxes: of 300 objects one has 0.3 MB.
const MAX_BOX_BYTES: u64 = 32 << 20;
/// Frames that are read at once.
pub(crate) const BATCH: usize = 16;

/// Whether post-processing has been done, by the files of the first record.
pub(crate) fn is_processed(scene: &Scene) -> bool {
    scene
        .agents
        .iter()
        .all(|(_, records)| records.iter().all(|r| r.files.contains_key(crate::names::COMBINED)))
}

/// The boxes of an agent at a frame.
pub(crate) fn read_boxes(
    folder: &Folder,
    scene: &Scene,
    (position, frame): (usize, usize),
    is_processed: bool,
) -> Result<Vec<Labelled>, ImportError> {
    let (agent, records) = &scene.agents[position];
    let place = |e: ImportError| e.within(format!("{agent} frame {frame}"));
    let said = records[frame].files.get(BOXES).map(String::as_str).unwrap_or_default();
    if said.is_empty() {
        return Err(place(ImportError::source(std::path::Path::new(BOXES), "the infos name no such file")));
    }
    let (path, bytes) = folder.read(said, MAX_BOX_BYTES).map_err(place)?;
    let value = if said.ends_with(".json") {
        json::parse(&bytes).map_err(SourceFault::from)
    } else {
        npy::parse(&bytes).map_err(SourceFault::from)
    };
    let boxes = value.and_then(|value| record::boxes(&value, is_processed));
    boxes.map_err(|problem| place(ImportError::source(&path, problem)))
}

/// An object as its first box has it.
#[derive(Clone, Debug)]
struct FirstBox {
    first: Labelled,
    agent: Option<AgentId>,
}

/// The objects of a scene.
#[derive(Debug)]
pub(crate) struct SceneObjects {
    /// By the ids of the layout.
    known: BTreeMap<i128, FirstBox>,
    /// Numbers of a store by the ids of the layout.
    ids: BTreeMap<i128, u16>,
    /// Numbers of the agents, in their order.
    pub(crate) agent_ids: Vec<u16>,
}

impl SceneObjects {
    /// Reads all lists of a scene.
    ///
    /// # Errors
    /// A file is missing or broken; there are more than 65,535 objects.
    pub(crate) fn read(folder: &Folder, scene: &Scene, is_processed: bool) -> Result<Self, ImportError> {
        let frames: Vec<usize> = (0..scene.frames() as usize).collect();
        let mut known: BTreeMap<i128, FirstBox> = BTreeMap::new();
        let mut own: Vec<Option<i128>> = vec![None; scene.agents.len()];
        for batch in frames.chunks(BATCH) {
            let lists: Vec<Result<Vec<(usize, Labelled)>, ImportError>> = batch
                .par_iter()
                .map(|&frame| {
                    let mut found = Vec::new();
                    for position in 0..scene.agents.len() {
                        let boxes = read_boxes(folder, scene, (position, frame), is_processed)?;
                        found.extend(boxes.into_iter().map(|labelled| (position, labelled)));
                    }
                    Ok(found)
                })
                .collect();
            for list in lists {
                for (position, labelled) in list? {
                    let is_own = labelled.angle_rad.is_none();
                    if is_own && own[position].is_none() {
                        own[position] = Some(labelled.id);
                    }
                    known.entry(labelled.id).or_insert(FirstBox { first: labelled, agent: None });
                }
            }
        }
        for (position, id) in own.iter().enumerate() {
            if let Some(known) = id.and_then(|id| known.get_mut(&id)) {
                known.agent = Some(scene.agents[position].0);
            }
        }
        let (ids, agent_ids) = number(&known, &own).ok_or_else(|| {
            ImportError::source(
                folder.root(),
                "has more than the 65,535 objects that a scene of a store can have",
            )
        })?;
        Ok(Self { known, ids, agent_ids })
    }

    /// The number of an object; 0 of none and of those that no list has and whose id is too great.
    pub(crate) fn id(&self, id: i128) -> u16 {
        self.ids.get(&id).copied().unwrap_or_else(|| u16::try_from(id).unwrap_or(0))
    }

    /// Whether an object never moves: scenery, and what was put up beside a hazard.
    pub(crate) fn is_fixed(labelled: &Labelled) -> bool {
        use DetectionClass::{Barrier, TrafficCone, TrafficSign};
        !labelled.is_alive || matches!(labelled.class, Barrier | TrafficCone | TrafficSign)
    }

    /// The rows of `log/actors`: what the lists say of each object, and RSUs.
    pub(crate) fn actors(&self, scene: &Scene) -> Vec<ActorRow> {
        let mut rows: Vec<ActorRow> = self.known.values().map(|known| self.actor(known)).collect();
        for (position, (agent, records)) in scene.agents.iter().enumerate() {
            let id = self.agent_ids[position];
            if rows.iter().any(|row| row.id == id) {
                continue;
            }
            rows.push(ActorRow {
                id,
                kind: if agent.kind == AgentKind::Rsu { ActorKind::Rsu } else { ActorKind::Vehicle },
                model: String::new(),
                role: ActorRole::Agent(*agent),
                fixed: agent.kind == AgentKind::Rsu,
                xyz_m: records[0].xyz_m,
                quaternion: records[0].quaternion,
                attributes: Attributes::new(),
                ..ActorRow::default()
            });
        }
        rows.sort_by_key(|row| row.id);
        rows
    }

    fn actor(&self, FirstBox { first, agent }: &FirstBox) -> ActorRow {
        let [length_m, width_m, height_m] = first.size_m();
        let pose = Pose::<World, Object>::from_xyz_rpy(first.foot_m(), first.rpy_rad);
        ActorRow {
            id: self.id(first.id),
            kind: kind_of(first.class, first.is_alive),
            model: first.model.clone(),
            role: agent.map_or_else(|| role_of(first), ActorRole::Agent),
            semantic_tags: first.tags.clone(),
            length_m,
            width_m,
            height_m,
            color: first.color.clone(),
            fixed: Self::is_fixed(first),
            xyz_m: first.foot_m(),
            quaternion: pose.wxyz(),
            variant: 0,
            parent: first.parent.map(|id| i32::from(self.id(id))).filter(|&id| id != 0),
            opendrive_id: first.opendrive_id.clone(),
            attributes: first.attributes.clone(),
        }
    }

    /// Model and colour of an agent's body.
    pub(crate) fn body(&self, position: usize) -> Option<(&str, &[u8])> {
        let id = *self.agent_ids.get(position)?;
        let known = self.known.values().find(|known| self.id(known.first.id) == id)?;
        Some((&known.first.model, &known.first.color))
    }
}

/// Numbers of a store: ids that can be one stay; the others, and agents that are in no list, take those that
/// no object of a list has, from the top.
fn number(known: &BTreeMap<i128, FirstBox>, own: &[Option<i128>]) -> Option<(BTreeMap<i128, u16>, Vec<u16>)> {
    let fits = |id: i128| u16::try_from(id).ok().filter(|&id| id != 0);
    let taken: std::collections::BTreeSet<u16> = known.keys().filter_map(|&id| fits(id)).collect();
    let mut free = (1..=u16::MAX).rev().filter(|id| !taken.contains(id));
    let mut ids = BTreeMap::new();
    for &id in known.keys() {
        let number = match fits(id) {
            Some(number) => number,
            None => free.next()?,
        };
        ids.insert(id, number);
    }
    let mut agent_ids = Vec::with_capacity(own.len());
    for id in own {
        let listed = id.and_then(|id| ids.get(&id).copied()).filter(|id| !agent_ids.contains(id));
        agent_ids.push(match listed {
            Some(id) => id,
            None => free.next()?,
        });
    }
    Some((ids, agent_ids))
}

fn kind_of(class: DetectionClass, is_alive: bool) -> ActorKind {
    use DetectionClass::*;
    match class {
        TrafficLight => ActorKind::TrafficLight,
        TrafficSign => ActorKind::Sign,
        Pedestrian => ActorKind::Walker,
        Car | Truck | Bus | Motorcycle | Bicycle if is_alive => ActorKind::Vehicle,
        Car | Truck | Bus | Motorcycle | Bicycle => ActorKind::Parked,
        TrafficCone | Barrier => ActorKind::Prop,
    }
}

fn role_of(first: &Labelled) -> ActorRole {
    match (first.is_alive, kind_of(first.class, first.is_alive)) {
        (false, _) => ActorRole::Scenery,
        (true, ActorKind::Walker) => ActorRole::Walker,
        (true, ActorKind::Vehicle) if !first.role_name.starts_with("hazard_") => ActorRole::Background,
        (true, _) => ActorRole::Hazard,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_ids_stay_and_great_ones_come_from_the_top() {
        let first = record::tests::car();
        let known: BTreeMap<i128, FirstBox> = [1, 7, 65_535, 1 << 63, 1 << 62]
            .map(|id| (id, FirstBox { first: Labelled { id, ..first.clone() }, agent: None }))
            .into();
        let (ids, agents) = number(&known, &[Some(7), None, Some(7)]).expect("few objects");
        assert_eq!(ids[&1], 1);
        assert_eq!((ids[&65_535], ids[&(1 << 62)], ids[&(1 << 63)]), (65_535, 65_534, 65_533));
        assert_eq!(agents, [7, 65_532, 65_531], "no two agents are one object");
        let many: BTreeMap<i128, FirstBox> =
            (0..65_536).map(|id| (id + (1 << 20), FirstBox { first: first.clone(), agent: None })).collect();
        assert!(number(&many, &[]).is_none());
    }
}
