//! Boxes of an agent's list, with what its sensors saw of them.

use scene::{BoxFrames, LabelledBox};
use schema::AgentId;

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::drawn::{Drawn, speed_text};
use crate::mcap::messages::{KeyValuePair, SceneEntity, SceneUpdate};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// An agent's boxes.
pub(crate) struct BoxTrack {
    boxes: BoxFrames,
    topic: Topic<SceneUpdate>,
    every_n_frames: u32,
    lifetime_frames: u32,
}

impl BoxTrack {
    /// Of an agent; boxes are drawn for so many frames.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        lifetime_frames: u32,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let every_n_frames = scene.info().label_every_n_frames;
        let facts = [("every_n_frames", every_n_frames.to_string())];
        let topic = topics.add(format!("/{agent}/boxes"), &facts)?;
        Ok(Self { boxes: scene.boxes(agent)?, topic, every_n_frames, lifetime_frames })
    }
}

impl Track for BoxTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        if schema::rate::is_due(frame, self.every_n_frames) {
            let boxes = self.boxes.at(frame)?;
            let entities = boxes.iter().map(|found| entity(found, frame, self.lifetime_frames)).collect();
            self.topic.send(frame, &SceneUpdate { entities, ..SceneUpdate::default() }, out);
        }
        Ok(())
    }
}

fn entity(found: &LabelledBox, frame: u32, lifetime_frames: u32) -> SceneEntity {
    let LabelledBox { raw, seen } = found;
    let mut metadata = vec![
        KeyValuePair::of("class", &raw.class),
        KeyValuePair::of("model", &raw.model),
        KeyValuePair::of("speed_mps", speed_text(raw.velocity_mps)),
        KeyValuePair::of("distance_m", format!("{:.2}", raw.distance_m)),
    ];
    metadata.extend(raw.signal_state.map(|state| KeyValuePair::of("signal_state", state)));
    if let Some(seen) = seen {
        metadata.extend([
            KeyValuePair::of("valid_flag", seen.valid_flag),
            KeyValuePair::of("difficulty", &seen.difficulty),
            KeyValuePair::of("num_lidar_pts", seen.num_lidar_pts),
            KeyValuePair::of("num_radar_pts", seen.num_radar_pts),
            KeyValuePair::of("num_pixels", seen.num_pixels),
        ]);
    }
    metadata.push(KeyValuePair::of("attributes", &raw.attributes));
    let drawn = Drawn {
        id: raw.id,
        class: &raw.class,
        center_m: raw.center_m,
        size_m: raw.size_m,
        rpy_rad: raw.rpy_rad,
        velocity_mps: raw.velocity_mps,
        is_seen: seen.as_ref().map(|seen| seen.valid_flag),
    };
    drawn.entity(frame, lifetime_frames, metadata)
}
