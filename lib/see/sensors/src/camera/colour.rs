//! The colour image.

use random::Stream;
use schema::geometry::Snapshot;
use schema::images::{OfKind, Rgb};
use schema::tables::CameraRow;
use settings::Rig;

use super::encode;
use super::image::{Image, Images};
use crate::error::SensorError;
use crate::observation::Observation;
use crate::sensor::{Amount, Sensor, SensorContext, SensorTable};
use shading::Drops;
use shading::Noise;
use shading::Picture;
use shading::Sight;

impl Image for Rgb {
    type Row = CameraRow;

    fn of(_: &Snapshot, sight: &Sight, frame: u32) -> Result<CameraRow, SensorError> {
        let picture = sight.picture.as_ref().ok_or(SensorError::NoPainter)?;
        let image = encode::jpeg(picture, sight.view.settings.jpeg_quality)?;
        Ok(encode::camera_row(frame, image))
    }
}

/// Colour images of one camera, through the drops on its glass and with the noise of its chip.
pub(super) struct ColourImages {
    images: Images<Rgb>,
    drops: Option<Drops>,
    noise: Option<Noise>,
    stream: Stream,
}

impl ColourImages {
    pub(super) fn new(rig: &Rig, camera: usize, carrier: &SensorContext) -> Self {
        let (strength, drops) = (rig.camera.noise, rig.camera.lens_drops);
        let table = Rgb::KIND.table(&rig.cameras[camera].name);
        Self {
            images: Images::new(rig, camera),
            drops: (drops > 0.0).then(|| Drops::new(drops, carrier.stream(&format!("{table}/drops")))),
            noise: (strength > 0.0).then(|| Noise::new(strength)),
            stream: carrier.stream(&table),
        }
    }
}

impl Sensor for ColourImages {
    type Row = CameraRow;

    fn table(&self) -> SensorTable {
        self.images.table()
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<CameraRow>, SensorError> {
        let Some(sight) = self.images.sight(at) else { return Ok(Vec::new()) };
        let picture = sight.picture.as_ref().ok_or(SensorError::NoPainter)?;
        let rain = (at.weather.precipitation / 100.0).clamp(0.0, 1.0) as f32;
        let wet: Option<Picture> = self.drops.as_ref().and_then(|drops| drops.on(picture, at.frame, rain));
        let picture = wet.as_ref().unwrap_or(picture);
        let noisy = self.noise.as_ref().map(|noise| noise.on(picture, &self.stream, at.frame));
        let image = encode::jpeg(noisy.as_ref().unwrap_or(picture), sight.view.settings.jpeg_quality)?;
        Ok(vec![encode::camera_row(at.frame, image)])
    }

    fn amount(&self, rows: &[CameraRow]) -> Option<Amount> {
        self.images.amount(rows)
    }
}
