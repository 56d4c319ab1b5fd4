//! The list of all sensors: one line a kind.

use schema::Joined;
use schema::tables::{LidarReturnsRow, LidarRow, SemanticLidarRow};
use settings::{LidarSpec, Rig};

use crate::camera::{Boxes2d, VisibleObjects, visit_images};
use crate::gnss::Gnss;
use crate::imu::Imu;
use crate::lidar::{LidarSensor, SweepRow};
use crate::radar::Radar;
use crate::sensor::{SensorContext, SensorVisitor};

/// Shows every sensor of a rig, in a fixed order.
///
/// # Errors
/// A sensor's settings are impossible, or the visitor's own.
pub fn visit_sensors<V: SensorVisitor>(
    rig: &Rig,
    carrier: &SensorContext,
    visitor: &mut V,
) -> Result<(), V::Error> {
    visit_images(rig, carrier, visitor)?;
    for lidar in &rig.lidars {
        if lidar.semantic {
            visit_lidar::<SemanticLidarRow, V>(lidar, carrier, visitor)?;
        } else {
            visit_lidar::<LidarRow, V>(lidar, carrier, visitor)?;
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

/// Shows a lidar with the columns that its settings ask for.
fn visit_lidar<R: SweepRow, V: SensorVisitor>(
    lidar: &LidarSpec,
    carrier: &SensorContext,
    visitor: &mut V,
) -> Result<(), V::Error> {
    if lidar.tells_returns() {
        visitor.visit(LidarSensor::<Joined<R, LidarReturnsRow>>::new(lidar, carrier)?)
    } else {
        visitor.visit(LidarSensor::<R>::new(lidar, carrier)?)
    }
}
