//! One list of objects per frame out of all agents' lists, and the objects' tracks over the scene.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use schema::difficulty::difficulty_of;
use schema::tables::{BoxRow, SightingRow, TrackFrameRow, TrackRow, ValidBoxRow, WindowRow};
use schema::{AgentId, ObjectId};

mod count;
mod sightings;
mod windows;

pub use count::count;
pub use windows::windows;

use sightings::Sightings;

/// The tables don't belong together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TrackError {
    /// One table is longer.
    #[error("there are {boxes} boxes but {valid} rows of boxes_valid")]
    Lengths {
        /// Rows of `boxes`.
        boxes: usize,
        /// Rows of `boxes_valid`.
        valid: usize,
    },
    /// A row of one table is about another box than its partner.
    #[error("row {row}: boxes has frame {frame}, {agent}, object {id}, but boxes_valid has another")]
    Mismatch {
        /// Number of the row, from 0.
        row: usize,
        /// Frame in `boxes`.
        frame: u32,
        /// Agent in `boxes`.
        agent: String,
        /// Object in `boxes`.
        id: ObjectId,
    },
    /// A row belongs to no agent.
    #[error("row {row} of boxes: {source}")]
    Agent {
        /// Number of the row, from 0.
        row: usize,
        /// What is wrong with its name.
        source: schema::ParseAgentError,
    },
}

/// The objects of a scene over all agents.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// Objects, by frame, then id.
    pub frames: Vec<TrackFrameRow>,
    /// Tracks, by id.
    pub tracks: Vec<TrackRow>,
    /// When each agent saw each object, by id, then agent.
    pub sightings: Vec<SightingRow>,
}

/// Merges the boxes of all agents of a scene. The two tables are paired row by row; their order does not
/// matter.
///
/// Per frame and object, the record of the first agent (vehicles by number, then RSUs) is taken; points of
/// all agents add up, valid flags are OR-ed, and the difficulty follows from the points alone. There are
/// boxes at every `every_n_frames`th frame: these are neighbours.
///
/// # Errors
/// The tables are not of the same boxes, or an agent's name is none.
pub fn merge(boxes: &[BoxRow], valid: &[ValidBoxRow], every_n_frames: u32) -> Result<Merged, TrackError> {
    if boxes.len() != valid.len() {
        return Err(TrackError::Lengths { boxes: boxes.len(), valid: valid.len() });
    }
    let mut order: Vec<(u32, ObjectId, AgentId, usize)> = Vec::with_capacity(boxes.len());
    for (row, (b, v)) in boxes.iter().zip(valid).enumerate() {
        if (b.frame, b.id, &b.agent) != (v.frame, v.id, &v.agent) {
            return Err(TrackError::Mismatch { row, frame: b.frame, agent: b.agent.clone(), id: b.id });
        }
        let agent = b.agent.parse().map_err(|source| TrackError::Agent { row, source })?;
        order.push((b.frame, b.id, agent, row));
    }
    order.sort_unstable();

    let mut frames = Vec::new();
    let mut tracks: BTreeMap<ObjectId, Track> = BTreeMap::new();
    let mut sightings = Sightings::new(every_n_frames);
    for same in order.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let records = same.iter().map(|&(_, _, agent, row)| (agent, &boxes[row], &valid[row]));
        records.clone().for_each(|(agent, listed, judged)| sightings.add(agent, listed, judged));
        if let Some((row, seen_by)) = merge_object(records) {
            tracks
                .entry(row.id)
                .or_insert_with(|| Track::new(&boxes[same[0].3], every_n_frames))
                .add(&row, &seen_by);
            frames.push(row);
        }
    }
    let tracks = tracks.into_values().map(|track| track.row).collect();
    Ok(Merged { frames, tracks, sightings: sightings.rows() })
}

/// Gives tracks and windows of those whose box follows their pose the size that they have while they stand.
pub fn stand(tracks: &mut [TrackRow], windows: &mut [WindowRow], standing_m: &BTreeMap<ObjectId, [f64; 3]>) {
    let tracks = tracks.iter_mut().map(|row| (row.id, &mut row.size_m));
    let windows = windows.iter_mut().map(|row| (row.id, &mut row.size_m));
    for (id, size_m) in tracks.chain(windows) {
        if let Some(standing_m) = standing_m.get(&id) {
            *size_m = *standing_m;
        }
    }
}

