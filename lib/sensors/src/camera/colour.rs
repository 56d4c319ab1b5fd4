//! The colour image.

use schema::geometry::Snapshot;
use schema::images::Rgb;
use schema::tables::CameraRow;

use super::encode;
use super::image::Image;
use super::sight::Sight;
use crate::error::SensorError;

impl Image for Rgb {
    type Row = CameraRow;

    fn of(_: &Snapshot, sight: &Sight, frame: u32) -> Result<CameraRow, SensorError> {
        let picture = sight.picture.as_ref().ok_or(SensorError::NoPainter)?;
        let image = encode::jpeg(picture, sight.view.settings.jpeg_quality)?;
        Ok(encode::camera_row(frame, image))
    }
}
