//! Models of packs as actors.

use std::sync::Arc;

use crate::packed::ModelError;
use meshes::actors::{ActorMesh, Coarser, Joint, Piece, Rig};
use packs::{Attachment, PackModel};
use schema::scene_info::PackedModelInfo;
use store::Store;
use world::OwnModels;

/// The meshes of a scene's models.
///
/// # Errors
/// A model is missing, broken or another one.
pub(crate) fn read(store: &Store, models: &[PackedModelInfo]) -> Result<OwnModels, ModelError> {
    let read = |info: &PackedModelInfo| {
        let model = crate::packed::read(store, [&info.name, &info.page, &info.hash])?;
        Ok((info.name.clone(), mesh(model)))
    };
    models.iter().map(read).collect()
}

fn mesh(model: PackModel) -> ActorMesh {
    let mut levels = model
        .levels
        .into_iter()
        .map(|level| Coarser { from_m: level.from_m, pieces: level.pieces.into_iter().map(piece).collect() });
    let finest = levels.next().map(|level| level.pieces).unwrap_or_default();
    let rig = model.walker.map(|walker| Arc::new(Rig::Walks(walker)));
    ActorMesh { pieces: finest, coarser: levels.collect(), rig, cabin: None }
}

fn piece(piece: packs::PackPiece) -> Piece {
    let joint = match piece.hang {
        Attachment::Body => Joint::Fixed,
        // Its own mesh for each side: none is turned round.
        Attachment::Wheel { at, steered } => Joint::Wheel { at, steered, right: false },
        Attachment::Door { at, door } => Joint::Leaf { at, door },
        Attachment::Bone(bone) => Joint::Bone(bone),
    };
    Piece { mesh: Arc::clone(&piece.mesh), joint }
}