/// One object at one frame, from the records of the agents that list it, in order.
fn merge_object<'a>(
    mut records: impl Iterator<Item = (AgentId, &'a BoxRow, &'a ValidBoxRow)>,
) -> Option<(TrackFrameRow, Vec<AgentId>)> {
    let (agent, first, valid) = records.next()?;
    let mut seen_by: Vec<AgentId> = valid.valid_flag.then_some(agent).into_iter().collect();
    let (mut lidar, mut radar) = (valid.num_lidar_pts, valid.num_radar_pts);
    for (agent, _, valid) in records {
        lidar = lidar.saturating_add(valid.num_lidar_pts);
        radar = radar.saturating_add(valid.num_radar_pts);
        if valid.valid_flag && seen_by.last() != Some(&agent) {
            seen_by.push(agent);
        }
    }
    let row = TrackFrameRow {
        frame: first.frame,
        id: first.id,
        class: first.class.clone(),
        semantic_tags: first.semantic_tags.clone(),
        corners_m: first.corners_m,
        center_m: first.center_m,
        size_m: first.size_m,
        rpy_rad: first.rpy_rad,
        velocity_mps: first.velocity_mps,
        angular_velocity_radps: first.angular_velocity_radps,
        num_lidar_pts: lidar,
        num_radar_pts: radar,
        valid_flag: !seen_by.is_empty(),
        difficulty: difficulty_of(&first.class, None, lidar.saturating_add(radar)).name().to_owned(),
        seen_by: seen_by.iter().map(AgentId::to_string).collect(),
        signal_state: first.signal_state,
        is_alive: first.is_alive,
        is_active: first.is_active,
        is_dormant: first.is_dormant,
        opendrive_id: first.opendrive_id.clone(),
        attributes: first.attributes.clone(),
    };
    Some((row, seen_by))
}

/// A track as it grows, frame by frame.
struct Track {
    row: TrackRow,
    last_center_m: [f64; 3],
    seen_by: Vec<AgentId>,
    every_n_frames: u32,
}

impl Track {
    fn new(first: &BoxRow, every_n_frames: u32) -> Self {
        Self {
            row: TrackRow {
                id: first.id,
                class: first.class.clone(),
                model: first.model.clone(),
                size_m: first.size_m,
                first_frame: first.frame,
                ..TrackRow::default()
            },
            last_center_m: first.center_m,
            seen_by: Vec::new(),
            every_n_frames: every_n_frames.max(1),
        }
    }

