//! Models of packs, as the store has them.

use std::sync::Arc;

use actors::{ActorMesh, Coarser, Joint, Piece};
use packs::{Files, Hang, PackError, PackLevel};
use schema::scene_info::PackedModelInfo;
use store::{Store, StoreError, keys};
use world::OwnModels;

/// A model of a pack cannot be read from the store.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The store failed.
    #[error("{0}")]
    Store(#[from] StoreError),
    /// It is missing or broken.
    #[error("{0} (run spawn-planner with --force)")]
    Pack(#[from] PackError),
    /// It is another one than the plan was made with.
    #[error("model {name}: its files are not those of the plan (run spawn-planner with --force)")]
    Other {
        /// The model.
        name: String,
    },
}

/// The files of a model in a store.
struct InStore<'a> {
    store: &'a Store,
    model: &'a str,
}

impl Files for InStore<'_> {
    fn read(&self, path: &str, most: u64) -> Result<Option<Vec<u8>>, String> {
        let key = keys::model_file(self.model, path);
        let bytes = self.store.read(&key).map_err(|e| e.to_string())?;
        // The planner let none in that is larger.
        Ok(bytes.map(|mut bytes| {
            bytes.truncate(usize::try_from(most.saturating_add(1)).unwrap_or(usize::MAX));
            bytes
        }))
    }

    fn location(&self, path: &str) -> String {
        self.store.location(&keys::model_file(self.model, path))
    }
}

/// The meshes of a scene's models.
///
/// # Errors
/// A model is missing, broken or another one.
pub(crate) fn read(store: &Store, models: &[PackedModelInfo]) -> Result<OwnModels, ModelError> {
    let read = |info: &PackedModelInfo| {
        let model = packs::read_model(&info.page, &InStore { store, model: &info.name })?;
        if model.row.hash != info.hash || model.row.name != info.name {
            return Err(ModelError::Other { name: info.name.clone() });
        }
        Ok((info.name.clone(), mesh(model.levels)))
    };
    models.iter().map(read).collect()
}

fn mesh(levels: Vec<PackLevel>) -> ActorMesh {
    let mut levels = levels
        .into_iter()
        .map(|level| Coarser { from_m: level.from_m, pieces: level.pieces.into_iter().map(piece).collect() });
    let finest = levels.next().map(|level| level.pieces).unwrap_or_default();
    ActorMesh { pieces: finest, coarser: levels.collect(), rig: None, cabin: None }
}

fn piece(piece: packs::PackPiece) -> Piece {
    let joint = match piece.hang {
        Hang::Body => Joint::Fixed,
        // Its own mesh for each side: none is turned round.
        Hang::Wheel { at, steered } => Joint::Wheel { at, steered, right: false },
        Hang::Door { at, door } => Joint::Leaf { at, door },
    };
    Piece { mesh: Arc::clone(&piece.mesh), joint }
}
