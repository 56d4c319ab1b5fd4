//! The world at any frame of a log.

use std::sync::Arc;

use crate::packed::ModelError;
use opendrive::Map;
use scene::{SceneError, SceneLog, SceneReader, read_ground};
use schema::ObjectId;
use schema::geometry::{Snapshot, TriMesh};
use world::{Light, Moment, SceneWorld, WorldError};

use crate::models;

/// A scene cannot be replayed from what the store holds.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// Its log cannot be read.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A model of a pack cannot be read.
    #[error("{0}")]
    Model(#[from] ModelError),
    /// Its map cannot be read.
    #[error("{0}")]
    Map(#[from] crate::maps::MapError),
    /// An actor has no mesh.
    #[error("scene {scene}: {source}")]
    World {
        /// The scene.
        scene: u32,
        /// Which, and why.
        source: WorldError,
    },
}

/// A log with the map and meshes it speaks of.
pub struct Replay {
    /// The log.
    pub log: SceneLog,
    /// The map.
    pub map: Map,
    world: SceneWorld,
}

impl Replay {
    /// Opens the log of a scene, reads its tiles and builds its meshes.
    ///
    /// # Errors
    /// The log, the map or a tile is missing or broken, or an actor has no mesh.
    pub fn open(scene: &SceneReader) -> Result<Self, ReplayError> {
        Self::in_light(scene, Light::Any)
    }

    /// The same with what is to be known of the light on its models.
    ///
    /// # Errors
    /// As [`Replay::open`].
    pub fn in_light(scene: &SceneReader, light: Light) -> Result<Self, ReplayError> {
        let log = SceneLog::read(scene)?;
        let map = crate::maps::read(scene.store(), &log.info.map, &log.info.map_hash)?;
        let models = models::read(scene.store(), &log.info.models)?;
        let number = scene.scene();
        let wrong = |source| ReplayError::World { scene: number, source };
        let mut world =
            SceneWorld::with_models(&log.actors, read_ground(scene)?, &models, light).map_err(wrong)?;
        world.set_lamps(&log.lamps);
        Ok(Self { log, map, world })
    }

    /// Adds what cameras see beyond the world around agents, as far as `to_m`.
    pub fn add_horizon(&mut self, to_m: f64) {
        let from_m = self.log.info.world_radius_m;
        if from_m >= to_m {
            return;
        }
        let place = |agent, frame| {
            let [x, y, _] = self.log.world_from_agent(agent, frame).xyz();
            [x, y]
        };
        let frames = 0..self.log.frame_count();
        let agents = 0..self.log.agent_ids().len();
        let places: Vec<[f64; 2]> = agents
            .flat_map(|agent| frames.clone().step_by(10).map(move |frame| (agent, frame)))
            .map(|(a, f)| place(a, f))
            .collect();
        let seed = u64::from_str_radix(self.log.info.map_hash.get(..16).unwrap_or_default(), 16).unwrap_or(0);
        let is_winter = self.log.actors.iter().any(|actor| actor.model.ends_with(".bare"));
        // An agent is elsewhere between the frames that are looked at, by less than a piece is wide.
        let between_m = [from_m - land::horizon::PIECE_M, to_m + land::horizon::PIECE_M];
        let pieces = land::horizon::horizon(&self.map, (seed, is_winter), &places, between_m);
        let pieces = pieces.into_iter().map(|piece| (piece.origin_m, piece.mesh)).collect();
        self.world.add_horizon(pieces, [from_m, to_m]);
    }

    /// All meshes; a snapshot's mesh numbers are indices into them.
    #[must_use]
    pub fn meshes(&self) -> Arc<[Arc<TriMesh>]> {
        self.world.meshes()
    }

    /// What never moves within a radius of a place, and no farther than it is there around every agent, less
    /// `nearer_m`; as detailed as it is at `detail_m`.
    #[must_use]
    pub fn still(&self, centre_world_m: [f64; 3], radius_m: f64, nearer_m: f64, detail_m: f64) -> Snapshot {
        self.world.still(centre_world_m, radius_m.min(self.log.info.world_radius_m) - nearer_m, detail_m)
    }

    /// Whether an object of a snapshot may move.
    #[must_use]
    pub fn moves(&self, object: ObjectId) -> bool {
        self.world.moves(object)
    }

    /// Everything within a radius of a place at a frame, and no farther than the static world is there around
    /// every agent: a place is the same wherever agents came from.
    #[must_use]
    pub fn snapshot(&self, frame: u32, centre_world_m: [f64; 3], radius_m: f64) -> Snapshot {
        let at = i64::from(frame);
        let moment = Moment {
            states: self.log.states_at(at),
            previous: self.log.states_at(at - 1),
            signals: self.log.signals_at(at),
            frame: &self.log.frames[frame as usize],
        };
        self.world.snapshot(&moment, centre_world_m, radius_m.min(self.log.info.world_radius_m))
    }
}
