//! The list of all sensors: one line a kind.

use schema::settings::Rig;

use crate::camera::{Boxes2d, VisibleObjects, visit_images};
use crate::gnss::Gnss;
use crate::imu::Imu;
use crate::lidar::{PlainLidar, SemanticLidar};
use crate::radar::Radar;
use crate::sensor::{Carrier, SensorVisitor};

/// Shows every sensor of a rig, in a fixed order.
///
/// # Errors
/// A sensor's settings are impossible, or the visitor's own.
pub fn visit_sensors<V: SensorVisitor>(
    rig: &Rig,
    carrier: &Carrier,
    visitor: &mut V,
) -> Result<(), V::Error> {
    visit_images(rig, visitor)?;
    for lidar in &rig.lidars {
        if lidar.semantic {
            visitor.visit(SemanticLidar::new(lidar, carrier)?)?;
        } else {
            visitor.visit(PlainLidar::new(lidar, carrier)?)?;
        }
    }
    for radar in &rig.radars {
        visitor.visit(Radar::new(radar, carrier))?;
    }
    if let Some(gnss) = &rig.gnss {
        visitor.visit(Gnss::new(gnss, carrier))?;
    }
    if let Some(imu) = &rig.imu {
        visitor.visit(Imu::new(imu, carrier))?;
    }
    if let Some(visible) = VisibleObjects::of(rig) {
        visitor.visit(visible)?;
    }
    if let Some(boxes) = Boxes2d::of(rig) {
        visitor.visit(boxes)?;
    }
    Ok(())
}
