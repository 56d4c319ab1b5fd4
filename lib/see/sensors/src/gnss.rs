//! GNSS receivers.

use frames::{Agent, Pose, World};
use random::Stream;
use schema::tables::{GNSS_TABLE, GnssRow};
use settings::GnssSpec;

use crate::error::SensorError;
use crate::geo::GeoOrigin;
use crate::metadata::sensor_metadata;
use crate::noise::normals;
use crate::observation::Observation;
use crate::sensor::{Layout, Sensor, SensorContext, SensorTable};

/// One fix, with noise: frame `f` reads the random words at `f`.
#[must_use]
pub fn gnss(
    spec: &GnssSpec,
    origin: &GeoOrigin,
    world_from_agent: &Pose<World, Agent>,
    stream: &random::Stream,
    frame: u32,
) -> GnssRow {
    let antenna = *world_from_agent * spec.mount.agent_from_sensor();
    let [latitude, longitude, altitude] = origin.geodetic_from_world(antenna.xyz());
    let [n0, n1, n2, _] = normals(stream, u64::from(frame));
    GnssRow {
        frame,
        time_s: crate::frame_time_s(frame),
        latitude_deg: latitude + spec.noise_deg[0] * n0,
        longitude_deg: longitude + spec.noise_deg[1] * n1,
        altitude_m: altitude + spec.noise_altitude_m * n2,
    }
}

/// The GNSS receiver of an agent.
pub(crate) struct Gnss {
    spec: GnssSpec,
    origin: GeoOrigin,
    stream: Stream,
}

impl Gnss {
    pub(crate) fn new(spec: &GnssSpec, carrier: &SensorContext) -> Self {
        Self { spec: spec.clone(), origin: carrier.geo_origin, stream: carrier.stream(GNSS_TABLE) }
    }
}

impl Sensor for Gnss {
    type Row = GnssRow;

    fn table(&self) -> SensorTable {
        let every = self.spec.every_n_frames;
        let about = sensor_metadata(GNSS_TABLE, &self.spec.mount, every);
        SensorTable::new(GNSS_TABLE, Some(about), Layout::Whole, every)
    }

    fn sense(&self, at: &Observation<'_>) -> Result<Vec<GnssRow>, SensorError> {
        let pose = &at.agent.motion.world_from_agent;
        Ok(vec![gnss(&self.spec, &self.origin, pose, &self.stream, at.frame)])
    }
}
