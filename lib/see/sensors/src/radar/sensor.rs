//! A radar as one of an agent's sensors.

use random::Stream;
use schema::measures::sensors::RADAR_POINTS;
use schema::tables::RadarRow;
use settings::RadarSpec;

use super::instrument::{RadarQuery, radars};
use crate::error::SensorError;
use crate::metadata::sensor_metadata;
use crate::observation::Observation;
use crate::sensor::{Amount, Layout, Sensor, SensorContext, SensorTable};

/// A radar of an agent.
pub(crate) struct Radar {
    spec: RadarSpec,
    stream: Stream,
}

impl Radar {
    pub(crate) fn new(spec: &RadarSpec, carrier: &SensorContext) -> Self {
        Self { spec: spec.clone(), stream: carrier.stream(&spec.name) }
    }
}

impl Sensor for Radar {
    type Row = RadarRow;

    fn table(&self) -> SensorTable {
        let every = self.spec.every_n_frames;
        let about = sensor_metadata(&self.spec.name, &self.spec.mount, every);
        SensorTable::new(&self.spec.name, Some(about), Layout::Frames, every)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<RadarRow>, SensorError> {
        let returns = match at.radar_returns.get(&self.spec.name) {
            Some(returns) => returns.clone(),
            None => {
                let motion = at.radar_motion(&self.spec.mount);
                let query = RadarQuery { spec: &self.spec, motion, stream: &self.stream };
                radars(at.scene, &[query], at.frame)?.pop().unwrap_or_default()
            }
        };
        Ok(vec![returns.into_row(at.frame)])
    }

    fn amount(&self, rows: &[RadarRow]) -> Option<Amount> {
        let count = rows.iter().map(|row| row.depth.len() as u64).sum();
        Some(Amount { measure: RADAR_POINTS, count })
    }
}
