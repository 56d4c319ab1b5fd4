//! What sensors' tables hold.

use crate::table::Row;
use crate::tables::{CameraRow, FlowRow, GnssRow, HalfFlowRow, ImuRow, LidarRow, RadarRow, SemanticLidarRow};
use crate::{ImageKind, SCENE_COLUMN};

/// What kind of readings a sensor's table holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SensorKind {
    /// Images of a kind of a camera.
    Image(ImageKind),
    /// Sweeps of a lidar.
    Lidar,
    /// Sweeps of a semantic lidar.
    SemanticLidar,
    /// Returns of a radar.
    Radar,
    /// Fixes of a GNSS receiver.
    Gnss,
    /// Readings of an IMU.
    Imu,
}

/// What rows of a type hold.
enum Holds {
    /// Images; the table's name begins with that of their kind.
    Images,
    Readings(SensorKind),
}

fn columns_of<R: Row>() -> Vec<&'static str> {
    R::fields().into_iter().map(|field| field.name).collect()
}

/// The row types of sensors' tables. A sensor of a new row type is a line here; a test finds one that is
/// forgotten.
fn row_types() -> [(Vec<&'static str>, Holds); 8] {
    [
        (columns_of::<CameraRow>(), Holds::Images),
        (columns_of::<FlowRow>(), Holds::Readings(SensorKind::Image(ImageKind::Flow))),
        (columns_of::<HalfFlowRow>(), Holds::Readings(SensorKind::Image(ImageKind::Flow))),
        (columns_of::<LidarRow>(), Holds::Readings(SensorKind::Lidar)),
        (columns_of::<SemanticLidarRow>(), Holds::Readings(SensorKind::SemanticLidar)),
        (columns_of::<RadarRow>(), Holds::Readings(SensorKind::Radar)),
        (columns_of::<GnssRow>(), Holds::Readings(SensorKind::Gnss)),
        (columns_of::<ImuRow>(), Holds::Readings(SensorKind::Imu)),
    ]
}

impl SensorKind {
    /// What a sensor's table holds, by its row type: its first columns besides that of the scene, in order,
    /// are those of the type. (Tables of lidars may have further ones.) `None`: no sensor's table.
    #[must_use]
    pub fn of_table(name: &str, columns: &[String]) -> Option<Self> {
        let columns = match columns {
            [first, own @ ..] if first == SCENE_COLUMN.name => own,
            all => all,
        };
        let is_of = |(of_type, _): &(Vec<&str>, Holds)| {
            columns.len() >= of_type.len() && of_type.iter().zip(columns).all(|(a, b)| a == b)
        };
        match row_types().into_iter().find(is_of)?.1 {
            Holds::Readings(kind) => Some(kind),
            Holds::Images => {
                let is_kind = |kind: &&ImageKind| {
                    name.strip_prefix(kind.spec().prefix).is_some_and(|camera| camera.starts_with('-'))
                };
                ImageKind::ALL.iter().find(is_kind).copied().map(Self::Image)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::every_table;

    fn of<R: Row>(name: &str) -> Option<SensorKind> {
        SensorKind::of_table(name, &columns_of::<R>().into_iter().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn row_types_tell_the_kind() {
        assert_eq!(of::<CameraRow>("SEG-CAM"), Some(SensorKind::Image(ImageKind::Semantic)));
        assert_eq!(of::<CameraRow>("CAM"), None);
        assert_eq!(of::<FlowRow>("FLW-CAM"), Some(SensorKind::Image(ImageKind::Flow)));
        assert_eq!(of::<LidarRow>("SEG-TOP"), Some(SensorKind::Lidar), "whatever it is called");
        assert_eq!(of::<SemanticLidarRow>("TOP"), Some(SensorKind::SemanticLidar));
        assert_eq!(of::<RadarRow>("FRONT"), Some(SensorKind::Radar));
        let further = [columns_of::<LidarRow>(), vec!["return_number"]].concat();
        let further: Vec<String> = further.into_iter().map(str::to_owned).collect();
        assert_eq!(SensorKind::of_table("TOP", &further), Some(SensorKind::Lidar));
        assert_eq!(SensorKind::of_table("TOP", &["frame".to_owned(), "ring".to_owned()]), None);
    }

    #[test]
    fn every_table_among_sensors_is_of_a_kind_or_of_none() {
        // Facts of images, and further columns of lidars.
        let of_none = ["sensors/{agent}/visible", "sensors/{agent}/boxes_2d", "sensors/{agent}/{lidar}"];
        for table in every_table().into_iter().filter(|table| table.name.starts_with("sensors/")) {
            let columns: Vec<String> = table.columns.iter().map(|(field, _)| field.name.to_owned()).collect();
            let is_known = SensorKind::of_table("RGB-CAM", &columns).is_some();
            assert!(
                is_known != of_none.contains(&table.name),
                "{}: say in `row_types` what sensor it is of, or that it is of none here",
                table.name
            );
        }
    }
}
