//! Boxes of all agents together: one for each object.

use schema::table::Row;
use schema::tables::TrackFrameRow;
use store::{RowGroups, keys};

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::drawn::{Drawn, speed_text};
use crate::mcap::messages::{KeyValuePair, SceneEntity, SceneUpdate};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// The merged boxes of a scene.
pub(crate) struct MergedTrack {
    groups: RowGroups<TrackFrameRow>,
    ready: std::vec::IntoIter<TrackFrameRow>,
    /// A row of a later frame.
    held: Option<TrackFrameRow>,
    topic: Topic<SceneUpdate>,
    every_n_frames: u32,
    lifetime_frames: u32,
}

impl MergedTrack {
    /// Of a scene; boxes are drawn for so many frames.
    pub(crate) fn open(
        scene: &SceneSource,
        lifetime_frames: u32,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let every_n_frames = scene.info().label_every_n_frames;
        let topic = topics.add("/boxes".into(), &[("every_n_frames", every_n_frames.to_string())])?;
        let key = keys::table::<TrackFrameRow>(scene.number());
        let reader = scene.reader();
        let groups = reader.store().row_groups(reader.manifest(TrackFrameRow::STAGE)?, &key)?;
        let ready = Vec::new().into_iter();
        Ok(Self { groups, ready, held: None, topic, every_n_frames, lifetime_frames })
    }

    /// The rows of a frame; those of frames before it are passed over.
    fn at(&mut self, frame: u32) -> Result<Vec<TrackFrameRow>, ExportError> {
        let mut found = Vec::new();
        loop {
            let row = match self.held.take().or_else(|| self.ready.next()) {
                Some(row) => row,
                None => match self.groups.next() {
                    Some(group) => {
                        self.ready = group?.into_iter();
                        continue;
                    }
                    None => return Ok(found),
                },
            };
            if row.frame > frame {
                self.held = Some(row);
                return Ok(found);
            }
            if row.frame == frame {
                found.push(row);
            }
        }
    }
}

impl Track for MergedTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        if schema::rate::is_due(frame, self.every_n_frames) {
            let rows = self.at(frame)?;
            let entities = rows.iter().map(|row| entity(row, self.lifetime_frames)).collect();
            self.topic.send(frame, &SceneUpdate { entities, ..SceneUpdate::default() }, out);
        }
        Ok(())
    }
}

fn entity(row: &TrackFrameRow, lifetime_frames: u32) -> SceneEntity {
    let mut metadata = vec![
        KeyValuePair::of("class", &row.class),
        KeyValuePair::of("speed_mps", speed_text(row.velocity_mps)),
        KeyValuePair::of("valid_flag", row.valid_flag),
        KeyValuePair::of("difficulty", &row.difficulty),
        KeyValuePair::of("num_lidar_pts", row.num_lidar_pts),
        KeyValuePair::of("num_radar_pts", row.num_radar_pts),
        KeyValuePair::of("seen_by", row.seen_by.join(" ")),
    ];
    metadata.extend(row.signal_state.map(|state| KeyValuePair::of("signal_state", state)));
    metadata.push(KeyValuePair::of("attributes", &row.attributes));
    let drawn = Drawn {
        id: row.id,
        class: &row.class,
        center_m: row.center_m,
        size_m: row.size_m,
        rpy_rad: row.rpy_rad,
        velocity_mps: row.velocity_mps,
        is_seen: Some(row.valid_flag),
    };
    drawn.entity(row.frame, lifetime_frames, metadata)
}
