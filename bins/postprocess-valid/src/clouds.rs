//! An agent's lidar and radar readings, one frame at a time.

use frames::{Agent, Pose, World};
use labels::validity::{PointCloud, radar_to_cartesian};
use scene::{SceneError, SceneReader, SensorFrames};
use schema::tables::{LidarRow, RadarRow};
use schema::{AgentId, ReturnKind, columns, framed, rate};
use settings::Mount;
use settings::stages::{RangeRig, RangeSensor};

columns! {
    /// Where a lidar's returns are.
    LidarPoints of LidarRow { frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32> }
}

columns! {
    /// The same of a lidar that may see rain and fog, and which returns these are.
    LidarReturns of LidarRow { frame: u32, x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, return_kind: Vec<u8> }
}

columns! {
    /// Where a radar's returns are.
    RadarPoints of RadarRow { frame: u32, depth: Vec<f32>, altitude: Vec<f32>, azimuth: Vec<f32> }
}

framed!(LidarPoints, LidarReturns, RadarPoints);

/// The open table of a lidar.
enum LidarTable {
    Plain(SensorFrames<LidarPoints>),
    Told(SensorFrames<LidarReturns>),
}

/// The open table of a range sensor.
struct Source<T> {
    mount: Mount,
    every_n_frames: u32,
    rows: T,
}

/// The open tables of an agent's range sensors.
pub(crate) struct Clouds {
    lidars: Vec<Source<LidarTable>>,
    radars: Vec<Source<SensorFrames<RadarPoints>>>,
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
        let lidar = |s: &RangeSensor| {
            let frames = (frames, s.every_n_frames);
            let rows = if s.tells_returns {
                LidarTable::Told(SensorFrames::open(scene, agent, &s.name, frames)?)
            } else {
                LidarTable::Plain(SensorFrames::open(scene, agent, &s.name, frames)?)
            };
            Ok(Source { mount: s.mount, every_n_frames: s.every_n_frames, rows })
        };
        let radar = |s: &RangeSensor| {
            let rows = SensorFrames::open(scene, agent, &s.name, (frames, s.every_n_frames))?;
            Ok(Source { mount: s.mount, every_n_frames: s.every_n_frames, rows })
        };
        Ok(Self {
            lidars: rig.lidars.iter().map(lidar).collect::<Result<_, SceneError>>()?,
            radars: rig.radars.iter().map(radar).collect::<Result<_, SceneError>>()?,
        })
    }

    /// Reads the next frame, whose number is given: what those sensors gave that have readings at it.
    ///
    /// # Errors
    /// A table is broken, ends, or goes on with another frame.
    pub(crate) fn next_frame(&mut self, frame: u32) -> Result<Readings, SceneError> {
        let mut readings = Readings { lidars: Vec::new(), radars: Vec::new() };
        for source in self.lidars.iter_mut().filter(|source| source.is_due(frame)) {
            let points = match &mut source.rows {
                LidarTable::Plain(rows) => rows.next().transpose()?.map(|row| [row.x, row.y, row.z]),
                LidarTable::Told(rows) => rows.next().transpose()?.map(|row| of_surfaces(&row)),
            };
            readings.lidars.extend(points.map(|points| (source.mount, points)));
        }
        for source in self.radars.iter_mut().filter(|source| source.is_due(frame)) {
            if let Some(row) = source.rows.next().transpose()? {
                let points = radar_to_cartesian(&row.depth, &row.altitude, &row.azimuth);
                readings.radars.push((source.mount, points));
            }
        }
        Ok(readings)
    }
}

impl<T> Source<T> {
    fn is_due(&self, frame: u32) -> bool {
        rate::is_due(frame, self.every_n_frames)
    }
}

/// Points on surfaces: no object is seen by a drop of rain within its box.
fn of_surfaces(row: &LidarReturns) -> [Vec<f32>; 3] {
    [&row.x, &row.y, &row.z].map(|axis| {
        let kinds = axis.iter().zip(&row.return_kind);
        kinds.filter(|(_, kind)| ReturnKind::is_of_surface(**kind)).map(|(value, _)| *value).collect()
    })
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
