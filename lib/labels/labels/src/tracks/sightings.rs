//! When each agent saw an object.

use std::collections::BTreeMap;

use schema::tables::{BoxRow, SightingRow, ValidBoxRow};
use schema::{AgentId, ObjectId};

/// Sightings as they grow, frame by frame.
pub(crate) struct Sightings {
    rows: BTreeMap<(ObjectId, AgentId), SightingRow>,
    /// Frames from one list to the next.
    every_n_frames: u32,
}

impl Sightings {
    /// Of lists at every so many frames: these are neighbours.
    pub(crate) fn new(every_n_frames: u32) -> Self {
        Self { rows: BTreeMap::new(), every_n_frames: every_n_frames.max(1) }
    }

    /// Adds a record of an agent's list; of an agent and object frames come in ascending order.
    pub(crate) fn add(&mut self, agent: AgentId, listed: &BoxRow, judged: &ValidBoxRow) {
        let frame = listed.frame;
        let row = self.rows.entry((listed.id, agent)).or_insert_with(|| SightingRow {
            id: listed.id,
            agent: agent.to_string(),
            first_frame: frame,
            min_distance_m: f64::INFINITY,
            ..SightingRow::default()
        });
        row.last_frame = frame;
        row.frames += 1;
        row.num_lidar_pts += u64::from(judged.num_lidar_pts);
        row.num_radar_pts += u64::from(judged.num_radar_pts);
        row.min_distance_m = row.min_distance_m.min(listed.distance_m);
        if judged.valid_flag {
            match row.seen_to.last_mut() {
                // Several records of one object at one frame (light boxes) are one sighting.
                Some(last) if *last + self.every_n_frames >= frame => *last = frame,
                _ => {
                    row.seen_from.push(frame);
                    row.seen_to.push(frame);
                }
            }
        }
    }

    /// The rows, by object, then agent: vehicles by number, then RSUs.
    pub(crate) fn rows(self) -> Vec<SightingRow> {
        self.rows.into_values().collect()
    }
}
