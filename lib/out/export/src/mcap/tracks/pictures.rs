//! Pictures of a camera as they are in the store, each with the camera's calibration.

use scene::{SensorEntry, SensorFrames};
use schema::AgentId;
use schema::ImageKind;
use schema::calibration::Calibration;
use schema::images::ImageEncoding;
use schema::tables::CameraRow;
use settings::Lens;

use super::Track;
use crate::mcap::chunk::{Compression, Messages};
use crate::mcap::messages::{CameraCalibration, CompressedImage, Timestamp};
use crate::mcap::topics::{Topic, Topics};
use crate::{ExportError, SceneSource};

/// A camera.
pub(crate) struct CameraTrack {
    kinds: Vec<KindOfPicture>,
    calibration: CameraCalibration,
    /// How often the tables have readings: the calibration goes with any of them.
    rates: Vec<u32>,
    topic: Topic<CameraCalibration>,
}

struct KindOfPicture {
    pictures: SensorFrames<CameraRow>,
    topic: Topic<CompressedImage>,
    format: &'static str,
}

/// The last part of the topic of a kind of pictures; none of those that are no encoded pictures as people
/// look at them.
pub(crate) fn topic_of(kind: ImageKind) -> Option<&'static str> {
    match kind {
        ImageKind::Rgb => Some("image"),
        ImageKind::Semantic => Some("semantic"),
        ImageKind::Instance => Some("instance"),
        ImageKind::Depth | ImageKind::Flow => None,
    }
}

impl CameraTrack {
    /// Of the tables of one camera of an agent; those that are no encoded pictures count for the calibration
    /// alone.
    pub(crate) fn open(
        scene: &SceneSource,
        agent: AgentId,
        camera: &str,
        tables: &[(&SensorEntry, ImageKind)],
        topics: &mut Topics,
    ) -> Result<Option<Self>, ExportError> {
        let Some((first, _)) = tables.first() else { return Ok(None) };
        let frame_id = format!("{agent}/{camera}");
        let Some(calibration) = calibration_of(&first.about, &frame_id) else {
            let problem = format!(
                "{camera}: its table has no size or intrinsics (run render-sensors again with --force)"
            );
            let agent = Some(agent.to_string());
            return Err(ExportError::Content { scene: scene.number(), frame: None, agent, problem });
        };
        let rate = |sensor: &SensorEntry| [("every_n_frames", sensor.about.every_n_frames.to_string())];
        let mut kinds = Vec::new();
        for (sensor, kind) in tables {
            let Some(last) = topic_of(*kind) else { continue };
            let topic = topics.add(format!("/{agent}/{camera}/{last}"), &rate(sensor))?;
            let format = if kind.spec().encoding == ImageEncoding::Jpeg { "jpeg" } else { "png" };
            kinds.push(KindOfPicture { pictures: scene.readings(agent, sensor)?, topic, format });
        }
        let topic = topics.add(format!("/{agent}/{camera}/calibration"), &rate(first))?;
        let rates = tables.iter().map(|(sensor, _)| sensor.about.every_n_frames).collect();
        Ok(Some(Self { kinds, calibration, rates, topic }))
    }
}

impl Track for CameraTrack {
    fn messages(&mut self, frame: u32, out: &mut Messages) -> Result<(), ExportError> {
        for KindOfPicture { pictures, topic, format } in &mut self.kinds {
            let Some(row) = pictures.at(frame)? else { continue };
            let image = CompressedImage {
                timestamp: Timestamp::at(frame),
                data: row.image.0,
                format: (*format).to_owned(),
                frame_id: self.calibration.frame_id.clone(),
            };
            topic.send(frame, &image, out);
        }
        if self.rates.iter().any(|rate| schema::rate::is_due(frame, *rate)) {
            self.calibration.timestamp = Timestamp::at(frame);
            self.topic.send(frame, &self.calibration, out);
        }
        Ok(())
    }

    fn compression(&self) -> Compression {
        Compression::None
    }
}

/// Intrinsics in OpenCV's words; none where the table does not state them.
fn calibration_of(about: &Calibration, frame_id: &str) -> Option<CameraCalibration> {
    let k = about.intrinsics?;
    let (model, coefficients) = match about.lens.unwrap_or_default() {
        Lens::Pinhole => ("plumb_bob", vec![0.0; 5]),
        Lens::Brown { k: [k1, k2, k3], p: [p1, p2] } => ("plumb_bob", vec![k1, k2, p1, p2, k3]),
        Lens::Fisheye { k } => ("kannala_brandt", k.to_vec()),
    };
    Some(CameraCalibration {
        timestamp: Timestamp::default(),
        width: about.width?,
        height: about.height?,
        distortion_model: model.to_owned(),
        D: coefficients,
        K: k.concat(),
        R: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P: k.iter().flat_map(|[a, b, c]| [*a, *b, *c, 0.0]).collect(),
        frame_id: frame_id.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use schema::calibration::Mounting;

    use super::*;

    fn about(lens: Option<Lens>) -> Calibration {
        Calibration {
            name: "C".into(),
            frame: "optical".into(),
            agent_from_sensor: Mounting { translation: [0.0; 3], quaternion: [1.0, 0.0, 0.0, 0.0] },
            every_n_frames: 1,
            width: Some(8),
            height: Some(6),
            intrinsics: Some([[5.0, 0.0, 4.0], [0.0, 5.0, 3.0], [0.0, 0.0, 1.0]]),
            lens,
        }
    }

    #[test]
    fn lenses_speak_opencv() {
        let plain = calibration_of(&about(None), "a/C").expect("is a camera");
        assert_eq!((plain.distortion_model.as_str(), plain.D), ("plumb_bob", vec![0.0; 5]));
        assert_eq!(plain.K, [5.0, 0.0, 4.0, 0.0, 5.0, 3.0, 0.0, 0.0, 1.0]);
        assert_eq!(plain.P, [5.0, 0.0, 4.0, 0.0, 0.0, 5.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let brown = Lens::Brown { k: [1.0, 2.0, 3.0], p: [4.0, 5.0] };
        // OpenCV's order: k1, k2, p1, p2, k3.
        assert_eq!(calibration_of(&about(Some(brown)), "").expect("is one").D, [1.0, 2.0, 4.0, 5.0, 3.0]);
        let fisheye = calibration_of(&about(Some(Lens::Fisheye { k: [1.0, 2.0, 3.0, 4.0] })), "");
        let fisheye = fisheye.expect("is one");
        assert_eq!((fisheye.distortion_model.as_str(), fisheye.D.len()), ("kannala_brandt", 4));
        assert_eq!(calibration_of(&Calibration { intrinsics: None, ..about(None) }, ""), None);
    }
}
