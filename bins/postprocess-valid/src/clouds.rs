//! An agent's lidar and radar readings, one frame at a time.

use frames::{Agent, Pose, World};
use scene::{SceneError, SceneReader, SensorFrames};
use schema::AgentId;
use schema::settings::Mount;
use schema::settings::stages::{RangeRig, RangeSensor};
use schema::table::{Framed, Row};
use schema::tables::{LidarRow, RadarRow};
use schema::{columns, framed, rate};
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

/// The open table of a range sensor.
struct Source<R> {
    mount: Mount,
    every_n_frames: u32,
    rows: SensorFrames<R>,
}

/// The open tables of an agent's range sensors.
pub(crate) struct Clouds {
    lidars: Vec<Source<LidarPoints>>,
    radars: Vec<Source<RadarPoints>>,
}

/// Points of one frame, in sensor frames.
pub(crate) struct Readings {
    lidars: Vec<(Mount, [Vec<f32>; 3])>,
    radars: Vec<(Mount, [Vec<f32>; 3])>,
}

impl Clouds {
    /// Opens the tables of a scene of so many frames.
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
        ) -> Result<Vec<Source<R>>, SceneError> {
            let open = |sensor: &RangeSensor| {
                let RangeSensor { name, mount, every_n_frames } = sensor;
                let rows = SensorFrames::open(scene, agent, name, (frames, *every_n_frames))?;
                Ok(Source { mount: *mount, every_n_frames: *every_n_frames, rows })
            };
            sensors.iter().map(open).collect()
        }
        Ok(Self {
            lidars: tables(scene, agent, &rig.lidars, frames)?,
            radars: tables(scene, agent, &rig.radars, frames)?,
        })
    }

    /// Reads the next frame, whose number is given: what those sensors gave that have readings at it.
    ///
    /// # Errors
    /// A table is broken, ends, or goes on with another frame.
    pub(crate) fn next_frame(&mut self, frame: u32) -> Result<Readings, SceneError> {
        let mut readings = Readings { lidars: Vec::new(), radars: Vec::new() };
        for source in &mut self.lidars {
            if let Some(row) = source.row(frame)? {
                readings.lidars.push((source.mount, [row.x, row.y, row.z]));
            }
        }
        for source in &mut self.radars {
            if let Some(row) = source.row(frame)? {
                let points = radar_to_cartesian(&row.depth, &row.altitude, &row.azimuth);
                readings.radars.push((source.mount, points));
            }
        }
        Ok(readings)
    }
}

impl<R: Row + Framed> Source<R> {
    fn row(&mut self, frame: u32) -> Result<Option<R>, SceneError> {
        if rate::is_due(frame, self.every_n_frames) { self.rows.next().transpose() } else { Ok(None) }
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
