//! The areas that a scene has surfaces of, as its actor rows name them.

use schema::tables::ActorRow;
use schema::{ActorKind, ObjectId};

use crate::layer::Layer;
use crate::region::Region;

/// An area with surfaces, each of which is one object.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Where it is.
    pub region: Region,
    /// Its layers with their objects.
    layers: Vec<(Layer, ObjectId)>,
}

impl Area {
    /// The object that a layer of this area is; none where the scene leaves it out.
    #[must_use]
    pub fn object(&self, layer: Layer) -> Option<ObjectId> {
        self.layers.iter().find(|(own, _)| *own == layer).map(|(_, object)| *object)
    }
}

/// Why a row of kind `surface` stands for no area.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AreaError {
    /// There is no such layer.
    #[error("actor {id}: unknown model `{model}`")]
    UnknownModel {
        /// The actor.
        id: ObjectId,
        /// Its model.
        model: String,
    },
    /// Its place or extent is none.
    #[error("actor {id} ({model}): the area of a surface must have a finite, positive extent")]
    BadExtent {
        /// The actor.
        id: ObjectId,
        /// Its model.
        model: String,
    },
}

/// The areas that the rows of kind `surface` stand for, in the order of the rows; layers of one area are together. A row's
/// position is the middle of its area, length and width are the extent.
///
/// # Errors
/// A row has a model that is no layer, or an extent that is none.
pub fn areas<'a>(rows: impl IntoIterator<Item = &'a ActorRow>) -> Result<Vec<Area>, AreaError> {
    let mut areas: Vec<Area> = Vec::new();
    for actor in rows.into_iter().filter(|a| a.kind == ActorKind::Surface) {
        let layer = Layer::from_model(&actor.model)
            .ok_or_else(|| AreaError::UnknownModel { id: actor.id, model: actor.model.clone() })?;
        let half = [0.5 * actor.length_m, 0.5 * actor.width_m];
        let region = Region {
            min: [actor.xyz_m[0] - half[0], actor.xyz_m[1] - half[1]],
            max: [actor.xyz_m[0] + half[0], actor.xyz_m[1] + half[1]],
        };
        let usable = half.iter().all(|h| *h > 0.0 && *h < 1e5) && actor.xyz_m.iter().all(|v| v.abs() < 1e8);
        if !usable {
            return Err(AreaError::BadExtent { id: actor.id, model: actor.model.clone() });
        }
        match areas.iter_mut().find(|known| known.region == region) {
            Some(known) => known.layers.push((layer, actor.id)),
            None => areas.push(Area { region, layers: vec![(layer, actor.id)] }),
        }
    }
    Ok(areas)
}
