//! From tiles to the objects of a scene.

use std::collections::BTreeSet;

use schema::tables::{ActorRow, TileObjectRow};
use schema::tile::{TILE_M, TILE_OVERHANG_M, TileIndex};
use schema::{ActorKind, ActorRole, Layer, ObjectId};

/// The tiles of which something may be within a distance of one of some places, in their order.
#[must_use]
pub fn reached(places: impl IntoIterator<Item = [f64; 3]>, reach_m: f64) -> BTreeSet<TileIndex> {
    let near = |[x, y, _]: [f64; 3]| TileIndex::near(x, y, reach_m + TILE_OVERHANG_M);
    places.into_iter().flat_map(near).collect()
}

/// The static objects of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbered {
    /// Their rows: a surface for each layer, then the objects in each tile; ids ascend without gaps.
    pub actors: Vec<ActorRow>,
    /// Id of the first object of each tile; where a tile has none, that of the next tile's first.
    pub first_ids: Vec<ObjectId>,
}

/// The static objects of a scene do not fit into its ids.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{fixed} static objects in the {tiles} tiles that agents come near do not fit into the ids from {first_id} to 65535 \
     (lower world.radius_m, timing.max_duration_s, agents.max_vehicles, or the densities of [world])"
)]
pub struct TooManyObjects {
    /// How many there are.
    pub fixed: usize,
    /// In how many tiles.
    pub tiles: usize,
    /// The first free id.
    pub first_id: usize,
}

/// Numbers the static world of a scene from `first_id` on: one object for each of the layers, then the
/// objects in each of the tiles, in the order in which they are given.
///
/// Rows of kind `surface` lie in the middle of the tiles; their length and width are the extent of these.
///
/// # Errors
/// There are not so many ids.
pub fn number(
    tiles: &[(TileIndex, &[TileObjectRow])],
    layers: &BTreeSet<Layer>,
    first_id: usize,
) -> Result<Numbered, TooManyObjects> {
    let fixed = layers.len() + tiles.iter().map(|(_, objects)| objects.len()).sum::<usize>();
    let last = first_id + fixed;
    let too_many = || TooManyObjects { fixed, tiles: tiles.len(), first_id };
    // A tile without objects at the end names the id after the last one: that one must exist, too.
    if first_id == 0 || last > usize::from(ObjectId::MAX) {
        return Err(too_many());
    }
    let mut ids = (first_id..last).map(|id| id as ObjectId);
    let mut numbered = Numbered::default();
    let middle_and_extent = extent(tiles.iter().map(|(index, _)| *index));
    for (layer, id) in layers.iter().zip(&mut ids) {
        numbered.actors.push(surface(*layer, id, middle_and_extent));
    }
    for (_, objects) in tiles {
        numbered.first_ids.push((first_id + numbered.actors.len()) as ObjectId);
        numbered.actors.extend(objects.iter().zip(&mut ids).map(|(object, id)| object.actor(id)));
    }
    Ok(numbered)
}

/// Middle and extent of some tiles along x and y, metres.
fn extent(tiles: impl Iterator<Item = TileIndex>) -> [[f64; 2]; 2] {
    let corners: Vec<[f64; 2]> = tiles.map(TileIndex::low_m).collect();
    let axis = |k: usize| {
        let low = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
        let high = corners.iter().map(|c| c[k] + TILE_M).fold(f64::NEG_INFINITY, f64::max);
        if corners.is_empty() { [0.0, 0.0] } else { [0.5 * (low + high), high - low] }
    };
    [axis(0), axis(1)]
}

fn surface(layer: Layer, id: ObjectId, [x, y]: [[f64; 2]; 2]) -> ActorRow {
    ActorRow {
        id,
        kind: ActorKind::Surface,
        model: layer.name().to_owned(),
        role: ActorRole::Scenery,
        semantic_tags: vec![layer.tag() as u8],
        length_m: x[1],
        width_m: y[1],
        color: vec![128; 3],
        fixed: true,
        xyz_m: [x[0], y[0], 0.0],
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..ActorRow::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn objects(n: usize) -> Vec<TileObjectRow> {
        (0..n).map(|k| TileObjectRow { model: format!("thing.{k}"), ..TileObjectRow::default() }).collect()
    }

    #[test]
    fn ids_go_by_layer_then_tile_then_place_in_it() {
        let (few, none, many) = (objects(2), objects(0), objects(3));
        let at = |x, y| TileIndex { x, y };
        let tiles: [(TileIndex, &[TileObjectRow]); 3] =
            [(at(0, 0), &few), (at(0, 1), &none), (at(1, 0), &many)];
        let layers = BTreeSet::from([Layer::Terrain, Layer::Road]);
        let numbered = number(&tiles, &layers, 41).expect("there are ids");
        let ids: Vec<_> = numbered.actors.iter().map(|a| (a.id, a.model.as_str())).collect();
        let wanted = [
            (41, "surface.road"),
            (42, "surface.terrain"),
            (43, "thing.0"),
            (44, "thing.1"),
            (45, "thing.0"),
            (46, "thing.1"),
            (47, "thing.2"),
        ];
        assert_eq!(ids, wanted);
        assert_eq!(numbered.first_ids, [43, 45, 45]);
        assert!(numbered.actors.iter().all(|a| a.fixed && a.role == ActorRole::Scenery));
        // Two by two tiles.
        let road = &numbered.actors[0];
        assert_eq!((road.xyz_m, road.length_m, road.width_m), ([256.0, 256.0, 0.0], 512.0, 512.0));
    }

    #[test]
    fn too_many_say_what_to_lower() {
        let many = objects(65_000);
        let tiles: [(TileIndex, &[TileObjectRow]); 1] = [(TileIndex::default(), &many)];
        assert!(number(&tiles, &BTreeSet::new(), 535).is_ok());
        let error = number(&tiles, &BTreeSet::new(), 536).expect_err("no id is left");
        assert_eq!(error, TooManyObjects { fixed: 65_000, tiles: 1, first_id: 536 });
        assert!(error.to_string().contains("world.radius_m"), "{error}");
        assert!(number(&[], &BTreeSet::new(), 0).is_err());
    }

    #[test]
    fn tiles_are_reached_with_what_overhangs_them() {
        // 128 m to every side of a tile's middle, less what may overhang.
        let middle = [128.0, 128.0, 7.0];
        assert_eq!(reached([middle], 127.0 - TILE_OVERHANG_M), BTreeSet::from([TileIndex::default()]));
        assert_eq!(reached([middle], 128.0 - TILE_OVERHANG_M).len(), 5);
        assert_eq!(reached([middle, [896.0, 128.0, 0.0]], 127.0 - TILE_OVERHANG_M).len(), 2);
    }
}
