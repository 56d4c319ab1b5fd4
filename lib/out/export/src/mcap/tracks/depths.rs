//! Depth pictures as metres.

use codecs::images::{ImageError, Limits, decode_png};
use scene::{SensorEntry, SensorFrames};
use schema::AgentId;
use schema::tables::CameraRow;

use super::Track;
use crate::mcap::chunk::Messages;
use crate::mcap::messages::{RawImage, Timestamp};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// Metres of the greatest code, 2^24 - 1.
const FAR_M: f64 = 1000.0;

/// Depth pictures of a camera.
pub(crate) struct DepthTrack {
    pictures: SensorFrames<CameraRow>,
    topic: Topic<RawImage>,
    frame_id: String,
    scene: u32,
    agent: AgentId,
}

impl DepthTrack {
    /// Of an agent's table of depth pictures.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        camera: &str,
        sensor: &SensorEntry,
        topics: &mut Topics,
    ) -> Result<Self, ExportError> {
        let facts = [("every_n_frames", sensor.about.every_n_frames.to_string()), ("unit", "m".to_owned())];
        let topic = topics.add(format!("/{agent}/{camera}/depth"), &facts)?;
        let pictures = scene.readings(agent, sensor)?;
        Ok(Self { pictures, topic, frame_id: format!("{agent}/{camera}"), scene: scene.number(), agent })
    }
}

impl Track for DepthTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        let Some(row) = self.pictures.at(frame)? else { return Ok(()) };
        let (width, height, metres) = decode(&row.image.0).map_err(|problem| ExportError::Content {
            scene: self.scene,
            frame: Some(frame),
            agent: Some(self.agent.to_string()),
            problem: format!(
                "depth picture of {}: {problem} (run render-sensors again with --force)",
                self.frame_id
            ),
        })?;
        let image = RawImage {
            timestamp: Timestamp::at(frame),
            width,
            height,
            encoding: "32FC1".into(),
            step: 4 * width,
            data: metres,
            frame_id: self.frame_id.clone(),
        };
        self.topic.send(frame, &image, out);
        Ok(())
    }
}

/// Width, height and metres as little-endian `f32` of a picture whose red is the lowest byte of the code.
fn decode(png: &[u8]) -> Result<(u32, u32, Vec<u8>), ImageError> {
    let image = decode_png(png, Limits::SENSOR)?;
    let codes = image.rgb.chunks_exact(3);
    let metres = codes.flat_map(|code| metres_of([code[0], code[1], code[2]]).to_le_bytes()).collect();
    Ok((image.width, image.height, metres))
}

fn metres_of([low, middle, high]: [u8; 3]) -> f32 {
    let code = u32::from_le_bytes([low, middle, high, 0]);
    (FAR_M * f64::from(code) / f64::from((1_u32 << 24) - 1)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_is_the_lowest_byte() {
        assert_eq!(metres_of([255; 3]), 1000.0);
        assert_eq!(metres_of([0; 3]), 0.0);
        // 16,777 of 16,777,215 is a metre less 13 micrometres.
        assert!((metres_of([0x89, 0x41, 0]) - 0.999_987).abs() < 1e-6);
        assert!(decode(b"no picture").is_err());
    }
}
