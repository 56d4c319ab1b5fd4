//! The colour image.

use random::Stream;
use schema::geometry::Snapshot;
use schema::images::{OfKind, Rgb};
use schema::settings::Rig;
use schema::tables::CameraRow;

use super::encode;
use super::image::{Image, Images};
use super::noise::Noise;
use super::sight::Sight;
use crate::error::SensorError;
use crate::observation::Observation;
use crate::sensor::{Amount, Carrier, Sensor, SensorTable};

impl Image for Rgb {
    type Row = CameraRow;

    fn of(_: &Snapshot, sight: &Sight, frame: u32) -> Result<CameraRow, SensorError> {
        let picture = sight.picture.as_ref().ok_or(SensorError::NoPainter)?;
        let image = encode::jpeg(picture, sight.view.settings.jpeg_quality)?;
        Ok(encode::camera_row(frame, image))
    }
}

/// Colour images of one camera, with the noise of its chip.
pub(super) struct ColourImages {
    images: Images<Rgb>,
    noise: Option<Noise>,
    stream: Stream,
}

impl ColourImages {
    pub(super) fn new(rig: &Rig, camera: usize, carrier: &Carrier) -> Self {
        let strength = rig.camera.noise;
        Self {
            images: Images::new(rig, camera),
            noise: (strength > 0.0).then(|| Noise::new(strength)),
            stream: carrier.stream(&Rgb::KIND.table(&rig.cameras[camera].name)),
        }
    }
}

impl Sensor for ColourImages {
    type Row = CameraRow;

    fn table(&self) -> SensorTable {
        self.images.table()
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<CameraRow>, SensorError> {
        let (Some(noise), Some(sight)) = (&self.noise, self.images.sight(at)) else {
            return self.images.sense(at);
        };
        let picture = sight.picture.as_ref().ok_or(SensorError::NoPainter)?;
        let image =
            encode::jpeg(&noise.on(picture, &self.stream, at.frame), sight.view.settings.jpeg_quality)?;
        Ok(vec![encode::camera_row(at.frame, image)])
    }

    fn amount(&self, rows: &[CameraRow]) -> Option<Amount> {
        self.images.amount(rows)
    }
}