    fn add(&mut self, frame: &TrackFrameRow, seen_by: &[AgentId]) {
        let row = &mut self.row;
        // Over a gap the way is unknown; only steps between neighbouring frames count.
        if row.frames > 0 && frame.frame == row.last_frame + self.every_n_frames {
            row.path_m += (Vector3::from(frame.center_m) - Vector3::from(self.last_center_m)).norm();
        }
        self.last_center_m = frame.center_m;
        row.last_frame = frame.frame;
        row.frames += 1;
        if frame.valid_flag {
            let number = i32::try_from(frame.frame).ok();
            row.valid_frames += 1;
            row.first_valid_frame = row.first_valid_frame.or(number);
            row.last_valid_frame = number;
        }
        row.num_lidar_pts += u64::from(frame.num_lidar_pts);
        row.num_radar_pts += u64::from(frame.num_radar_pts);
        let speed_mps = Vector3::from(frame.velocity_mps.map(f64::from)).norm();
        row.max_speed_mps = row.max_speed_mps.max(speed_mps);
        for &agent in seen_by {
            if let Err(place) = self.seen_by.binary_search(&agent) {
                self.seen_by.insert(place, agent);
                row.seen_by.insert(place, agent.to_string());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pair(frame: u32, agent: &str, id: u16, lidar: u32, valid: bool, x: f64) -> (BoxRow, ValidBoxRow) {
        let b = BoxRow {
            frame,
            agent: agent.into(),
            id,
            class: "car".into(),
            model: format!("seen by {agent}"),
            center_m: [x, 0.0, 0.0],
            velocity_mps: [3.0, 4.0, 0.0],
            distance_m: 500.0,
            ..BoxRow::default()
        };
        let v = ValidBoxRow {
            frame,
            agent: agent.into(),
            id,
            class: "car".into(),
            num_lidar_pts: lidar,
            num_radar_pts: 1,
            valid_flag: valid,
            difficulty: "hard".into(),
            ..ValidBoxRow::default()
        };
        (b, v)
    }

    fn merged(pairs: &[(BoxRow, ValidBoxRow)]) -> Merged {
        let (boxes, valid): (Vec<_>, Vec<_>) = pairs.iter().cloned().unzip();
        merge(&boxes, &valid, 1).expect("paired")
    }

    #[test]
    fn the_first_agent_gives_the_record_and_all_give_points() {
        let Merged { frames, tracks, .. } = merged(&[
            pair(0, "rsu_0", 4, 30, false, 9.0),
            pair(0, "vehicle_10", 4, 40, true, 8.0),
            pair(0, "vehicle_2", 4, 7, true, 7.0),
        ]);
        assert_eq!(frames.len(), 1);
        let row = &frames[0];
        assert_eq!((row.num_lidar_pts, row.num_radar_pts, row.valid_flag), (77, 3, true));
        assert_eq!(row.center_m[0], 7.0, "vehicle_2 comes before vehicle_10 and RSUs");
        assert_eq!(row.difficulty, "easy", "80 points; the distance doesn't count");
        assert_eq!(row.seen_by, ["vehicle_2", "vehicle_10"]);
        assert_eq!(tracks[0].model, "seen by vehicle_2");
        assert_eq!(tracks[0].max_speed_mps, 5.0);
    }

    #[test]
    fn the_way_goes_on_between_annotated_frames() {
        let places = [(0, 0.0), (4, 2.0), (8, 5.0), (16, 50.0)];
        let (boxes, valid): (Vec<_>, Vec<_>) =
            places.iter().map(|&(frame, x)| pair(frame, "vehicle_0", 4, 0, true, x)).unzip();
        let way = |every| merge(&boxes, &valid, every).expect("paired").tracks[0].path_m;
        assert_eq!((way(4), way(1), way(2)), (5.0, 0.0, 0.0), "frame 12 lacks");
        let seen = merge(&boxes, &valid, 4).expect("paired").sightings.remove(0);
        assert_eq!(
            (seen.seen_from, seen.seen_to),
            (vec![0, 16], vec![8, 16]),
            "and a sighting breaks there alone"
        );
    }

    #[test]
    fn tracks_count_frames_and_way() {
        let Merged { tracks, sightings, .. } = merged(&[
            pair(0, "vehicle_0", 4, 0, false, 0.0),
            pair(1, "vehicle_0", 4, 5, true, 2.0),
            pair(7, "rsu_0", 4, 0, true, 100.0),
            pair(8, "rsu_0", 4, 0, false, 101.0),
        ]);
        let t = &tracks[0];
        assert_eq!((t.first_frame, t.last_frame, t.frames, t.valid_frames), (0, 8, 4, 2));
        assert_eq!(t.path_m, 3.0, "the jump over the gap is no way");
        assert_eq!(t.seen_by, ["vehicle_0", "rsu_0"]);
        assert_eq!((t.num_lidar_pts, t.num_radar_pts), (5, 4));
        assert_eq!((t.first_valid_frame, t.last_valid_frame), (Some(1), Some(7)));
        let spans = |row: &SightingRow| (row.agent.clone(), row.first_frame, row.last_frame, row.frames);
        let spans: Vec<_> = sightings.iter().map(spans).collect();
        assert_eq!(spans, [("vehicle_0".into(), 0, 1, 2), ("rsu_0".into(), 7, 8, 2)]);
    }

    #[test]
    fn sightings_are_spans_without_a_break() {
        let seen = [true, true, false, true, false, false, true, true];
        let pairs: Vec<_> =
            seen.iter().zip(0..).map(|(valid, k)| pair(10 + k, "vehicle_1", 4, 2, *valid, 0.0)).collect();
        let row = &merged(&pairs).sightings[0];
        assert_eq!(
            (row.seen_from.as_slice(), row.seen_to.as_slice()),
            (&[10, 13, 16][..], &[11, 13, 17][..])
        );
        assert_eq!((row.num_lidar_pts, row.num_radar_pts, row.min_distance_m), (16, 8, 500.0));
        // Between two frames that are not neighbours there is a break, too.
        let gap = merged(&[pair(1, "rsu_0", 4, 2, true, 0.0), pair(5, "rsu_0", 4, 2, true, 0.0)]);
        assert_eq!(gap.sightings[0].seen_from, [1, 5]);
        let never = merged(&[pair(1, "rsu_0", 4, 0, false, 0.0)]);
        assert_eq!((never.tracks[0].first_valid_frame, never.sightings[0].seen_to.len()), (None, 0));
    }

    #[test]
    fn faults_are_named() {
        let (b, v) = pair(0, "vehicle_0", 4, 0, false, 0.0);
        let other = ValidBoxRow { id: 5, ..v.clone() };
        assert!(matches!(
            merge(std::slice::from_ref(&b), &[], 1),
            Err(TrackError::Lengths { boxes: 1, valid: 0 })
        ));
        assert!(matches!(
            merge(std::slice::from_ref(&b), &[other], 1),
            Err(TrackError::Mismatch { row: 0, .. })
        ));
        let (b, v) = (BoxRow { agent: "car".into(), ..b }, ValidBoxRow { agent: "car".into(), ..v });
        assert!(matches!(merge(&[b], &[v], 1), Err(TrackError::Agent { row: 0, .. })));
    }

    proptest! {
        #[test]
        fn merging_loses_no_point_and_ignores_order(
            rows in proptest::collection::btree_map((0..4_u32, 0..3_u16, 1..6_u16), (0..50_u32, any::<bool>()), 0..40),
        ) {
            let pairs: Vec<_> = rows
                .iter()
                .map(|(&(frame, agent, id), &(points, valid))| pair(frame, &AgentId::vehicle(agent).to_string(), id, points, valid, f64::from(agent)))
                .collect();
            let all = merged(&pairs);
            let backwards: Vec<_> = pairs.iter().rev().cloned().collect();
            prop_assert_eq!(&merged(&backwards), &all);
            let Merged { frames, tracks, sightings } = all;
            prop_assert_eq!(sightings.iter().map(|r| r.frames as usize).sum::<usize>(), pairs.len());
            let points: u64 = rows.values().map(|v| u64::from(v.0)).sum();
            prop_assert_eq!(frames.iter().map(|r| u64::from(r.num_lidar_pts)).sum::<u64>(), points);
            prop_assert_eq!(tracks.iter().map(|r| r.num_lidar_pts).sum::<u64>(), points);
            prop_assert_eq!(tracks.iter().map(|r| r.frames as usize).sum::<usize>(), frames.len());
            for row in &frames {
                let seen = pairs.iter().any(|(b, v)| (b.frame, b.id) == (row.frame, row.id) && v.valid_flag);
                prop_assert_eq!(row.valid_flag, seen);
                prop_assert_eq!(row.valid_flag, !row.seen_by.is_empty());
            }
        }
    }

    #[test]
    fn tracks_keep_the_size_of_who_stands() {
        let mut tracks = [4, 7].map(|id| TrackRow { id, size_m: [1.0; 3], ..TrackRow::default() });
        let mut windows = [7].map(|id| WindowRow { id, size_m: [2.0; 3], ..WindowRow::default() });
        stand(&mut tracks, &mut windows, &BTreeMap::from([(7, [0.4, 0.5, 1.7])]));
        assert_eq!(tracks.map(|row| row.size_m), [[1.0; 3], [0.4, 0.5, 1.7]]);
        assert_eq!(windows[0].size_m, [0.4, 0.5, 1.7]);
    }
}
