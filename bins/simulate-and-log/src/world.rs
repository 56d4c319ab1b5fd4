//! The static world of a scene: tiles, asked for as agents come near, and numbered in the end.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

use land::tiles::{Numbered, number, reached};
use nalgebra::Point3;
use replay::tiles::{KnownTile, TileError, TileStore};
use runner::{At, Place, StageError};
use schema::ObjectId;
use schema::tables::{ActorRow, SceneTileRow, SignalRow};
use schema::tile::TileIndex;
use schema::{ActorKind, ActorRole};
use traffic::{FixedWorld, SimulationLog};

/// A store's failure is not the scene's.
pub(crate) fn failed(error: TileError, place: &Place) -> StageError {
    match error {
        TileError::Store(error) => error.into(),
        error => match Err::<(), _>(error).at(|| place.clone()) {
            Err(error) => error,
            Ok(()) => StageError::Stopped,
        },
    }
}

/// The tiles around agents, for traffic.
#[derive(Debug)]
pub(crate) struct Nearby<'a> {
    tiles: &'a TileStore<'a>,
    reach_m: f64,
    failed: Mutex<Option<TileError>>,
}

impl<'a> Nearby<'a> {
    pub(crate) fn new(tiles: &'a TileStore<'a>, reach_m: f64) -> Self {
        Self { tiles, reach_m, failed: Mutex::default() }
    }

    /// Why the simulation was ended, if it was for want of a tile.
    pub(crate) fn into_error(self) -> Option<TileError> {
        self.failed.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl FixedWorld for Nearby<'_> {
    fn near(&self, places: &[Point3<f64>], seen: &mut BTreeSet<TileIndex>) -> ControlFlow<(), Vec<ActorRow>> {
        let near = reached(places.iter().map(|p| (*p).into()), self.reach_m);
        let new: BTreeSet<TileIndex> = near.difference(seen).copied().collect();
        if new.is_empty() {
            return ControlFlow::Continue(Vec::new());
        }
        match self.tiles.get(&new) {
            Ok(tiles) => {
                seen.extend(new);
                // They have no ids before it is known which of them the scene has.
                let objects = tiles.iter().flat_map(|tile| &tile.objects).map(|object| object.actor(0));
                ControlFlow::Continue(objects.collect())
            }
            Err(error) => {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                ControlFlow::Break(())
            }
        }
    }
}

/// The tiles that a scene has.
pub(crate) struct SceneTiles {
    tiles: Vec<Arc<KnownTile>>,
    /// The objects in them, and their surfaces, with ids.
    pub(crate) actors: Vec<ActorRow>,
    /// The rows of the log.
    pub(crate) rows: Vec<SceneTileRow>,
}

impl SceneTiles {
    /// The tiles within reach of any agent at any frame. Ids follow those of moving objects.
    ///
    /// # Errors
    /// The store fails, or ids run out.
    pub(crate) fn of(
        tiles: &TileStore<'_>,
        log: &SimulationLog,
        reach_m: f64,
        place: &Place,
    ) -> Result<Self, StageError> {
        let is_agent = |actor: &&ActorRow| matches!(actor.role, ActorRole::Agent(_));
        let agents: BTreeSet<ObjectId> = log.actors.iter().filter(is_agent).map(|a| a.id).collect();
        let states = log.states.iter().filter(|s| s.frame >= 0 && agents.contains(&s.id)).map(|s| s.xyz_m);
        let standing = log.actors.iter().filter(is_agent).filter(|a| a.fixed).map(|a| a.xyz_m);
        let tiles_of_scene = tiles.get(&reached(states.chain(standing), reach_m));
        let found = tiles_of_scene.map_err(|error| failed(error, place))?;
        let objects: Vec<_> = found.iter().map(|tile| (tile.index, tile.objects.as_slice())).collect();
        let layers = found.iter().flat_map(|tile| &tile.layers).copied().collect();
        let numbered = number(&objects, &layers, log.actors.len() + 1).at(|| place.clone())?;
        let Numbered { actors, first_ids } = numbered;
        let set = format!("{:016x}", tiles.set());
        let row = |(tile, first_id): (&Arc<KnownTile>, &ObjectId)| SceneTileRow {
            set: set.clone(),
            x: tile.index.x,
            y: tile.index.y,
            digest: tile.digest.clone(),
            first_id: *first_id,
            objects: tile.objects.len() as u32,
        };
        let rows = found.iter().zip(&first_ids).map(row).collect();
        Ok(Self { tiles: found, actors, rows })
    }

    /// Which tiles they are.
    pub(crate) fn indices(&self) -> impl Iterator<Item = TileIndex> {
        self.tiles.iter().map(|tile| tile.index)
    }

    /// What the traffic lights of the scene showed: rows for the ids that they have got, by frame, then id.
    pub(crate) fn signals(&self, shown: &[SignalRow]) -> Vec<SignalRow> {
        let mut ids: BTreeMap<&str, Vec<ObjectId>> = BTreeMap::new();
        for light in self.actors.iter().filter(|a| a.kind == ActorKind::TrafficLight) {
            ids.entry(light.opendrive_id.as_deref().unwrap_or_default()).or_default().push(light.id);
        }
        let mut rows = Vec::with_capacity(shown.len());
        for frame in shown.chunk_by(|a, b| a.frame == b.frame) {
            let states: BTreeMap<&str, &SignalRow> =
                frame.iter().map(|row| (row.opendrive_id.as_str(), row)).collect();
            let first = rows.len();
            for (name, row) in states {
                let ids = ids.get(name).into_iter().flatten();
                rows.extend(ids.map(|id| SignalRow { id: *id, ..row.clone() }));
            }
            rows[first..].sort_by_key(|row| row.id);
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use schema::SignalState;

    #[test]
    fn lights_of_the_scene_have_its_ids_at_every_frame() {
        let light = |id, name: &str| ActorRow {
            id,
            kind: ActorKind::TrafficLight,
            opendrive_id: Some(name.into()),
            ..ActorRow::default()
        };
        let actors = vec![light(90, "b"), light(91, "a"), ActorRow { id: 92, ..ActorRow::default() }];
        let scene = SceneTiles { tiles: Vec::new(), actors, rows: Vec::new() };
        let shown = |frame, name: &str, state| SignalRow { frame, id: 0, state, opendrive_id: name.into() };
        let shown = [
            shown(-1, "a", SignalState::Red),
            shown(-1, "b", SignalState::Green),
            shown(-1, "far", SignalState::Green),
            shown(0, "a", SignalState::Green),
            shown(0, "b", SignalState::Yellow),
        ];
        let found: Vec<_> = scene.signals(&shown).iter().map(|r| (r.frame, r.id, r.state)).collect();
        let wanted = [
            (-1, 90, SignalState::Green),
            (-1, 91, SignalState::Red),
            (0, 90, SignalState::Yellow),
            (0, 91, SignalState::Green),
        ];
        assert_eq!(found, wanted);
    }
}
