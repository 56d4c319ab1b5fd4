//! The world at any frame of a log.

use std::sync::Arc;

use opendrive::Map;
use pipeline::{At, Job, StageError, StageSettings};
use schema::geometry::{Snapshot, TriMesh};
use world::{Moment, SceneWorld};

use crate::log::SceneLog;
use crate::map::read_map;

/// A log with the map and meshes it speaks of.
pub struct Replay {
    /// The log.
    pub log: SceneLog,
    /// The map.
    pub map: Map,
    world: SceneWorld,
}

impl Replay {
    /// Opens the log of a job's scene and builds its meshes.
    ///
    /// # Errors
    /// The log or the map is missing or broken, or an actor has no mesh.
    pub fn open<S: StageSettings>(job: &Job<'_, S>) -> Result<Self, StageError> {
        let log = SceneLog::read(job)?;
        let map = read_map(job.store(), &log.info.map, &log.info.map_hash)?;
        let mut world = SceneWorld::new(&map, &log.actors).at(|| job.place())?;
        world.set_lamps(&log.lamps);
        Ok(Self { log, map, world })
    }

    /// All meshes; a snapshot's mesh numbers are indices into them.
    #[must_use]
    pub fn meshes(&self) -> Arc<[Arc<TriMesh>]> {
        self.world.meshes()
    }

    /// Everything within a radius of a place at a frame.
    #[must_use]
    pub fn snapshot(&self, frame: u32, centre_world_m: [f64; 3], radius_m: f64) -> Snapshot {
        let at = i64::from(frame);
        let moment = Moment {
            states: self.log.states_at(at),
            previous: self.log.states_at(at - 1),
            signals: self.log.signals_at(at),
            frame: &self.log.frames[frame as usize],
        };
        self.world.snapshot(&moment, centre_world_m, radius_m)
    }
}
