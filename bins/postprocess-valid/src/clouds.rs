//! An agent's lidar and radar readings, one frame at a time.

use frames::{Agent, Pose, World};
use scene::{SceneError, SceneReader, SensorFrames};
use schema::AgentId;
use schema::settings::Mount;
use schema::settings::stages::{RangeRig, RangeSensor};
use schema::table::{Framed, Row};
use schema::tables::{LidarRow, RadarRow};
use schema::{columns, framed};
use validity::{PointCloud, radar_to_cartesian};

columns! {
    /// Where a lidar's returns are.
    LidarPoints of LidarRow { frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32> }
}

columns! {
    /// Where a radar's returns are.
    RadarPoints of RadarRow { frame: u32, depth: Vec<f32>, altitude: Vec<f32>, azimuth: Vec<f32> }
}

framed!(LidarPoints, RadarPoints);

/// The open tables of an agent's range sensors.
pub(crate) struct Clouds {
    lidars: Vec<(Mount, SensorFrames<LidarPoints>)>,
    radars: Vec<(Mount, SensorFrames<RadarPoints>)>,
}

/// Points of one frame, in sensor frames.
pub(crate) struct Readings {
    lidars: Vec<(Mount, [Vec<f32>; 3])>,
    radars: Vec<(Mount, [Vec<f32>; 3])>,
}

impl Clouds {
    /// Opens the tables, each of so many frames.
    ///
    /// # Errors
    /// One is missing or broken.
    pub(crate) fn open(
        scene: &SceneReader,
        agent: AgentId,
        rig: &RangeRig,
        frames: u32,
    ) -> Result<Self, SceneError> {
        fn tables<R: Row + Framed>(
            scene: &SceneReader,
            agent: AgentId,
            sensors: &[RangeSensor],
            frames: u32,
        ) -> Result<Vec<(Mount, SensorFrames<R>)>, SceneError> {
            sensors
                .iter()
                .map(|s| Ok((s.mount, SensorFrames::open(scene, agent, &s.name, frames)?)))
                .collect()
        }
        Ok(Self {
            lidars: tables(scene, agent, &rig.lidars, frames)?,
            radars: tables(scene, agent, &rig.radars, frames)?,
        })
    }

    /// Reads the next frame.
    ///
    /// # Errors
    /// A table is broken, ends, or goes on with another frame.
    pub(crate) fn next_frame(&mut self) -> Result<Readings, SceneError> {
        let mut readings = Readings { lidars: Vec::new(), radars: Vec::new() };
        for (mount, rows) in &mut self.lidars {
            if let Some(row) = rows.next().transpose()? {
                readings.lidars.push((*mount, [row.x, row.y, row.z]));
            }
        }
        for (mount, rows) in &mut self.radars {
            if let Some(row) = rows.next().transpose()? {
                readings.radars.push((*mount, radar_to_cartesian(&row.depth, &row.altitude, &row.azimuth)));
            }
        }
        Ok(readings)
    }
}

impl Readings {
    /// Lidars and their points.
    pub(crate) fn lidars(&self) -> &[(Mount, [Vec<f32>; 3])] {
        &self.lidars
    }

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
