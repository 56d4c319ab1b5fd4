//! Making tiles.

use crate::surfaces::{Atlas, Region};
use catalogue::Catalogue;
use opendrive::Map;
use schema::geometry::SurfaceMesh;
use schema::tables::{ActorRow, TileObjectRow};
use schema::tile::{TILE_M, TileIndex};
use settings::SceneryRules;

use crate::tiles::number::{TooManyObjects, number, reached};

/// A tile of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// The triangles of its ground.
    pub surfaces: Vec<SurfaceMesh>,
    /// The objects in it.
    pub objects: Vec<TileObjectRow>,
}

/// The static world around some places, without a store.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// The objects there, and the surfaces, with ids.
    pub actors: Vec<ActorRow>,
    /// The triangles of the ground.
    pub ground: Vec<SurfaceMesh>,
}

/// Makes the tiles of a map, any of them in any order and on any thread.
#[derive(Debug)]
pub struct TileMaker<'a> {
    atlas: Atlas<'a>,
    rules: &'a SceneryRules,
    catalogue: &'a Catalogue,
}

impl<'a> TileMaker<'a> {
    /// A maker for a map, the rules of its scenery, and the models that may be parked.
    #[must_use]
    pub fn new(map: &'a Map, rules: &'a SceneryRules, catalogue: &'a Catalogue) -> Self {
        Self { atlas: Atlas::new(map), rules, catalogue }
    }

    /// A tile.
    #[must_use]
    pub fn make(&self, index: TileIndex) -> Tile {
        let min = index.low_m();
        let ground = self.atlas.ground(&Region { min, max: min.map(|v| v + TILE_M) });
        Tile {
            surfaces: ground.surfaces(),
            objects: crate::scenery::place(&ground, self.rules, self.catalogue),
        }
    }

    /// The tiles within reach of some places, numbered from `first_id` on.
    ///
    /// # Errors
    /// There are not so many ids.
    pub fn around(
        &self,
        places: &[[f64; 3]],
        reach_m: f64,
        first_id: usize,
    ) -> Result<Surroundings, TooManyObjects> {
        let tiles: Vec<(TileIndex, Tile)> = reached(places.iter().copied(), reach_m)
            .into_iter()
            .map(|index| (index, self.make(index)))
            .collect();
        let objects: Vec<_> = tiles.iter().map(|(index, tile)| (*index, tile.objects.as_slice())).collect();
        let layers = tiles.iter().flat_map(|(_, tile)| &tile.surfaces).map(|piece| piece.layer).collect();
        let actors = number(&objects, &layers, first_id)?.actors;
        Ok(Surroundings { actors, ground: tiles.into_iter().flat_map(|(_, tile)| tile.surfaces).collect() })
    }
}
