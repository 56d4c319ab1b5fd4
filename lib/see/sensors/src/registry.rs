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
    // A new field is read here, or it does not compile.
    let Rig { camera: _, cameras: _, lidars, radars, gnss, imu } = rig;
    visit_images(rig, carrier, visitor)?;
    for lidar in lidars {
        if lidar.semantic {
            visit_lidar::<SemanticLidarRow, V>(lidar, carrier, visitor)?;
        } else {
            visit_lidar::<LidarRow, V>(lidar, carrier, visitor)?;
        }
    }
    for radar in radars {
        visitor.visit(Radar::new(radar, carrier))?;
    }
    if let Some(gnss) = gnss {
        visitor.visit(Gnss::new(gnss, carrier))?;
    }
    if let Some(imu) = imu {
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

#[cfg(test)]
mod tests {
    use schema::{AgentId, ImageKind, ImageSet};
    use settings::PerAgent;
    use settings::stages::SensorSettings;

    use super::*;
    use crate::{GeoOrigin, Sensor, SensorError};

    struct Names(Vec<String>);

    impl SensorVisitor for Names {
        type Error = SensorError;

        fn visit<S: Sensor>(&mut self, sensor: S) -> Result<(), SensorError> {
            self.0.push(sensor.table().name);
            Ok(())
        }
    }

    #[test]
    fn of_every_sensor_it_is_said_what_its_table_depends_on() {
        let mut rig = Rig::vehicle();
        rig.lidars.push(rig.lidars[0].semantic());
        // Whatever is off by default is switched on.
        let Rig { camera: _, cameras, lidars, radars, gnss, imu } = &rig;
        assert!(!(cameras.is_empty() || lidars.is_empty() || radars.is_empty()));
        assert!(gnss.is_some() && imu.is_some());
        for (images, boxes) in [(ImageSet::of(ImageKind::ALL), true), (ImageSet::NONE, true)] {
            (rig.camera.images, rig.camera.boxes_2d) = (images, boxes);
            let agent = AgentId::vehicle(0);
            let carrier = SensorContext { seed: 1, scene: 0, agent, geo_origin: GeoOrigin::default() };
            let mut visited = Names(Vec::new());
            visit_sensors(&rig, &carrier, &mut visited).expect("all can be made");
            let rigs = PerAgent { vehicle: rig.clone(), rsu: Rig::rsu(), own: Vec::new() };
            let settings = SensorSettings { seed: 1, rigs };
            let mut told: Vec<String> = settings.tables(agent).into_iter().map(|table| table.name).collect();
            told.sort_unstable();
            visited.0.sort_unstable();
            assert_eq!(told, visited.0);
        }
    }
}
