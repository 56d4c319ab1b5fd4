//! Radars of one agent, whose rays are followed together.

use std::collections::BTreeMap;

use random::Stream;
use render::Scene;
use schema::rate;
use settings::{Mount, RadarSpec, Rig};

use super::instrument::{RadarMotion, RadarQuery, RadarReturns, radars};
use crate::error::SensorError;

/// The radars of an agent whose tables are made, with their random numbers.
pub struct Radars(Vec<(RadarSpec, Stream)>);

impl Radars {
    /// Those of a rig whose tables are made, by the tables' names; each has the random numbers of its name.
    pub fn for_tables(rig: &Rig, stream: impl Fn(&str) -> Stream, is_made: impl Fn(&str) -> bool) -> Self {
        let made = rig.radars.iter().filter(|spec| is_made(&spec.name));
        Self(made.map(|spec| (spec.clone(), stream(&spec.name))).collect())
    }

    /// What those that are due at a frame read, by name.
    ///
    /// # Errors
    /// The renderer failed.
    pub(crate) fn read(
        &self,
        scene: &dyn Scene,
        frame: u32,
        motion: impl Fn(&Mount) -> RadarMotion,
    ) -> Result<BTreeMap<String, RadarReturns>, SensorError> {
        let due = || self.0.iter().filter(|(spec, _)| rate::is_due(frame, spec.every_n_frames));
        let queries: Vec<RadarQuery<'_>> =
            due().map(|(spec, stream)| RadarQuery { spec, motion: motion(&spec.mount), stream }).collect();
        let names = due().map(|(spec, _)| spec.name.clone());
        Ok(names.zip(radars(scene, &queries, frame)?).collect())
    }
}
