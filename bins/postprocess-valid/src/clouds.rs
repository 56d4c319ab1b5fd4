//! An agent's lidar and radar readings, one frame at a time.

use frames::{Agent, Pose, World};
use pipeline::{At, Place, StageError};
use schema::AgentId;
use schema::settings::Mount;
use schema::settings::stages::RangeRig;
use schema::tables::{LidarRow, RadarRow};
use store::{RowGroups, keys};
use validity::{PointCloud, radar_to_cartesian};

use crate::error::InputError;
use crate::{RENDER, Work};

/// The open tables of an agent's range sensors.
pub(crate) struct Clouds {
    lidars: Vec<(Mount, Rows<LidarRow>)>,
    radars: Vec<(Mount, Rows<RadarRow>)>,
}

/// Points of one frame, in sensor frames.
pub(crate) struct Readings {
    lidars: Vec<(Mount, [Vec<f32>; 3])>,
    radars: Vec<(Mount, [Vec<f32>; 3])>,
}

struct Rows<R> {
    place: Place,
    groups: RowGroups<R>,
    ready: std::vec::IntoIter<R>,
}

impl<R: schema::table::Row> Rows<R> {
    fn next(&mut self, frame: u32) -> Result<R, StageError> {
        let place = || self.place.clone().frame(frame);
        loop {
            if let Some(row) = self.ready.next() {
                return Ok(row);
            }
            match self.groups.next() {
                Some(group) => self.ready = group?.into_iter(),
                None => return Err(InputError::Ends).at(place),
            }
        }
    }
}

impl Clouds {
    /// Opens the tables.
    ///
    /// # Errors
    /// One is missing or broken.
    pub(crate) fn open(job: &Work<'_>, agent: AgentId, rig: &RangeRig) -> Result<Self, StageError> {
        fn rows<R: schema::table::Row>(
            job: &Work<'_>,
            agent: AgentId,
            name: &str,
        ) -> Result<Rows<R>, StageError> {
            let key = keys::sensor(job.scene(), agent, name);
            let groups = job.store().row_groups(job.input(RENDER)?, &key)?;
            let place = job.place().agent(agent).sensor(name).in_file(job.store().location(&key));
            Ok(Rows { place, groups, ready: Vec::new().into_iter() })
        }
        Ok(Self {
            lidars: rig
                .lidars
                .iter()
                .map(|l| Ok((l.mount, rows(job, agent, &l.name)?)))
                .collect::<Result<_, StageError>>()?,
            radars: rig
                .radars
                .iter()
                .map(|r| Ok((r.mount, rows(job, agent, &r.name)?)))
                .collect::<Result<_, StageError>>()?,
        })
    }

    /// Reads the next frame, which must be this one.
    ///
    /// # Errors
    /// A table is broken, ends, or goes on with another frame.
    pub(crate) fn next_frame(&mut self, frame: u32) -> Result<Readings, StageError> {
        let check = |found: u32, place: &Place| {
            if found == frame {
                return Ok(());
            }
            Err(InputError::OtherFrame { found }).at(|| place.clone().frame(frame))
        };
        let mut readings = Readings { lidars: Vec::new(), radars: Vec::new() };
        for (mount, rows) in &mut self.lidars {
            let row = rows.next(frame)?;
            check(row.frame, &rows.place)?;
            readings.lidars.push((*mount, [row.x, row.y, row.z]));
        }
        for (mount, rows) in &mut self.radars {
            let row = rows.next(frame)?;
            check(row.frame, &rows.place)?;
            readings.radars.push((*mount, radar_to_cartesian(&row.depth, &row.altitude, &row.azimuth)));
        }
        Ok(readings)
    }
}

impl Readings {
    /// Lidar and radar points with their sensors' poses.
    pub(crate) fn in_world(
        &self,
        world_from_agent: &Pose<World, Agent>,
    ) -> (Vec<PointCloud<'_>>, Vec<PointCloud<'_>>) {
        (clouds_of(&self.lidars, world_from_agent), clouds_of(&self.radars, world_from_agent))
    }
}

fn clouds_of<'a>(
    readings: &'a [(Mount, [Vec<f32>; 3])],
    world_from_agent: &Pose<World, Agent>,
) -> Vec<PointCloud<'a>> {
    readings
        .iter()
        .map(|(mount, [x, y, z])| PointCloud {
            world_from_sensor: *world_from_agent * mount.agent_from_sensor(),
            x,
            y,
            z,
        })
        .collect()
}
