//! What the annotators say about a log: agents frame by frame; raw boxes and HD-map records at the annotated
//! ones.

use std::collections::BTreeMap;

use frames::{Pose, World};
use labels::annotation::boxes::{ObservedObject, Observer};
use labels::annotation::hd_map::HdMap;
use opendrive::Map;
use runner::{At, Place, StageError};
use schema::measures::counts::PartialCounts;
use schema::scene_info::SceneInfo;
use schema::tables::{ActorRow, AgentRow, BoxRow, HdMapRow, PartialRow, StateRow};
use schema::{AgentId, FRAME_PERIOD_S, ObjectId, SignalState, measures, rate};
use traffic::SimulationLog;

use crate::error::LogError;

/// Labels of all frames of a scene.
pub(crate) struct Labels {
    pub(crate) agents: Vec<AgentRow>,
    pub(crate) boxes: Vec<BoxRow>,
    pub(crate) hd_map: Vec<HdMapRow>,
    pub(crate) counts: Vec<PartialRow>,
}

impl Labels {
    /// Labels a log.
    ///
    /// # Errors
    /// An agent's name is none, or the map has no driving lanes.
    pub(crate) fn collect(
        map: &Map,
        actors: &[ActorRow],
        log: &SimulationLog,
        info: &SceneInfo,
        box_radius_m: f64,
    ) -> Result<Self, StageError> {
        let ids: Vec<(AgentId, ObjectId)> = info
            .agents
            .iter()
            .map(|a| a.agent.parse().map(|id| (id, a.id)))
            .collect::<Result<_, _>>()
            .at(|| Place::scene(info.scene))?;
        let hd_map = HdMap::new(map);
        let mut labels =
            Self { agents: Vec::new(), boxes: Vec::new(), hd_map: Vec::new(), counts: Vec::new() };
        let (mut states, mut signals) = (log.states.as_slice(), log.signals.as_slice());
        take_frame(&mut states, |s| s.frame, -1);
        take_frame(&mut signals, |s| s.frame, -1);
        for frame in 0..info.frames {
            let states_now = take_frame(&mut states, |s| s.frame, frame as i32);
            let states_by_id: BTreeMap<ObjectId, &StateRow> = states_now.iter().map(|s| (s.id, s)).collect();
            let signals_now = take_frame(&mut signals, |s| s.frame, frame as i32);
            let signals_by_id: BTreeMap<ObjectId, SignalState> =
                signals_now.iter().map(|s| (s.id, s.state)).collect();
            let objects: Vec<ObservedObject<'_>> = actors
                .iter()
                .map(|actor| observe(actor, &states_by_id, signals_by_id.get(&actor.id).copied()))
                .collect();
            let is_annotated = rate::is_due(frame, info.label_every_n_frames);
            let mut observers = Vec::new();
            for &(agent, id) in &ids {
                // Ids count from 1 without gaps.
                let object = &objects[usize::from(id) - 1];
                let world_from_agent = Pose::from_isometry(*object.world_from_object.isometry());
                labels.agents.push(agent_row(frame, agent, object));
                if !is_annotated {
                    continue;
                }
                let record = hd_map.record(frame, agent, &world_from_agent).ok_or(LogError::NoLane);
                let record = record.at(|| Place::scene(info.scene).frame(frame).agent(agent))?;
                labels.hd_map.push(record);
                observers.push(Observer { agent, id, world_from_agent });
            }
            labels.boxes.extend(labels::annotation::boxes::collect(
                frame,
                &observers,
                &objects,
                box_radius_m,
            ));
        }
        labels.counts = counts(info);
        Ok(labels)
    }
}

fn counts(info: &SceneInfo) -> Vec<PartialRow> {
    let mut counts = PartialCounts::new();
    for agent in &info.agents {
        counts.add(&agent.agent, measures::simulation::AGENT_FRAMES, "", 0, u64::from(info.frames));
    }
    counts.rows()
}

/// Splits off the rows of a frame; rows are sorted by frame.
fn take_frame<'a, T>(rows: &mut &'a [T], frame_of: impl Fn(&T) -> i32, frame: i32) -> &'a [T] {
    let n = rows.iter().take_while(|r| frame_of(r) <= frame).count();
    let (now, later) = rows.split_at(n);
    *rows = later;
    now
}

fn observe<'a>(
    actor: &'a ActorRow,
    states: &BTreeMap<ObjectId, &'a StateRow>,
    signal_state: Option<SignalState>,
) -> ObservedObject<'a> {
    let fixed = || Pose::<World, _>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
    let standing = [actor.length_m, actor.width_m, actor.height_m];
    match states.get(&actor.id) {
        Some(state) => ObservedObject {
            actor,
            size_m: if state.size_m == [0.0; 3] { standing } else { state.size_m.map(f64::from) },
            world_from_object: Pose::from_xyz_wxyz(state.xyz_m, state.quaternion),
            velocity_mps: state.velocity_mps,
            angular_velocity_radps: state.angular_velocity_radps,
            signal_state,
            dormant: state.dormant,
        },
        None => ObservedObject {
            actor,
            size_m: standing,
            world_from_object: fixed(),
            velocity_mps: [0.0; 3],
            angular_velocity_radps: [0.0; 3],
            signal_state,
            dormant: false,
        },
    }
}

fn agent_row(frame: u32, agent: AgentId, object: &ObservedObject<'_>) -> AgentRow {
    AgentRow {
        frame,
        time_s: f64::from(frame) * FRAME_PERIOD_S,
        agent: agent.to_string(),
        id: object.actor.id,
        xyz_m: object.world_from_object.xyz(),
        quaternion: object.world_from_object.wxyz(),
        velocity_mps: object.velocity_mps.map(f64::from),
        angular_velocity_radps: object.angular_velocity_radps.map(f64::from),
    }
}
