//! A lidar as one of an agent's sensors.

use std::marker::PhantomData;

use random::Stream;
use schema::measures::sensors::LIDAR_POINTS;
use settings::LidarSpec;

use super::instrument::Lidar;
use super::sweep::SweepRow;
use crate::error::SensorError;
use crate::metadata::sensor_metadata;
use crate::observation::Observation;
use crate::sensor::{Amount, Layout, Sensor, SensorContext, SensorTable};

/// A lidar of an agent, with the rows of its table.
pub(crate) struct LidarSensor<R> {
    lidar: Lidar,
    stream: Stream,
    rows: PhantomData<fn() -> R>,
}

impl<R> LidarSensor<R> {
    pub(crate) fn new(spec: &LidarSpec, carrier: &SensorContext) -> Result<Self, SensorError> {
        Ok(Self { lidar: Lidar::new(spec)?, stream: carrier.stream(&spec.name), rows: PhantomData })
    }
}

impl<R: SweepRow> Sensor for LidarSensor<R> {
    type Row = R;

    fn table(&self) -> SensorTable {
        let spec = self.lidar.spec();
        let every = spec.every_n_frames;
        let about = sensor_metadata(&spec.name, &spec.mount, every);
        SensorTable::new(&spec.name, Some(about), Layout::Frames, every)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<R>, SensorError> {
        let Self { lidar, stream, .. } = self;
        let moment = at.lidar_moment(&lidar.spec().mount);
        let sweep = match at.scans.iter().find(|shared| shared.is_of(lidar.spec())) {
            Some(shared) => lidar.sweep_of(&shared.scan, at.scene, &moment, stream),
            None => lidar.sweep(at.scene, &moment, stream)?,
        };
        Ok(vec![R::of(sweep, at.frame)])
    }

    fn amount(&self, rows: &[R]) -> Option<Amount> {
        let count = rows.iter().map(|row| row.returns() as u64).sum();
        Some(Amount { measure: LIDAR_POINTS, count })
    }
}
